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
    """A node for the newest frame, and the red view that lies in it.

    Parameters
    ----------
    views : LiveViews

    Attributes
    ----------
    frame : LiveFrame or None
        Which is seen.

    Notes
    -----
    A new frame costs the application tens of milliseconds in the node and as many in the view. Each is a step of its own, to be taken in
    another turn of the event loop; nothing is drawn between the two, for the frame would lie where the view has left.
    """

    def __init__(self, views: LiveViews):
        self._views = views
        self._node: Any = None
        self.frame = None

    @property
    def node(self):
        """The volume of the frame that is seen; None before there is one, and when somebody has deleted it."""
        return self._node if self.frame is not None and self._isThere() else None

    def stepsTo(self, frame):
        """Steps that show a `LiveFrame`, an iterator for `InSteps`; None where it is shown already or has no place."""
        if frame is None or frame is self.frame or frame.image_to_reference is None or frame.status != "OK":
            return None
        return self._steps(frame)

    def remove(self) -> None:
        """Take the frame out of the scene, and give the red view back as it was."""
        self._views.restore()
        if self._isThere():
            removeNodes([self._node], self._node.GetScene())
        self._node = self.frame = None

    def _isThere(self) -> bool:
        return bool(self._node and self._node.GetScene())

    def _steps(self, frame):
        if not self._isThere():
            self.frame = None
            self._node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", FRAME_NAME)
            self._node.SetSaveWithScene(False)
            self._node.CreateDefaultDisplayNodes()
            showGrayLevels(self._node, frame.image.dtype)
            yield
        rows, columns = frame.image.shape
        # What is inserted lies where the exact matrix puts it
        updateVolumeNode(self._node, Volume(frame.image[None], atRightAngles(frame.image_to_reference, columns, rows)))
        yield
        while self._isThere() and self._views.prepareFor(self._node):
            yield
        if self._isThere():
            self._views.follow(self._node)
        self.frame = frame
