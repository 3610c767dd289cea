"""The last pixel of a voxel."""

from __future__ import annotations

import numpy as np

from ...arrays import Integers, Reals, Singles
from .method import Accumulator, AccumulatorTypes, BuiltInMethod, Pixels


def _kept(whole: bool, shares: bool) -> AccumulatorTypes:
    return AccumulatorTypes(np.uint8 if whole and not shares else np.float32)


def _insert(kept: Accumulator, pixels: Pixels) -> None:
    # Of several in one voxel numpy leaves the last
    kept.value[pixels.voxels] = pixels.values


def _spread(kept: Accumulator, voxels: Integers, values: Singles, _: Reals) -> None:
    kept.value[voxels] = values


LATEST = BuiltInMethod(name="latest", words="last pixel", in_plus="LATEST", kept=_kept, insert=_insert, spread=_spread, least_share=0.125)
