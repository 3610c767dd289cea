"""The part of a volume that holds all chosen voxels."""

from __future__ import annotations

import numpy as np
import scipy

from ..arrays import Integers, Mask

Box = tuple[slice, slice, slice]
"""Part of an array [k, j, i]."""


def box_around(mask: Mask, margin: Integers | int = 0) -> Box:
    """The smallest part of `mask` [k, j, i] that holds every True voxel, and up to `margin` (k, j, i) voxels more on every side.

    Where none is True it is around the first voxel.
    """
    found = scipy.ndimage.find_objects(mask.view(np.uint8), max_label=1)[0] or (slice(0, 1),) * 3
    around = np.broadcast_to(margin, 3)
    k, j, i = (slice(max(s.start - int(m), 0), min(s.stop + int(m), n)) for s, m, n in zip(found, around, mask.shape, strict=True))
    return k, j, i
