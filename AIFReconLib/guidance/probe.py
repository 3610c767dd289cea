"""The probe on the skin: what its images are like, where its face is in them, and the poses that it can take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from ..arrays import Floats, Matrix
from ..geometry.transforms import image_plane_axes, invert, pixel_spacing, transform_points
from ..imaging.beams import LINEAR, ProbeGeometry
from ..imaging.region import ImageRegion, extreme_pixels
from ..simulation.phased_array import PhasedArray
from .bone import GuidedBone
from .snapshot import ProbeShape

AIM_DEPTH = 30.0
"""mm under the skin of the point about which tilts turn: spinous processes and laminae lie there, and stay in view."""

UNDER_SKIN = 15.0
"""mm of fat and fascia behind the tips of the spinous processes, where nothing tells the skin."""

FARTHEST = 300.0
"""mm from a face to the point aimed at, at most: skin that a beam meets farther on, or never, bends more than a back does."""

BEND = 30.0
"""mm to the side or along the spine over which the skin may bend; it says how far its shape is trusted beyond where it was felt."""

BODY, CONTACT = (55.0, 14.0), 8.0
"""mm: how long and how thick a probe is drawn, and how near to the middle of the face pixels are between which it is as wide."""

DRAWN_ROWS = 24
"""Of the image plane, between which its border is drawn straight."""


@dataclass(frozen=True, eq=False)
class ProbeImages:
    """What the images of a probe are like."""

    frame_size: tuple[int, int]  #: (columns, rows)
    spacing: tuple[float, float]  #: (x, y), mm per pixel
    geometry: ProbeGeometry
    region: ImageRegion  #: The pixels that are ultrasound

    @classmethod
    def simulated(cls) -> ProbeImages:
        """Those of the simulated phased array, a probe like the paper's."""
        probe = PhasedArray()
        return cls((probe.columns, probe.rows), (probe.pixel_spacing, probe.pixel_spacing), probe.geometry, probe.region)

    @cached_property
    def face_px(self) -> tuple[float, float]:
        """The middle of the face, (column, row)."""
        mask = self.region.mask(*self.frame_size)
        rows, columns = np.nonzero(mask)
        if self.geometry.kind == LINEAR:
            return (float(columns.min()) + float(columns.max())) / 2, float(rows.min())
        x, y = self.spacing
        column, row = self.geometry.apex
        fan = self.region.fan
        if fan is not None:
            angle, radius = np.radians(sum(fan.angles_deg) / 2), fan.radii[0] * x
        else:
            angles = np.arctan2((columns - column) * x, (rows - row) * y)
            angle, radius = (angles.min() + angles.max()) / 2, np.hypot((columns - column) * x, (rows - row) * y).min()
        return float(column + radius * np.sin(angle) / x), float(row + radius * np.cos(angle) / y)

    @cached_property
    def image_to_face(self) -> Matrix:
        """(4, 4), pixels to mm: origin in the middle of the face, x along the columns, y down the rows, z = x cross y."""
        x, y = self.spacing
        matrix = np.diag([x, y, (x + y) / 2, 1.0])
        matrix[:2, 3] = -x * self.face_px[0], -y * self.face_px[1]
        return matrix

    @cached_property
    def shape(self) -> ProbeShape:
        """Image plane with its border, and a body that stands on the face and narrows away from it."""
        mask = self.region.mask(*self.frame_size)
        ends = extreme_pixels(mask)
        left, right = ends[: len(ends) // 2], ends[len(ends) // 2 :]
        chosen = np.unique(np.linspace(0, len(left) - 1, min(len(left), DRAWN_ROWS)).round().astype(int))
        count = len(chosen)
        plane = [(n, n + 1, count + n + 1, count + n) for n in range(count - 1)]
        rows, columns = np.nonzero(mask)
        (column, row), (x, y) = self.face_px, self.spacing
        contact = columns[np.hypot((columns - column) * x, (rows - row) * y) < CONTACT]
        half, (length, thickness) = np.ptp(contact) * x / 2 + 4.0, BODY
        outward = ((-1, -1), (1, -1), (1, 1), (-1, 1))
        body = [(x * wide, back, z * thickness / 2) for back, wide in ((0.0, half), (-length, 0.6 * half)) for x, z in outward]
        flat = np.concatenate([left[chosen], right[chosen]])
        faces = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
        placed = transform_points(invert(self.image_to_face), np.array(body))
        return ProbeShape(
            np.concatenate([np.column_stack([flat, np.zeros(len(flat))]), placed]),
            (*plane, *(tuple(len(flat) + corner for corner in face) for face in faces)),
            (*range(count), *range(2 * count - 1, count - 1, -1), 0),
        )

    def faces(self, image_to_reference: Matrix) -> Floats:
        """The middles of the faces of frames, (n, 3) mm in Reference."""
        column, row = self.face_px
        return image_to_reference[:, :3, 0] * column + image_to_reference[:, :3, 1] * row + image_to_reference[:, :3, 3]


@dataclass(frozen=True, eq=False)
class Skin:
    """The skin of the back as a surface y(x, z): to the front over right and head, in the patient's axes."""

    coefficients: Floats  #: (6,), mm. Of 1, x, z, x^2, x z, z^2 in units of `BEND`.

    @classmethod
    def through(cls, points_patient: Floats) -> Skin:
        """The smooth skin through points (n, 3) on it, straight on where there are none."""
        terms = _terms(points_patient[:, 0], points_patient[:, 2])
        # A tenth of what a point weighs holds every slope and bend at 0
        hold = np.diag([0.0, *[np.sqrt(0.1)] * 5])
        found = np.linalg.lstsq(np.concatenate([terms, hold]), np.concatenate([points_patient[:, 1], np.zeros(6)]), rcond=None)[0]
        return cls(found)

    @classmethod
    def over(cls, bone: GuidedBone) -> Skin:
        """An estimate: `UNDER_SKIN` behind the spinous processes."""
        points = transform_points(invert(bone.patient_to_reference), bone.surface.points_reference)
        tips = []
        for label in np.unique(bone.surface.labels):
            of_label = points[bone.surface.labels == label]
            behind = of_label[of_label[:, 1] <= np.quantile(of_label[:, 1], 0.01)]
            tips.append((0.0, behind[:, 1].mean() - UNDER_SKIN, behind[:, 2].mean()))
        return cls.through(np.array(tips))

    def at(self, x: Floats | float, z: Floats | float) -> Floats:
        """y of the skin, mm."""
        x, z = np.asarray(x, dtype=np.float64) / BEND, np.asarray(z, dtype=np.float64) / BEND
        one, by_x, by_z, by_xx, by_xz, by_zz = self.coefficients
        y: Floats = one + x * (by_x + by_xx * x + by_xz * z) + z * (by_z + by_zz * z)
        return y

    def ways_back(self, x: Floats, z: Floats, beams: Floats) -> Floats:
        """mm (n,) back along beams (n, 3) from points `AIM_DEPTH` under the skin at x, z (n,) to where it is met first; `FARTHEST` at most.

        On the way the depth under the skin is ``AIM_DEPTH - rate w - bend w^2``.
        """
        _one, by_x, by_z, by_xx, by_xz, by_zz = self.coefficients
        (right, head), x, z = beams[:, ::2].T / BEND, x / BEND, z / BEND
        rate = beams[:, 1] - right * (by_x + 2.0 * by_xx * x + by_xz * z) - head * (by_z + by_xz * x + 2.0 * by_zz * z)
        bend = by_xx * right**2 + by_xz * right * head + by_zz * head**2
        inside = rate**2 + 4.0 * bend * AIM_DEPTH
        half = np.where(inside < 0.0, 0.0, rate + np.sqrt(np.maximum(inside, 0.0))) / 2.0
        ways: Floats = AIM_DEPTH / np.maximum(half, AIM_DEPTH / FARTHEST)
        return ways


def _terms(x: Floats, z: Floats) -> Floats:
    x, z = x / BEND, z / BEND
    return np.stack([np.ones_like(x), x, z, x * x, x * z, z * z], axis=-1)


@dataclass(frozen=True)
class ProbePlacement:
    """How a probe stands on the back."""

    x: float
    z: float
    """mm. The point aimed at, to the right and to the head in the patient's axes; it lies `AIM_DEPTH` under the skin."""
    turn_deg: float = 0.0  #: Of the image plane: 0 transverse (columns to the right), 90 sagittal (columns to the head)
    in_plane_deg: float = 0.0  #: Turns the middle beam toward the image's columns
    across_deg: float = 0.0
    """Turns it out of the plane, toward z = columns cross rows: to the head where transverse, to the left where sagittal."""

    @property
    def tilt_deg(self) -> float:
        """From straight ahead to the middle beam."""
        return float(np.degrees(np.arccos(np.cos(np.radians(self.in_plane_deg)) * np.cos(np.radians(self.across_deg)))))


@dataclass(frozen=True, eq=False)
class ProbeOnBack:
    """Poses of a probe on a patient's back."""

    images: ProbeImages
    skin: Skin
    patient_to_reference: Matrix  #: (4, 4), mm

    def pose(self, placement: ProbePlacement) -> Matrix:
        """image_to_reference of a probe that stands so, (4, 4)."""
        pose: Matrix = self.poses([placement])[0]
        return pose

    def poses(self, placements: Sequence[ProbePlacement]) -> Matrix:
        """image_to_reference of a probe that stands so, one after the other, (n, 4, 4)."""
        x, z, *angles = np.array([(one.x, one.z, -one.turn_deg, -one.in_plane_deg, one.across_deg) for one in placements]).T
        turns = scipy.spatial.transform.Rotation.from_euler("YZX", np.stack(angles, axis=1), degrees=True).as_matrix()
        beams = turns[:, :, 1]
        targets = np.stack([x, self.skin.at(x, z) + AIM_DEPTH, z], axis=1)
        ways = self.skin.ways_back(x, z, beams)
        faces = np.tile(np.eye(4), (len(x), 1, 1))
        faces[:, :3, :3], faces[:, :3, 3] = turns, targets - ways[:, None] * beams
        poses: Matrix = self.patient_to_reference @ faces @ self.images.image_to_face
        return poses

    def placement(self, image_to_reference: Matrix) -> ProbePlacement:
        """How a probe stands whose image is there: the inverse of `pose`, wherever the skin is."""
        right, down = image_plane_axes(image_to_reference)
        turn = self.patient_to_reference[:3, :3].T @ np.stack([right, down, np.cross(right, down)], axis=1)
        a, b, c = scipy.spatial.transform.Rotation.from_matrix(turn).as_euler("YZX", degrees=True)
        face = transform_points(invert(self.patient_to_reference), self.images.faces(image_to_reference[None])[0])
        target = face + AIM_DEPTH / max(turn[1, 1], 0.3) * turn[:, 1]
        return ProbePlacement(float(target[0]), float(target[2]), -float(a), -float(b), float(c))


def images_like(image_to_reference: Matrix, frame_size: tuple[int, int], geometry: ProbeGeometry, region: ImageRegion) -> ProbeImages:
    """The images of a recorded sweep, whose first pose is given."""
    return ProbeImages(frame_size, pixel_spacing(image_to_reference), geometry, region)
