"""The views during a scan: the red one lies in the frame that is seen now, the others show the growing volume over the CT."""

from dataclasses import dataclass

import numpy as np
import slicer

from ..display import sliceDisplay
from ..transforms import ijkToRAS

FOLLOWING = "Red"
OTHERS = ("Yellow", "Green")
MARGIN = 1.1
"""Of the view around the frame."""

FASTEST, SLOWER, SLOWEST = 12.0, 4.0, 2.0
"""Pictures/s at most of the red view, of those in 3D, and of the other slices, whose volume changes twice a second: whatever moves, Slicer
asks every view to be drawn anew."""


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
        self._before: _View | None = None
        self._frame = self._volume = None
        self._rates: list = []

    def follow(self, frameNode) -> None:
        """Let the red slice lie in the frame, at its true place in the 3D view too."""
        logic = _following()
        if logic is None:
            return
        node, composite = logic.GetSliceNode(), logic.GetSliceCompositeNode()
        if self._frame is not frameNode:
            if self._before is None:
                self._before, self._rates = _View.of(node, composite), _slowed()
            self._frame = frameNode
            with sliceDisplay.changing(composite):
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

    def show(self, volumeNode) -> None:
        """Show the growing volume over the CT in the other views, once."""
        if self._volume is not volumeNode:
            self._volume = volumeNode
            sliceDisplay.showOverCT(volumeNode, self._ct, self._opacity, views=OTHERS)

    def restore(self) -> None:
        """The red slice as it was; where there is a volume now, it shows that as the others do."""
        logic = _following()
        before, self._before, self._frame = self._before, None, None
        if logic is None or before is None:
            return
        for view, rate in self._rates:
            view.maximumUpdateRate = rate
        before.restore(logic.GetSliceNode(), logic.GetSliceCompositeNode())
        if self._volume is not None and self._volume.GetScene() is not None:
            sliceDisplay.showOverCT(self._volume, self._ct, self._opacity)


def _following():
    """The slice logic of the view that moves with the probe; None in an application without it."""
    return slicer.app.applicationLogic().GetSliceLogicByLayoutName(FOLLOWING)


def _slowed() -> list:
    """All views, drawn less often from now on, each with its rate before."""
    manager = slicer.app.layoutManager()
    if manager is None:
        return []
    views = {name: manager.sliceWidget(name).sliceView() for name in manager.sliceViewNames()}
    views |= {number: manager.threeDWidget(number).threeDView() for number in range(manager.threeDViewCount)}
    before = [(view, view.maximumUpdateRate) for view in views.values()]
    for name, view in views.items():
        view.maximumUpdateRate = FASTEST if name == FOLLOWING else SLOWEST if name in manager.sliceViewNames() else SLOWER
    return before


@dataclass(frozen=True)
class _View:
    """What a slice view showed, and where."""

    sliceToRAS: object
    fieldOfView: tuple
    visible: bool
    background: str | None
    foreground: str | None
    opacity: float

    @classmethod
    def of(cls, node, composite) -> "_View":
        return cls(
            slicer.util.arrayFromVTKMatrix(node.GetSliceToRAS()),
            tuple(node.GetFieldOfView()),
            bool(node.GetSliceVisible()),
            composite.GetBackgroundVolumeID(),
            composite.GetForegroundVolumeID(),
            composite.GetForegroundOpacity(),
        )

    def restore(self, node, composite) -> None:
        scene = node.GetScene()
        there = [volume if volume and scene.GetNodeByID(volume) else None for volume in (self.background, self.foreground)]
        with slicer.util.NodeModify(node), sliceDisplay.changing(composite):
            node.SetSliceVisible(self.visible)
            node.GetSliceToRAS().DeepCopy(slicer.util.vtkMatrixFromArray(self.sliceToRAS))
            node.SetFieldOfView(*self.fieldOfView)
            node.UpdateMatrices()
            composite.SetBackgroundVolumeID(there[0])
            composite.SetForegroundVolumeID(there[1])
            composite.SetForegroundOpacity(self.opacity)
