"""Images for a scan from within Slicer: an image node that something else keeps up to date, with the transforms above it."""

import time

import slicer
from vtk.util import numpy_support

from AIFReconLib.errors import TransformError
from AIFReconLib.live.wire.messages import ImageMessage, StreamEvent
from AIFReconLib.message import message_of

from ..sweep.sweepPoses import transformStatus
from ..transforms import ijkToRAS, matrixToWorld, parentTransforms

DEVICE = "Image_Reference"
"""The pose is told as Plus tells it: the image's own matrix to Reference, which is RAS world here, and its status as metadata."""


class NodeImages:
    """Observes an image node and gives each new image with its place in RAS world; `replaced` counts those that nobody took in time.

    The node is updated by SlicerOpenIGTLink, or the proxy of a sequence browser that is replayed. Image and transforms of one moment are
    set one after the other, in either order. So an image that has come is only marked, and taken with its transforms by `take`, which the
    panel calls from its timer when Slicer has finished with that moment.
    """

    def __init__(self, imageNode):
        self._node, self._pending, self.replaced = imageNode, False, 0
        self._observation = imageNode.AddObserver(slicer.vtkMRMLVolumeNode.ImageDataModifiedEvent, self._onImage)

    def stop(self) -> None:
        """Observe no more."""
        self._node.RemoveObserver(self._observation)

    def take(self):
        """The message of the image that has come since the last call, with the transforms as they are now; None where none has come."""
        if not self._pending:
            return None
        self._pending, now = False, time.monotonic()
        image = self._node.GetImageData()
        if image is None or image.GetPointData().GetScalars() is None:
            return None
        columns, rows, slices = image.GetDimensions()
        if slices != 1 or image.GetNumberOfScalarComponents() != 1:
            detail = (
                f"{self._node.GetName()} must hold gray images of one slice; got {columns} x {rows} x {slices} pixels of "
                f"{image.GetNumberOfScalarComponents()} values."
            )
            return StreamEvent("refused", detail, now)
        try:
            pose = matrixToWorld(self._node) @ ijkToRAS(self._node)
        except TransformError as error:
            return StreamEvent("refused", message_of(error), now)
        pixels = numpy_support.vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns).copy()
        statuses = [transformStatus(node) for node in parentTransforms(self._node)]
        status = next((each for each in statuses if each.value != "OK"), None)
        metadata = {
            "ImageToReferenceTransform": " ".join(repr(float(value)) for value in pose.ravel()),
            "ImageToReferenceTransformStatus": "OK" if status is None else status.value,
        }
        return ImageMessage(DEVICE, now, pixels, pose, metadata, now, 2)

    def _onImage(self, caller, event) -> None:
        self.replaced += self._pending
        self._pending = True
