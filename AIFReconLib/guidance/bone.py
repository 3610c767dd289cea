"""The bone that a probe on the back can meet: points on the surface of placed labels or of echoes, and the patient's axes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import scipy

from ..arrays import Floats, Integers, Mask, Matrix
from ..bone.field import VOXEL, BoneField
from ..bone.map import BoneMap
from ..errors import GeometryError
from ..evaluation.surface import BoneSurface, bone_surface, interspinous_border
from ..evaluation.visibility import GRAZING_DEG, LIFT, BoneRays
from ..geometry.box import in_cubes
from ..geometry.labels import Labels, centers_of_mass
from ..geometry.transforms import affine, as_matrix, image_plane_axes, transform_points, unit_vectors
from ..geometry.volume import Volume

PITCH = 1.0
"""mm. About one point per square of this side; coarser where there would be more than `MOST_POINTS`."""

MOST_POINTS = 20_000
"""Points that are looked at in every frame of a live scan."""

OUTSIDE_DEG = 60.0
"""Beams of a probe on the back run within this angle of straight ahead: it tilts by some 40 degrees, and a sector opens by as much, but
steeper than this the skin ends or the bone is too deep."""

DIRECTIONS = 61
"""Of such beams, spread evenly, by which it is told what can be reached at all."""

SHOWN = 0.15
"""Probability from which voxels on both sides lie on the surface of echoes."""

APART = 2.5
"""mm. One point for each cube of this side on that surface, and beyond it."""

BEYOND, BEND, WAYS = (3.0, 6.0), 8.0, 8
"""mm from a point of that surface at which bone may go on, the radius by which it is thought to bend away there, and in how many ways."""

AGREE = 0.3
"""Length of the mean of the normals in a cube below which they face all sorts of ways."""

NEAR = 0.8
"""Times that far: what lies nearer to other points of the surface does not go on from this one."""


@dataclass(frozen=True, eq=False)
class GuidedBone:
    """What guidance looks at."""

    surface: BoneSurface  #: Only the part that some beam from the back reaches, past all other bone; in Reference
    border: Mask  #: (n,). Points that bound an interspinous gap.
    distance: Volume  #: float32, mm. Signed distance to bone, placed in Reference; of `bone_of_echoes` at most that, and 0 in bone.
    centers: dict[int, Floats]  #: (3,) mm. Each label's center of mass in Reference; none where echoes alone tell of bone.
    patient_to_reference: Matrix
    """(4, 4), mm. Patient: to the right, to the front, to the head; its origin is the middle of the points. Of `bone_of_echoes`: along the
    rows of the first image, with the beams, and into it as one looks at it."""
    names: Mapping[int, str] = field(default_factory=dict)
    """What labels are called, such as those of a segmentation's segments; a label without a name goes by its number."""

    def __len__(self) -> int:
        return len(self.surface)

    @property
    def is_of_ct(self) -> bool:
        """Whether a CT tells it, and with it where the patient's head is."""
        return bool(self.centers)

    @property
    def starts(self) -> Floats:
        """Where beams to the points must be free of bone, just above the surface, (n, 3) mm in Reference."""
        lift = max(LIFT, float(self.distance.grid.spacing.max()))
        return self.surface.points_reference + lift * self.surface.normals_reference

    def only(self, points: Integers) -> GuidedBone:
        """Some of the points, by their numbers, still in the shadow of all bone."""
        whole = self.surface
        some = BoneSurface(whole.points_reference[points], whole.normals_reference[points], whole.areas[points], whole.labels[points])
        return replace(self, surface=some, border=self.border[points])

    def name_of(self, label: int) -> str:
        """What a label is called: its name, with its number where others have that name too, else its number."""
        name = self.names.get(label, "")
        if not name:
            return str(label)
        return name if list(self.names.values()).count(name) == 1 else f"{name} ({label})"

    @property
    def aim(self) -> str:
        """The part that a scan is for: the borders of the interspinous gaps, where labels tell them, else what faces the back."""
        return "interspinous" if self.border.any() else "posterior" if self.posterior.any() else "all"

    @property
    def posterior(self) -> Mask:
        """Points that face the back, within 60 degrees, (n,) bool."""
        facing: Mask = -self.surface.normals_reference @ self.patient_to_reference[:3, 1] >= np.cos(np.radians(60.0))
        return facing

    def placed_by(self, motion: Matrix) -> GuidedBone:
        """The same bone in another place, (4, 4) rigid: what a probe on the back can reach does not change with it."""
        surface = replace(
            self.surface,
            points_reference=transform_points(motion, self.surface.points_reference),
            normals_reference=self.surface.normals_reference @ motion[:3, :3].T,
        )
        centers = {label: transform_points(motion, center[None])[0] for label, center in self.centers.items()}
        return replace(
            self,
            surface=surface,
            distance=self.distance.placed_by(motion),
            centers=centers,
            patient_to_reference=motion @ self.patient_to_reference,
        )

    def target(self, name: str) -> Mask:
        """The points of `all`, `interspinous` (borders) or `posterior` (facing the back), or of a label by its name or number.

        Raises GeometryError when there is no such target.
        """
        if name == "all":
            return np.ones(len(self), dtype=bool)
        if name == "interspinous":
            chosen = self.border
        elif name == "posterior":
            chosen = self.posterior
        else:
            called = [label for label in np.unique(self.surface.labels) if name in (self.name_of(label), str(label))]
            chosen = np.isin(self.surface.labels, called)
        if not chosen.any():
            labels = ", ".join(self.name_of(label) for label in np.unique(self.surface.labels))
            raise GeometryError(
                f"Input target must be all, interspinous, posterior or a label of the segmentation ({labels}) that a probe on the back "
                f"can reach; got {name!r}. Borders of interspinous gaps need one label per vertebra."
            )
        return chosen


