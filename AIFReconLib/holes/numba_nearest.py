"""Hole filling as a compiled search: each hole looks along the rows around it, nearest row first, until none can hold a nearer voxel."""

from __future__ import annotations

import numpy as np

from ..arrays import Bytes, Integers, Numbers
from ..machine.numba_compile import compiled

EMPTY, MEASURED, FILLED = 0, 1, 2


@compiled
def fill_slab(values: Numbers, mask: Bytes, rows_kj: Integers, lengths: Integers, first: int, stop: int) -> int:
    """Fill the holes of the planes [first, stop) of a volume [k, j, i]; returns how many.

    Parameters
    ----------
    values : [k, j, i] array
    mask : [k, j, i] uint8 array
    rows_kj : (rows, 2) int64 array, [k, j]
        Offsets of the rows within reach, nearest first, equally near ones by rising [k, j].
    lengths : (rows, reach + 2) int64 array
        How far the voxel is that lies so many steps along i in each of these rows; as much as in the last column: out of reach.

    Notes
    -----
    Filled voxels are no sources, so planes may be filled in any order and at the same time. How many steps along i the nearest measured
    voxel is, is noted once for every voxel; a hole then asks rows instead of voxels, and none where the box around it is empty.
    """
    planes, rows, columns = mask.shape
    count, reach = lengths.shape[0], lengths.shape[1] - 2
    never = lengths[0, reach + 1]
    reach_k, reach_j = rows_kj[:, 0].max(), rows_kj[:, 1].max()
    low, high = max(first - reach_k, 0), min(stop + reach_k, planes)
    steps = np.empty((high - low, rows, columns), np.uint8)
    for k in range(low, high):
        for j in range(rows):
            step = reach + 1
            for i in range(columns):
                step = 0 if mask[k, j, i] == MEASURED else min(step + 1, reach + 1)
                steps[k - low, j, i] = step
            step = reach + 1
            for i in range(columns - 1, -1, -1):
                step = 0 if mask[k, j, i] == MEASURED else min(step + 1, reach + 1)
                if step < steps[k - low, j, i]:
                    steps[k - low, j, i] = step
    near = np.zeros((high - low, rows, columns), np.bool_)
    for k in range(high - low):
        for j in range(rows):
            for there in range(max(j - reach_j, 0), min(j + reach_j + 1, rows)):
                for i in range(columns):
                    near[k, j, i] |= steps[k, there, i] <= reach
    filled = 0
    asked = np.empty(columns, np.bool_)
    for k in range(first, stop):
        for j in range(rows):
            asked[:] = False
            for there in range(max(k - reach_k, low), min(k + reach_k + 1, high)):
                for i in range(columns):
                    asked[i] |= near[there - low, j, i]
            for i in range(columns):
                if mask[k, j, i] != EMPTY or not asked[i]:
                    continue
                best, best_k, best_j, best_i = never, 0, 0, 0
                for n in range(count):
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
                if best < never:
                    values[k, j, i] = values[best_k, best_j, best_i]
                    mask[k, j, i] = FILLED
                    filled += 1
    return filled
