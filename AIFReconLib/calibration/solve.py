"""The CT's place and what is wrong with a calibration, solved together: echoes of several angles must all lie on the CT's bone.

References
----------
Mercier L, Lango T, Lindseth F, Collins DL (2005), A review of calibration techniques for freehand 3-D ultrasound systems, Ultrasound in
Medicine and Biology 31:449-471. Wein W, Khamene A (2008), Image-based method for in-vivo freehand ultrasound calibration, SPIE Medical
Imaging 6920: the patient instead of a phantom. Welsch's robust loss as in registration/refine.py.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Floats, Mask
from ..bone.field import BoneField
from ..geometry.transforms import invert, transform_points
from ..progress import Progress, report
from ..registration.comparison import ENTERING
from ..registration.refine import FAR, minimized, vector_motion
from .echoes import Correction, ImagedEchoes

PARAMETERS = (
    "shift across",
    "shift along",
    "shift out of the image",
    "turn about across",
    "turn about along",
    "turn in the image",
    "size across",
    "size along",
    "delay",
)
"""What a correction holds, in the order of its numbers."""

EXPECTED = np.array([5.0, 5.0, 5.0, math.radians(3.0), math.radians(3.0), math.radians(3.0), 0.03, 0.03, 0.06])
"""mm, radians, parts and s: as wrong as a calibration is expected to be at most. The units of all steps."""

UNITS = ("mm", "mm", "mm", "deg", "deg", "deg", "%", "%", "ms")

KNOWN = 5.0
"""One over the variance, in those units, that a number of the correction has before the scan: what is 5 mm at most is 2 mm as a rule."""

SEEN_TOGETHER = 20.0
"""Echoes that tell as much as one that is independent: neighbors of a frame err together."""

NOISE = 0.1
"""mm^2. Variance of an echo's distance, for the weight of what is known before; measured after."""

COARSE, FINE = (8.0, 4.0, 2.0), (2.0, 0.7)
"""mm. Scales of the robust distance, one after the other; see registration/refine.py."""

COARSE_ECHOES, FINE_ECHOES = 700, 2500
STARTS, FINISHED = 8, 2
ALL: Mask = np.ones(9, dtype=bool)


@dataclass(frozen=True, eq=False)
class Solved:
    """Where a solution ended."""

    labels_to_reference: Floats  #: (4, 4), mm
    correction: Correction
    cost: float  #: 0 to 1. Mean of 1 - exp(-d^2 / 2 s^2) over the echoes, s the last scale.


class _Cost:
    """Distances of echoes to bone, and their slopes, as functions of steps from a place and a correction."""

    def __init__(self, echoes: ImagedEchoes, bone: BoneField, start: Solved, free: Mask):
        self.echoes, self.bone, self.start, self.free = echoes, bone, start, free
        placed = echoes.placed(start.correction)
        self.center = placed.points.mean(axis=0)
        self.lever = max(math.sqrt(((placed.points - self.center) ** 2).sum(axis=1).mean()), 1.0)

    def stepped(self, vector: Floats) -> Solved:
        """Place and correction after a step (6 + free,)."""
        by, was = np.zeros(9), self.start.correction
        by[self.free] = vector[6:] * EXPECTED[self.free]
        turn = scipy.spatial.transform.Rotation.from_rotvec(by[3:6]).as_matrix()
        correction = Correction(turn @ was.turn, was.shift + by[:3], was.scale * np.exp(by[6:8]), was.delay + by[8], was.center)
        return Solved(vector_motion(vector[:6], self.center, self.lever) @ self.start.labels_to_reference, correction, math.nan)

    def __call__(self, vector: Floats) -> tuple[Floats, Floats]:
        """(n,) distances in mm, `FAR` where sound would leave bone, and (n, 6 + free) slopes."""
        now = self.stepped(vector)
        correction, echoes = now.correction, self.echoes
        planes = echoes.planes_at(correction.delay)
        turns, origins = planes[echoes.frames, :3, :3], planes[echoes.frames, :3, 3]
        arm = echoes.points - correction.center
        scaled = arm * [*correction.scale, 1.0]
        turned = scaled @ correction.turn.T
        inside = correction.center + turned + correction.shift
        points = np.einsum("nij,nj->ni", turns, inside) + origins
        beams = np.einsum("nij,nj->ni", turns @ correction.turn, echoes.beams)
        to_labels = invert(now.labels_to_reference)
        distances, slopes = self.bone.sample(transform_points(to_labels, points))
        slopes = slopes @ to_labels[:3, :3]  # in Reference
        leaving = -(slopes * beams).sum(axis=1) < ENTERING * np.linalg.norm(slopes, axis=1)
        slopes[leaving] = 0.0
        jacobian = np.empty((len(points), 15))
        jacobian[:, :3] = -slopes
        jacobian[:, 3:6] = -np.cross(points - vector[:3] - self.center, slopes) / self.lever
        in_plane = np.einsum("nij,ni->nj", turns, slopes)
        jacobian[:, 6:9] = in_plane
        jacobian[:, 9:12] = np.cross(turned, in_plane)
        jacobian[:, 12:14] = scaled[:, :2] * (in_plane @ correction.turn)[:, :2]
        jacobian[:, 14] = 0.0
        if self.free[8]:
            step = 0.01
            before, after = (echoes.planes_at(correction.delay + by)[echoes.frames] for by in (-step, step))
            moved = np.einsum("nij,nj->ni", (after - before)[:, :3, :3], inside) + (after - before)[:, :3, 3]
            jacobian[:, 14] = (moved * slopes).sum(axis=1) / (2 * step)
        jacobian[:, 6:] *= EXPECTED
        return np.where(leaving, FAR, distances), jacobian[:, np.concatenate([np.ones(6, dtype=bool), self.free])]