def guided_bone(
    labels: Volume,
    labels_to_reference: Matrix | None = None,
    anterior_reference: Floats | None = None,
    names: Mapping[int, str] | None = None,
) -> GuidedBone:
    """The reachable bone of a segmentation.

    Raises GeometryError when there is no bone, or none that a beam could reach.

    Parameters
    ----------
    labels : Volume of integers
        Any label above 0 is bone; one label per vertebra tells where the interspinous gaps are. Along the axes of the patient, as a CT
        and its segmentation are.
    labels_to_reference : (4, 4) array, mm, or None
        The registration.
    anterior_reference : (3,) unit vector or None
        Which way the probe looks, where the labels' own axes do not say: with it the patient's head is where the labels' is, as far as
        that leaves.
    names : mapping of int to str or None
        What the labels are called; by default what `Labels` know themselves.
    """
    placed = np.eye(4) if labels_to_reference is None else as_matrix(labels_to_reference, "labels_to_reference")
    called = names or (labels.names if isinstance(labels, Labels) else {})
    field = BoneField.from_labels(labels)
    distance = field.distance.placed_by(placed)
    labels = labels.placed_by(placed)
    axes = _axes(placed[:3, :3], anterior_reference)
    whole = bone_surface(distance, labels, PITCH)
    reached = _from_outside(whole, distance, axes)
    if not reached.any():
        raise GeometryError("Input labels must have bone that a probe on the back can reach; got none. Was the right segmentation chosen?")
    if reached.sum() > MOST_POINTS:
        whole = bone_surface(distance, labels, PITCH * float(np.sqrt(reached.sum() / MOST_POINTS)))
        reached = _from_outside(whole, distance, axes)
    centers = centers_of_mass(_coarse(labels))
    border = interspinous_border(whole, centers)
    surface = BoneSurface(*(getattr(whole, name)[reached] for name in ("points_reference", "normals_reference", "areas", "labels")))
    patient = affine(axes, surface.points_reference.mean(axis=0))
    return GuidedBone(surface, border[reached], distance, centers, patient, dict(called))


def bone_of_echoes(known: BoneMap, image_to_reference: Matrix) -> GuidedBone:
    """The surface that echoes lie on, and where bone may go on beyond it: what guidance looks for where there is no CT.

    Raises GeometryError when a probe on the back reaches none of it.

    Parameters
    ----------
    known : BoneMap
        Of `bone_from_sweep`.
    image_to_reference : (n, 4, 4) array, pixels to mm
        Of the frames that have shown it.

    Notes
    -----
    From a point p of the surface, facing n, bone may go on to p + s t - s^2 / 2R n, facing n + (s / R) t, for `WAYS` directions t along
    the surface, s in `BEYOND` and R = `BEND`, where no other point of the surface is near: bone is round, and what no echo has shown has
    mostly turned away from the beams. Of points in one cube of `APART` the mean is taken. Labels are 1 on the surface, and 0 beyond.
    """
    if known.inside is None or known.slopes is None:
        raise ValueError("Input known must tell which side of its surface is bone.")
    inside, shown = known.inside.array > 0, known.probability.array >= SHOWN
    sides = [scipy.ndimage.binary_dilation(shown & side) for side in (inside, ~inside)]
    kji = np.argwhere(shown & sides[0] & sides[1])
    place, spacing = known.probability.ijk_to_reference, known.probability.grid.spacing
    out = -np.stack([slope[tuple(kji.T)] for slope in known.slopes], axis=1) @ (place[:3, :3] / spacing).T
    seen = _in_cubes(transform_points(place, kji[:, ::-1].astype(np.float64)), unit_vectors(out))
    points, normals = (np.concatenate(both) for both in zip(seen, _beyond(*seen), strict=True))
    # Along the axes, which is quick to tell and never more than the distance: all that rays want to know
    away = spacing.min() * scipy.ndimage.distance_transform_cdt(~inside, "chessboard")
    distance = Volume(away.astype(np.float32), place)
    looks = unit_vectors(unit_vectors(image_to_reference[:, :3, 1]).mean(axis=0))
    patient = affine(_axes(np.stack([right := image_plane_axes(image_to_reference[0])[0], looks, np.cross(right, looks)], axis=1), looks))
    is_seen = np.arange(len(points)) < len(seen[0])
    # A plane meets so many cubes for each mm^2
    surface = BoneSurface(points, normals, APART**2 / np.abs(normals).sum(axis=1), is_seen.astype(np.int64))
    reached = _from_outside(surface, distance, patient[:3, :3])
    if not reached.any():
        raise GeometryError("The echoes so far lie on no surface that a probe on the back can reach. Scan the bone longer.")
    patient[:3, 3] = points[reached].mean(axis=0)
    bone = GuidedBone(surface, np.zeros(len(points), dtype=bool), distance, {}, patient)
    return bone.only(np.flatnonzero(reached))


