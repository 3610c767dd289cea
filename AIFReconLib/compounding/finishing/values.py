"""What was remembered of voxels becomes their values; untouched memory stays untouched."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Bytes, Numbers, Singles
from ...machine.threads import in_parts, optional_module, usable_cores
from ..methods.table import method_named
from ..state import VoxelState, unpacked

AT_ONCE = 2**16
"""Voxels that numpy finishes at a time: what lies between state and result stays in the cache."""

PARTS = 64
"""Parts that threads take."""


def finish_values(state: VoxelState, intensity: Numbers, mask: Bytes, *, engine: str = "auto", threads: int | None = None) -> None:
    """Write the values of a state, and 1 where there is one, wherever a pixel entered; whoever computes them, they are the same.

    Parameters
    ----------
    intensity : (voxels,) uint8 or float32 array
        0 elsewhere, or the state's own values. Gray levels of 8 bits are rounded, halves up.
    mask : (voxels,) uint8 array
        0 elsewhere.
    """
    method, voxels, to_8_bit = method_named(state.method), len(intensity), intensity.dtype == np.uint8
    divisor: Numbers | None = None
    if method.is_mean and not state.packed:
        divisor = state.hits if state.weight is None else state.weight
    compiled: Any = (
        None if engine == "numpy" or method.finish is not None else optional_module("AIFReconLib.compounding.compiled.numba_finish")
    )

    def finish(part: int) -> None:
        start, stop = part * voxels // PARTS, (part + 1) * voxels // PARTS
        if state.packed:
            compiled.finish_packed(state.value, start, stop, to_8_bit, intensity, mask)
        elif divisor is not None:
            compiled.finish_quotients(state.value, divisor, state.met, start, stop, to_8_bit, intensity, mask)
        else:
            compiled.finish_values(state.value, state.hits, start, stop, to_8_bit, intensity, mask)

    if compiled is not None:
        in_parts(finish, PARTS, threads or usable_cores())
    else:
        for start in range(0, voxels, AT_ONCE):
            part = slice(start, start + AT_ONCE)
            _finish(state, part, divisor if divisor is None else divisor[part], method.finish, intensity[part], mask[part])
    overfull = state.whole_of_overfull()
    if overfull is not None:
        intensity[overfull.voxels] = _written((overfull.sums / overfull.hits).astype(np.float32), to_8_bit)
        mask[overfull.voxels] = 1


def _finish(
    state: VoxelState, part: slice, divisor: Numbers | None, finish: Callable[[Numbers], Numbers] | None, intensity: Numbers, mask: Bytes
) -> None:
    """The values of a part in numpy; `divisor`, `intensity` and `mask` are of that part alone."""
    sums: Numbers
    hits: NDArray[np.unsignedinteger]
    sums, hits = state.value[part], state.met[part]
    if state.packed:
        sums, hits = unpacked(sums)
        divisor = hits
    met = np.flatnonzero(hits)
    if not met.size:
        return
    # Where next to nothing is empty, numpy is faster with all
    at = slice(None) if met.size == len(mask) else met
    values = sums[at] if divisor is None else np.true_divide(sums[at], divisor[at])
    if finish is not None:
        values = finish(values)
    intensity[at] = _written(values.astype(np.float32), intensity.dtype == np.uint8)
    mask[at] = 1


def _written(values: Singles, to_8_bit: bool) -> Singles:
    return np.floor(np.clip(values, 0.0, 255.0) + np.float32(0.5)) if to_8_bit else values