def descend(echoes: ImagedEchoes, bone: BoneField, start: Solved, scales: tuple[float, ...], free: Mask = ALL) -> Solved:
    """The best place and correction near a start; only the numbers of the correction that are `free`, (9,), change."""
    now = start
    free = free & (ALL if echoes.timed else np.arange(9) < 8)
    pull = math.sqrt(KNOWN * SEEN_TOGETHER * NOISE)
    for scale in scales:
        cost = _Cost(echoes, bone, now, free)
        given = as_vector(now.correction)[free] / EXPECTED[free]

        def judged(vector: Floats, scale: float = scale, cost: _Cost = cost, given: Floats = given) -> tuple[Floats, Floats]:
            distances, slopes = cost(vector)
            prior = pull * np.eye(len(given), len(vector), 6)
            return np.concatenate([distances / scale, pull * (given + vector[6:])]), np.concatenate([slopes / scale, prior])

        now = cost.stepped(minimized(judged, 6 + int(free.sum()), len(echoes)))
    distances, _ = _Cost(echoes, bone, now, free)(np.zeros(6 + int(free.sum())))
    weights = np.exp(-0.5 * np.minimum((distances / scales[-1]) ** 2, 1e3))
    return Solved(now.labels_to_reference, now.correction, float(1 - weights.mean()))


def as_vector(correction: Correction) -> Floats:
    """A correction as nine numbers in the order of `PARAMETERS`: mm, radians, parts, s; all 0 where nothing is wrong."""
    turn = scipy.spatial.transform.Rotation.from_matrix(correction.turn).as_rotvec()
    return np.concatenate([correction.shift, turn, np.log(correction.scale), [correction.delay]])


def as_correction(vector: Floats, center: Floats) -> Correction:
    """The correction of nine numbers."""
    turn = scipy.spatial.transform.Rotation.from_rotvec(vector[3:6]).as_matrix()
    return Correction(turn, vector[:3].copy(), np.exp(vector[6:8]), float(vector[8]), center)


def named(chosen: Mask) -> list[str]:
    """Words for some of the nine numbers."""
    return [name for name, one in zip(PARAMETERS, chosen, strict=True) if one]


def in_words(vector: Floats) -> Floats:
    """A correction in the units that people read, `UNITS`."""
    numbers: Floats = vector * np.array([1.0, 1.0, 1.0, *(3 * [180 / math.pi]), 100.0, 100.0, 1000.0])
    return numbers


def solve(echoes: ImagedEchoes, bone: BoneField, places: list[Floats], free: Mask = ALL, progress: Progress | None = None) -> list[Solved]:
    """Places and corrections, the best first: from each of these places, and from calibrations that are wrong as calibrations are."""
    rng = np.random.default_rng(0)
    few, many = echoes.spread(COARSE_ECHOES), echoes.spread(FINE_ECHOES)
    found = []
    for number in range(STARTS):
        report(progress, number / (STARTS + FINISHED), "Solving the calibration")
        vector = np.zeros(9)
        if number >= len(places):
            vector[free] = (rng.standard_normal(9) * EXPECTED / 2)[free]
        start = Solved(places[number % len(places)], as_correction(vector, echoes.center), math.nan)
        found.append(descend(few, bone, start, COARSE, free))
    found.sort(key=lambda one: one.cost)
    report(progress, STARTS / (STARTS + FINISHED), "Solving the calibration")
    finished = [descend(many, bone, one, FINE, free) for one in found[:FINISHED]]
    return sorted(finished, key=lambda one: one.cost)
