"""Frames from pictures: PNG, JPEG, TIFF (of many pages too), BMP, each turned as viewers turn it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from ...arrays import Numbers
from ..sequence.decoded_images import DecodedImages, library
from ..sequence.file_images import MAXIMUM_FRAMES
from .images import ImportedImages
from .tiff import ORIENTATION, is_tiff, readable, tiff_frames

_FORMATS = ("PNG", "JPEG", "BMP", "MPO")
"""Pillow's names. It goes by the content, whatever the suffix, and would start Ghostscript for PostScript."""

_AS_THEY_ARE = ("L", "I", "F", "RGB", "RGBA", "I;16", "I;16L", "I;16B", "I;16N", "LA")
"""Modes that become arrays of their own type; palettes, CMYK and the like are made RGB first."""


def open_pictures(files: list[Path]) -> ImportedImages:
    """The pages of these files, one frame each.

    Raises FileFormatError when a file is no picture.
    """
    readers = {path: tiff_frames(path) if is_tiff(path) else _picture_frames(path) for path in files}
    pages = [(path, page) for path in files for page in range(readers[path][0])]
    several = len(pages) > len(files)

    def decode(number: int) -> Numbers:
        path, page = pages[number]
        return readers[path][1](page)

    stack = DecodedImages(len(pages), decode, lambda number: ", page ".join(map(str, pages[number][: 1 + several])))
    kinds = "/".join(sorted({path.suffix[1:].upper() for path in files}))
    what = f"{kinds} {'pages' if several else 'pictures'}"
    names = None if several else tuple(path.name for path, _ in pages)
    notes = dict.fromkeys(note for _, _, notes in readers.values() for note in notes)
    return ImportedImages(stack, what, names, notes=tuple(notes))


def _picture_frames(path: Path) -> tuple[int, Callable[[int], Numbers], tuple[str, ...]]:
    """How many pages a file has, what reads one, and what is done to it."""
    pictures, turns = library("PIL.Image", "Pictures"), library("PIL.ImageOps", "Pictures")

    def read(page: int) -> Numbers:
        # From a file object, not a path: Pillow maps some files into memory, and one that is cut while mapped ends the program
        with readable(path), open(path, "rb") as file, pictures.open(file, formats=_FORMATS) as picture:
            picture.seek(page)
            shown = turns.exif_transpose(picture)
            if shown.mode == "1":
                return np.asarray(shown.convert("L"))
            return np.asarray(shown if shown.mode in _AS_THEY_ARE else shown.convert("RGB"))

    with readable(path), open(path, "rb") as file, pictures.open(file, formats=_FORMATS) as picture:
        # One more is refused as any recording of so many frames is
        count = min(int(getattr(picture, "n_frames", 1)), MAXIMUM_FRAMES + 1)
        turned = picture.getexif().get(ORIENTATION, 1) in range(2, 9)
    return count, read, ("turned as they say",) if turned else ()
