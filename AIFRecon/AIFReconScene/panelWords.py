"""What the panel says of an error of the library, settings by the names of its controls."""

import re
from functools import partial

from slicer.i18n import tr as _

from AIFReconLib.io.foreign.options import RULES as OF_IMPORT
from AIFReconLib.message import Spelling, advised, as_label
from AIFReconLib.recipe.recipe import RULES


def inPanelWords(sentence) -> str:
    """A sentence or an error of the library, and what to do about it in the panel."""
    return advised(sentence, asControl())


def inImportWords(sentence) -> str:
    """The same in the dialog that asks what images and poses do not say."""
    return advised(sentence, partial(as_label, {name: rule["label"].rstrip(":") for name, rule in OF_IMPORT.items()}))


def withNames(text: str, names: dict[int, str]) -> str:
    """A text with the names of bones in the place of the numbers of their labels."""
    return re.sub(r"\blabel (\d+)\b", lambda found: names.get(int(found[1]), found[0]), text)


def asControl() -> Spelling:
    """How the panel writes a setting; the worker takes it, too."""
    inputs = {
        "accept": _("Move CT there"),
        "bone_from_sweep": _("Bone told by"),
        "bone_labels": _("Bone of CT"),
        "bone_probability": _("Bone of CT"),
        "bone_transform": _("Place CT on sweep"),
        "calibrate": _("Calibrate on this sweep"),
        "config": _("Open recording, calibration, CT..."),
        "check": _("Calibrate on this sweep"),
        "ct": _("Bone from CT"),
        "grid_like": _("Like volume"),
        "labels": _("Segments that are bone"),
        "import": _("Import..."),
        "level": _("Places"),
        "register": _("Place CT on sweep"),
        "target": _("Target"),
    }
    return partial(as_label, {**{name: rule["label"].rstrip(":") for name, rule in RULES.items()}, **inputs})
