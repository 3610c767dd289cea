"""The mean of what frames show, bone that a frame shows and the map expects above all: sum(w v) / sum(w), whatever the order."""

from __future__ import annotations

import numpy as np

from . import rules
from .method import Accumulator, AccumulatorTypes, BuiltInMethod, Pixels


def _insert(kept: Accumulator, pixels: Pixels) -> None:
    """Where no shadow begins, as nearly everywhere, the gate is closed: the bone map is not looked at."""
    if pixels.bone_at is None:
        raise ValueError("Input bone must be given for method weighted; got None.")
    factors = pixels.factors
    weight, value = factors.floor * pixels.reach, np.minimum(pixels.values, factors.maximum)
    begins = np.flatnonzero(pixels.onset > 0)
    probability, directions = pixels.bone_at(pixels.voxels[begins])
    gate = rules.weighted_gate(pixels.onset[begins], probability)
    compensation = rules.weighted_compensation(pixels.beams.of_pixels(begins).cosine(directions), factors.beta)
    weight[begins] = rules.weighted_weight(gate, pixels.reach[begins], factors.floor)
    value[begins] = rules.weighted_value(pixels.values[begins], gate, compensation, factors.gain, factors.maximum)
    value *= weight
    np.add.at(kept.value, pixels.voxels, value)
    np.add.at(kept.weights, pixels.voxels, weight)


WEIGHTED = BuiltInMethod(
    name="weighted",
    words="mean weighted by the bone and shadow that frames show, bone brightened",
    kept=lambda whole, shares: AccumulatorTypes(np.float32, np.float32),
    insert=_insert,
    reads_bone="at onsets",
    needs_shadows=True,
    is_mean=True,
    always_weighs=True,
    widens=True,
    follows_agreement=True,
    mends_motion=True,
    compared=True,
    uses=frozenset({"beta", "bone_gain", "weight_floor", "intensity_maximum", "gray_levels"}),
)
