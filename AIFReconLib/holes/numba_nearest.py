"""Hole filling by the nearest measured voxel, compiled; see `nearest` for the rule and its tables."""

from __future__ import annotations

import numpy as np

from ..arrays import Bytes, Integers, Numbers
from ..machine.numba_compile import compiled

EMPTY, MEASURED, FILLED = 0, 1, 2


@compiled
def fill(values: Numbers, mask: Bytes, first: int, stop: int, rows: Integers, ranks: Integers, offsets: Integers) -> int:
    """Fill the holes of the planes [first, stop) of a part [k, j, i] of a volume that all that is within reach belongs to; how many."""
    planes, lines, columns = mask.shape
    reach, none = ranks.shape[1] // 2 - 1, len(offsets)
    # Steps along i to the nearest measured voxel: the lower of two, reach + 1 where there is none
    steps, near = np.empty(mask.shape, np.int16), np.empty(columns, np.bool_)
    for k in range(planes):
        for j in range(lines):
            step = reach + 1
            for i in range(columns - 1, -1, -1):
                step = 0 if mask[k, j, i] == MEASURED else min(step + 1, reach + 1)
                steps[k, j, i] = step
            step = reach + 1
            for i in range(columns):
                step = 0 if mask[k, j, i] == MEASURED else min(step + 1, reach + 1)
                if step <= min(steps[k, j, i], reach):
                    steps[k, j, i] = -step
    filled = 0
    for k in range(first, stop):
        for j in range(lines):
            # Most holes have nothing near: whole lines are looked at together, which is fast
            near[:] = False
            for n in range(len(rows)):
                at_k, at_j = k + rows[n, 0], j + rows[n, 1]
                if 0 <= at_k < planes and 0 <= at_j < lines:
                    for i in range(columns):
                        near[i] |= steps[at_k, at_j, i] <= reach
            for i in range(columns):
                if mask[k, j, i] != EMPTY or not near[i]:
                    continue
                best = none
                for n in range(len(rows)):
                    if ranks[n, reach] > best:
                        break
                    at_k, at_j = k + rows[n, 0], j + rows[n, 1]
                    if 0 <= at_k < planes and 0 <= at_j < lines:
                        best = min(best, ranks[n, reach + steps[at_k, at_j, i]])
                if best < none:
                    values[k, j, i] = values[k + offsets[best, 0], j + offsets[best, 1], i + offsets[best, 2]]
                    mask[k, j, i] = FILLED
                    filled += 1
    return filled
