"""Frames from pictures: PNG, JPEG, TIFF (of many pages too), BMP."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .imported_images import DecodedImages, ImportedImages, decoding, describe_stack, library

_AS_THEY_ARE = ("L", "I", "F", "RGB", "RGBA", "I;16", "I;16L", "I;16B", "I;16N", "LA")
"""Modes that become arrays of their own type; palettes, CMYK and the like are made RGB first."""


def open_pictures(files: list[Path]) -> ImportedImages:
    """The pages of these files, one frame each.

    Raises
    ------
    FileFormatError
        When a file is no picture.
    """
    image_module = library("PIL.Image", "Pictures")
    pages = [(path, page) for path in files for page in range(_page_count(image_module, path))]
    several = len(pages) > len(files)

    def decode(number: int) -> np.ndarray:
        path, page = pages[number]
        with _readable(path), image_module.open(path) as picture:
            picture.seek(page)
            if picture.mode == "1":
                return np.asarray(picture.convert("L"))
            return np.asarray(picture if picture.mode in _AS_THEY_ARE else picture.convert("RGB"))

    def where(number: int) -> str:
        path, page = pages[number]
        return f"{path}, page {page}" if several else str(path)

    stack = DecodedImages(len(pages), decode, where)
    kinds = "/".join(sorted({path.suffix[1:].upper() for path in files}))
    what = f"{kinds} {'pages' if several else 'pictures'}"
    names = None if several else tuple(path.name for path, _ in pages)
    return ImportedImages(stack, describe_stack(len(pages), what, stack.shape[1:], stack.dtype), names)


def _page_count(image_module, path: Path) -> int:
    with _readable(path), image_module.open(path) as picture:
        return int(getattr(picture, "n_frames", 1))


def _readable(path: Path):
    return decoding(f"{path}: it cannot be read as a picture", "Export it again.")
