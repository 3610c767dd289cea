"""What a sweep holds of a calibration, and how well: from the curvature of the cost, and from halves of the sweep against each other."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Mask
from ..bone.field import BoneField
from ..geometry.transforms import invert, transform_points
from .echoes import ImagedEchoes
from .solve import FINE, FINE_ECHOES, KNOWN, SEEN_TOGETHER, Solved, _Cost, descend

HELD = 0.25
"""Part of what is expected of a number (`EXPECTED`) within which the sweep must tell it, one standard deviation, for it to be held."""

BLOCKS = 4
"""Parts into which the frames of each angle are cut, in the order of time; every other one belongs to the same half."""

DRAWS = 60

THICKNESS = 0.15
"""mm. Half of what an echo is thick: how far all of them together may lie off the bone."""


def covariance(echoes: ImagedEchoes, bone: BoneField, solved: Solved, free: Mask) -> Floats:
    """Of a step of place and correction, (6 + free, 6 + free), in the units of `_Cost`: noise over curvature, with what is `KNOWN`."""
    distances, slopes = _Cost(echoes, bone, solved, free)(np.zeros(6 + int(free.sum())))
    weights = np.exp(-0.5 * np.minimum((distances / FINE[-1]) ** 2, 1e3))
    noise = (weights * np.minimum(np.abs(distances), 1e3) ** 2).sum() / weights.sum()
    curvature = (slopes * weights[:, None]).T @ slopes / (SEEN_TOGETHER * noise)
    known = np.concatenate([np.zeros(6), np.full(int(free.sum()), KNOWN)])
    return np.linalg.pinv(curvature + np.diag(known), hermitian=True)


def deviations(echoes: ImagedEchoes, bone: BoneField, solved: Solved, asked: Mask) -> Floats:
    """Standard deviations of the numbers that were asked for, in units of `EXPECTED`; what is not held may be wrong as is expected."""
    return np.sqrt(np.diag(covariance(echoes, bone, solved, asked))[6:])


def halves(echoes: ImagedEchoes) -> tuple[ImagedEchoes, ImagedEchoes]:
    """The echoes in two halves: every other block of the frames of each angle."""
    half = np.zeros(len(echoes.angles), dtype=np.int64)
    for number in np.unique(echoes.angles):
        mine = np.flatnonzero(echoes.angles == number)
        half[mine] = np.arange(len(mine)) * BLOCKS // len(mine) % 2
    first = half[echoes.frames] == 0
    return echoes[first], echoes[~first]


def placed_by(solved: Solved, echoes: ImagedEchoes) -> Floats:
    """Where the echoes lie in the labels' frame, (n, 3) mm."""
    return transform_points(invert(solved.labels_to_reference), echoes.placed(solved.correction).points)


def spread_of(echoes: ImagedEchoes, bone: BoneField, solved: Solved, asked: Mask, apart: float) -> float:
    """mm. By how much echoes may be misplaced on the bone, in the median over them; 9 times in 10 it is less.

    By the curvature, and by what the two halves are `apart`: their mean is wrong by half of that.
    """
    cost = _Cost(echoes, bone, solved, asked)
    spread = covariance(echoes, bone, solved, asked)
    draws = np.random.default_rng(0).multivariate_normal(np.zeros(len(spread)), spread, DRAWS)
    was = placed_by(solved, echoes)
    moved = [np.median(np.linalg.norm(placed_by(cost.stepped(draw), echoes) - was, axis=1)) for draw in draws]
    return math.hypot(float(np.quantile(moved, 0.9)), apart / 2, THICKNESS)


@dataclass(frozen=True)
class Halves:
    """Calibrated on one half of a sweep, measured on the other; the mean of both ways round."""

    before: float  #: mm. Median distance of the other half's echoes to bone with the calibration as given, the CT's place refined.
    after: float  #: mm. The same with the calibration of the first half.
    apart: float  #: mm. Median over all echoes of how far apart both halves' calibrations place them on the bone.


def compared_halves(echoes: ImagedEchoes, bone: BoneField, given: Solved, solved: Solved, free: Mask) -> Halves:
    """Solve each half from the whole's solution, and measure it on the other; `given` is the calibration as it was."""
    parts = halves(echoes)
    none = np.zeros(9, dtype=bool)
    ends = [descend(part.spread(FINE_ECHOES), bone, solved, FINE, free) for part in parts]
    plain = [descend(part.spread(FINE_ECHOES), bone, given, FINE, none) for part in parts]
    medians = [[median_distance(other, bone, one) for one, other in zip(which, reversed(parts), strict=True)] for which in (plain, ends)]
    apart = np.linalg.norm(placed_by(ends[0], echoes) - placed_by(ends[1], echoes), axis=1)
    return Halves(float(np.mean(medians[0])), float(np.mean(medians[1])), float(np.median(apart)))


def median_distance(echoes: ImagedEchoes, bone: BoneField, solved: Solved, near: float = 10.0) -> float:
    """mm. Median of the echoes' distances to bone, without sign, of those near it."""
    distances = np.abs(bone.sample(placed_by(solved, echoes))[0])
    close = distances[distances <= near]
    return float(np.median(close)) if close.size else math.nan
