"""The paper's running average, plain and with compensation: each pixel counts by its angle of incidence and where bone is expected."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from ...arrays import Integers, Singles
from . import rules
from .method import Accumulator, AccumulatorTypes, BuiltInMethod, Pixels

LONG_RUN = 64
"""Pixels in the order of their voxels, on average, from which on the sort that merges such runs is the faster one."""


@dataclass(frozen=True, eq=False)
class VoxelGroups:
    """Pixels of a frame grouped by the voxel they fall into.

    Parameters
    ----------
    order : (m,) int64 array
        Positions in the frame's pixel list, voxel by voxel, rising within each.
    voxels : (g,) int64 array
        The voxels, fullest first.
    starts, counts : (g,) int64 arrays
        Where each voxel's pixels begin in `order`, and how many there are.
    """

    order: Integers
    voxels: Integers
    starts: Integers
    counts: Integers

    @classmethod
    def of(cls, voxels_of_pixels: Integers) -> VoxelGroups:
        """Group the pixels of `voxels_of_pixels` (m,) int64."""
        bits = max(int(voxels_of_pixels.size - 1).bit_length(), 1)
        keys = (voxels_of_pixels << bits) | np.arange(voxels_of_pixels.size)
        # Where rows run along the grid, hardly a pixel is out of order: merging what is in order is then the fastest way to sort
        falls = np.count_nonzero(voxels_of_pixels[1:] < voxels_of_pixels[:-1])
        keys.sort(kind="stable" if falls * LONG_RUN < keys.size else "quicksort")
        order = keys & ((1 << bits) - 1)
        keys >>= bits
        starts = np.concatenate([[0], np.flatnonzero(keys[1:] != keys[:-1]) + 1])
        counts = np.diff(starts, append=keys.size)
        most = counts.max()
        # Small numbers are sorted by their digits, which is faster
        fullest_first = np.argsort((most - counts).astype(np.min_scalar_type(most)), kind="stable")
        return cls(order, keys[starts][fullest_first], starts[fullest_first], counts[fullest_first])

    def rounds(self) -> Iterator[tuple[int, Integers]]:
        """Yield (n, positions) per round: the first n voxels take the pixels at `positions`."""
        for turn in range(int(self.counts[0])):
            active = int(np.searchsorted(-self.counts, -turn, side="left"))
            yield active, self.order[self.starts[:active] + turn]


def _kept(whole: bool, shares: bool) -> AccumulatorTypes:
    return AccumulatorTypes(np.float32, np.float32)


def _insert(kept: Accumulator, pixels: Pixels, compensated: bool) -> None:
    """The paper's rule, which depends on the order of pixels: those of a frame are sorted by voxel, in row-major order within each.

    Then one pixel of every voxel is taken at a time: as many vector operations as the fullest voxel has pixels, instead of as many scalar
    ones as the image has. The bone map is read once per voxel, not once per pixel.
    """
    values, voxels, beams, factors = pixels.values, pixels.voxels, pixels.beams, pixels.factors
    bone = np.flatnonzero(pixels.probability[voxels] != 0)
    limited: Singles = np.minimum(values, factors.maximum)
    if not bone.size:
        kept.value[voxels] = limited
        return
    groups = VoxelGroups.of(voxels[bone])
    at = groups.voxels
    value, count = kept.value[at].astype(np.float32, copy=False), kept.weights[at].astype(np.float32, copy=False)
    # Where no bone is expected the weight stays 0, and the rule comes down to the last pixel; elsewhere this is overwritten below
    kept.value[voxels] = limited
    x, y, z = pixels.directions[at].T
    facing_x, facing_y = rules.facing(x, y, z, beams.x_axis), rules.facing(x, y, z, beams.y_axis)
    probability = pixels.probability[at]
    for active, positions in groups.rounds():
        now, taken = slice(0, active), bone[positions]
        cosine = rules.cosine_of_incidence(beams.x[taken], beams.y[taken], facing_x[now], facing_y[now])
        weight = rules.paper_angle_weight(cosine, factors.beta, compensated) * probability[now]
        new = rules.paper_value(values[taken], weight, factors.alpha, factors.maximum)
        value[now] = rules.paper_update(value[now], count[now], new)
        count[now] += weight
    kept.value[at], kept.weights[at] = value, count


AIF = BuiltInMethod(
    name="aif",
    words="the paper's running average by the angle of incidence",
    kept=_kept,
    insert=partial(_insert, compensated=False),
    reads_bone="everywhere",
    compared=True,
    uses=frozenset({"alpha", "intensity_maximum"}),
)

AIF_COMPENSATED = BuiltInMethod(
    name="aif-compensated",
    words="the same with oblique beams raised",
    kept=_kept,
    insert=partial(_insert, compensated=True),
    reads_bone="everywhere",
    compared=True,
    uses=frozenset({"alpha", "beta", "intensity_maximum"}),
)
