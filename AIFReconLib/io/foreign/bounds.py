"""What a picture or a DICOM file may ask of its decoder, looked at before anything is decoded: a small file can ask for hours."""

from __future__ import annotations

import io
import struct
from collections.abc import Iterable
from pathlib import Path
from typing import IO

from ...errors import FileFormatError
from ..sequence.file_images import MAXIMUM_FRAME_BYTES

MOST_WORK = 2**28
"""Pixels of a JPEG image times its scans: each goes through all pixels. Cameras write some ten."""

MOST_CHUNKS, MOST_BESIDE = 2**18, 2**20
"""Chunks of a PNG file, and the bytes of those that hold no pixels."""

_PIXEL_CHUNKS = (b"IHDR", b"PLTE", b"IDAT", b"fcTL", b"fdAT", b"IEND")
_SCAN = b"\xff\xda"
_PIECE = 2**20


def check_picture(file: IO[bytes], path: Path) -> None:
    """Return if the chunks of a PNG file can be read in little time; other files are left alone.

    Raises FileFormatError otherwise.
    """
    if file.read(8) != b"\x89PNG\r\n\x1a\n":
        return
    chunks = beside = 0
    while len(head := file.read(8)) == 8:
        length, kind = struct.unpack(">I4s", head)
        chunks += 1
        # Each takes twelve bytes more
        beside += 0 if kind in _PIXEL_CHUNKS else length + 12
        if chunks > MOST_CHUNKS or beside > MOST_BESIDE:
            raise _too_much(path, "it holds more text and other chunks than pictures do")
        file.seek(length + 4, io.SEEK_CUR)


def check_pixels(path: Path, columns: int, rows: int, bytes_per_pixel: int) -> None:
    """Return if an image is no larger than a frame may be.

    Raises FileFormatError otherwise.
    """
    if columns * rows * bytes_per_pixel > MAXIMUM_FRAME_BYTES:
        raise _too_much(path, f"it says that it has {columns} x {rows} pixels")


def check_scans(pieces: Iterable[bytes], path: Path, pixels: int, images: int = 1) -> None:
    """Return if JPEG images, of so many pixels each, have no more scans than such images have.

    Raises FileFormatError otherwise.

    Parameters
    ----------
    pieces : iterable of bytes
        Of the file, or of its images.
    path : Path
    pixels, images : int
    """
    scans, last = 0, b""
    for piece in pieces:
        scans += piece.count(_SCAN) + (last == _SCAN[:1] and piece[:1] == _SCAN[1:])
        last = piece[-1:]
    if scans * pixels > MOST_WORK * images:
        raise _too_much(path, f"it has {scans} scans")


def pieces_of(file: IO[bytes]) -> Iterable[bytes]:
    """A file from its beginning, a piece at a time."""
    file.seek(0)
    return iter(lambda: file.read(_PIECE), b"")


def _too_much(path: Path, why: str) -> FileFormatError:
    return FileFormatError(f"{path}: {why}, which would take too long or too much memory to read. Export it again.")
