"""Slice views turned as a scanner shows them: the probe's side up, in the sweep's own planes; or as radiologists look."""

import numpy as np
import slicer

from AIFReconLib.errors import AIFReconError
from AIFReconLib.sweep.poses import sweep_poses

from ..display import sliceDisplay
from ..sweep.sequenceReader import sequenceFromBrowser
from ..sweep.sweepStatus import sweepKey
from ..transforms import placeOf

LEAST = 0.3
"""Length of the mean of unit vectors below which they point everywhere: the first frame then tells which way the columns run."""


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
        axes = sweepAxes(browser, imageSequence, placeOf(bone)[:3, 2])
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


def sweepAxes(browser, imageSequence, head) -> tuple:
    """The axes of three views, (3, 3) each: right, up and out of the screen as columns, in RAS; so is `head` (3,), toward the patient's.

    An AIFReconError says that no frame of the sweep can be placed.
    """
    sequence = sequenceFromBrowser(browser, imageSequence)
    poses = sweep_poses(sequence)
    poses.require_usable(sequence.name)
    placed = poses.image_to_reference[poses.usable][:, :3, :2]
    across, beam = (_mean(placed[..., axis]) for axis in (0, 1))
    across = across - (across @ beam) * beam
    across /= np.linalg.norm(across)
    along = np.cross(across, beam)
    along = along if along @ head > 0 else -along
    pairs = ((across, -beam), (-along, -beam), (np.cross(along, -beam), along))
    return tuple(np.column_stack([right, up, np.cross(right, up)]) for right, up in pairs)


def _mean(directions: np.ndarray) -> np.ndarray:
    unit = directions / np.linalg.norm(directions, axis=1)[:, None]
    mean = unit.mean(axis=0)
    mean = mean if np.linalg.norm(mean) >= LEAST else unit[0]
    return mean / np.linalg.norm(mean)
