"""The last pixel of a voxel."""

from __future__ import annotations

import numpy as np

from ...arrays import Integers, Reals, Singles
from .method import BuiltInMethod, Kept, Kinds, Pixels


def _kept(whole: bool, shares: bool) -> Kinds:
    return Kinds(np.uint8 if whole and not shares else np.float32)


def _insert(kept: Kept, pixels: Pixels) -> None:
    # Of several in one voxel numpy leaves the last
    kept.value[pixels.voxels] = pixels.values


def _spread(kept: Kept, voxels: Integers, values: Singles, _: Reals) -> None:
    kept.value[voxels] = values


LATEST = BuiltInMethod(name="latest", words="last pixel", in_plus="LATEST", kept=_kept, insert=_insert, spread=_spread, least_share=0.125)
