"""The paper's running average, plain and with compensation: each pixel counts by its angle of incidence and where bone is expected."""

from __future__ import annotations

from functools import partial

import numpy as np

from . import rules
from .method import Accumulator, AccumulatorTypes, BuiltInMethod, Pixels


def _insert(kept: Accumulator, pixels: Pixels, compensated: bool) -> None:
    """The paper's rule, which depends on the order of pixels: first the first pixel of every voxel enters, then the second, and so on.

    Where no bone is expected the weight stays 0, and the rule comes down to the last pixel.
    """
    voxels, factors, bone = pixels.voxels, pixels.factors, pixels.probability[pixels.voxels] != 0
    kept.value[voxels[~bone]] = np.minimum(pixels.values[~bone], factors.maximum)
    by_voxel = np.flatnonzero(bone)[np.argsort(voxels[bone], kind="stable")]
    starts = np.flatnonzero(np.diff(voxels[by_voxel], prepend=-1))
    turns = np.arange(by_voxel.size) - np.repeat(starts, np.diff(starts, append=by_voxel.size))
    for taken in np.split(by_voxel[np.argsort(turns, kind="stable")], np.cumsum(np.bincount(turns))):
        at = voxels[taken]
        cosine = pixels.beams.of_pixels(taken).cosine(pixels.directions[at])
        weight = rules.paper_angle_weight(cosine, factors.beta, compensated) * pixels.probability[at]
        new = rules.paper_value(pixels.values[taken], weight, factors.alpha, factors.maximum)
        kept.value[at] = rules.paper_update(kept.value[at].astype(np.float32), kept.weights[at].astype(np.float32), new)
        kept.weights[at] += weight


AIF = BuiltInMethod(
    name="aif",
    words="the paper's running average by the angle of incidence",
    kept=lambda whole, shares: AccumulatorTypes(np.float32, np.float32),
    insert=partial(_insert, compensated=False),
    reads_bone="everywhere",
    compared=True,
    uses=frozenset({"alpha", "intensity_maximum"}),
)

AIF_COMPENSATED = BuiltInMethod(
    name="aif-compensated",
    words="the same with oblique beams raised",
    kept=lambda whole, shares: AccumulatorTypes(np.float32, np.float32),
    insert=partial(_insert, compensated=True),
    reads_bone="everywhere",
    compared=True,
    uses=frozenset({"alpha", "beta", "intensity_maximum"}),
)
