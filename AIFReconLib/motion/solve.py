"""The motion and the calibration with which the echoes of all passes lie on one surface, and on a CT's bone where there is one.

Gauss and Newton's steps. A calibration that is wrong moves all frames alike, seen from the probe; a patient who moves does not. So both are
looked for together, and each takes what it explains with less.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from ..arrays import Floats, Integers, Matrix
from ..bone.echoes.found import SweepEchoes
from ..bone.field import BoneField
from ..geometry.transforms import image_plane_axes, invert, transform_points
from ..progress import Progress, report
from .passes import Passes

KNOT, MOST_KNOTS = 0.5, 400
"""s between knots of a pass's curve, and the most knots of a recording."""

SIZE, TURN_DEG = 4.0, 2.0
"""What is expected of a motion, standard deviations: mm at a knot, degrees of a pass."""

CALIBRATION, CALIBRATION_DEG = 3.0, 2.0
"""What is expected of a calibration, standard deviations: mm, and degrees about the bone in the image."""

MOTION_ALONE, CALIBRATION_ALONE, BOTH = slice(None, -6), slice(-6, None), slice(None)
"""The parameters that are looked for."""

HELD = 0.03
"""mm that a shift may have along a direction in which nothing moves."""

NOISE, TOGETHER = 0.5, 15.0
"""mm by which an echo lies off its surface, and how many echoes err together."""

COARSE = ((True, 12.0, 6.0, 0.1),) * 4 + ((True, 8.0, 3.0, 0.1),) * 4 + ((True, 6.0, 1.5, 0.2),) * 3
ALL_ON_BONE = ((False, 1.0, 8.0, 0.001),) * 3 + ((False, 1.0, 4.0, 0.001),) * 3 + ((False, 1.0, 2.0, 0.001),) * 3
FINE = ((False, 4.0, 1.5, 1.5),) * 3 + ((False, 3.0, 0.75, 1.5),) * 3 + ((False, 2.0, 0.5, 1.5),) * 3
"""Whether pass is laid on pass, mm to the farthest neighbor, mm of the loss, and mm from a knot to the next; one after the other."""

NEIGHBORS, FLAT = 12, 0.8
"""Echoes of other passes through which a plane is laid, and how thick they may be, mm."""

ALIKE = 0.7
"""Cosine between the planes of two passes at echoes that may be of one place."""

MOST_ECHOES, OF_PAIRS = 3000, 1500
"""Echoes that are laid on planes, and on each other pass."""


