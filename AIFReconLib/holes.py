"""The hole-filling step: empty voxels between measured ones take the nearest measured value."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from .progress import Progress, report

EMPTY, MEASURED, FILLED = 0, 1, 2
"""Values of the mask volume."""

SLAB_VOXELS = 4_000_000
"""Voxels looked at in one go: bounds the memory of the list of holes."""


def fill_holes(values: np.ndarray, mask: np.ndarray, spacing: np.ndarray, limit: float, progress: Progress | None = None) -> int:
    """Fill holes in place.

    Parameters
    ----------
    values : [k, j, i] array
        Changed where a hole is filled.
    mask : [k, j, i] uint8 array
        MEASURED or EMPTY; filled voxels become FILLED.
    spacing : (3,) array, mm along i, j, k
    limit : float, mm
        Farthest measured voxel to take a value from; 0 fills nothing.

    Returns
    -------
    filled : int
        How many voxels were filled.

    Notes
    -----
    Distances are between voxel centers; among equally near voxels the one with the lowest [k, j, i] gives its value. Only measured
    voxels are sources, so the order of filling does not matter.
    """
    offsets = neighbor_offsets(spacing, limit)
    if not len(offsets):
        return 0
    reach = np.abs(offsets).max(axis=0)
    near_measured = mask == MEASURED
    for axis in range(3):
        near_measured = ndimage.maximum_filter1d(near_measured.view(np.uint8), 2 * int(reach[axis]) + 1, axis=axis, mode="constant").view(
            bool
        )
    slab = max(SLAB_VOXELS // (mask.shape[1] * mask.shape[2]), 1)
    filled = 0
    for first in range(0, mask.shape[0], slab):
        report(progress, first / mask.shape[0], "Filling holes")
        holes = np.argwhere((mask[first : first + slab] == EMPTY) & near_measured[first : first + slab])
        holes[:, 0] += first
        filled += _fill(holes, values, mask, offsets)
    report(progress, 1.0, "Filled holes")
    return filled


def neighbor_offsets(spacing: np.ndarray, limit: float) -> np.ndarray:
    """Offsets (n, 3) in [k, j, i] to every voxel within `limit` mm, nearest first, equally near ones by rising [k, j, i]."""
    spacing_kji = np.asarray(spacing, dtype=np.float64)[::-1]
    reach = np.floor(limit / spacing_kji + 1e-9).astype(int)
    offsets = np.stack(np.meshgrid(*(np.arange(-r, r + 1) for r in reach), indexing="ij"), axis=-1).reshape(-1, 3)
    # In nanometers, so that distances equal in mm are equal here whatever order they were added up in
    distance = np.rint(np.linalg.norm(offsets * spacing_kji, axis=1) * 1e6).astype(np.int64)
    within = (distance > 0) & (distance <= round(limit * 1e6))
    offsets, distance = offsets[within], distance[within]
    return offsets[np.lexsort((offsets[:, 2], offsets[:, 1], offsets[:, 0], distance))]


def _fill(holes: np.ndarray, values: np.ndarray, mask: np.ndarray, offsets: np.ndarray) -> int:
    """Give each hole (n, 3) the value of its first measured neighbor in the order of `offsets`; returns how many had one."""
    filled = 0
    for offset in offsets:
        if not len(holes):
            break
        there = holes + offset
        inside = ((there >= 0) & (there < mask.shape)).all(axis=1)
        k, j, i = np.where(inside[:, None], there, 0).T
        found = inside & (mask[k, j, i] == MEASURED)
        at = tuple(holes[found].T)
        values[at] = values[k[found], j[found], i[found]]
        mask[at] = FILLED
        filled += int(found.sum())
        holes = holes[~found]
    return filled
