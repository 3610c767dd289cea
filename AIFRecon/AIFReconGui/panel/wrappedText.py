"""Texts of several lines that get the room they need."""


def say(label, text: str) -> None:
    """Show a text in a label that wraps its words, with room for all of its lines.

    Notes
    -----
    The panel's layouts hear of a least height at once, but go by what they knew of the height that a width asks for: without a least
    height a text that grows squeezes the sections around it, in Slicer itself though not everywhere.
    """
    label.text = text
    label.minimumHeight = label.heightForWidth(label.width) if text and label.visible else 0
