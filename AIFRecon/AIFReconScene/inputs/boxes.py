"""The box to reconstruct in, which is laid around what there is while it has no size; and the part of the image that is ultrasound."""

import slicer
from slicer.i18n import tr as _

from AIFReconLib.errors import AIFReconError
from AIFReconLib.worker.reconstructing import corners_of_sweep, recognized_clip

from ..sceneNodes import boundsOf
from ..sweep.browserItems import checkRecorded
from ..sweep.sequenceReader import sequenceFromBrowser
from ..work import inWorker
from .inputs import Inputs


def isEmpty(roiNode) -> bool:
    """Whether a box has no place or no size, as "Create new" makes it."""
    return not roiNode.GetNumberOfControlPoints() or min(roiNode.GetSize()) <= 0


def layAround(roiNode, parameters) -> None:
    """Lay a box along the axes of RAS around the chosen sweep, else around the CT; nothing happens where neither has a place.

    It is shown as its edges, with handles: filled and with its name across, which is Slicer's default, it would hide the images.
    """
    found = _aroundSweep(parameters)
    found = _aroundVolume(parameters.ctVolume) if found is None else found
    if found is None:
        return
    least, most = found
    with slicer.util.NodeModify(roiNode):
        roiNode.SetCenterWorld(*((least + most) / 2))
        roiNode.SetSize(*(most - least))
    if roiNode.GetDisplayNode() is None:
        roiNode.CreateDefaultDisplayNodes()
    display = roiNode.GetDisplayNode()
    with slicer.util.NodeModify(display):
        display.SetFillVisibility(False)
        display.SetOutlineVisibility(True)
        display.SetPropertiesLabelVisibility(False)
        display.SetHandlesInteractive(True)


def _aroundSweep(parameters) -> tuple | None:
    """Least and most RAS coordinates, (3,) mm each, of the voxels that hold every pixel of the sweep that counts."""
    if parameters.sweep is None:
        return None
    try:
        inputs = Inputs.fromParameters(parameters)
        least, most = inWorker(corners_of_sweep, inputs.sequence(), inputs.recipe)
    except AIFReconError:
        return None  # the panel says what is wrong with the sweep
    return least - parameters.spacing / 2, most + parameters.spacing / 2


def _aroundVolume(volumeNode) -> tuple | None:
    """Least and most RAS coordinates, (3,) mm each, of a volume."""
    if volumeNode is None or volumeNode.GetImageData() is None:
        return None
    return tuple(boundsOf(volumeNode).T)


def clipAsRecognized(parameters, progress=None) -> str:
    """Set the clip rectangle to what is recognized in the chosen sweep, and return it in words; an AIFReconError says why there is none."""
    checkRecorded(parameters.sweep)
    x, y, width, height = inWorker(recognized_clip, sequenceFromBrowser(parameters.sweep, parameters.imageSequence), progress=progress)
    parameters.clipColumn, parameters.clipRow, parameters.clipWidth, parameters.clipHeight = x, y, width, height
    words = _("Set as recognized: columns {left:g} to {right:g}, rows {top:g} to {bottom:g}.")
    return words.format(left=x, right=x + width, top=y, bottom=y + height)
