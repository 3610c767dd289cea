"""Images as frames hold them: one after the other, gray."""

from __future__ import annotations

import operator
from typing import Protocol

import numpy as np

from ..arrays import Numbers, NumberType


class ImageStack(Protocol):
    """The images of a sequence, in memory or read from a file when asked for: a numpy array (n, rows, columns) is one."""

    @property
    def shape(self) -> tuple[int, ...]:
        """(frames, rows, columns)."""
        ...

    @property
    def dtype(self) -> NumberType:
        """Type of a pixel."""
        ...

    def __len__(self) -> int: ...

    def __getitem__(self, index: int, /) -> Numbers: ...


class ImagesOnDemand:
    """An `ImageStack` whose images are read, decoded or cut when asked for; who derives from it sets `shape` and `dtype`, and gives one."""

    shape: tuple[int, ...]
    dtype: NumberType

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
        """Image `index`, from 0: (rows, columns)."""
        raise NotImplementedError


def luminance(image: Numbers) -> Numbers:
    """Gray levels (rows, columns) of a color image (rows, columns, 3 or 4), in its own type; a fourth channel is not used."""
    red, green, blue = (image[..., channel].astype(np.float64) for channel in range(3))
    gray = REC_601[0] * red + REC_601[1] * green + REC_601[2] * blue
    if image.dtype.kind in "iu":
        gray = np.rint(gray)
    return gray.astype(image.dtype.newbyteorder("="))


REC_601 = (0.299, 0.587, 0.114)
"""Luminance of red, green and blue (ITU-R BT.601)."""
