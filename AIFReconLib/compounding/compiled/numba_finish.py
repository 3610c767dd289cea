"""What was remembered of voxels becomes their values, compiled; voxels that no pixel entered are passed over, not written."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Bytes, Numbers, Reals
from ...machine.numba_compile import compiled, inlined

ZERO, HALF, BRIGHTEST = np.float32(0), np.float32(0.5), np.float32(255)
SUM = np.uint64(2**32 - 1)
ABOVE = np.uint64(32)


@inlined
def rounded(value: np.float32, to_8_bit: bool) -> np.float32:
    """The value as it is, or the nearest of 8 bits, halves up."""
    if not to_8_bit:
        return value
    value = value if value > ZERO else ZERO
    return np.float32(np.floor((value if value < BRIGHTEST else BRIGHTEST) + HALF))


@compiled
def finish_packed(packed: NDArray[np.uint64], start: int, stop: int, to_8_bit: bool, intensity: Numbers, mask: Bytes) -> None:
    """Means of voxels [start, stop) of `packed` state (voxels,), into `intensity` (voxels,), with 1 in `mask` (voxels,) uint8."""
    for voxel in range(start, stop):
        both = packed[voxel]
        if both != 0:
            mean = np.float32(np.float64(both & SUM) / np.float64(both >> ABOVE))
            intensity[voxel] = rounded(mean, to_8_bit)
            mask[voxel] = 1


@compiled
def finish_quotients(
    value: Reals, divisor: Numbers, hits: NDArray[np.uint32], start: int, stop: int, to_8_bit: bool, intensity: Numbers, mask: Bytes
) -> None:
    """The same of values that are divided by hits or by weights."""
    for voxel in range(start, stop):
        if hits[voxel] != 0:
            intensity[voxel] = rounded(np.float32(value[voxel] / divisor[voxel]), to_8_bit)
            mask[voxel] = 1


@compiled
def finish_values(value: Numbers, hits: NDArray[np.uint32], start: int, stop: int, to_8_bit: bool, intensity: Numbers, mask: Bytes) -> None:
    """The same of values that stand as they are."""
    for voxel in range(start, stop):
        if hits[voxel] != 0:
            intensity[voxel] = rounded(np.float32(value[voxel]), to_8_bit)
            mask[voxel] = 1
