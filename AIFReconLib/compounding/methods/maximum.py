"""The brightest pixel of a voxel."""

from __future__ import annotations

import math

import numpy as np

from ...arrays import Integers, Reals, Singles
from .method import Accumulator, AccumulatorTypes, BuiltInMethod, Pixels


def _kept(whole: bool, shares: bool) -> AccumulatorTypes:
    return AccumulatorTypes(np.uint8) if whole and not shares else AccumulatorTypes(np.float32, start=-math.inf)


def _insert(kept: Accumulator, pixels: Pixels) -> None:
    np.maximum.at(kept.value, pixels.voxels, pixels.values.astype(kept.value.dtype, copy=False))


def _spread(kept: Accumulator, voxels: Integers, values: Singles, _: Reals) -> None:
    np.maximum.at(kept.value, voxels, values)


MAXIMUM = BuiltInMethod(
    name="maximum", words="brightest pixel", in_plus="MAXIMUM", kept=_kept, insert=_insert, spread=_spread, least_share=0.125
)
