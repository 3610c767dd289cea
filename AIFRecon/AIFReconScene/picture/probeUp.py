"""Slice views turned as a scanner shows them: the probe's side up, in the sweep's own planes; or as radiologists look."""

import slicer

from AIFReconLib.errors import AIFReconError
from AIFReconLib.sweep.probe_up import probe_up_axes

from ..display import sliceDisplay
from ..sweep.sequenceReader import sequenceFromBrowser
from ..sweep.sweepStatus import sweepKey
from ..transforms import placeOf


class ProbeUp:
    """Turns the red, yellow and green view when the choice or the sweep changes, and leaves a view alone that the user turns after that.

    Notes
    -----
    Red lies as the frames do, yellow along the sweep with the head on the left, green across the beams as one looks along them. The
    turns are orientations of the views, by name in their bars; the center of each view stays.
    """

    def __init__(self):
        self._turned = None

    def update(self, parameters) -> None:
        """Follow the parameters; a sweep that cannot be placed turns nothing."""
        wanted = None
        if parameters.probeUp and parameters.sweep is not None:
            bone = parameters.bone.GetTransformNodeID() if parameters.bone is not None else None
            wanted = sweepKey(parameters.sweep, parameters.imageSequence), bone
        if wanted == self._turned:
            return
        self._turned = wanted
        with slicer.util.RenderBlocker():
            if wanted is None:
                _turnBack()
            else:
                _turnTo(parameters.sweep, parameters.imageSequence, parameters.bone)

    def clear(self) -> None:
        """The user leaves, or the scene goes with its views: what is turned stays so."""
        self._turned = None


def _turnBack() -> None:
    for node in sliceDisplay.mainViews():
        if node.GetOrientation() == orientationName(node):
            node.SetOrientationToDefault()


def _turnTo(browser, imageSequence, bone) -> None:
    try:
        axes = probe_up_axes(sequenceFromBrowser(browser, imageSequence), placeOf(bone)[:3, 2])
    except AIFReconError:
        return
    for node, turn in zip(sliceDisplay.mainViews(), axes):
        name, matrix = orientationName(node), slicer.util.vtkMatrixFromArray(turn)
        if node.HasSliceOrientationPreset(name):
            node.RemoveSliceOrientationPreset(name)
        node.AddSliceOrientationPreset(name, matrix)
        node.SetOrientation(name)


def orientationName(sliceNode) -> str:
    """What a view's orientation is called.

    MRML writes it into the scene as a part of an XML attribute's name: with a blank or a comma in it the scene could be opened no more.
    """
    return "".join(letter for letter in sliceNode.GetDefaultOrientation() if letter.isalnum()) + "ProbeUp"
