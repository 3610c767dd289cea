"""What was remembered of voxels becomes their values; untouched memory stays untouched."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType

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
    """Write the values of a state, and 1 where there is one, wherever a pixel entered.

    Parameters
    ----------
    intensity : (voxels,) uint8 or float32 array
        0 elsewhere, or the state's own values. Gray levels of 8 bits are rounded, halves up.
    mask : (voxels,) uint8 array
        0 elsewhere.
    engine : "auto", "numpy" or "numba"
        Who does it; the values are the same.
    threads : int or None
        How many numba uses; by default every core.
    """
    to_8_bit = intensity.dtype == np.uint8
    method = method_named(state.method)
    compiled = None if engine == "numpy" or method.finish is not None else optional_module("AIFReconLib.compounding.compiled.numba_finish")
    voxels = len(intensity)
    if compiled is None:
        for start in range(0, voxels, AT_ONCE):
            _finish(state, start, min(start + AT_ONCE, voxels), intensity, mask, to_8_bit, method.finish)
    else:
        _finish_compiled(compiled, state, intensity, mask, to_8_bit, threads or usable_cores())
    overfull = state.whole_of_overfull()
    if overfull is not None:
        intensity[overfull.voxels] = _written((overfull.sums / overfull.hits).astype(np.float32), to_8_bit)
        mask[overfull.voxels] = 1


def _finish_compiled(compiled: ModuleType, state: VoxelState, intensity: Numbers, mask: Bytes, to_8_bit: bool, threads: int) -> None:
    divisor, voxels = divisor_of(state), len(intensity)

    def finish(part: int) -> None:
        start, stop = part * voxels // PARTS, (part + 1) * voxels // PARTS
        if state.packed:
            compiled.finish_packed(state.value, start, stop, to_8_bit, intensity, mask)
        elif divisor is not None:
            compiled.finish_quotients(state.value, divisor, state.met, start, stop, to_8_bit, intensity, mask)
        else:
            compiled.finish_values(state.value, state.hits, start, stop, to_8_bit, intensity, mask)

    in_parts(finish, PARTS, threads)


def divisor_of(state: VoxelState) -> Numbers | None:
    """What the values of a state are divided by; None where they stand as they are, or are packed with it."""
    if state.packed or not method_named(state.method).is_mean:
        return None
    return state.hits if state.weight is None else state.weight


def _finish(
    state: VoxelState, start: int, stop: int, intensity: Numbers, mask: Bytes, to_8_bit: bool, finish: Callable[[Numbers], Numbers] | None
) -> None:
    part = slice(start, stop)
    sums: Numbers
    hits: NDArray[np.unsignedinteger]
    sums, hits = state.value[part], state.met[part]
    divisor = divisor_of(state)
    if state.packed:
        sums, hits = unpacked(state.value[part])
        divisor = hits
    elif divisor is not None:
        divisor = divisor[part]
    met = np.flatnonzero(hits)
    if not met.size:
        return
    # Where next to nothing is empty, numpy is faster with all
    at = slice(None) if met.size == stop - start else met
    values = sums[at] if divisor is None else np.true_divide(sums[at], divisor[at])
    if finish is not None:
        values = finish(values)
    values = values.astype(np.float32)
    intensity[part][at] = _written(values, to_8_bit)
    mask[part][at] = 1


def _written(values: Singles, to_8_bit: bool) -> Singles:
    return np.floor(np.clip(values, 0.0, 255.0) + np.float32(0.5)) if to_8_bit else values
