"""The part of the image that is ultrasound, as it is recognized in a sweep."""

from slicer.i18n import tr as _

from AIFReconLib.worker.reconstructing import recognized_clip

from ..sweep.browserItems import checkRecorded
from ..sweep.sequenceReader import sequenceFromBrowser
from ..work import inWorker


def clipAsRecognized(parameters, progress=None) -> str:
    """Set the clip rectangle to what is recognized in the chosen sweep, and return it in words; an AIFReconError says why there is none."""
    checkRecorded(parameters.sweep)
    x, y, width, height = inWorker(recognized_clip, sequenceFromBrowser(parameters.sweep, parameters.imageSequence), progress=progress)
    parameters.clipColumn, parameters.clipRow, parameters.clipWidth, parameters.clipHeight = x, y, width, height
    words = _("Set as recognized: columns {left:g} to {right:g}, rows {top:g} to {bottom:g}.")
    return words.format(left=x, right=x + width, top=y, bottom=y + height)
