"""The images of a sequence node as the library reads them: one at a time, when asked for."""

import math
import operator

import numpy as np
from vtk.util import numpy_support

from AIFReconLib.errors import GeometryError, SequenceFormatError
from AIFReconLib.imaging.images import luminance
from AIFReconLib.progress import report

REPORTED_EVERY = 1 << 22
"""Bytes that are copied between two reports: some milliseconds."""


class SweepImages:
    """Images in volume nodes (None where a frame has no image), an `ImageStack` (frames, rows, columns) of gray levels.

    Flips bring the stored images to MF orientation; colors are reduced to luminance as those of files are. A frame without an image reads
    as zeros; its status keeps it out of a volume. Frames are looked at when they are read: asking every node takes long in VTK.

    Raises SequenceFormatError when there is no image at all; so does a frame when it is read and is not 2D, or neither gray nor color.
    """

    def __init__(self, nodes: list, name: str, *, flipColumns: bool = False, flipRows: bool = False):
        self._nodes = nodes
        self._shared: np.ndarray | None = None
        self._name = name
        self._flips = (slice(None, None, -1 if flipRows else 1), slice(None, None, -1 if flipColumns else 1))
        first = next((number for number, node in enumerate(nodes) if hasImage(node)), None)
        if first is None:
            raise SequenceFormatError(f"{name}: none of its {len(nodes)} items holds an image. Choose the sequence of the images.")
        columns, rows, _ = self._image(first).GetDimensions()
        self.shape = (len(nodes), rows, columns)
        self.dtype = self[first].dtype

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, index: int) -> np.ndarray:
        index = operator.index(index)
        if not hasImage(self._nodes[index]):
            return np.zeros(self.shape[1:], self.dtype)
        image = self._image(index)
        columns, rows, _ = image.GetDimensions()
        scalars = image.GetPointData().GetScalars()
        pixels = numpy_support.vtk_to_numpy(scalars)
        if scalars.GetNumberOfComponents() > 1:
            pixels = luminance(pixels.reshape(rows, columns, -1))
        # A copy: the node's pixels may be replaced while the frame is in use
        return np.array(pixels.reshape(rows, columns)[self._flips], order="C")

    def __array__(self, dtype=None, copy=None) -> np.ndarray:
        if copy is False:
            raise ValueError("Images in nodes cannot become an array without a copy.")
        return np.stack([self[index] for index in range(len(self))]).astype(self.dtype if dtype is None else dtype, copy=False)

    def shared(self, progress=None) -> np.ndarray:
        """All images (frames, rows, columns) as the worker gets them, copied once; a GeometryError when they are not alike."""
        if self._shared is None:
            images = np.empty(self.shape, self.dtype)
            few = max(1, REPORTED_EVERY // max(1, math.prod(self.shape[1:]) * self.dtype.itemsize))
            for number in range(len(self)):
                if number % few == 0:
                    report(progress, number / len(self), "Reading the frames")
                image = self[number]
                if image.shape != self.shape[1:] or image.dtype != self.dtype:
                    raise GeometryError(
                        f"{self._name}: images must all be alike; got {image.shape} {image.dtype} in frame {number} after "
                        f"{self.shape[1:]} {self.dtype}."
                    )
                images[number] = image
            self._shared = images
        return self._shared

    def __reduce__(self):
        # Another process has no nodes
        return np.asarray, (self.shared(),)

    def _image(self, number: int):
        """The vtkImageData of an item that has one, checked."""
        image = self._nodes[number].GetImageData()
        depth, channels = image.GetDimensions()[2], image.GetNumberOfScalarComponents()
        if not image.GetNumberOfPoints() or image.GetPointData().GetScalars() is None:
            raise SequenceFormatError(f"{self._name}: item {number} has no pixels. Remove it from the sequence.")
        if depth != 1:
            raise SequenceFormatError(
                "{name}: item {number} must be a 2D image; got {size} voxels. Choose a sequence of tracked 2D frames.".format(
                    name=self._name, number=number, size=" x ".join(str(n) for n in image.GetDimensions())
                )
            )
        if channels not in (1, 3, 4):
            raise SequenceFormatError(
                f"{self._name}: item {number} must have 1 channel, or 3 or 4 (color); got {channels}. Convert the images to gray."
            )
        return image


def hasImage(node) -> bool:
    """Whether a volume node (or None) holds an image."""
    return node is not None and node.GetImageDataConnection() is not None