def _beyond(points: Floats, normals: Floats) -> tuple[Floats, Floats]:
    """Where bone may go on beyond these points (n, 3) of its surface, and how it faces there; see `bone_of_echoes`."""
    known = scipy.spatial.cKDTree(points)
    across, along = axes_across(normals)
    found, facing = [np.empty((0, 3))], [np.empty((0, 3))]
    for turn in 2.0 * np.pi * np.arange(WAYS) / WAYS:
        way, goes_on = np.cos(turn) * across + np.sin(turn) * along, np.ones(len(points), dtype=bool)
        for step in BEYOND:
            there = points + step * way - step**2 / (2.0 * BEND) * normals
            goes_on &= known.query(there)[0] > NEAR * step
            found.append(there[goes_on])
            facing.append(unit_vectors(normals + step / BEND * way)[goes_on])
    return _in_cubes(np.concatenate(found), np.concatenate(facing))


def axes_across(normals: Floats) -> tuple[Floats, Floats]:
    """Unit vectors (n, 3) at right angles to normals (n, 3) and to each other: first cross second is the normal."""
    some = np.where(np.abs(normals[:, :1]) < 0.8, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    first = unit_vectors(np.cross(some, normals))
    return first, np.cross(normals, first)


def _in_cubes(points: Floats, normals: Floats) -> tuple[Floats, Floats]:
    """The mean of the points (n, 3) in each cube of `APART`, and of their normals (n, 3); not where these face all sorts of ways."""
    means = in_cubes(points, APART, normals)
    agree = np.linalg.norm(means[1], axis=1) > AGREE
    return means[0][agree], unit_vectors(means[1][agree])


def _axes(rotation: Floats, anterior: Floats | None) -> Floats:
    """Right, front and head as columns, orthonormal: of the labels' frame turned by `rotation`, or about a given front."""
    right, ahead, head = rotation.T / np.linalg.norm(rotation, axis=0)[:, None]
    if anterior is not None:
        ahead = anterior
    if abs(head @ ahead) > 0.9:
        head = np.cross(right, ahead)
    head = head - (head @ ahead) * ahead
    head /= np.linalg.norm(head)
    return np.stack([np.cross(ahead, head), ahead, head], axis=1)


def _from_outside(surface: BoneSurface, distance: Volume, axes: Floats) -> Mask:
    """Which points some beam within `OUTSIDE_DEG` of straight ahead reaches, (n,) bool."""
    rays = BoneRays(distance)
    starts = surface.points_reference + max(LIFT, float(distance.grid.spacing.max())) * surface.normals_reference
    reached = np.zeros(len(surface), dtype=bool)
    for beam in beams_from_the_back() @ axes.T:
        open_ = np.flatnonzero(~reached & (-surface.normals_reference @ beam >= np.cos(np.radians(GRAZING_DEG))))
        beams = np.broadcast_to(beam, (len(open_), 3))
        reached[open_] = ~rays.blocks(starts[open_], beams, np.full(len(open_), np.inf))
    return reached


def beams_from_the_back() -> Floats:
    """Unit vectors evenly over the cone about straight ahead, (DIRECTIONS, 3) in the patient's axes; a spiral, the middle first."""
    n = np.arange(DIRECTIONS)
    cosine = 1.0 - (1.0 - np.cos(np.radians(OUTSIDE_DEG))) * n / (DIRECTIONS - 1)
    angle = n * np.pi * (3.0 - np.sqrt(5.0))
    sine = np.sqrt(1.0 - cosine**2)
    return np.stack([sine * np.cos(angle), cosine, sine * np.sin(angle)], axis=1)


def _coarse(labels: Volume) -> Volume:
    """Every so many voxels of labels that are finer than guidance needs."""
    factors = np.maximum(np.floor(VOXEL / labels.grid.spacing + 0.5), 1).astype(int)
    i, j, k = factors.tolist()
    return labels[::k, ::j, ::i]
