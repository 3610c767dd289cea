"""The exact mean of all pixels of a voxel."""

from __future__ import annotations

import numpy as np

from ...arrays import Integers, Reals, Singles
from .method import Accumulator, AccumulatorTypes, BuiltInMethod, Pixels


def _kept(whole: bool, shares: bool) -> AccumulatorTypes:
    if shares:
        return AccumulatorTypes(np.float64, np.float64)
    return AccumulatorTypes(np.uint32 if whole else np.float64)


def _insert(kept: Accumulator, pixels: Pixels) -> None:
    np.add.at(kept.value, pixels.voxels, pixels.values.astype(kept.value.dtype))


def _spread(kept: Accumulator, voxels: Integers, values: Singles, shares: Reals) -> None:
    shares = shares.astype(np.float64, copy=False)
    np.add.at(kept.value, voxels, shares * values)
    np.add.at(kept.weights, voxels, shares)


AVERAGE = BuiltInMethod(
    name="average",
    words="mean of all pixels",
    kept=_kept,
    insert=_insert,
    spread=_spread,
    weighs_pixels=True,
    is_mean=True,
    compared=True,
    in_plus="MEAN",
)
