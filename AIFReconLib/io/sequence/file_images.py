"""The images of a sequence file, read one at a time when asked for."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...arrays import Numbers
from ...imaging.images import ImagesOnDemand, luminance
from ..metafile.header import RAW
from ..metafile.metafile import Metafile, PayloadError
from ..metafile.payload import PayloadStream

MAXIMUM_FRAMES = 1_000_000
MAXIMUM_FRAME_BYTES = 2**28
"""Limits of what can be a recording: nine hours at 30 frames/s, and 256 MB in one image."""

KEPT_BYTES = 2**27
"""Compressed recordings that take no more than this are kept once they are decoded: to look for the probe, for bone and to reconstruct all
read them from the first frame on."""

_SPACE_KINDS = frozenset(("domain", "space"))
_TIME_KINDS = frozenset(("list", "time"))


class FileImages(ImagesOnDemand):
    """Images in a sequence file, an `ImageStack` (frames, rows, columns).

    Parameters
    ----------
    metafile : Metafile
    flip_columns, flip_rows : bool
        What brings the stored images to MF orientation.
    interleaved : bool
        Whether the frame is the first axis: all frames of a pixel lie together, as Slicer wrote sequences before 2022.

    Notes
    -----
    `images[n]` reads frame n: (rows, columns), in MF orientation, colors reduced to luminance, a new array each time. Compressed
    data are one stream: reading in frame order decodes each byte once, going back starts over, but for recordings of up to `KEPT_BYTES`.
    No file stays open. Interleaved frames are read and kept all at once, when the first is asked for.
    """

    def __init__(self, metafile: Metafile, *, flip_columns: bool = False, flip_rows: bool = False, interleaved: bool = False):
        self.shape = frames, rows, columns = (_interleaved_layout if interleaved else frame_layout)(metafile)
        if frames > MAXIMUM_FRAMES or metafile.pixel_bytes // frames > MAXIMUM_FRAME_BYTES:
            limits = f"{MAXIMUM_FRAMES} frames, {MAXIMUM_FRAME_BYTES} bytes in each"
            raise metafile.failure(f"{frames} frames of {columns} x {rows} pixels are beyond the limits ({limits}). Split the recording.")
        if metafile.channels not in (1, 3, 4):
            raise metafile.failure(f"pixels must have 1 channel, or 3 or 4 (color); got {metafile.channels}. Convert the images to gray.")
        self._metafile = replace(metafile, fields={})
        self.dtype = metafile.dtype.newbyteorder("=")
        self._flips = (slice(None, None, -1 if flip_rows else 1), slice(None, None, -1 if flip_columns else 1))
        self._frame_bytes = metafile.pixel_bytes // frames
        self._stream = PayloadStream(metafile)
        self._keeps_all = metafile.encoding != RAW and metafile.pixel_bytes <= KEPT_BYTES
        self._kept: dict[int, bytes] = {}
        self._interleaved = interleaved
        self._all: Numbers | None = None

    def _image(self, index: int) -> Numbers:
        _, rows, columns = self.shape
        image = self._interleaved_image(index) if self._interleaved else np.frombuffer(self._read(index), self._metafile.dtype)
        if self._metafile.channels > 1:
            image = luminance(image.reshape(rows, columns, self._metafile.channels))
        return np.array(image.reshape(rows, columns)[self._flips], dtype=self.dtype, order="C")

    def _read(self, index: int) -> bytes:
        """The stored bytes of one frame."""
        if index in self._kept:
            return self._kept[index]
        start = index * self._frame_bytes
        with self._metafile.open_payload() as file:
            stream, kept = self._stream, self._kept if self._keeps_all else {}
            if stream.position > start:
                stream = PayloadStream(self._metafile)
            # After a failure the next one begins anew
            self._stream, self._kept = PayloadStream(self._metafile), {}
            try:
                if not self._keeps_all:
                    stream.skip(file, start - stream.position)
                for number in range(stream.position // self._frame_bytes, index + 1):
                    kept[number] = stream.read(file, self._frame_bytes)
                if index == len(self) - 1:
                    stream.finish(file)
            except PayloadError as error:
                broken = min(stream.position // self._frame_bytes, len(self) - 1)
                raise PayloadError(f"{error}, in frame {broken}") from error
            self._metafile.require_unchanged(file)
        self._stream, self._kept = stream, kept
        return kept[index]

    def _interleaved_image(self, index: int) -> Numbers:
        """The pixels of one frame of a file in which those of all frames lie together."""
        if self._all is None:
            stream, pixels = PayloadStream(self._metafile), np.empty((len(self), self._frame_bytes), np.uint8)
            with self._metafile.open_payload() as file:
                for piece in pixels:
                    piece[:] = np.frombuffer(stream.read(file, self._frame_bytes), np.uint8)
                stream.finish(file)
            self._all = pixels.view(self._metafile.dtype).reshape(-1, len(self), self._metafile.channels)
        return np.ascontiguousarray(self._all[:, index])


def _interleaved_layout(metafile: Metafile) -> tuple[int, int, int]:
    frames, columns, *others = metafile.size
    rows = others.pop(0) if others else 1
    if math.prod(others) != 1:
        raise metafile.failure(f"its frames must be 2D images; got {metafile.size[1:]}. Save the sequence from a newer Slicer.")
    return frames, rows, columns


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
        raise metafile.failure(f"its axes must be columns, rows and time; got the kinds {' '.join(kinds)}. Export it from Plus or Slicer.")
    if kinds and kinds[-1] not in _TIME_KINDS:
        others.append(1)  # no time axis: one frame
    frames, depth = others.pop() if others else 1, math.prod(others)
    if depth != 1:
        hint = "Give the recording that it was made of; of a recording, the last of its kinds must be list."
        raise metafile.failure(f"it is a volume of {columns} x {rows} x {depth} voxels; frames must be 2D. {hint}")
    return frames, rows, columns
