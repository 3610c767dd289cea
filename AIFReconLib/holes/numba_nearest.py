"""Hole filling as a compiled search: each hole looks at its neighbors, nearest first, until it meets a measured one."""

from __future__ import annotations

import numpy as np

from ..arrays import Bytes, Integers, Numbers
from ..machine.numba_compile import compiled

EMPTY, MEASURED, FILLED = 0, 1, 2


@compiled
def fill_slab(values: Numbers, mask: Bytes, offsets: Integers, first: int, stop: int) -> int:
    """Fill the holes of the planes [first, stop) of a volume [k, j, i]; returns how many.

    Parameters
    ----------
    values : [k, j, i] array
    mask : [k, j, i] uint8 array
    offsets : (n, 3) int64 array, [k, j, i]
        In the order in which neighbors are asked.

    Notes
    -----
    Filled voxels are no sources, so planes may be filled in any order and at the same time. Away from the border, neighbors are at
    fixed distances in memory.
    """
    planes, rows, columns = mask.shape
    count = offsets.shape[0]
    reach_k, reach_j, reach_i = np.abs(offsets[:, 0]).max(), np.abs(offsets[:, 1]).max(), np.abs(offsets[:, 2]).max()
    steps = np.empty(count, np.int64)
    for n in range(count):
        steps[n] = (offsets[n, 0] * rows + offsets[n, 1]) * columns + offsets[n, 2]
    flat_values, flat_mask = values.ravel(), mask.ravel()
    filled = 0
    for k in range(first, stop):
        for j in range(rows):
            inner_row = reach_k <= k < planes - reach_k and reach_j <= j < rows - reach_j
            start = (k * rows + j) * columns
            for i in range(columns):
                here = start + i
                if flat_mask[np.uint64(here)] != EMPTY:
                    continue
                if inner_row and reach_i <= i < columns - reach_i:
                    for n in range(count):
                        there = np.uint64(here + steps[n])
                        if flat_mask[there] == MEASURED:
                            flat_values[np.uint64(here)] = flat_values[there]
                            flat_mask[np.uint64(here)] = FILLED
                            filled += 1
                            break
                    continue
                for n in range(count):
                    at_k, at_j, at_i = k + offsets[n, 0], j + offsets[n, 1], i + offsets[n, 2]
                    if 0 <= at_k < planes and 0 <= at_j < rows and 0 <= at_i < columns and mask[at_k, at_j, at_i] == MEASURED:
                        flat_values[np.uint64(here)] = values[at_k, at_j, at_i]
                        flat_mask[np.uint64(here)] = FILLED
                        filled += 1
                        break
    return filled
