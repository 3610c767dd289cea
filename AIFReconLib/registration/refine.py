"""From a start to the best place nearby: a robust distance of echoes to bone, minimized over a rigid motion, from coarse to fine.

References
----------
Brendel B, Winter S, Rick A, Stockheim M, Ermert H (2002), Registration of 3D CT and ultrasound datasets of the spine using bone structures,
Computer Aided Surgery 7:146-155: bone surfaces that sound can reach laid upon the image. Besl PJ, McKay ND (1992), A method for
registration of 3-D shapes, IEEE PAMI 14:239-256: the closest-point ancestor. Fitzgibbon AW (2003), Robust registration of 2D and 3D point
sets, Image and Vision Computing 21:1145-1153: Levenberg-Marquardt on a distance transform under a robust cost, which is what is done here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, cast

import numpy as np
import scipy

from ..arrays import Floats
from ..bone.echoes.found import SweepEchoes
from ..bone.field import BoneField
from ..geometry.transforms import affine, invert, transform_points
from .comparison import ENTERING

SCALES = (8.0, 4.0, 2.0, 1.0)
"""mm. Distances much beyond a scale count as far, no matter how far; one after the other."""

MOST_ECHOES = 1500
"""Echoes that take part, evenly in space."""

STEPS = 15
"""Steps at each scale, where many places are followed at once."""

FAR = 1e3
"""Stands for the distance, in scales, of an echo whose sound would leave bone there."""


def vector_motion(vector: Floats, center: Floats, lever: float = 1.0) -> Floats:
    """A rigid motion (4, 4) in Reference: turn about `center` by the rotation vector ``vector[3:] / lever``, then move by
    ``vector[:3]``.
    """
    linear = scipy.spatial.transform.Rotation.from_rotvec(vector[3:] / lever).as_matrix()
    return affine(linear, center - linear @ center + vector[:3])


def welsch(count: int) -> Callable[[Floats], Floats]:
    """A loss as `scipy.optimize.least_squares` takes it: 1 - exp(-r^2 / 2) of the first residuals, which are echoes, r^2 of the others."""

    def loss(squared: Floats) -> Floats:
        decay = np.exp(-0.5 * np.minimum(squared[:count], 1e3))
        rho = np.stack([squared, np.ones_like(squared), np.zeros_like(squared)])
        rho[:, :count] = 2 * (1 - decay), decay, -0.5 * decay
        return rho

    return loss


def minimized(judged: Callable[[Floats], tuple[Floats, Floats]], size: int, echoes: int, tolerance: float = 1e-5, most: int = 30) -> Floats:
    """The vector near 0, of this size, with the least robust sum of what is `judged` of it: residuals, and their slopes.

    The first residuals are those of so many `echoes`; see `welsch`.
    """
    last: list[tuple[Floats, tuple[Floats, Floats]]] = []

    def once(vector: Floats) -> tuple[Floats, Floats]:
        """Residuals and slopes are asked for apart, of one vector."""
        if not last or not np.array_equal(vector, last[0][0]):
            last[:] = [(vector.copy(), judged(vector))]
        return last[0][1]

    # Typed in another way from one release of the stubs to the next
    solution = cast("Any", scipy.optimize.least_squares)(
        lambda vector: once(vector)[0],
        np.zeros(size),
        jac=lambda vector: once(vector)[1],
        loss=welsch(echoes),
        xtol=1e-4,
        ftol=tolerance,
        gtol=1e-6,
        max_nfev=most,
    )
    found: Floats = solution.x
    return found


class _Cost:
    """Distances of echoes to bone, and their slopes, as functions of a motion of the labels in Reference."""

    def __init__(self, echoes: SweepEchoes, bone: BoneField, start: Floats):
        self._echoes, self._bone, self._start = echoes, bone, start
        self.center = echoes.points.mean(axis=0)
        self.lever = max(math.sqrt(((echoes.points - self.center) ** 2).sum(axis=1).mean()), 1.0)

    def __call__(self, vector: Floats) -> tuple[Floats, Floats]:
        """(n,) distances in mm, `FAR` where sound would leave bone, and (n, 6) slopes."""
        # Moving the labels by M is moving the echoes by its inverse
        turn = scipy.spatial.transform.Rotation.from_rotvec(vector[3:] / self.lever).as_matrix()
        still = (self._echoes.points - vector[:3] - self.center) @ turn
        to_labels = invert(self._start)
        distances, slopes = self._bone.sample(transform_points(to_labels, still + self.center))
        slopes = slopes @ to_labels[:3, :3]
        beams = self._echoes.beams @ turn
        steepness = np.linalg.norm(slopes, axis=1)
        leaving = -(slopes * beams).sum(axis=1) < ENTERING * steepness
        # d = D(R^T q + c) with q = p - t - c: by t it changes as -R g, by a small further turn w as -(q x R g) . w
        turned = slopes @ turn.T
        arm = self._echoes.points - vector[:3] - self.center
        jacobian = np.concatenate([-turned, -np.cross(arm, turned) / self.lever], axis=1)
        jacobian[leaving] = 0.0
        return np.where(leaving, FAR, distances), jacobian


def robust_cost(echoes: SweepEchoes, bone: BoneField, labels_to_reference: Floats) -> float:
    """The mean of 1 - exp(-d^2 / 2 s^2) over the echoes, s the finest scale; 0 to 1."""
    distances, _ = _Cost(echoes, bone, labels_to_reference)(np.zeros(6))
    return float(1 - np.exp(-0.5 * np.minimum((distances / SCALES[-1]) ** 2, 1e3)).mean())


def refine(
    echoes: SweepEchoes,
    bone: BoneField,
    start: Floats,
    scales: tuple[float, ...] = SCALES,
    most: int = MOST_ECHOES,
    free: Floats | None = None,
) -> Floats:
    """The best place of bone near a start, labels_to_reference, (4, 4) in mm.

    Minimized is the mean of 1 - exp(-d^2 / 2 s^2) over the echoes, d the signed distance of an echo to bone, for s = 8, 4, 2 and 1 mm.
    An echo far from all bone, or whose sound would leave bone, costs 1 and pulls nowhere: gas, fascia, and bone that the labels lack do
    no harm. The turn about the echoes' center is composed anew at each scale, so that its vector stays small.

    `start` is a rigid labels_to_reference, (4, 4) in mm; `most` echoes take part; `scales` are mm. `free`, (6, n), leads to the motions
    that are followed, as `vector_motion` takes them; None: all.
    """
    chosen = echoes.thinned(most)
    place = np.array(start, dtype=np.float64)
    free = np.eye(6) if free is None else free
    for scale in scales:
        cost = _Cost(chosen, bone, place)

        def judged(vector: Floats, scale: float = scale, cost: _Cost = cost) -> tuple[Floats, Floats]:
            distances, slopes = cost(free @ vector)
            return distances / scale, slopes @ free / scale

        vector = free @ minimized(judged, free.shape[1], len(chosen))
        place = vector_motion(vector, cost.center, cost.lever) @ place
    return place


def close_at(echoes: SweepEchoes, bone: BoneField, places: Floats, scale: float) -> tuple[Floats, Floats, Floats]:
    """At many places, (n, 4, 4): how close each echo is to bone, exp(-d^2 / 2 s^2), 0 where sound would leave bone, (n, echoes); its
    distance, (n, echoes) mm, and how that rises, (n, echoes, 3)."""
    turns = places[:, :3, :3]
    points = (echoes.points - places[:, None, :3, 3]) @ turns
    distances, slopes = bone.sample(points.reshape(-1, 3))
    distances, slopes = distances.reshape(points.shape[:2]), slopes.reshape(points.shape) @ turns.transpose(0, 2, 1)
    entering = -(slopes * echoes.beams).sum(axis=2) >= ENTERING * np.linalg.norm(slopes, axis=2)
    return np.where(entering, np.exp(-0.5 * (distances / scale) ** 2), 0.0), distances, slopes


def led(echoes: SweepEchoes, bone: BoneField, starts: Floats) -> Floats:
    """Roughly where many starts lead to, all at once, (n, 4, 4): what `refine` minimizes, by `STEPS` steps of Levenberg and Marquardt at
    each scale.

    All `echoes` take part: few are wanted. `starts` are rigid labels_to_reference, (n, 4, 4) in mm.
    """
    center = echoes.points.mean(axis=0)
    arms = echoes.points - center
    lever = max(math.sqrt((arms**2).sum(axis=1).mean()), 1.0)

    def judged(places: Floats, scale: float) -> tuple[Floats, Floats, Floats]:
        """Cost (n,), its slope (n, 6) and its curvature (n, 6, 6)."""
        weights, distances, slopes = close_at(echoes, bone, places, scale)
        jacobian = np.concatenate([-slopes, -np.cross(arms, slopes) / lever], axis=2)
        curved = jacobian * (weights * np.maximum(1 - (distances / scale) ** 2, 0.0))[..., None]
        return 1 - weights.mean(axis=1), (jacobian * (weights * distances)[..., None]).sum(axis=1), curved.transpose(0, 2, 1) @ jacobian

    places = starts.copy()
    for scale in SCALES:
        cost, slope, curvature = judged(places, scale)
        damping = np.full(len(places), 0.01 * len(echoes))
        for _ in range(STEPS):
            steps = -np.linalg.solve(curvature + damping[:, None, None] * np.eye(6), slope[..., None])[..., 0]
            steps *= np.minimum(scale / np.maximum(np.linalg.norm(steps, axis=1), 1e-9), 1.0)[:, None]
            moved, tried = scipy.spatial.transform.Rotation.from_rotvec(steps[:, 3:] / lever).as_matrix(), places.copy()
            tried[:, :3, 3] = (moved @ (places[:, :3, 3] - center)[..., None])[..., 0] + center + steps[:, :3]
            tried[:, :3, :3] = moved @ places[:, :3, :3]
            found = judged(tried, scale)
            better = found[0] < cost
            places[better] = tried[better]
            for known, new in zip((cost, slope, curvature), found):
                known[better] = new[better]
            damping *= np.where(better, 0.3, 5.0)
    return places
