"""The library's messages in the panel's words: they name options of the command line, which a user of the panel has never seen."""

import re

from slicer.i18n import tr as _


def inPanelWords(text: str) -> str:
    """`text` with every option that the panel has replaced by what it is called there, and its placeholders left out."""

    def word(found) -> str:
        shown = _words().get(found["option"])
        return found[0] if shown is None else f"\N{LEFT DOUBLE QUOTATION MARK}{shown}\N{RIGHT DOUBLE QUOTATION MARK}"

    return re.sub(r"(?P<option>--[a-z][a-z-]*)(?: [A-Z]{2,}\b)*", word, text)


def _words() -> dict:
    return {
        "--apex-px": _("Apex"),
        "--bone-labels": _("Bone"),
        "--bone-probability": _("Bone"),
        "--bone-transform": _("the transform of the CT"),
        "--config": _("Configuration"),
        "--grid-like": _("Like volume"),
        "--hole-limit": _("Hole limit"),
        "--intensity-maximum": _("Brightest value"),
        "--output-type": _("Voxel type"),
        "--probe": _("Probe"),
        "--skip": _("Every N-th frame"),
        "--spacing": _("Spacing"),
    }
