"""Segments as outlines while a reconstruction is on display: filled, they would hide the very surface that it is about."""

import slicer

from . import sliceDisplay


class BoneOutlines:
    """Follows the bone that the parameters name, and gives it its fill back at the end.

    Notes
    -----
    It changes a segmentation when a reconstruction comes on display: one that the user fills again after that stays filled.
    """

    def __init__(self):
        self._parameterNode = None
        self._displayID = None
        self._wasFilled = False

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none: then the user leaves."""
        self._parameterNode = parameterNode
        if parameterNode is None:
            self._follow(None)

    def update(self) -> None:
        """Outline the bone, if a reconstruction is on display."""
        bone = self._parameterNode.bone
        isSegmented = bone is not None and bone.IsA("vtkMRMLSegmentationNode") and bone.GetDisplayNode() is not None
        self._follow(bone.GetDisplayNode() if isSegmented and sliceDisplay.showsReconstruction() else None)

    def _follow(self, display) -> None:
        displayID = display.GetID() if display is not None else None
        if displayID == self._displayID:
            return
        before = slicer.mrmlScene.GetNodeByID(self._displayID) if self._displayID is not None else None
        if before is not None and self._wasFilled:
            before.SetVisibility2DFill(True)
        self._displayID = displayID
        if display is not None:
            self._wasFilled = bool(display.GetVisibility2DFill())
            display.SetVisibility2DFill(False)
            display.SetVisibility2DOutline(True)
