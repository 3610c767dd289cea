"""The signs and colors of the panel: each with a shape, a word and letters that stand out, so that nobody needs to tell the colors."""

from slicer.i18n import tr as _

GREEN, YELLOW, RED, GRAY = ("#1b7a3d", "#ffffff"), ("#f2b100", "#000000"), ("#b3261e", "#ffffff"), ("#5f6368", "#ffffff")
"""Background and letters; the contrast is 5 or more on each."""

SIGNS = {"good": ("\N{CHECK MARK}", GREEN), "look": ("\N{BLACK UP-POINTING TRIANGLE}", YELLOW), "poor": ("\N{BALLOT X}", RED)}
"""By level: the shape that stands before the word, and its colors."""

UNKNOWN = ("\N{WHITE CIRCLE}", GRAY)


def signOf(level: str) -> tuple:
    """Shape and word, and the style, of a level of `AIFReconLib.inspection.verdicts`."""
    shape, colors = SIGNS.get(level, UNKNOWN)
    word = {"good": _("good"), "look": _("caution"), "poor": _("poor")}.get(level, _("not yet"))
    return f"{shape} {word}", styleOf(colors)


def styleOf(colors: tuple, pixels: int = 0) -> str:
    """The style of a label in these colors; with `pixels` in letters that are read from two meters."""
    background, letters = colors
    size = f" font-size: {pixels}px; padding: 10px;" if pixels else " padding: 3px;"
    return f"QLabel {{ background-color: {background}; color: {letters}; font-weight: bold; border-radius: 4px;{size} }}"