@dataclass(frozen=True, eq=False)
class MotionCurve:
    """A rigid motion of Reference for each frame: a turn of each pass, and a shift on a line from knot to knot.

    Before it, what is wrong with the calibration moves the image, the same in all frames.
    """

    passes: Passes
    knots: Integers  #: (frames,). First of the two knots of each frame.
    shares: Floats  #: (frames,). How far on the way to the next knot.
    owners: Integers  #: (knots,). Pass of each.
    knot_times: Floats  #: (knots,), s
    centers: Floats  #: (passes, 3), mm. About which each pass turns.
    places: Floats  #: (frames, 3), mm. Where the bone is that each frame shows.
    lever: float  #: mm by which turns are measured
    shifts: Floats  #: (knots, 3), mm
    turns: Floats  #: (passes, 3, 3)
    planes: Matrix  #: (frames, 4, 4), mm. Image planes in Reference, about where bone is in the image.
    calibration: Matrix  #: (4, 4), mm. What moves each image in its plane's axes.
    image_lever: float  #: mm by which its turn is measured

    @classmethod
    def none(cls, passes: Passes, echoes: SweepEchoes) -> MotionCurve:
        """At rest."""
        frames = len(passes.numbers)
        first, shares = np.zeros(frames, np.int64), np.zeros(frames)
        owners: list[int] = []
        times: list[float] = []
        lasting = sum(np.ptp(passes.times[passes.numbers == n]) for n in range(len(passes)))
        apart = max(KNOT, float(lasting) / MOST_KNOTS)
        of_echo = passes.numbers[echoes.frames]
        middle = echoes.points.mean(axis=0)
        centers = np.array([echoes.points[of_echo == n].mean(axis=0) if (of_echo == n).any() else middle for n in range(len(passes))])
        for number in range(len(passes)):
            mine = np.flatnonzero(passes.numbers == number)
            begin, end = passes.times[mine].min(), passes.times[mine].max()
            count = max(int(np.ceil((end - begin) / apart)), 1) + 1
            at = (passes.times[mine] - begin) / max(end - begin, 1e-9) * (count - 1)
            low = np.minimum(at.astype(np.int64), count - 2)
            first[mine], shares[mine] = len(owners) + low, at - low
            owners += [number] * count
            times += np.linspace(begin, end, count).tolist()
        lever = max(float(np.sqrt(((echoes.points - centers[of_echo]) ** 2).sum(axis=1).mean())), 1.0)
        turns = np.tile(np.eye(3), (len(passes), 1, 1))
        seen, rows = np.unique(echoes.frames, return_inverse=True)
        means = (np.bincount(rows, axis) / np.bincount(rows) for axis in echoes.points.T)
        places = np.stack([np.interp(np.arange(frames), seen, mean) for mean in means], axis=1)
        planes, image_lever = _planes_about(echoes, passes)
        shifts = np.zeros((len(owners), 3))
        of_frames = passes, first, shares, np.array(owners), np.array(times)
        return cls(*of_frames, centers, places, lever, shifts, turns, planes, np.eye(4), image_lever)

    @property
    def matrices(self) -> Matrix:
        """(frames, 4, 4), mm. What is to be done to the poses of each frame; those without a pass stay."""
        mine = self.passes.numbers >= 0
        result = self.motions.copy()
        if not np.array_equal(self.calibration, np.eye(4)):
            result[mine] = result[mine] @ self.planes[mine] @ self.calibration @ np.linalg.inv(self.planes[mine])
        return result

    @property
    def calibration_off(self) -> float:
        """mm by which the calibration moves bone in the image, root mean square."""
        turn = scipy.spatial.transform.Rotation.from_matrix(self.calibration[:3, :3]).magnitude()
        return float(np.hypot(np.linalg.norm(self.calibration[:3, 3]), turn * self.image_lever))

    @cached_property
    def motions(self) -> Matrix:
        """(frames, 4, 4), mm. What of that is the patient's."""
        result = np.tile(np.eye(4), (len(self.knots), 1, 1))
        mine = self.passes.numbers >= 0
        number = self.passes.numbers[mine]
        share = self.shares[mine, None]
        shift = (1 - share) * self.shifts[self.knots[mine]] + share * self.shifts[self.knots[mine] + 1]
        turns, centers = self.turns[number], self.centers[number]
        result[mine, :3, :3] = turns
        result[mine, :3, 3] = centers + shift - np.einsum("nij,nj->ni", turns, centers)
        return result

    def moved(self, echoes: SweepEchoes) -> SweepEchoes:
        """The echoes where this motion takes them."""
        of = self.matrices[echoes.frames]
        points = np.einsum("nij,nj->ni", of[:, :3, :3], echoes.points) + of[:, :3, 3]
        return replace(echoes, points=points, beams=np.einsum("nij,nj->ni", of[:, :3, :3], echoes.beams))

    def then(self, motion: Matrix) -> MotionCurve:
        """The motion, followed by another of all frames together, (4, 4)."""
        turn = motion[:3, :3]
        shifts = transform_points(motion, self.centers[self.owners] + self.shifts) - self.centers[self.owners]
        return replace(self, turns=turn @ self.turns, shifts=shifts)

    def stepped(self, step: Floats) -> MotionCurve:
        """The motion after a step (parameters,): turns of the passes in mm of the lever, shifts of the knots, calibration."""
        count, rotation = len(self.turns), scipy.spatial.transform.Rotation
        turned = rotation.from_rotvec(step[: 3 * count].reshape(-1, 3) / self.lever).as_matrix()
        shifts = self.shifts + step[3 * count : -6].reshape(-1, 3)
        by = np.eye(4)
        by[:3, :3], by[:3, 3] = rotation.from_rotvec(step[-6:-3] / self.image_lever).as_matrix(), step[-3:]
        return replace(self, turns=turned @ self.turns, shifts=shifts, calibration=by @ self.calibration)


