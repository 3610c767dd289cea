"""Many places are tried at once and the best few refined: around a start, along the levels of a spine, or without any start.

The spine repeats itself, so the best place alone says little: what counts is how far the second best lies behind it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Floats
from ..bone.echoes.found import SweepEchoes
from ..bone.field import BoneField
from ..geometry.labels import centers_of_mass
from ..geometry.transforms import invert, transform_points, unit_vectors
from ..progress import Progress, report
from .agreement import Agreement
from .comparison import check
from .refine import MOST_ECHOES, close_at, led, refine

AROUND_MM, AROUND_DEG = 30.0, 25.0
"""How far from a start places are tried when the way down from it leads nowhere good."""

TRIED_AROUND, TRIED_ANYWHERE = 3000, 9000
"""Places that are scored, of which `FOLLOWED` are refined coarsely and `FINISHED` fully."""

FOLLOWED, FINISHED = 120, 6

SCORE_SCALE, SCORE_ECHOES = 4.0, 150
"""mm, and echoes that take part, when places are scored."""

COARSE_ECHOES = 300

APART = 4.0
"""mm that the echoes' center or the mean echo must move from one place to the next for these to be two."""

LEVELS_MM = (24.0, 30.0, 36.0, 42.0)
"""Heights of a lumbar vertebra with its disc, which a CT of one vertebra does not tell."""

TILT_DEG = 12.0
"""Standard deviation of the turns of a patient on a table against the axes of a CT."""


@dataclass(frozen=True, eq=False)
class Place:
    """A place of the bone: where it is, and how well it agrees with all echoes."""

    labels_to_reference: Floats  #: (4, 4) float64, mm
    agreement: Agreement


def finished(echoes: SweepEchoes, bone: BoneField, start: Floats) -> Place:
    """The place that a start leads to."""
    place = refine(echoes, bone, start)
    return Place(place, check(echoes, bone, place))


def distinct(places: Sequence[Place], echoes: SweepEchoes) -> list[Place]:
    """The places by their tightness, best first, without those that are another one within `APART`."""
    points = echoes.thinned(COARSE_ECHOES).points
    found: list[Place] = []
    for place in sorted(places, key=lambda place: place.agreement.tightness, reverse=True):
        if all(motion_between(place.labels_to_reference, other.labels_to_reference, points) > APART for other in found):
            found.append(place)
    return found


def motion_between(one: Floats, other: Floats, points: Floats) -> float:
    """Mean distance in mm by which two places differ, at points (n, 3) of Reference."""
    return float(np.linalg.norm(transform_points(other @ invert(one), points) - points, axis=1).mean())


def beside(echoes: SweepEchoes, bone: BoneField, place: Floats) -> list[Place]:
    """Where the bone comes to lie from a level or two beside a place, labels_to_reference (4, 4); of a single bone the best two."""
    shifts = list(level_shifts(bone).values())
    if shifts:
        return [finished(echoes, bone, place @ shifted(by)) for by in shifts]
    coarse = echoes.thinned(COARSE_ECHOES)
    starts = np.array([place @ shifted(np.array([0.0, 0.0, sign * height])) for height in LEVELS_MM for sign in (1, -1)])
    rough = [Place(end, check(coarse, bone, end)) for end in led(coarse, bone, starts)]
    return [finished(echoes, bone, one.labels_to_reference) for one in distinct(rough, echoes)[:2]]


