"""Segments as outlines while a reconstruction is on display: filled, they would hide the very surface that it is about."""

from . import sliceDisplay
from .borrowed import Borrowed

UNFILLED = Borrowed("Visibility2DFill", False, "AIFRecon.FilledBefore")
OUTLINED = Borrowed("Visibility2DOutline", True, "AIFRecon.OutlinedBefore")
THIN = Borrowed("SliceIntersectionThickness", 1, "AIFRecon.ThicknessBefore")
HIDDEN = Borrowed("Visibility2D", False, "AIFRecon.HiddenIn2D")


class BoneOutlines:
    """Follows the bone that the parameters name, and gives it its fill back at the end.

    Notes
    -----
    It changes a segmentation when a reconstruction comes on display: one that the user fills again after that stays filled.
    """

    def __init__(self):
        self._parameterNode = None

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none: then the user leaves."""
        self._parameterNode = parameterNode
        if parameterNode is None:
            self._follow(None)

    def update(self) -> None:
        """Outline the bone, or hide it if that is chosen, while a reconstruction is on display."""
        bone = self._parameterNode.bone
        isSegmented = bone is not None and bone.IsA("vtkMRMLSegmentationNode")
        display = bone.GetDisplayNode() if isSegmented and sliceDisplay.showsReconstruction() else None
        self._follow(display, None if self._parameterNode.showBoneOutlines else display)

    def _follow(self, display, hidden=None) -> None:
        for each in (UNFILLED, OUTLINED, THIN):
            each.follow(display)
        HIDDEN.follow(hidden)