def _planes_about(echoes: SweepEchoes, passes: Passes) -> tuple[Matrix, float]:
    """The image planes (frames, 4, 4) of frames with a pass about the middle of their echoes in the image, and how wide these are, mm."""
    planes = np.tile(np.eye(4), (len(passes.numbers), 1, 1))
    for number in np.flatnonzero(passes.numbers >= 0):
        pose = passes.image_to_reference[number]
        across, along = image_plane_axes(pose)
        planes[number, :3] = np.stack([across, along, np.cross(across, along), pose[:3, 3]], axis=1)
    of = planes[echoes.frames]
    inside = np.einsum("nij,ni->nj", of[:, :3, :3], echoes.points - of[:, :3, 3])
    middle = inside.mean(axis=0)
    planes[:, :3, 3] += planes[:, :3, :3] @ middle
    return planes, max(float(np.sqrt(((inside - middle) ** 2).sum(axis=1).mean())), 1.0)


@dataclass(frozen=True, eq=False)
class _EchoPlanes:
    """Where echoes should lie: each on a plane through echoes of other passes."""

    rows: Integers  #: (n,)
    neighbors: Integers  #: (n, `NEIGHBORS`)
    normals: Floats  #: (n, 3)
    thick: Floats  #: (n,), mm. Standard deviation of the neighbors along the normal.

    def off(self, points: Floats) -> Floats:
        """(n,) mm from the planes, with sign."""
        off: Floats = np.einsum("ni,ni->n", self.normals, points[self.rows] - points[self.neighbors].mean(axis=1))
        return off


def planes_of(points: Floats, owners: Integers, chosen: Integers, reach: float) -> _EchoPlanes:
    """For each of the `chosen` echoes with enough neighbors within `reach` mm."""
    found = []
    for owner in np.unique(owners[chosen]):
        mine, others = chosen[owners[chosen] == owner], np.flatnonzero(owners != owner)
        if len(others) < NEIGHBORS:
            continue
        away, nearest = _nearest(points[others], points[mine], NEIGHBORS, reach)
        near = np.isfinite(away[:, -1])
        neighbors = others[nearest[near]]
        around = points[neighbors]
        arms = around - around.mean(axis=1, keepdims=True)
        variances, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", arms, arms) / NEIGHBORS)
        found.append((mine[near], neighbors, axes[:, :, 0], np.sqrt(np.maximum(variances[:, 0], 0.0))))
    if not found:
        return _EchoPlanes(np.empty(0, np.int64), np.empty((0, NEIGHBORS), np.int64), np.empty((0, 3)), np.empty(0))
    return _EchoPlanes(*(np.concatenate(one) for one in zip(*found, strict=True)))


def _nearest(points: Floats | scipy.spatial.cKDTree, asked: Floats, count: int, reach: float = np.inf) -> tuple[Floats, Integers]:
    """How far the nearest of points (n, 3) or of their tree are from those asked for (m, 3), and which, (m, count) each."""
    tree = points if isinstance(points, scipy.spatial.cKDTree) else scipy.spatial.cKDTree(points)
    away, nearest = (np.asarray(one) for one in tree.query(asked, k=np.arange(1, count + 1), distance_upper_bound=reach))
    return away, nearest


def pairs_of(points: Floats, owners: Integers, chosen: Integers, normals: Floats, reach: float) -> _EchoPlanes:
    """For each of the `chosen` echoes the nearest of every other pass, with the plane of that pass there."""
    trees = {int(owner): (scipy.spatial.cKDTree(points[owners == owner]), np.flatnonzero(owners == owner)) for owner in np.unique(owners)}
    found = []
    for owner in trees:
        mine = chosen[owners[chosen] == owner]
        for other, (tree, numbers) in trees.items():
            if other != owner and len(mine):
                away, nearest = _nearest(tree, points[mine], 1, reach)
                near = np.isfinite(away[:, 0])
                rows, there = mine[near], numbers[nearest[near, 0]]
                alike = np.abs((normals[rows] * normals[there]).sum(axis=1)) > ALIKE
                found.append((rows[alike], there[alike]))
    rows, there = (np.concatenate(one) for one in zip(*found, strict=True)) if found else (np.empty(0, np.int64),) * 2
    return _EchoPlanes(rows, there[:, None], normals[there], np.zeros(len(rows)))


