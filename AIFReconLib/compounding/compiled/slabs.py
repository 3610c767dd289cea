"""How a volume is cut for threads: slabs that share no voxel, so that no thread waits for another."""

from __future__ import annotations

import numpy as np

from ...arrays import Integers, Matrix, Numbers
from ..layout import PixelLayout

SLABS, SLABS_WITH_BONE = 8, 16
"""Slabs that a batch is cut into at most, and where the bone map is read in every voxel, which takes 16 bytes more of each: what frames
share of a slab fits into a core's cache."""

VOXELS_OF_SLAB = 8_000
"""Of one frame, that a core's cache holds beside the rest; smaller slabs only cut rows into more pieces, which are read out of turn."""

SLABS_OF_THREAD = 2
"""At least, so that threads end at about the same time."""


def slabs_for(matrices: Matrix, layout: PixelLayout, threads: int, most: int = SLABS) -> int:
    """How many slabs, at `most`, the cache and the threads ask for, by the voxels that the first of `matrices` (frames, 4, 4) meets."""
    left, right, top, bottom = layout.bounds
    pixel = float(np.linalg.norm(np.cross(matrices[0, :3, 0], matrices[0, :3, 1])))
    needed = pixel * (right - left) * (bottom - top) / VOXELS_OF_SLAB * (most / SLABS)
    return min(max(int(needed), SLABS_OF_THREAD * threads), most)


def cut_into_slabs(matrices: Matrix, layout: PixelLayout, bounds: Numbers, slabs: int = SLABS) -> tuple[int, Integers]:
    """The axis across which to cut, and the edges of the slabs along it, for frames at these places.

    Parameters
    ----------
    matrices : (frames, 4, 4) float64 array, image_to_ijk
    layout : PixelLayout
    bounds : (2, 3) array, along i, j, k
        The first voxel of the part that counts, and the one after the last.
    slabs : int
        How many, at most.

    Returns
    -------
    axis : int
    edges : (slabs + 1,) int64 array
        First voxel of each slab, and the end of the last; together they hold every voxel that a pixel is in or, by less than one
        voxel, beside.

    Notes
    -----
    The axis is the one that image rows lie across and image columns lie along, so that rows are cut as little as can be.
    """
    left, right, top, bottom = layout.bounds
    down, along = np.abs(matrices[:, :3, 1]).mean(axis=0) * (bottom - top), np.abs(matrices[:, :3, 0]).mean(axis=0) * (right - left)
    axis = int(np.argmax(down - along))
    corners = np.array([(x, y, 0, 1) for x in (left, right) for y in (top, bottom)], dtype=np.float64)
    reached = corners @ matrices[:, axis, :].T + 0.5
    low, high = bounds[:, axis]
    first, last = (float(np.clip(np.floor(end), low, high - 1)) for end in (reached.min(), reached.max()))
    return axis, np.unique(np.floor(np.linspace(max(first - 1, low), min(last + 2, high), slabs + 1)).astype(np.int64))