def mirrored(echoes: SweepEchoes, bone: BoneField, place: Floats) -> Place:
    """The place of the same bone with left and right swapped, near a place: the echoes are mirrored instead."""
    to_labels = invert(place)
    mirror = np.diag([-1.0, 1.0, 1.0, 1.0])
    mirror[0, 3] = 2 * bone.middle[0]
    across = place @ mirror @ to_labels
    swapped = SweepEchoes(transform_points(across, echoes.points), echoes.beams @ across[:3, :3].T, echoes.scores, echoes.frames)
    other = refine(swapped, bone, place, most=MOST_ECHOES // 2)
    return Place(other, check(swapped, bone, other))


def search(echoes: SweepEchoes, bone: BoneField, candidates: Floats, progress: Progress | None = None) -> list[Place]:
    """The best distinct places that any of the candidates leads to.

    `candidates` are labels_to_reference, (n, 4, 4) in mm.
    """
    report(progress, 0.0, "Looking for the CT's place")
    order = np.argsort(_scores(echoes.thinned(SCORE_ECHOES), bone, candidates))
    coarse, points = echoes.thinned(COARSE_ECHOES), echoes.thinned(SCORE_ECHOES).points
    followed: list[Floats] = []
    for number in order:
        if all(motion_between(candidates[number], other, points) > APART for other in followed):
            followed.append(candidates[number])
        if len(followed) == FOLLOWED:
            break
    report(progress, 0.2, "Looking for the CT's place")
    places = [Place(place, check(coarse, bone, place)) for place in led(coarse, bone, np.array(followed))]
    best = distinct(places, echoes)[:FINISHED]
    result = []
    for done, place in enumerate(best):
        report(progress, 0.8 + 0.2 * done / len(best), "Looking for the CT's place")
        result.append(finished(echoes, bone, place.labels_to_reference))
    return distinct(result, echoes)


def around(start: Floats, center: Floats) -> Floats:
    """Places up to `AROUND_MM` and `AROUND_DEG` from a start, evenly in length and angle, (n, 4, 4); always the same ones."""
    rng, count = np.random.default_rng(0), TRIED_AROUND
    moves, axes = (unit_vectors(rng.standard_normal((count, 3))) for _ in range(2))
    turns = scipy.spatial.transform.Rotation.from_rotvec(np.deg2rad(AROUND_DEG) * rng.random((count, 1)) * axes).as_matrix()
    return _placed(turns, center + AROUND_MM * rng.random((count, 1)) * moves, start, center)


def shifted(by: Floats) -> Floats:
    """A motion by (3,) mm, (4, 4)."""
    matrix = np.eye(4)
    matrix[:3, 3] = by
    return matrix


def level_shifts(bone: BoneField) -> dict[int, Floats]:
    """How far bone must move in the labels' own frame for each label to take the place of the n-th after it, (3,) mm by n, n = -2 ... 2.

    The mean over the labels that have such a neighbor, in the order of their numbers. Empty for a single bone.
    """
    centers = np.array(list(centers_of_mass(bone.labels).values()))
    shifts = {}
    for n in (1, 2):
        if len(centers) > n:
            shifts[n] = (centers[n:] - centers[:-n]).mean(axis=0)
        elif len(centers) > 1:
            shifts[n] = n * shifts[1]
    return {sign * n: sign * shift for n, shift in shifts.items() for sign in (1, -1)}


def anywhere(echoes: SweepEchoes, bone: BoneField) -> Floats:
    """Places of a spine under a sweep of which nothing else is known, (n, 4, 4); always the same ones.

    The labels' frame is the patient's: x to the right, y anterior, z superior. The transducer is behind the patient, so the mean beam
    points anterior, give or take `TILT_DEG`. The sweep ran along the spine if it is longer than wide, up or down; else any turn about
    the beam is tried. The middle of the back of bone, as seen from behind, comes to lie on the middle of the echoes, moved along the
    spine by up to half of what both are long together, and by some mm to the side and in depth.
    """
    rng, count = np.random.default_rng(0), TRIED_ANYWHERE
    center = echoes.points.mean(axis=0)
    anterior = echoes.beams.mean(axis=0)
    anterior /= max(np.linalg.norm(anterior), 1e-9)
    across = echoes.points - center
    across -= (across @ anterior)[:, None] * anterior
    _, lengths, axes = np.linalg.svd(across - across.mean(axis=0), full_matrices=False)
    superior = axes[0]
    upright = np.stack([np.cross(anterior, superior), anterior, superior], axis=1)
    elongated = lengths[0] > 1.3 * lengths[1]
    about_beam = rng.normal(0.0, np.deg2rad(TILT_DEG), count) + np.pi * rng.integers(0, 2, count)
    if not elongated:
        about_beam = rng.uniform(0.0, 2 * math.pi, count)
    tilts = rng.normal(0.0, np.deg2rad(TILT_DEG), (count, 2))
    turns = upright @ scipy.spatial.transform.Rotation.from_euler("YXZ", np.column_stack([about_beam, tilts])).as_matrix()
    back = _back_of(bone)
    middle = np.array([np.median(back[:, 0]), np.median(back[:, 1]), 0.5 * (back[:, 2].min() + back[:, 2].max())])
    reach = 0.5 * (np.ptp(back[:, 2]) + np.ptp(across @ superior))
    moves = np.column_stack([rng.normal(0.0, 8.0, count), rng.normal(0.0, 8.0, count), rng.uniform(-reach, reach, count)])
    start = np.eye(4)
    start[:3, 3] = center - middle
    # Moves are along the spine's own axes, so they turn with it
    return _placed(turns, center + np.einsum("nij,nj->ni", turns, moves), start, center)


def _back_of(bone: BoneField) -> Floats:
    """What is seen of bone from behind: the hindmost bone of every line along y, (n, 3) mm in the labels' frame; near the midline."""
    grid, inside = bone.distance.grid, bone.distance.array <= 0
    k, j, i = np.nonzero(inside)
    points = transform_points(grid.ijk_to_reference, np.column_stack([i, j, k]).astype(np.float64))
    cells = np.floor(points[:, [0, 2]] / 2.0).astype(np.int64)
    order = np.lexsort((points[:, 1], *cells.T))
    first = np.ones(len(order), dtype=bool)
    first[1:] = (np.diff(cells[order], axis=0) != 0).any(axis=1)
    seen = points[order[first]]
    central: Floats = seen[np.abs(seen[:, 0] - np.median(points[:, 0])) < 25.0]
    return central


def _placed(turns: Floats, centers: Floats, start: Floats, center: Floats) -> Floats:
    """`start` turned about `center` by each of (n, 3, 3), and moved so that this point comes to each of `centers` (n, 3)."""
    result = np.tile(np.eye(4), (len(turns), 1, 1))
    result[:, :3, :3] = turns @ start[:3, :3]
    result[:, :3, 3] = centers + turns @ (start[:3, 3] - center)
    return result


def _scores(echoes: SweepEchoes, bone: BoneField, candidates: Floats) -> Floats:
    """The mean robust distance of the echoes at each candidate, (n,), 0 to 1, where beams that would leave bone count as far."""
    scores = np.empty(len(candidates))
    for first in range(0, len(candidates), 500):
        some = candidates[first : first + 500]
        scores[first : first + 500] = 1 - close_at(echoes, bone, some, SCORE_SCALE)[0].mean(axis=1)
    return scores