def own_normals(points: Floats, owners: Integers) -> Floats:
    """The normals (n, 3) of the planes through the neighbors of each echo in its own pass."""
    normals = np.zeros_like(points)
    for owner in np.unique(owners):
        mine = np.flatnonzero(owners == owner)
        if len(mine) >= 2 * NEIGHBORS:
            around = points[mine][_nearest(points[mine], points[mine], 2 * NEIGHBORS)[1]]
            arms = around - around.mean(axis=1, keepdims=True)
            normals[mine] = np.linalg.eigh(np.einsum("nki,nkj->nij", arms, arms))[1][:, :, 0]
    return normals


@dataclass(frozen=True, eq=False)
class BoneInPlace:
    """A CT's bone where it lies."""

    bone: BoneField
    labels_to_reference: Matrix

    def sample(self, points: Floats) -> tuple[Floats, Floats]:
        """Distances (n,) and slopes (n, 3) in Reference."""
        to_labels = invert(self.labels_to_reference)
        distances, slopes = self.bone.sample(transform_points(to_labels, points))
        return distances, slopes @ to_labels[:3, :3]


def solved(
    echoes: SweepEchoes,
    curve: MotionCurve,
    bone: BoneInPlace | None = None,
    still: Floats | None = None,
    stages: tuple[tuple[bool, float, float, float], ...] = COARSE + FINE,
    free: slice = BOTH,
    progress: Progress | None = None,
) -> tuple[MotionCurve, Matrix]:
    """The motion of these echoes, beginning with another, and what they tell of its parameters (n, n).

    `still` leads onto the directions along which each pass does not move, (passes, 3, 3); the `stages` are those of `COARSE` and `FINE`;
    only the parameters that are `free` change.
    """
    owners = curve.passes.numbers[echoes.frames]
    normals = own_normals(echoes.points, owners) if stages[0][0] else np.zeros_like(echoes.points)
    information = np.zeros(0)
    for done, (pairwise, reach, scale, change) in enumerate(stages):
        report(progress, done / len(stages), "Taking the patient's motion out")
        chosen = np.unique(np.linspace(0, len(echoes) - 1, OF_PAIRS if pairwise else MOST_ECHOES).astype(np.int64))
        prior = _expected(curve, change, still)
        placed = curve.moved(echoes)
        if pairwise:
            turned = np.einsum("nij,nj->ni", curve.turns[owners], normals)
            planes = pairs_of(placed.points, owners, chosen, turned, reach)
        else:
            planes = planes_of(placed.points, owners, chosen, reach)
            flat = planes.thick < FLAT
            planes = _EchoPlanes(planes.rows[flat], planes.neighbors[flat], planes.normals[flat], planes.thick[flat])
        rows, off = [_plane_rows(curve, echoes, placed.points, planes)], [planes.off(placed.points)]
        if bone is not None:
            distances, slopes = bone.sample(placed.points[chosen])
            entering = -(slopes * placed.beams[chosen]).sum(axis=1) > 0.1
            kept = chosen[entering]
            rows.append(_rows(curve, echoes, placed.points, np.arange(len(kept)), kept, slopes[entering], len(kept)))
            off.append(distances[entering])
        jacobian, residual = scipy.sparse.vstack(rows).tocsr(), np.concatenate(off)
        weights = 1 / (1 + (residual / scale) ** 2) ** 2 / (NOISE**2 * TOGETHER)
        information = np.asarray((jacobian.T @ jacobian.multiply(weights[:, None])).todense())
        slope = jacobian.T @ (weights * residual) + prior @ _vector(curve)
        step = np.zeros_like(slope)
        step[free] = -np.linalg.solve((information + prior)[free, free], slope[free])
        curve = curve.stepped(step)
    return curve, information


