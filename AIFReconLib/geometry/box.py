"""Boxes: the part of a volume that holds all chosen voxels, and where boxes lie."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from ..arrays import Floats, Integers, Mask, Matrix, Numbers

Box = tuple[slice, slice, slice]
"""Part of an array [k, j, i]."""

NEAR = 0.6
"""Of a box's half extent across a plane: farther from its middle a plane is not near it, or two levels would be named in one place."""


def box_around(mask: Mask, margin: Integers | int = 0) -> Box:
    """The smallest part of `mask` [k, j, i] that holds every True voxel, and up to `margin` (k, j, i) voxels more on every side.

    Where none is True it is around the first voxel.
    """
    held = [np.flatnonzero(mask.any(axis=others)) for others in ((1, 2), (0, 2), (0, 1))]
    ends = [(int(each[0]), int(each[-1]) + 1) if len(each) else (0, 1) for each in held]
    around = np.broadcast_to(margin, 3)
    k, j, i = (slice(max(a - int(m), 0), min(b + int(m), n)) for (a, b), m, n in zip(ends, around, mask.shape, strict=True))
    return k, j, i


def block_sums(array: Numbers, factors: ArrayLike, dtype: DTypeLike) -> Any:
    """Sums over blocks of so many elements along each axis; what fills no block at the far sides is left out."""
    blocks = np.asarray(factors, int)
    counts = np.array(array.shape) // blocks
    sums = np.zeros(counts, dtype)
    for first in np.ndindex(*blocks):
        sums += array[tuple(slice(a, a + count * block, block) for a, count, block in zip(first, counts, blocks, strict=True))]
    return sums


def in_cubes(points: Floats, edge: float, *more: Floats) -> list[Floats]:
    """The mean (m, 3) of the points (n, 3) in each cube of this edge, and of what `more` (n, 3) is told of each."""
    _, cube = np.unique(np.floor(points / edge), axis=0, return_inverse=True)
    count = np.bincount(cube.reshape(-1))
    return [np.stack([np.bincount(cube.reshape(-1), axis) / count for axis in each.T], axis=1) for each in (points, *more)]


def corners_of(ends: Floats) -> Floats:
    """The corners, (8, 3), of a box with these ends, (3, 2), along the axes."""
    return np.array([*product(*ends)])


def middle_on_plane(corners: Floats, plane: Matrix) -> Floats | None:
    """Where the middle of a box lies on a plane near it, (3,); None of a plane that passes it by.

    The box is given by its `corners` (8, 3), mm, the plane by the matrix (4, 4) of its axes, its normal the third.
    """
    normal = plane[:3, 2] / np.linalg.norm(plane[:3, 2])
    along = (corners - plane[:3, 3]) @ normal
    away = along.mean()
    if abs(away) > NEAR * np.ptp(along) / 2:
        return None
    middle: Floats = corners.mean(axis=0) - away * normal
    return middle
