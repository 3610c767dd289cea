"""What was remembered of voxels becomes their values; untouched memory stays untouched."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import Bytes, Numbers, Singles
from ...machine.threads import checked_threads, in_parts, optional_module
from ..methods.table import method_named
from ..state import VoxelState, unpacked

AT_ONCE = 2**16
"""Voxels that are finished at a time: what lies between state and result stays in the cache."""


def finish_values(state: VoxelState, intensity: Numbers, mask: Bytes, *, engine: str = "auto", threads: int | None = None) -> None:
    """Write the values of a state, and 1 where there is one, wherever a pixel entered; whoever computes them, they are the same.

    Parameters
    ----------
    intensity : (voxels,) uint8 or float32 array
        0 elsewhere, or the state's own values. Gray levels of 8 bits are rounded, halves up.
    mask : (voxels,) uint8 array
        0 elsewhere.
    """
    method, to_8_bit = method_named(state.method), intensity.dtype == np.uint8
    value, met, divisor = state.value, state.met, None
    if method.is_mean and not state.packed:
        divisor = state.hits if state.weight is None else state.weight
    compiled: Any = (
        None if engine == "numpy" or method.finish is not None else optional_module("AIFReconLib.compounding.compiled.numba_finish")
    )

    def finish(number: int) -> None:
        part = slice(number * AT_ONCE, (number + 1) * AT_ONCE)
        by = None if divisor is None else divisor[part]
        if compiled is not None:
            kind = compiled.PACKED if state.packed else compiled.AS_IT_IS if by is None else compiled.QUOTIENT
            compiled.finish(kind, value[part], met[part] if by is None else by, met[part], to_8_bit, intensity[part], mask[part])
            return
        entered = np.flatnonzero(met[part])
        found = value[part][entered]
        if state.packed:
            found, hits = unpacked(found)
            found = np.true_divide(found, hits)
        elif by is not None:
            found = np.true_divide(found, by[entered])
        if method.finish is not None:
            found = method.finish(found)
        intensity[part][entered] = _written(found.astype(np.float32), to_8_bit)
        mask[part][entered] = 1

    in_parts(finish, -(-len(mask) // AT_ONCE), checked_threads(threads))


def _written(values: Singles, to_8_bit: bool) -> Singles:
    return np.floor(np.clip(values, 0.0, 255.0) + np.float32(0.5)) if to_8_bit else values
