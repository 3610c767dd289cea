"""What a picture or a DICOM file may ask of its decoder, looked at before anything is decoded."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ...errors import FileFormatError
from ..sequence.file_images import MAXIMUM_FRAME_BYTES

MOST_WORK = 2**28
"""Pixels of a JPEG image times its scans: each goes through all pixels. Cameras write some ten."""

_SCAN = b"\xff\xda"


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


def _too_much(path: Path, why: str) -> FileFormatError:
    return FileFormatError(f"{path}: {why}, which would take too long or too much memory to read. Export it again.")
