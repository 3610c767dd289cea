"""The library's messages in the user's language and the panel's words: they name options, which a user of the panel has never seen."""

import contextlib
import re

from slicer.i18n import tr as _
from slicer.i18n import translate

from AIFReconLib.errors import AIFReconError, OperationCanceled
from AIFReconLib.message import translated

LIBRARY_CONTEXT = "AIFReconLib"
"""Where translations of the library's sentences are looked up; `make translations` lists them there."""


def inPanelWords(message) -> str:
    """A message of the library, translated, with every option that the panel has replaced by what it is called there.

    Parameters
    ----------
    message : Message, AIFReconError or str
        A plain str has lost what it was made of: it stays in English.
    """
    text = str(translated(message, lambda template: translate(LIBRARY_CONTEXT, template)))

    def word(found) -> str:
        shown = _words().get(found["option"])
        return found[0] if shown is None else f"\N{LEFT DOUBLE QUOTATION MARK}{shown}\N{RIGHT DOUBLE QUOTATION MARK}"

    return re.sub(r"(?P<option>--[a-z][a-z-]*)(?: [A-Z][A-Z0-9]*\b)*", word, text)


@contextlib.contextmanager
def errorsInPanelWords():
    """Errors of the library leave the block in the panel's words; a cancel as it is."""
    try:
        yield
    except OperationCanceled:
        raise
    except AIFReconError as error:
        raise type(error)(inPanelWords(error)) from error


def _words() -> dict:
    return {
        "--apex-px": _("Apex"),
        "--bone-from-sweep": _("Look for bone in the sweep"),
        "--bone-labels": _("Bone"),
        "--bone-probability": _("Bone"),
        "--bone-transform": _("the transform of the CT"),
        "--clip-px": _("Clip rectangle"),
        "--config": _("Configuration"),
        "--fan-angles-deg": _("Fan angles"),
        "--fan-radius-px": _("Fan radii"),
        "--grid-like": _("Like volume"),
        "--hole-limit": _("Hole limit"),
        "--importance-mask": _("Importance mask"),
        "--intensity-maximum": _("Brightest value"),
        "--longest-gap": _("Longest gap"),
        "--orientation": _("Stored pixels"),
        "--output-type": _("Voxel type"),
        "--probe": _("Probe"),
        "--skip": _("Every N-th frame"),
        "--spacing": _("Spacing"),
        "--speed-of-sound": _("Speed of sound"),
        "--time-offset": _("Time offset"),
    }
