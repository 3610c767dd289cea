"""Areas of an image: their gaps closed, thin lines dropped, the largest one without its holes."""

from __future__ import annotations

import numpy as np
import scipy

from ..arrays import Integers, Mask


def closed(mask: Mask, steps: int) -> Mask:
    """Grown by so many steps along rows and columns and shrunk again; beyond the image there is room to grow, (rows, columns)."""
    return ~_grown(~_grown(np.pad(mask, steps), steps), steps)[steps:-steps, steps:-steps]


def opened(mask: Mask, steps: int) -> Mask:
    """Shrunk by so many steps along rows and columns and grown again; beyond the image nothing is, (rows, columns)."""
    return _grown(~_grown(~np.pad(mask, steps), steps), steps)[steps:-steps, steps:-steps]


def largest_area(mask: Mask) -> Mask:
    """The largest of the connected areas of a mask that is not empty, without its holes; of several the first, (rows, columns)."""
    areas, sizes = _areas(mask)
    # What cannot be reached from beside the image is a hole
    outside, _ = _areas(np.pad(areas != 1 + sizes.argmax(), 1, constant_values=True))
    found: Mask = (outside != outside[0, 0])[1:-1, 1:-1]
    return found


def large_areas(mask: Mask, part: float) -> Mask:
    """The connected areas of a mask that have at least this part of the largest one's pixels, (rows, columns)."""
    areas, sizes = _areas(mask)
    large: Mask = np.append(False, sizes >= part * sizes.max(initial=0))[areas]
    return large


def _areas(mask: Mask) -> tuple[Integers, Integers]:
    """The number of the connected area of each pixel, from 1 on, 0 beside them; and the areas' sizes."""
    areas, count = scipy.ndimage.label(mask)
    return areas, np.bincount(areas.reshape(-1), minlength=count + 1)[1:]


def _grown(mask: Mask, steps: int) -> Mask:
    """Grown by so many steps along rows and columns."""
    if not mask.any():
        return mask
    grown: Mask = scipy.ndimage.distance_transform_cdt(~mask, "taxicab") <= steps
    return grown
