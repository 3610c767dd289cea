"""What was remembered of voxels becomes their values, compiled; memory that no pixel entered is passed over, not written."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Bytes, Numbers
from ...machine.numba_compile import compiled

AS_IT_IS, QUOTIENT, PACKED = range(3)
"""What a value is: itself, to be divided, or packed with the hits."""

ZERO, HALF, BRIGHTEST = np.float32(0), np.float32(0.5), np.float32(255)
SUM, ABOVE = np.uint32(2**20 - 1), np.uint32(20)


@compiled
def finish(
    kind: int, value: Numbers, divisor: Numbers, met: NDArray[np.unsignedinteger], to_8_bit: bool, intensity: Numbers, mask: Bytes
) -> None:
    """Write the values of voxels (n,) into `intensity`, and 1 into `mask`, wherever a pixel entered.

    Sums and hits of packed voxels are exact in float32, so that their quotient is the one nearest to the mean.
    """
    for n in range(met.size):
        if met[n] == 0:
            continue
        if kind == PACKED:
            both = np.uint32(met[n])
            found = np.float32(both & SUM) / np.float32(both >> ABOVE)
        elif kind == QUOTIENT:
            found = np.float32(value[n] / divisor[n])
        else:
            found = np.float32(value[n])
        if to_8_bit:
            found = found if found > ZERO else ZERO
            found = np.float32(np.floor((found if found < BRIGHTEST else BRIGHTEST) + HALF))
        intensity[n] = found
        mask[n] = np.uint8(1)
