"""Hole filling as a compiled search: a hole asks its neighbors, or where many ask in vain, the rows around it; nearest first."""

from __future__ import annotations

import numpy as np

from ..arrays import Bytes, Integers, Mask, Numbers
from ..machine.numba_compile import compiled

EMPTY, MEASURED, FILLED = 0, 1, 2

PATIENCE = 64
"""Holes of a few planes that may ask all their neighbors in vain; then how far measured voxels are is noted for all."""

FEW = 6
"""Neighbors that a hole asks before it turns to the rows."""


@compiled
def fill_plane(
    flat_values: Numbers,
    flat_mask: Bytes,
    mask: Bytes,
    offsets: Integers,
    rows_kj: Integers,
    lengths: Integers,
    k: int,
    box: tuple[int, int, int, int],
    low: int,
    steps: Bytes,
    near: Mask,
    vain: Integers,
) -> int:
    """Fill the holes of a plane of a volume [k, j, i]; returns how many.

    Parameters
    ----------
    flat_values : (voxels,) array
    flat_mask, mask : (voxels,) and [k, j, i] uint8 arrays of the same memory
        To make it flat here would take as long to compile as the search.
    offsets : (n, 3) int64 array, [k, j, i]
        The neighbors, in the order in which they are asked.
    rows_kj : (rows, 2) int64 array, [k, j]
        Offsets of the rows within reach, nearest first, equally near ones by rising [k, j].
    lengths : (rows, reach + 2) int64 array
        How far the voxel is that lies so many steps along i in each of these rows; as much as in the last column: out of reach.
    box : tuple of 4 int
        Rows [j] from the first to before the second, and columns [i] likewise, beside which nothing is within reach.
    steps, near : (planes, j, i) uint8 and bool arrays
        Room for notes on the planes from `low` on: those that are filled one after the other with it, and those within reach of them.
    vain : (1,) int64 array
        How many holes of these planes asked in vain, 0 before the first; the notes are there from PATIENCE on.

    Notes
    -----
    Filled voxels are no sources, so planes may be filled in any order and at the same time. Where measured voxels are dense, a hole meets
    one at the first or second neighbor. Where they are not, how many steps along i the nearest measured voxel is, is noted once for every
    voxel; a hole then asks rows instead of voxels, and none where the box around it is empty.
    """
    planes, rows, columns = mask.shape
    count, reach = offsets.shape[0], lengths.shape[1] - 2
    reach_k, reach_j = rows_kj[0, 0], rows_kj[0, 1]
    for n in range(len(rows_kj)):
        reach_k, reach_j = max(reach_k, rows_kj[n, 0]), max(reach_j, rows_kj[n, 1])
    high = low + steps.shape[0]
    flat_steps = np.empty(count, np.int64)
    for n in range(count):
        flat_steps[n] = (offsets[n, 0] * rows + offsets[n, 1]) * columns + offsets[n, 2]
    asked = np.empty(columns, np.bool_)
    filled, noted = 0, vain[0] >= PATIENCE
    tried = min(FEW, count) if noted else count
    for j in range(box[0], box[1]):
        inner_row = reach_k <= k < planes - reach_k and reach_j <= j < rows - reach_j
        start = (k * rows + j) * columns
        if noted:
            _look_around(asked, near, j, max(k - reach_k, low) - low, min(k + reach_k + 1, high) - low)
        for i in range(box[2], box[3]):
            here = start + i
            if flat_mask[np.uint64(here)] != EMPTY or (noted and not asked[i]):
                continue
            found = -1
            if inner_row and reach <= i < columns - reach:
                for n in range(tried):
                    if flat_mask[np.uint64(here + flat_steps[n])] == MEASURED:
                        found = here + flat_steps[n]
                        break
            else:
                for n in range(tried):
                    at_k, at_j, at_i = k + offsets[n, 0], j + offsets[n, 1], i + offsets[n, 2]
                    inside = 0 <= at_k < planes and 0 <= at_j < rows and 0 <= at_i < columns
                    if inside and mask[at_k, at_j, at_i] == MEASURED:
                        found = here + flat_steps[n]
                        break
            if found < 0 and noted:
                found = _nearest_in_rows(mask, steps, rows_kj, lengths, k, j, i, low)
            if found >= 0:
                flat_values[np.uint64(here)] = flat_values[np.uint64(found)]
                flat_mask[np.uint64(here)] = FILLED
                filled += 1
            elif not noted:
                vain[0] += 1
                if vain[0] == PATIENCE:
                    noted, tried = True, min(FEW, count)
                    _note_steps_along_rows(mask[low:high], reach, steps)
                    _note_near_rows(steps, reach, reach_j, near)
                    _look_around(asked, near, j, max(k - reach_k, low) - low, min(k + reach_k + 1, high) - low)
    return filled


@compiled
def _note_steps_along_rows(mask: Bytes, reach: int, steps: Bytes) -> None:
    """Note how many steps along i the nearest measured voxel is from every voxel of `mask` [k, j, i]; reach + 1 where it is farther."""
    planes, rows, columns = mask.shape
    for k in range(planes):
        for j in range(rows):
            step = reach + 1
            for i in range(columns):
                step = 0 if mask[k, j, i] == MEASURED else min(step + 1, reach + 1)
                steps[k, j, i] = step
            step = reach + 1
            for i in range(columns - 1, -1, -1):
                step = 0 if mask[k, j, i] == MEASURED else min(step + 1, reach + 1)
                if step < steps[k, j, i]:
                    steps[k, j, i] = step


@compiled
def _note_near_rows(steps: Bytes, reach: int, reach_j: int, near: Mask) -> None:
    """Note in `near` whether something within reach was measured in the rows of the same plane around every voxel [k, j, i]."""
    planes, rows, columns = steps.shape
    for k in range(planes):
        for j in range(rows):
            for i in range(columns):
                near[k, j, i] = False
            for there in range(max(j - reach_j, 0), min(j + reach_j + 1, rows)):
                for i in range(columns):
                    near[k, j, i] |= steps[k, there, i] <= reach


@compiled
def _look_around(asked: Mask, near: Mask, j: int, first: int, stop: int) -> None:
    """Note in `asked` (i,) which voxels of row j have something near in the planes [first, stop)."""
    for i in range(len(asked)):
        asked[i] = False
    for there in range(first, stop):
        for i in range(len(asked)):
            asked[i] |= near[there, j, i]


@compiled
def _nearest_in_rows(mask: Bytes, steps: Bytes, rows_kj: Integers, lengths: Integers, k: int, j: int, i: int, low: int) -> int:
    """The flat number of the measured voxel nearest to a hole, -1 where none is within reach; `steps` begins at plane `low`."""
    planes, rows, columns = mask.shape
    never = lengths[0, lengths.shape[1] - 1]
    best, best_k, best_j, best_i = never, 0, 0, 0
    for n in range(lengths.shape[0]):
        if lengths[n, 0] > best:
            break
        at_k, at_j = k + rows_kj[n, 0], j + rows_kj[n, 1]
        if at_k < 0 or at_k >= planes or at_j < 0 or at_j >= rows:
            continue
        step = steps[at_k - low, at_j, i]
        length = lengths[n, step]
        if length > best or length == never:
            continue
        at_i = i - step if i >= step and mask[at_k, at_j, i - step] == MEASURED else i + step
        # Rows come nearest first, so an equally far voxel may lie in a row that comes before in the volume
        if length < best or (at_k, at_j) < (best_k, best_j):
            best, best_k, best_j, best_i = length, at_k, at_j, at_i
    return (best_k * rows + best_j) * columns + best_i if best < never else -1
