"""What stacks of images have in common whose images are read or decoded when asked for."""

from __future__ import annotations

import operator
from functools import cached_property

import numpy as np

from ...arrays import Numbers, NumberType
from ...imaging.detection import DetectedImaging


class ImagesOnDemand:
    """An `ImageStack` (frames, rows, columns); who derives from it sets `shape` and `dtype`, and says how to get one image."""

    shape: tuple[int, ...]
    dtype: NumberType

    @cached_property
    def recognized(self) -> dict[tuple[float, float], DetectedImaging]:
        """What `detect_imaging` has found in them, by the size of a pixel; they do not change."""
        return {}

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, index: int) -> Numbers:
        index = operator.index(index)
        if not -len(self) <= index < len(self):
            raise IndexError(f"Input frame must be below {len(self)}; got {index}.")
        return self._image(index % len(self))

    def __array__(self, dtype: NumberType | None = None, copy: bool | None = None) -> Numbers:
        if copy is False:
            raise ValueError("Images that are read one by one cannot become an array without a copy.")
        array = np.empty(self.shape, self.dtype if dtype is None else dtype)
        for index in range(len(self)):
            array[index] = self[index]
        return array

    def _image(self, index: int) -> Numbers:
        """Image `index`, from 0: (rows, columns), a new array each time."""
        raise NotImplementedError
