"""What is recognized of the images of a recording, which several parts of one job ask for: it is looked for once."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Hashable
from typing import TypeVar

import numpy as np

from ..errors import BeamGeometryError
from .detection import DetectedImaging, detect_imaging
from .gray_levels import GrayLevels
from .images import ImageStack
from .region import ImageRegion

Found = TypeVar("Found")

_last: dict[str, tuple[weakref.ref[ImageStack], Hashable, object]] = {}


def recognized(images: ImageStack, spacing: tuple[float, float] = (1.0, 1.0)) -> DetectedImaging:
    """What `detect_imaging` says."""

    def look() -> DetectedImaging | BeamGeometryError:
        try:
            return detect_imaging(images, spacing)
        except BeamGeometryError as error:
            return error

    found = _once("imaging", images, spacing, look)
    if isinstance(found, BeamGeometryError):
        raise found
    return found


def learned_gray_levels(images: ImageStack, region: ImageRegion) -> GrayLevels:
    """What `GrayLevels.learned` says of what the region keeps."""
    rows, columns = images.shape[1:3]
    return _once("gray levels", images, region, lambda: GrayLevels.learned(images, region.mask(columns, rows)))


def _once(kind: str, images: ImageStack, how: Hashable, look: Callable[[], Found]) -> Found:
    """What `look` finds. Images that were asked for last are not looked at again, unless they are an array that may change."""
    known = _last.get(kind)
    if known is not None and known[0]() is images and known[1] == how:
        return known[2]  # type: ignore[return-value]  # a kind has one type
    found = look()
    if not (isinstance(images, np.ndarray) and images.flags.writeable):
        _last[kind] = weakref.ref(images), how, found
    return found
