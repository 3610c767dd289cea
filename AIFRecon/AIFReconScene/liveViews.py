"""The views during a scan: the red one lies in the frame that is seen now, the others show the growing volume over the CT."""

import numpy as np
import slicer

from . import sliceDisplay
from .transforms import ijkToRAS

FOLLOWING = "Red"
OTHERS = ("Yellow", "Green")
MARGIN = 1.1
"""Of the view around the frame."""


class LiveViews:
    """Moves the red slice with the probe and puts everything back at the end.

    Parameters
    ----------
    ctNode : vtkMRMLScalarVolumeNode or None
    opacity : float, 0 to 1
        Of the volume over the CT.
    """

    def __init__(self, ctNode, opacity: float):
        self._ct = ctNode
        self._opacity = opacity
        self._orientation = None
        self._volume = None

    def showFrame(self, frameNode) -> None:
        """Let the red slice lie in the frame, at its true place in the 3D view too."""
        logic = slicer.app.applicationLogic().GetSliceLogicByLayoutName(FOLLOWING)
        if logic is None:
            return
        node, composite = logic.GetSliceNode(), logic.GetSliceCompositeNode()
        if self._orientation is None:
            self._orientation = node.GetOrientation()
            composite.SetBackgroundVolumeID(frameNode.GetID())
            composite.SetForegroundVolumeID(None)
            node.SetSliceVisible(True)
        pose = ijkToRAS(frameNode)
        columns, rows, _slices = frameNode.GetImageData().GetDimensions()
        spacing = np.linalg.norm(pose[:3, :2], axis=0)
        across, down = pose[:3, 0] / spacing[0], pose[:3, 1] / spacing[1]
        normal = np.cross(across, -down)
        center = pose @ [(columns - 1) / 2, (rows - 1) / 2, 0.0, 1.0]
        # Screens have their y axis upward, images have their rows downward
        sliceToRAS = np.eye(4)
        sliceToRAS[:3] = np.column_stack([across, -down, normal / np.linalg.norm(normal), center[:3]])
        width, height, _depth = node.GetDimensions()
        shown = MARGIN * max(columns * spacing[0] / max(width, 1), rows * spacing[1] / max(height, 1))
        with slicer.util.NodeModify(node):
            node.GetSliceToRAS().DeepCopy(slicer.util.vtkMatrixFromArray(sliceToRAS))
            node.SetFieldOfView(shown * width, shown * height, node.GetFieldOfView()[2])
            node.UpdateMatrices()

    def showVolume(self, volumeNode) -> None:
        """Show the growing volume over the CT in the other views, once."""
        if self._volume is volumeNode:
            return
        self._volume = volumeNode
        sliceDisplay.showOverCT(volumeNode, self._ct, self._opacity, views=OTHERS)

    def restore(self) -> None:
        """The red slice as it was."""
        logic = slicer.app.applicationLogic().GetSliceLogicByLayoutName(FOLLOWING)
        if logic is None or self._orientation is None:
            return
        logic.GetSliceNode().SetSliceVisible(False)
        logic.GetSliceNode().SetOrientation(self._orientation if self._orientation != "Reformat" else "Axial")
        self._orientation = None
        if self._volume is not None:
            sliceDisplay.showOverCT(self._volume, self._ct, self._opacity)
