"""Images as frames hold them: one after the other, gray."""

from __future__ import annotations

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


def luminance(image: Numbers) -> Numbers:
    """Gray levels (rows, columns) of a color image (rows, columns, 3 or 4), in its own type; a fourth channel is not used."""
    red, green, blue = (image[..., channel].astype(np.float64) for channel in range(3))
    gray = REC_601[0] * red + REC_601[1] * green + REC_601[2] * blue
    if image.dtype.kind in "iu":
        gray = np.rint(gray)
    return gray.astype(image.dtype.newbyteorder("="))


REC_601 = (0.299, 0.587, 0.114)
"""Luminance of red, green and blue (ITU-R BT.601)."""
