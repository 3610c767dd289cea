"""Images of a file whose fastest axis is the frame: all frames of a pixel lie together, as Slicer wrote sequences before 2022."""

from __future__ import annotations

import contextlib
import math
import tempfile
import weakref
from typing import BinaryIO

import numpy as np

from ..metafile.metafile import RAW, Metafile
from ..metafile.payload import Inflater, PayloadError
from .file_images import StoredImages

_PIECE = 2**23
"""Bytes that are turned over at a time."""


class InterleavedImages(StoredImages):
    """Images in such a file, whose first axis is the frame, the others columns, rows and, of size 1, slices.

    Notes
    -----
    When the first image is asked for, the whole payload is sorted by frames, 8 MB at a time, into a temporary file that goes away with
    this object: reading one frame from the original would mean reading all of it.
    """

    def __init__(self, metafile: Metafile, *, flip_columns: bool = False, flip_rows: bool = False):
        frames, columns, *others = metafile.size
        rows = others.pop(0) if others else 1
        if math.prod(others) != 1:
            raise metafile.failure(f"its frames must be 2D images; got {metafile.size[1:]}. Save the sequence from a newer Slicer.")
        super().__init__(metafile, (frames, rows, columns), flip_columns, flip_rows)
        self._sorted: BinaryIO | None = None

    def _read(self, index: int) -> bytes:
        if self._sorted is None:
            self._sorted = self._sort()
        try:
            self._sorted.seek(index * self._frame_bytes)
            return self._sorted.read(self._frame_bytes)
        except OSError as error:
            raise self._metafile.failure(f"its sorted copy cannot be read ({error.strerror}). Read the file again.") from error

    def _sort(self) -> BinaryIO:
        """A temporary file that holds frame after frame; it goes away with this object."""
        metafile = self._metafile
        frames, rows, columns = self.shape
        pixel_bytes = frames * metafile.channels * metafile.dtype.itemsize
        step = max(_PIECE // pixel_bytes, 1)
        inflater = Inflater(metafile.data_offset, metafile.data_length)
        with contextlib.ExitStack() as stack, metafile.open_payload() as file:
            try:
                by_frame = stack.enter_context(tempfile.TemporaryFile())
                file.seek(metafile.data_offset)
                for start in range(0, rows * columns, step):
                    count = min(step, rows * columns - start)
                    data = file.read(count * pixel_bytes) if metafile.encoding == RAW else inflater.read(file, count * pixel_bytes)
                    if len(data) != count * pixel_bytes:
                        raise PayloadError("are cut short")
                    pixels = np.frombuffer(data, metafile.dtype).reshape(count, frames, metafile.channels)
                    for frame in range(frames):
                        by_frame.seek(frame * self._frame_bytes + start * pixel_bytes // frames)
                        by_frame.write(pixels[:, frame].tobytes())
                if metafile.encoding != RAW:
                    inflater.finish(file)
                by_frame.flush()
            except PayloadError as error:
                raise metafile.failure(f"the pixel data {error}. Copy the file again, or save it from Slicer again.") from error
            except OSError as error:
                raise metafile.failure(f"its frames cannot be sorted ({error.strerror}). Free some space on the disk.") from error
            stack.pop_all()
            weakref.finalize(self, by_frame.close)
            return by_frame
