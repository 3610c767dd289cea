"""What the frames of a sweep show together: the least and the greatest of each pixel, and what of that stands out as ultrasound does."""

from __future__ import annotations

import numpy as np
import scipy

from ..arrays import Integers, Mask, Numbers
from .images import ImageStack
from .outline import BORDER_PX

FRAMES_LOOKED_AT = 24

BLOCK_PX, LEAST_SHARP = 8, 0.3
"""Width of a block of JPEG and MPEG, within which what changes makes noise, and the part of the greatest change so near that is none."""

STILL, SURROUND = 0.1, 0.25
"""Part of the brightest pixel by which others may change and stand still; part of these at the border that is darker than the surround."""


def extremes(images: ImageStack) -> tuple[Numbers, Numbers]:
    """The least and the greatest of each pixel in the frames looked at, (rows, columns)."""
    numbers = frames_looked_at(images)
    brightest = np.array(_without_gaps(images[int(numbers[0])]))
    darkest = brightest.copy()
    for number in numbers[1:]:
        image = _without_gaps(images[int(number)])
        np.maximum(brightest, image, out=brightest)
        np.minimum(darkest, image, out=darkest)
    return darkest, brightest


def frames_looked_at(images: ImageStack) -> Integers:
    """Numbers of the frames by which a sweep is judged, all over it."""
    numbers: Integers = np.unique(np.linspace(0, len(images) - 1, FRAMES_LOOKED_AT).astype(int))
    return numbers


def _without_gaps(image: Numbers) -> Numbers:
    """An image in which what is no finite number is black; the same one where all are finite, as whole numbers are."""
    return image if image.dtype.kind in "bui" else np.nan_to_num(image.astype(np.float32), posinf=0.0, neginf=0.0)


def standing_out(change: Numbers, brightest: Numbers) -> list[Numbers]:
    """How much each pixel stands out, (rows, columns), in as many ways as there may be, the surest first.

    What changes without the noise of compressed video, which moves outlines alike at all levels. Where the image's border is gray, also
    how much darker than that a pixel is, for where no echo comes from, ultrasound is black. But so is a window in a gray frame.
    """
    border = np.ones(change.shape, dtype=bool)
    border[BORDER_PX:-BORDER_PX, BORDER_PX:-BORDER_PX] = False
    still = brightest[border & (change <= STILL * brightest.max(initial=0))]
    surround = float(np.quantile(still, SURROUND)) if still.size else 0.0
    sharp: Numbers = np.where(is_sharp(change), change, 0)
    dark = brightest < surround / 2
    return [np.maximum(sharp, np.where(dark, np.subtract(surround, brightest), 0)), sharp] if dark.any() else [sharp]


def is_sharp(values: Numbers) -> Mask:
    """Which values of an image, or along a line of it, are no noise that compressed video makes beside greater ones."""
    sharp: Mask = values > np.multiply(LEAST_SHARP, scipy.ndimage.maximum_filter(values, 2 * BLOCK_PX + 1))
    return sharp
