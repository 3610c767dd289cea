"""Which pixels of one frame enter, where that depends on what the frame shows: dark pixels, and the part of a fan with contact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .region import ImageRegion


class PixelFilter:
    """Looks at one frame after the other.

    Parameters
    ----------
    rejection : float or None
        Pixels darker than this do not enter.
    region : ImageRegion
        Its fan is narrowed frame by frame where it has a `fan_detection`.
    """

    def __init__(self, rejection: float | None, region: ImageRegion):
        self._rejection = rejection
        self._region = region
        self._narrows = region.fan is not None and region.fan_detection is not None

    def kept(self, image: np.ndarray) -> np.ndarray | None:
        """The pixels of an image that enter, (rows, columns) bool; None for all (of the region, which is applied elsewhere)."""
        kept = None if self._rejection is None else image >= self._rejection
        if self._narrows:
            angles = self._region.fan_detection.angles(image, self._region.fan)
            if angles is None:
                return np.zeros(image.shape, dtype=bool)
            fan = replace(self._region.fan, angles_deg=angles).mask(image.shape[1], image.shape[0])
            kept = fan if kept is None else kept & fan
        return kept