def onto_bone(echoes: SweepEchoes, passes: Passes, bone: BoneInPlace) -> Matrix:
    """The motion (4, 4) of all echoes together that lays them on a CT's bone."""
    as_one = replace(passes, numbers=np.minimum(passes.numbers, 0))
    curve, _ = solved(echoes, MotionCurve.none(as_one, echoes), bone, stages=ALL_ON_BONE, free=MOTION_ALONE)
    matrix: Matrix = curve.matrices[passes.numbers >= 0].mean(axis=0)
    return matrix


def _vector(curve: MotionCurve) -> Floats:
    rotation = scipy.spatial.transform.Rotation
    turns = rotation.from_matrix(curve.turns).as_rotvec() * curve.lever
    turn = rotation.from_matrix(curve.calibration[:3, :3]).as_rotvec() * curve.image_lever
    vector: Floats = np.concatenate([turns.ravel(), curve.shifts.ravel(), turn, curve.calibration[:3, 3]])
    return vector


def _expected(curve: MotionCurve, step: float, still: Floats | None) -> Matrix:
    """What is known of a motion and a calibration beforehand, as the inverse of a covariance."""
    passes, knots = len(curve.turns), len(curve.shifts)
    turn = np.radians(TURN_DEG) * curve.lever
    of_knots = np.eye(knots) / (SIZE**2 * np.bincount(curve.owners)[curve.owners])
    follows = np.flatnonzero(curve.owners[1:] == curve.owners[:-1])
    for n in follows:
        of_knots[n : n + 2, n : n + 2] += np.array([[1.0, -1.0], [-1.0, 1.0]]) / step**2
    of_shifts = np.kron(of_knots, np.eye(3))
    if still is not None:
        of_shifts += scipy.linalg.block_diag(*still[curve.owners]) / HELD**2
    of_image = np.repeat([np.radians(CALIBRATION_DEG) * curve.image_lever, CALIBRATION], 3)
    prior: Matrix = scipy.linalg.block_diag(np.eye(3 * passes) / turn**2, of_shifts, np.diag(1 / of_image**2))
    return prior


def _plane_rows(curve: MotionCurve, echoes: SweepEchoes, points: Floats, planes: _EchoPlanes) -> scipy.sparse.csr_matrix:
    count, width = planes.neighbors.shape
    own = _rows(curve, echoes, points, np.arange(count), planes.rows, planes.normals, count)
    numbers = np.repeat(np.arange(count), width)
    others = _rows(curve, echoes, points, numbers, planes.neighbors.ravel(), planes.normals[numbers], count)
    between: scipy.sparse.csr_matrix = own - others / width
    return between


def _rows(
    curve: MotionCurve,
    echoes: SweepEchoes,
    points: Floats,
    rows: Integers,
    which: Integers,
    along: Floats,
    count: int,
) -> scipy.sparse.csr_matrix:
    """By how much echoes move along (n, 3) when parameters do, summed into rows, (count, parameters)."""
    frames = echoes.frames[which]
    passes, share = curve.passes.numbers[frames], curve.shares[frames][:, None]
    knots = curve.knots[frames]
    arms = points[which] - curve.centers[passes]
    planes = (curve.motions @ curve.planes)[frames]
    inside, along_image = (np.einsum("nij,ni->nj", planes[:, :3, :3], each) for each in (points[which] - planes[:, :3, 3], along))
    # A turn by w moves what lies at a by w x a, which along n is w . (a x n)
    of_motion = np.cross(arms, along) / curve.lever, (1 - share) * along, share * along
    values = np.concatenate([*of_motion, np.cross(inside, along_image) / curve.image_lever, along_image], axis=1)
    begin, end = 3 * len(curve.turns), 3 * (len(curve.turns) + len(curve.shifts))
    image = np.full(len(which), end)
    firsts = np.stack([3 * passes, begin + 3 * knots, begin + 3 * knots + 3, image, image + 3], axis=1)
    columns = (firsts[:, :, None] + np.arange(3)).reshape(len(which), 15)
    return scipy.sparse.coo_matrix((values.ravel(), (np.repeat(rows, 15), columns.ravel())), shape=(count, end + 6)).tocsr()
