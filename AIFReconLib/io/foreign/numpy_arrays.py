"""Frames from a .npy array, read one at a time. It is mapped no longer than that: a file that is cut while mapped ends the program."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...arrays import Numbers
from ...errors import FileFormatError
from ..sequence.decoded_images import DecodedImages, decoding
from .images import ImportedImages


def open_numpy(path: Path) -> ImportedImages:
    """The frames of an array (frames, rows, columns), with or without 3 or 4 colors as fourth axis.

    Raises FileFormatError when the file is no such array.
    """
    with decoding(f"{path}: numpy cannot read it", "Save the array again with numpy.save."):
        array = np.load(path, mmap_mode="r", allow_pickle=False)
    if not isinstance(array, np.memmap):
        raise FileFormatError(f"{path}: this is an archive of arrays. Save the one of the images with numpy.save.")
    if array.ndim not in (3, 4) or (array.ndim == 4 and array.shape[3] not in (1, 3, 4)) or not array.size:
        raise FileFormatError(f"{path}: the array must have shape (frames, rows, columns) or (..., 3); got {array.shape}. Transpose it.")

    def frame(number: int) -> Numbers:
        with decoding(f"{path}: frame {number} cannot be read", "Copy the file again."):
            return np.array(np.load(path, mmap_mode="r", allow_pickle=False)[number])

    return ImportedImages(DecodedImages(len(array), frame, lambda n: f"{path}, frame {n}"), f"frames in {path.name}")
