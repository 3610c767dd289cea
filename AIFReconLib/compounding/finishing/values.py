"""What was remembered of voxels becomes their values; untouched memory stays untouched."""

from __future__ import annotations

import numpy as np

from ...arrays import Bytes, Numbers, Singles
from ...machine.threads import checked_threads, in_parts
from ..methods.table import method_named
from ..state import VoxelState

AT_ONCE = 2**16
"""Voxels that are finished at a time: what lies between state and result stays in the cache."""


def finish_values(state: VoxelState, intensity: Numbers, mask: Bytes, threads: int | None = None) -> None:
    """Write the values of a state, and 1 where there is one, wherever a pixel entered.

    Parameters
    ----------
    intensity : (voxels,) uint8 or float32 array
        0 elsewhere, or the state's own values. Gray levels of 8 bits are rounded, halves up.
    mask : (voxels,) uint8 array
        0 elsewhere.
    """
    method, to_8_bit, met = method_named(state.method), intensity.dtype == np.uint8, state.met
    divisor = (state.hits if state.weight is None else state.weight) if method.is_mean else None

    def finish(number: int) -> None:
        part = slice(number * AT_ONCE, (number + 1) * AT_ONCE)
        entered = np.flatnonzero(met[part])
        found = state.value[part][entered]
        if divisor is not None:
            found = np.true_divide(found, divisor[part][entered])
        if method.finish is not None:
            found = method.finish(found)
        intensity[part][entered] = _written(found.astype(np.float32), to_8_bit)
        mask[part][entered] = 1

    in_parts(finish, -(-len(mask) // AT_ONCE), checked_threads(threads))


def _written(values: Singles, to_8_bit: bool) -> Singles:
    return np.floor(np.clip(values, 0.0, 255.0) + np.float32(0.5)) if to_8_bit else values
