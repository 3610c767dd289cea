"""The images of a sequence file, read one at a time when asked for."""

from __future__ import annotations

from typing import BinaryIO

import numpy as np

from ...arrays import Numbers
from ...imaging.images import ImagesOnDemand, luminance
from ..metafile.metafile import RAW, Metafile
from ..metafile.payload import Inflater, PayloadError

MAXIMUM_FRAMES = 1_000_000
MAXIMUM_FRAME_BYTES = 2**28
"""Limits of what can be a recording: nine hours at 30 frames/s, or as many frames as a header has lines of, and 256 MB in one image."""

KEPT_BYTES = 2**27
"""Compressed recordings that take no more than this are kept once they are decoded: to look for the probe, for bone and to reconstruct all
read them from the first frame on."""

_SPACE_KINDS = frozenset(("domain", "space"))
_TIME_KINDS = frozenset(("list", "time"))


class StoredImages(ImagesOnDemand):
    """Images of a metafile, an `ImageStack` (frames, rows, columns); who derives from it says how to read the bytes of one.

    Parameters
    ----------
    metafile : Metafile
    shape : (frames, rows, columns)
    flip_columns, flip_rows : bool
        What brings the stored images to MF orientation.
    """

    def __init__(self, metafile: Metafile, shape: tuple[int, int, int], flip_columns: bool, flip_rows: bool):
        frames, rows, columns = shape
        described = len(metafile.frame_lines) if metafile.frame_lines is not None else 0
        if frames > max(MAXIMUM_FRAMES, described) or metafile.pixel_bytes // frames > MAXIMUM_FRAME_BYTES:
            raise metafile.failure(
                f"{frames} frames of {columns} x {rows} pixels are beyond the limits ({MAXIMUM_FRAMES} frames, {MAXIMUM_FRAME_BYTES} bytes "
                "in each). The size in the header is wrong, or the recording must be split."
            )
        if metafile.channels not in (1, 3, 4):
            raise metafile.failure(f"pixels must have 1 channel, or 3 or 4 (color); got {metafile.channels}. Convert the images to gray.")
        self._metafile = metafile
        self.shape = shape
        self.dtype = metafile.dtype.newbyteorder("=")
        self._flips = (slice(None, None, -1 if flip_rows else 1), slice(None, None, -1 if flip_columns else 1))
        self._frame_bytes = metafile.pixel_bytes // frames

    def _image(self, index: int) -> Numbers:
        _, rows, columns = self.shape
        image = np.frombuffer(self._read(index), self._metafile.dtype)
        if self._metafile.channels > 1:
            image = luminance(image.reshape(rows, columns, self._metafile.channels))
        return np.array(image.reshape(rows, columns)[self._flips], dtype=self.dtype, order="C")

    def _read(self, index: int) -> bytes:
        """The stored bytes of one frame."""
        raise NotImplementedError


class FileImages(StoredImages):
    """Images in a sequence file.

    Notes
    -----
    `images[n]` reads frame n: (rows, columns), in MF orientation, colors reduced to luminance, a new array each time. Compressed
    data are one stream: reading in frame order decodes each byte once, going back starts over, but for recordings of up to `KEPT_BYTES`.
    No file stays open.
    """

    def __init__(self, metafile: Metafile, *, flip_columns: bool = False, flip_rows: bool = False):
        super().__init__(metafile, frame_layout(metafile), flip_columns, flip_rows)
        self._stream: Inflater | None = None
        self._keeps_all = metafile.pixel_bytes <= KEPT_BYTES
        self._kept: dict[int, bytes] = {}

    def _read(self, index: int) -> bytes:
        metafile = self._metafile
        kept = self._kept.get(index)
        if kept is not None:
            return kept
        with metafile.open_payload() as file:
            try:
                if metafile.encoding == RAW:
                    file.seek(metafile.data_offset + index * self._frame_bytes)
                    data = file.read(self._frame_bytes)
                    if len(data) != self._frame_bytes:
                        raise PayloadError("are cut short")
                else:
                    data = self._decode(file, index)
                metafile.require_unchanged(file)
            except PayloadError as error:
                broken = index if self._stream is None else min(self._stream.position // self._frame_bytes, len(self) - 1)
                self._stream = None
                raise metafile.failure(f"the pixel data {error}, in frame {broken}. Copy the file again, or record it again.") from error
            except OSError as error:
                self._stream = None
                raise metafile.failure(f"frame {index} cannot be read ({error.strerror}). Copy the file again.") from error
        return data

    def _decode(self, file: BinaryIO, index: int) -> bytes:
        start = index * self._frame_bytes
        if self._stream is None or self._stream.position > start:
            self._stream = Inflater(self._metafile.data_offset, self._metafile.data_length)
        if self._keeps_all:
            for before in range(self._stream.position // self._frame_bytes, index):
                self._kept[before] = self._stream.read(file, self._frame_bytes)
        else:
            self._kept.clear()
            self._stream.skip(file, start - self._stream.position)
        data = self._stream.read(file, self._frame_bytes)
        if index == len(self) - 1:
            self._stream.finish(file)
        self._kept[index] = data
        return data


def frame_layout(metafile: Metafile) -> tuple[int, int, int]:
    """Frames, rows and columns of a sequence file.

    Raises
    ------
    FileFormatError
        The metafile's kind, when its axes are not columns, rows and time.
    """
    columns, rows, *others = metafile.size
    kinds = metafile.kinds
    if kinds and not set(kinds[:2]) <= _SPACE_KINDS:
        raise metafile.failure(
            f"its axes must be columns, rows and time; got the kinds {' '.join(kinds)}. Export the sequence from Plus or Slicer."
        )
    if kinds and kinds[-1] not in _TIME_KINDS:
        others.append(1)  # no time axis: one frame
    frames = others.pop() if others else 1
    depth = others[0] if others else 1
    if depth != 1 or len(others) > 1:
        raise metafile.failure(
            f"its images are 3D ({columns} x {rows} x {depth}), which is not supported: frames must be 2D. If this is a recording of "
            "2D frames, the last of its kinds must be list; if it is a volume, give it as one."
        )
    return frames, rows, columns
