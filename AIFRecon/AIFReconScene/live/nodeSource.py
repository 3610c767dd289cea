"""A live source within Slicer: an image node that something else keeps up to date, with the transforms above it."""

import time
from dataclasses import replace

import slicer
from vtk.util import numpy_support

from AIFReconLib.errors import TransformError
from AIFReconLib.live.wire.messages import ImageMessage, StreamEvent
from AIFReconLib.live.wire.sources import QueueSource

from ..sweep.sweepPoses import transformStatus
from ..transforms import ijkToRAS, matrixToWorld, parentTransforms

DEVICE = "Image_Reference"
"""The pose is told as Plus tells it: the image's own matrix to Reference, which is RAS world here, and its status as metadata."""


class NodeSource(QueueSource):
    """Observes an image node and hands on each new image with its place in RAS world.

    Parameters
    ----------
    imageNode : vtkMRMLScalarVolumeNode
        Updated by SlicerOpenIGTLink, or the proxy of a sequence browser that is replayed.

    Notes
    -----
    Image and transforms of one moment are set one after the other, in either order. So an image that has come is only marked, and taken
    with its transforms by `collect`, which the panel calls from its timer when Slicer has finished with that moment. An image that is
    replaced before that, or not taken when the scan ends, is counted as dropped. Everything here happens on the main thread but `get`.
    """

    def __init__(self, imageNode):
        super().__init__()
        self._node = imageNode
        self._observation = None
        self._pending = False
        self.replaced = 0

    def start(self) -> None:
        """Begin to observe."""
        self._observation = self._node.AddObserver(slicer.vtkMRMLVolumeNode.ImageDataModifiedEvent, self._onImage)

    def stop(self) -> None:
        """Observe no more."""
        if self._observation is not None:
            self._node.RemoveObserver(self._observation)
            self._observation = None
        self.replaced += self._pending
        self._pending = False
        super().stop()

    @property
    def statistics(self):
        """How many messages were dropped: images that nobody took in time."""
        queued = super().statistics
        return replace(queued, dropped=queued.dropped + self.replaced, dropped_images=queued.dropped_images + self.replaced)

    def collect(self) -> None:
        """Hand on the image that has come since the last call, if any, with the transforms as they are now."""
        if not self._pending:
            return
        self._pending = False
        image = self._node.GetImageData()
        if image is None or image.GetPointData().GetScalars() is None:
            return
        columns, rows, slices = image.GetDimensions()
        if slices != 1 or image.GetNumberOfScalarComponents() != 1:
            detail = (
                f"{self._node.GetName()} must hold gray images of one slice; got {columns} x {rows} x {slices} pixels of "
                f"{image.GetNumberOfScalarComponents()} values."
            )
            self.put(StreamEvent("refused", detail, time.monotonic()))
            return
        pixels = numpy_support.vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns).copy()
        try:
            pose = matrixToWorld(self._node) @ ijkToRAS(self._node)
        except TransformError as error:
            self.put(StreamEvent("refused", error.args[0], time.monotonic()))
            return
        statuses = [transformStatus(node) for node in parentTransforms(self._node)]
        status = next((each for each in statuses if each.value != "OK"), None)
        now = time.monotonic()
        metadata = {
            "ImageToReferenceTransform": " ".join(repr(float(value)) for value in pose.ravel()),
            "ImageToReferenceTransformStatus": "OK" if status is None else status.value,
        }
        self.put(ImageMessage(DEVICE, now, pixels, pose, metadata, now, 2))

    def _onImage(self, caller, event) -> None:
        self.replaced += self._pending
        self._pending = True
