"""The views during a scan: the red one lies in the frame that is seen now, the others show the growing volume over the CT."""

from typing import Any

import slicer

from AIFReconLib.geometry.transforms import at_right_angles
from AIFReconLib.geometry.volume import Volume

from ..display import sliceDisplay
from ..sceneNodes import removeNodes, showGrayLevels
from ..volumes.volumeNodes import updateVolumeNode

FRAME_NAME = "Live frame"

OTHERS = ("Yellow", "Green")

FASTEST, SLOWER, SLOWEST = 12.0, 4.0, 2.0
"""Pictures/s at most of the red view, of those in 3D, and of the other slices, whose volume changes twice a second: whatever moves, Slicer
asks every view to be drawn anew."""


class LiveViews:
    """Moves the red slice with the probe and puts everything back at the end; `opacity`, 0 to 1, is that of the volume over the CT.

    `frame` is the `LiveFrame` that is seen, or None.
    """

    def __init__(self, ctNode, opacity: float):
        self._ct, self._opacity = ctNode, opacity
        self._before: Any = None
        self._node: Any = None
        self.frame = self._followed = self._volume = None
        self._rates: list = []

    @property
    def frameNode(self):
        """The volume of the frame that is seen, in its place; None before there is one, and when somebody has deleted it."""
        return self._node if self._node and self._node.GetScene() else None

    def showFrame(self, frame) -> None:
        """Show a `LiveFrame`, and let the red slice lie in it."""
        node, (rows, columns) = self.frameNode, frame.image.shape
        if node is None:
            self._node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", FRAME_NAME)
            self._node.SetSaveWithScene(False)
        # What is inserted lies where the exact matrix puts it
        updateVolumeNode(self._node, Volume(frame.image[None], at_right_angles(frame.image_to_reference, columns, rows)))
        if node is None:
            showGrayLevels(self._node)
        self.follow(self._node)
        self.frame = frame

    def follow(self, frameNode) -> None:
        """Let the red slice lie in the frame, at its true place in the 3D view too."""
        logic = _following()
        if logic is None:
            return
        node, composite = logic.GetSliceNode(), logic.GetSliceCompositeNode()
        if self._followed is not frameNode:
            if self._before is None:
                self._before, self._rates = _asItIs(node, composite), _slowed()
            self._followed = frameNode
            with sliceDisplay.changing(composite):
                composite.SetBackgroundVolumeID(frameNode.GetID())
                composite.SetForegroundVolumeID(None)
            node.SetSliceVisible(True)
        sliceDisplay.lieIn(node, frameNode)

    def show(self, volumeNode) -> None:
        """Show the growing volume over the CT in the other views, once."""
        if self._volume is not volumeNode:
            self._volume = volumeNode
            sliceDisplay.showOverCT(volumeNode, self._ct, self._opacity, views=OTHERS)

    def removeFrame(self) -> None:
        """Take the frame out of the scene, and give the red view back as it was."""
        self._restore()
        removeNodes([self.frameNode])
        self._node = self.frame = None

    def _restore(self) -> None:
        """The red slice as it was; where there is a volume now, it shows that as the others do."""
        before, self._before, self._followed = self._before, None, None
        if _following() is None or before is None:
            return
        for view, rate in self._rates:
            view.maximumUpdateRate = rate
        before()
        if self._volume is not None and self._volume.GetScene() is not None:
            sliceDisplay.showOverCT(self._volume, self._ct, self._opacity)


def _following():
    """The slice logic of the view that moves with the probe; None in an application without it."""
    return slicer.app.applicationLogic().GetSliceLogicByLayoutName(sliceDisplay.FRAME_VIEW)


def _slowed() -> list:
    """All views, drawn less often from now on, each with its rate before."""
    manager = slicer.app.layoutManager()
    if manager is None:
        return []
    views = {name: manager.sliceWidget(name).sliceView() for name in manager.sliceViewNames()}
    views |= {number: manager.threeDWidget(number).threeDView() for number in range(manager.threeDViewCount)}
    before = [(view, view.maximumUpdateRate) for view in views.values()]
    for name, view in views.items():
        view.maximumUpdateRate = FASTEST if name == sliceDisplay.FRAME_VIEW else SLOWEST if name in manager.sliceViewNames() else SLOWER
    return before


def _asItIs(node, composite):
    """A function that has a slice view show again what it shows now, where it shows it."""
    place, field = slicer.util.arrayFromVTKMatrix(node.GetSliceToRAS()), tuple(node.GetFieldOfView())
    isVisible, opacity = bool(node.GetSliceVisible()), composite.GetForegroundOpacity()
    volumes = composite.GetBackgroundVolumeID(), composite.GetForegroundVolumeID()

    def restore() -> None:
        there = [volume if volume and node.GetScene().GetNodeByID(volume) else None for volume in volumes]
        with slicer.util.NodeModify(node), sliceDisplay.changing(composite):
            node.SetSliceVisible(isVisible)
            node.GetSliceToRAS().DeepCopy(slicer.util.vtkMatrixFromArray(place))
            node.SetFieldOfView(*field)
            node.UpdateMatrices()
            composite.SetBackgroundVolumeID(there[0])
            composite.SetForegroundVolumeID(there[1])
            composite.SetForegroundOpacity(opacity)

    return restore
