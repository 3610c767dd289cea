"""The frame that is seen now, as a volume in its place that the red view follows."""

from typing import Any

import slicer

from AIFReconLib.geometry.volume import Volume

from ..sceneNodes import removeNodes
from ..transforms import atRightAngles
from ..volumes.volumeNodes import showGrayLevels, updateVolumeNode
from .liveViews import LiveViews

FRAME_NAME = "Live frame"


class ShownFrame:
    """A node for the newest frame, and the red view that lies in it; `frame` is the `SeenFrame` that is seen, or None."""

    def __init__(self, views: LiveViews):
        self._views = views
        self._node: Any = None
        self.frame = None

    @property
    def node(self):
        """The volume of the frame that is seen; None before there is one, and when somebody has deleted it."""
        return self._node if self._node and self._node.GetScene() else None

    def show(self, frame) -> None:
        """Show a `SeenFrame`."""
        if self.node is None:
            self._node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", FRAME_NAME)
            self._node.SetSaveWithScene(False)
            self._node.CreateDefaultDisplayNodes()
            showGrayLevels(self._node, frame.image.dtype)
        rows, columns = frame.image.shape
        # What is inserted lies where the exact matrix puts it
        updateVolumeNode(self._node, Volume(frame.image[None], atRightAngles(frame.image_to_reference, columns, rows)))
        self._views.follow(self._node)
        self.frame = frame

    def remove(self) -> None:
        """Take the frame out of the scene, and give the red view back as it was."""
        self._views.restore()
        if self.node is not None:
            removeNodes([self._node])
        self._node = self.frame = None
