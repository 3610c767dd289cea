"""Frames from a .npy array, read one at a time. Not by memory map: a file that is cut while mapped ends the program, not the call."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ...arrays import Numbers, NumberType
from ...errors import FileFormatError
from ..disk.regular_files import file_stamp, stamp
from .images import DecodedImages, ImportedImages, decoding, describe_stack


def open_numpy(path: Path) -> ImportedImages:
    """The frames of an array (frames, rows, columns), with or without 3 or 4 colors as fourth axis.

    Raises
    ------
    FileFormatError
        When the file is no such array.

    Notes
    -----
    An array in Fortran order has its frames spread over the file, and is read as a whole.
    """
    with decoding(f"{path}: numpy cannot read it", "Save the array again with numpy.save."):
        array = np.load(path, mmap_mode="r", allow_pickle=False)
    if not isinstance(array, np.memmap):
        raise FileFormatError(f"{path}: this is an archive of arrays. Save the one of the images with numpy.save.")
    if array.ndim not in (3, 4) or (array.ndim == 4 and array.shape[3] not in (1, 3, 4)) or not array.size:
        raise FileFormatError(
            f"{path}: the array must have shape (frames, rows, columns) or (frames, rows, columns, 3); got {array.shape}. Transpose it."
        )
    if array.flags.c_contiguous:
        frame = _frame_reader(path, array.shape[1:], array.dtype, array.offset)
    else:
        frame = np.load(path, allow_pickle=False).__getitem__
    count = len(array)
    stack = DecodedImages(count, frame, lambda n: f"{path}, frame {n}")
    return ImportedImages(stack, describe_stack(count, "frames", stack.shape[1:], stack.dtype) + f" in {path.name}")


def _frame_reader(path: Path, shape: tuple[int, ...], dtype: NumberType, offset: int) -> Callable[[int], Numbers]:
    """A function that reads frame n from the file, provided that it is still the one that was opened."""
    frame_bytes = int(np.prod(shape)) * dtype.itemsize
    opened = file_stamp(path)

    def read(number: int) -> Numbers:
        try:
            with open(path, "rb") as file:
                same = stamp(os.fstat(file.fileno())) == opened
                file.seek(offset + number * frame_bytes)
                data = file.read(frame_bytes)
                same = same and stamp(os.fstat(file.fileno())) == opened
        except OSError as error:
            raise FileFormatError(f"{path}: frame {number} cannot be read ({error.strerror}). Copy the file again.") from error
        if not same or len(data) != frame_bytes:
            raise FileFormatError(f"{path}: the file has changed since it was opened. Import it again.")
        return np.frombuffer(data, dtype).reshape(shape)

    return read
