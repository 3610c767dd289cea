"""The part of a volume that holds all chosen voxels."""

from __future__ import annotations

import numpy as np

from ..arrays import Integers, Mask

Box = tuple[slice, slice, slice]
"""Part of an array [k, j, i]."""


def box_around(mask: Mask, margin: Integers | int = 0) -> Box:
    """The smallest part of `mask` [k, j, i] that holds every True voxel, and up to `margin` (k, j, i) voxels more on every side.

    Where none is True it is around the first voxel.
    """
    held = [np.flatnonzero(mask.any(axis=others)) for others in ((1, 2), (0, 2), (0, 1))]
    ends = [(int(each[0]), int(each[-1]) + 1) if len(each) else (0, 1) for each in held]
    around = np.broadcast_to(margin, 3)
    k, j, i = (slice(max(a - int(m), 0), min(b + int(m), n)) for (a, b), m, n in zip(ends, around, mask.shape, strict=True))
    return k, j, i
