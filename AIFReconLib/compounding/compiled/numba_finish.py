"""What was remembered of voxels becomes their values, compiled; memory that no pixel entered is passed over, not written."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Bytes, Numbers, Reals
from ...machine.numba_compile import compiled, inlined

ZERO, HALF, BRIGHTEST = np.float32(0), np.float32(0.5), np.float32(255)
SUM = np.uint32(2**20 - 1)
ABOVE = np.uint32(20)
ONE = np.int32(1)
AT_ONCE = 512
"""Voxels that are passed over together where none was entered."""


@inlined
def rounded(value: np.float32, to_8_bit: bool) -> np.float32:
    """The value as it is, or the nearest of 8 bits, halves up."""
    if not to_8_bit:
        return value
    value = value if value > ZERO else ZERO
    return np.float32(np.floor((value if value < BRIGHTEST else BRIGHTEST) + HALF))


@inlined
def any_of(numbers: NDArray[np.unsignedinteger]) -> bool:
    """Whether any is not 0."""
    together = numbers.dtype.type(0)
    for n in range(numbers.size):
        together |= numbers[n]
    entered: bool = together != 0
    return entered


@compiled
def finish_packed(packed: NDArray[np.uint32], start: int, stop: int, to_8_bit: bool, intensity: Numbers, mask: Bytes) -> None:
    """Means of voxels [start, stop) of `packed` state (voxels,), into `intensity` (voxels,), with 1 in `mask` (voxels,) uint8.

    Notes
    -----
    As vectors, where any of `AT_ONCE` voxels was entered. Sums and hits are exact in float32, so that their quotient is the one nearest to
    the mean, as if it had been computed in float64 first.
    """
    for first in range(start, stop, AT_ONCE):
        last = min(first + AT_ONCE, stop)
        both, values, known = packed[first:last], intensity[first:last], mask[first:last]
        if any_of(both):
            for n in range(both.size):
                hits, total = np.int32(both[n] >> ABOVE), np.int32(both[n] & SUM)
                mean = np.float32(total) / np.float32(hits if hits > 0 else ONE)
                values[n] = rounded(mean, to_8_bit)
                known[n] = np.uint8(hits > 0)


@compiled
def finish_quotients(
    value: Reals, divisor: Numbers, hits: NDArray[np.uint32], start: int, stop: int, to_8_bit: bool, intensity: Numbers, mask: Bytes
) -> None:
    """The same of values that are divided by hits or by weights."""
    for first in range(start, stop, AT_ONCE):
        last = min(first + AT_ONCE, stop)
        here, total, by = hits[first:last], value[first:last], divisor[first:last]
        values, known = intensity[first:last], mask[first:last]
        if any_of(here):
            for n in range(here.size):
                mean = np.float32(total[n] / by[n])
                values[n] = rounded(mean if here[n] > 0 else ZERO, to_8_bit)
                known[n] = np.uint8(here[n] > 0)


@compiled
def finish_values(value: Numbers, hits: NDArray[np.uint32], start: int, stop: int, to_8_bit: bool, intensity: Numbers, mask: Bytes) -> None:
    """The same of values that stand as they are."""
    for first in range(start, stop, AT_ONCE):
        last = min(first + AT_ONCE, stop)
        here, found = hits[first:last], value[first:last]
        values, known = intensity[first:last], mask[first:last]
        if any_of(here):
            for n in range(here.size):
                values[n] = rounded(np.float32(found[n]) if here[n] > 0 else ZERO, to_8_bit)
                known[n] = np.uint8(here[n] > 0)
