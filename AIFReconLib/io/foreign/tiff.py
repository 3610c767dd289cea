"""Frames from TIFF files: a page each, or ImageJ's stacks, whose frames lie one after the other behind a single page."""

from __future__ import annotations

import logging
from collections.abc import Callable
from contextlib import AbstractContextManager
from itertools import islice
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Numbers
from ...errors import FileFormatError
from ..sequence.decoded_images import decoding, library
from ..sequence.file_images import MAXIMUM_FRAMES

if TYPE_CHECKING:
    from tifffile import TiffPage

_BEGINNINGS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
_JPEG = (6, 7)
ORIENTATION = 274


def is_tiff(path: Path) -> bool:
    """Whether a file begins as TIFF does, whatever its name."""
    with open(path, "rb") as file:
        return file.read(4) in _BEGINNINGS


def tiff_frames(path: Path) -> tuple[int, Callable[[int], Numbers], tuple[str, ...]]:
    """How many frames a file has, what reads one (gray levels or colors as a viewer shows them), and what is done to its first page.

    Raises FileFormatError when the file is damaged, or ImageJ says more than the file holds.

    Notes
    -----
    White may be zero, which is turned round at any depth; an orientation is followed. The largest of 2 and 4 bits becomes 255.
    """
    tifffile = library("tifffile", "TIFF files")
    # What is wrong is said by an error; it would also be printed
    logging.getLogger("tifffile").addHandler(logging.NullHandler())

    def read(number: int) -> Numbers:
        with readable(path), open(path, "rb") as file:
            tiff = tifffile.TiffFile(file)
            tiff.filehandle.seek(places[number])
            page = tifffile.TiffPage(tiff, 0)
            return _as_shown(tifffile, path, page, page.asarray(squeeze=True, maxworkers=1))

    with readable(path), open(path, "rb") as file:
        tiff = tifffile.TiffFile(file)
        first, places = tiff.pages[0], [page.offset for page in islice(tiff.pages, MAXIMUM_FRAMES + 1)]
        turned = first.tags.valueof(ORIENTATION, default=1) != 1
        white = first.photometric == tifffile.PHOTOMETRIC.MINISWHITE
        notes = ("turned as they say",) * turned + ("white was zero",) * white
        channels, count = (int(str((tiff.imagej_metadata or {}).get(key, 1))) for key in ("channels", "images"))
        # Of channels alone, without slices or frames, each is a frame: tifffile writes stacks so
        if 1 < channels < count:
            raise FileFormatError(f"{path}: ImageJ says that its frames have {channels} channels each. Convert them to gray levels or RGB.")
        if len(places) > 1 or count <= 1:
            return len(places), read, notes
        return count, _stack_of_imagej(tifffile, path, first, count), notes


def _stack_of_imagej(tifffile: ModuleType, path: Path, page: TiffPage, count: int) -> Callable[[int], Numbers]:
    """What reads a frame of those that lie behind the only page."""
    if not page.is_final or page.dtype is None:
        raise FileFormatError(f"{path}: ImageJ says that it holds {count} frames, of which one can be found. Save it as an image sequence.")
    dtype = page.dtype.newbyteorder(page.parent.byteorder)
    held = (path.stat().st_size - page.dataoffsets[0]) // page.nbytes
    if held < count:
        raise FileFormatError(f"{path}: ImageJ says that it holds {count} frames, but it ends after {held}. Copy or save it again.")

    def read(number: int) -> Numbers:
        with readable(path):
            stored = np.fromfile(path, dtype, page.size, offset=page.dataoffsets[0] + number * page.nbytes).reshape(page.shape)
            return _as_shown(tifffile, path, page, stored)

    return read


def _as_shown(tifffile: ModuleType, path: Path, page: TiffPage, pixels: Numbers) -> Numbers:
    """Stored values as gray levels or colors, turned as TIFF 6.0 and EXIF say that they are shown."""
    kind = tifffile.PHOTOMETRIC
    if page.photometric == kind.PALETTE and page.colormap is not None:
        pixels = (np.moveaxis(page.colormap, 0, -1)[pixels] // 257).astype(np.uint8)
    elif page.photometric in (kind.MINISWHITE, kind.MINISBLACK):
        pixels = _gray(path, pixels, int(page.bitspersample), white_is_zero=page.photometric == kind.MINISWHITE)
    elif page.photometric != kind.RGB and not (page.photometric == kind.YCBCR and page.compression in _JPEG):
        raise FileFormatError(f"{path}: colors of the kind {kind(page.photometric).name} are not read. Export it as gray levels or RGB.")
    if pixels.ndim == 3 and int(page.planarconfig) == 2:
        pixels = np.moveaxis(pixels, 0, -1)
    orientation = page.tags.valueof(ORIENTATION, default=1)
    pixels = np.swapaxes(pixels, 0, 1) if orientation in (5, 6, 7, 8) else pixels
    return pixels[:: -1 if orientation in (3, 4, 7, 8) else 1, :: -1 if orientation in (2, 3, 6, 7) else 1]


def _gray(path: Path, pixels: Numbers, bits: int, white_is_zero: bool) -> Numbers:
    if white_is_zero and pixels.dtype.kind not in "biu":
        raise FileFormatError(f"{path}: it says that white is zero, which {pixels.dtype} does not tell. Export it with black as zero.")
    largest = 2**bits - 1
    if white_is_zero:
        pixels = (largest - pixels).astype(pixels.dtype) if pixels.dtype.kind == "u" else np.invert(pixels)
    return np.multiply(pixels, 255 // largest, dtype=pixels.dtype) if bits < 8 and pixels.dtype.kind == "u" else pixels


def readable(path: Path) -> AbstractContextManager[None]:
    """Errors within are those of a picture."""
    return decoding(f"{path}: it cannot be read as a picture", "Export it again, without compression.")
