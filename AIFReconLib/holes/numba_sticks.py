"""Hole filling by sticks, compiled; see `igsio_hole_filling` for the rules."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Integers, Mask, Numbers
from ..machine.numba_compile import compiled


@compiled
def fill_along_sticks(
    flat_values: Numbers,
    flat_known: Mask,
    places: Integers,
    steps: Integers,
    lengths: Floats,
    size: int,
    wanted: int,
    averages: Floats,
) -> None:
    """Fill holes at flat `places` of a padded volume.

    Parameters
    ----------
    flat_values : (voxels,) array
    flat_known : (voxels,) bool array
    places : (holes,) int64 array
    steps : (13,) int64 array
        What a step along each stick is in the flat volume, and
    lengths : (13,) float64 array
        how long it is, in voxels.
    size : int
        Voxels of the longest stick.
    wanted : int
        How many sticks to average. Where it is one, directions in which no stick can be as good as the best so far are not followed.
    averages : (holes,) float64 array
        Written; NaN where no stick is found.
    """
    directions = steps.shape[0]
    score, value = np.empty(directions), np.empty(directions)
    for hole in range(places.shape[0]):
        here, shortest = places[hole], np.inf
        for n in range(directions):
            score[n] = 0.0
            # A little more, for rounding: what is kept for nothing does no harm
            longest = int(min(float(size), shortest / lengths[n] + 1e-6)) if wanted == 1 else size
            ahead = 0
            for taken in range(1, longest - 1):
                if flat_known[here + taken * steps[n]]:
                    ahead = taken
                    break
            if ahead == 0:
                continue
            for taken in range(1, longest - ahead):
                if flat_known[here - taken * steps[n]]:
                    length = ahead + taken + 1.0
                    toward = (taken + 1) / length
                    value[n] = (1 - toward) * flat_values[here - taken * steps[n]] + toward * flat_values[here + ahead * steps[n]]
                    score[n] = 1.0 / (length * lengths[n])
                    shortest = min(shortest, length * lengths[n])
                    break
        # Those of one score enter together
        total, weight, least = 0.0, 0.0, np.sort(score)[-min(wanted, directions)]
        for n in range(directions):
            if score[n] > 0.0 and score[n] >= least:
                total += score[n] * value[n]
                weight += score[n]
        averages[hole] = total / weight if weight > 0.0 else np.nan
