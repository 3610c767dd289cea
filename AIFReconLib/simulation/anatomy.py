"""A lumbar spine in a back: parameters, vertebrae in their places, and the phantom made of them.

Reference is RAS in mm: x to the patient's right, y anterior, z superior. The patient lies prone on a pillow (or sits bent forward), so
the lordosis is small; posterior, toward the probe, is -y. The origin is on the skin in the midline at the middle of the spine's
segment, and depth under the probe grows along +y.

The column follows an arc of a circle in the midsagittal plane whose center lies behind the back. Skin, layers and spinal canal follow
concentric arcs, so every tissue is a function of (x, depth along the arc's radius).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Bytes, Floats, Integers, Matrix, Singles
from ..errors import SettingsError
from ..geometry.transforms import invert, transform_points
from ..geometry.volume import Volume, VoxelGrid
from ..progress import Progress, part, report
from .computed_tomography import hounsfield_units
from .soft_tissue import SoftTissue, make_texture
from .vertebra import BODY_LIFT, LAMINA_THICKNESS, VERTEBRA_BOX, Vertebra

DISTANCE_LIMIT = 6.0
"""mm. Signed distances to bone are cut off here: what is farther is far."""

FACET_GAP = 1.6
"""mm of joint space between the facets of neighbors. Within the 1 to 2 mm of cartilage and fluid in CT."""

LEVELS = ("L2", "L3", "L4", "L5")


def _size(default: float, spread: float, minimum: float, maximum: float) -> float:
    return field(default=default, metadata={"spread": spread, "minimum": minimum, "maximum": maximum})


@dataclass(frozen=True)
class LumbarAnatomy:
    """Sizes of a lumbar spine in mm, as they are, not as means: `from_seed` draws a person.

    Parameters
    ----------
    seed : int
        Decides what the sizes leave open: small tilts and shifts of each vertebra, tissue texture and CT noise.
    vertebrae : int
        2 to 4 of L2 to L5: L3-L4, L2-L4, or L2-L5.
    body_width, body_depth, body_height, canal_width, canal_depth, transverse_width : float
        Means of L3, rounded [1]_. Depth is antero-posterior.
    disc_height : float
        About 10 mm in the mid-lumbar spine.
    spinous_length : float
        Spinolaminar junction to tip: about 30 mm [2]_.
    interspinous_gap : float
        Between neighboring spinous processes. 12 mm on the mean at L2-L3, 6 to 22 mm, less with age [3]_. It leaves processes of
        20 to 25 mm height here, as in [4]_.
    skin_to_lamina : float
        35 to 55 mm; ultrasound finds the epidural space, a few mm deeper, at 47 mm on the mean in parturients (standard deviation
        7 mm) [5]_.
    lordosis_deg : float
        Between neighboring vertebrae, at most half of the standing posture's.
    irregularity : float
        Scales all that is drawn per vertebra; 0 makes every vertebra and gap the same.

    References
    ----------
    .. [1] Panjabi et al. (1992), Human lumbar vertebrae: quantitative three-dimensional anatomy, Spine 17:299-306,
       doi:10.1097/00007632-199203000-00010.
    .. [2] Kaya Ayvaz et al. (2021), A radiological evaluation of lumbar spinous processes and interspinous spaces, Cureus,
       doi:10.7759/cureus.19454.
    .. [3] Interspinous distance and size of lumbar spinous processes on radiographs of 60 Koreans (2013), PubMed 22120390.
    .. [4] A morphometric study of the lumbar spinous process in the Chinese population (2015): 25 mm at L3 in men, 19 mm at L4 in
       women.
    .. [5] Arzola et al. (2007), Ultrasound using the transverse approach to the lumbar spine provides reliable landmarks for labor
       epidurals, Anesth Analg 104:1188-1192.
    """

    seed: int = 0
    vertebrae: int = 3
    body_width: float = _size(45.0, 2.5, 38.0, 54.0)
    body_depth: float = _size(33.0, 2.0, 28.0, 40.0)
    body_height: float = _size(27.0, 1.2, 23.0, 31.0)
    disc_height: float = _size(10.0, 1.2, 7.0, 14.0)
    canal_width: float = _size(24.0, 1.2, 20.0, 28.0)
    canal_depth: float = _size(17.0, 1.2, 13.0, 21.0)
    transverse_width: float = _size(84.0, 4.0, 70.0, 96.0)
    spinous_length: float = _size(30.0, 1.5, 25.0, 35.0)
    interspinous_gap: float = _size(8.5, 1.3, 5.0, 12.0)
    skin_to_lamina: float = _size(45.0, 4.0, 35.0, 55.0)
    lordosis_deg: float = _size(6.0, 1.3, 1.0, 10.0)
    irregularity: float = 1.0

    def __post_init__(self) -> None:
        if self.vertebrae not in (2, 3, 4):
            raise SettingsError(f"Input vertebrae must be 2, 3 or 4; got {self.vertebrae!r}.")
        for size in fields(self):
            low, high = size.metadata.get("minimum"), size.metadata.get("maximum")
            value = getattr(self, size.name)
            if low is not None and not low <= value <= high:
                raise SettingsError(f"Input {size.name} must be {low:g} to {high:g}; got {value!r}.")
        if not 0.0 <= self.irregularity <= 2.0:
            raise SettingsError(f"Input irregularity must be 0 to 2; got {self.irregularity!r}.")
        if self.spinous_length > self.skin_to_lamina - 5.0:
            raise SettingsError(
                f"Input spinous_length must leave 5 mm under the skin; got {self.spinous_length:g} with skin_to_lamina "
                f"{self.skin_to_lamina:g}."
            )

    @classmethod
    def from_seed(cls, seed: int, vertebrae: int = 3) -> LumbarAnatomy:
        """A person drawn at random: each size normal about its default, kept in its range."""
        rng = np.random.default_rng([seed, 1])
        drawn = {}
        for size in fields(cls):
            if "spread" in size.metadata:
                value = size.default + size.metadata["spread"] * rng.standard_normal()
                drawn[size.name] = float(np.clip(value, size.metadata["minimum"], size.metadata["maximum"]))
        drawn["spinous_length"] = min(drawn["spinous_length"], drawn["skin_to_lamina"] - 6.0)
        return cls(seed=seed, vertebrae=vertebrae, **drawn)

    @property
    def body_depth_from_lamina(self) -> float:
        """From the spinolaminar junction to the middle of the bodies."""
        return LAMINA_THICKNESS + self.canal_depth + self.body_depth / 2

    @property
    def arc_radius(self) -> float:
        """Radius of the arc on which the middles of the bodies lie."""
        return (self.body_height + self.disc_height) / math.radians(self.lordosis_deg)

    @property
    def arc_center_y(self) -> float:
        """y of the center of all arcs in Reference; its x and z are 0."""
        return self.skin_to_lamina + self.body_depth_from_lamina - self.arc_radius

    @property
    def fat_thickness(self) -> float:
        """From the skin to the thoracolumbar fascia in the midline, which lies just behind the tips of the spinous processes."""
        return max(self.skin_to_lamina - self.spinous_length - 2.5, 2.5)

    def vertebrae_in_place(self) -> tuple[Vertebra, ...]:
        """The vertebrae from superior to inferior, labels 1, 2, ..."""
        rng = np.random.default_rng([self.seed, 2])
        jitter = self.irregularity * np.clip(rng.standard_normal((self.vertebrae, 7)), -2.0, 2.0)
        gaps = self.interspinous_gap + self.irregularity * np.clip(rng.standard_normal(self.vertebrae + 1), -2.0, 2.0) * 0.8
        gaps = np.clip(gaps, 5.5, 11.5) if self.irregularity else gaps
        step = math.radians(self.lordosis_deg)
        first = LEVELS.index("L3" if self.vertebrae == 2 else "L2")
        lamina_radius = self.arc_radius - self.body_depth_from_lamina
        spines = []
        for n in range(self.vertebrae):
            pose = _pose_on_arc(self, ((self.vertebrae - 1) / 2 - n) * step, jitter[n])
            pitch = (step * lamina_radius, step)
            spines.append(
                Vertebra(
                    label=n + 1,
                    name=LEVELS[first + n],
                    vertebra_to_reference=pose,
                    scale=1.0 + 0.015 * jitter[n, 5],
                    body_width=self.body_width,
                    body_depth=self.body_depth,
                    body_height=self.body_height,
                    canal_width=self.canal_width,
                    canal_depth=self.canal_depth,
                    transverse_width=self.transverse_width,
                    spinous_length=self.spinous_length,
                    spinous_top=(pitch[0] / 2 - gaps[n] / 2, pitch[1] / 2),
                    spinous_bottom=(-pitch[0] / 2 + gaps[n + 1] / 2, -pitch[1] / 2),
                    spinous_slope=0.16,
                    spinous_deviation=1.0 * jitter[n, 6],
                )
            )
        return tuple(spines)


def _pose_on_arc(anatomy: LumbarAnatomy, angle: float, jitter: Floats) -> Matrix:
    """Vertebra to Reference at an angle (radians, superior positive) along the arc, with small tilts and shifts."""
    turn = np.deg2rad(np.array([0.7, 1.2, 1.5]) * jitter[:3])
    tilt = _rotation(0, angle + turn[0]) @ _rotation(1, turn[1]) @ _rotation(2, turn[2])
    radius = anatomy.arc_radius - anatomy.body_depth_from_lamina
    pose = np.eye(4)
    pose[:3, :3] = tilt
    pose[:3, 3] = (0.7 * jitter[3], anatomy.arc_center_y + radius * math.cos(angle) + 0.5 * jitter[4], radius * math.sin(angle))
    return pose


def _rotation(axis: int, angle: float) -> Floats:
    """Right-handed rotation (3, 3) by an angle in radians about a coordinate axis."""
    a, b = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[a, a] = matrix[b, b] = math.cos(angle)
    matrix[a, b], matrix[b, a] = -math.sin(angle), math.sin(angle)
    return matrix


@dataclass(frozen=True, eq=False)
class LumbarPhantom:
    """The spine as a CT and an ultrasound probe see it.

    Parameters
    ----------
    vertebrae : tuple of Vertebra
        From superior to inferior.
    ct, labels : Volume
        HU int16 and 0, 1, 2, ... uint8 on one grid. They lie in the CT's own frame: `ct.placed_by(ct_to_reference)` is in Reference.
    ct_to_reference : (4, 4) float64 array
        Identity unless the phantom was made otherwise.
    bone_distance : Volume
        Signed distance to the nearest bone surface, float32, mm, negative in bone, cut off at 6 mm; in Reference.
    ct_vertebrae : tuple of Vertebra
        Where the vertebrae were for the CT: the same places, unless the spine has bent since.
    """

    anatomy: LumbarAnatomy
    vertebrae: tuple[Vertebra, ...]
    ct: Volume
    labels: Volume
    ct_to_reference: Matrix
    bone_distance: Volume
    soft_tissue: SoftTissue
    ct_vertebrae: tuple[Vertebra, ...]

    def motions_since_ct(self) -> dict[int, Matrix]:
        """How each vertebra has moved in Reference from the CT to the scan, (4, 4) by label; the identity unless the spine has bent."""
        return {
            now.label: now.vertebra_to_reference @ invert(then.vertebra_to_reference)
            for now, then in zip(self.vertebrae, self.ct_vertebrae, strict=True)
        }

    def skin_y(self, x: ArrayLike, z: ArrayLike) -> Floats:
        """y of the skin in Reference at (x, z), mm."""
        return self.soft_tissue.skin_y(x, z)

    def scattering_db(self, points_reference: Floats, beams_reference: Floats) -> Singles:
        """Strength of the echo of soft tissue; see `SoftTissue.scattering_db`."""
        return self.soft_tissue.scattering_db(points_reference, beams_reference)

    def spinous_tips(self) -> Floats:
        """Middle of the hind edge of each spinous process in Reference, (vertebrae, 3), mm."""
        return np.array([transform_points(v.vertebra_to_reference, np.array(v.spinous_tip)) for v in self.vertebrae])

    def spinolaminar_junctions(self) -> Floats:
        """Where laminae and spinous process meet in Reference, (vertebrae, 3), mm."""
        return np.array([v.vertebra_to_reference[:3, 3] for v in self.vertebrae])


def make_lumbar_phantom(
    anatomy: LumbarAnatomy | None = None,
    *,
    spacing: float = 1.0,
    ct_to_reference: Matrix | None = None,
    ct_noise: float = 18.0,
    ct_flexion_deg: float = 0.0,
    progress: Progress | None = None,
) -> LumbarPhantom:
    """A lumbar phantom: CT, labels, and what the ultrasound simulation needs.

    Parameters
    ----------
    spacing : float, mm
        Of CT, labels and the distance volume.
    ct_to_reference : (4, 4), mm, optional
        The CT is scanned along the axes of its own frame, in which the patient lies as this rigid transform says.
    ct_noise : float, HU
        Standard deviation.
    ct_flexion_deg : float
        How much farther the spine was bent forward at each disc for the CT than for the scan (see `flexed`). Soft tissue in the CT does
        not follow.

    Returns
    -------
    LumbarPhantom
    """
    if not 0.2 <= spacing <= 3.0:
        raise SettingsError(f"Input spacing must be 0.2 to 3 mm; got {spacing!r}.")
    anatomy = anatomy or LumbarAnatomy()
    vertebrae = anatomy.vertebrae_in_place()
    ct_vertebrae = flexed(vertebrae, ct_flexion_deg)
    low, high = _extent(anatomy)
    grid = VoxelGrid.from_spacing(low, (np.ceil((high - low) / spacing).astype(int) + 1).tolist(), spacing)
    distance, owner = _bone_on_grid(vertebrae, grid, part(progress, 0.0, 0.5))
    bone_distance = Volume(distance, grid.ijk_to_reference)
    placed_grid, placement = grid, np.eye(4)
    if ct_to_reference is not None or ct_flexion_deg:
        placement = placement if ct_to_reference is None else np.asarray(ct_to_reference, dtype=np.float64)
        corners_ct = transform_points(invert(placement), grid.corners())
        size = (np.ceil(np.ptp(corners_ct, axis=0) / spacing).astype(int) + 1).tolist()
        ct_grid = VoxelGrid.from_spacing(corners_ct.min(axis=0), size, spacing)
        placed_grid = VoxelGrid(ct_grid.size, placement @ ct_grid.ijk_to_reference)
        distance, owner = _bone_on_grid(ct_vertebrae, placed_grid, part(progress, 0.5, 0.7))
    soft_tissue = _soft_tissue(anatomy)
    report(progress, 0.7, "Simulating the CT")
    hounsfield = hounsfield_units(soft_tissue, placed_grid, distance, ct_noise, np.random.default_rng([anatomy.seed, 4]))
    ijk_to_ct = invert(placement) @ placed_grid.ijk_to_reference
    labels = np.where(distance <= 0, owner, 0).astype(np.uint8)
    report(progress, 1.0, "Phantom made")
    return LumbarPhantom(
        anatomy, vertebrae, Volume(hounsfield, ijk_to_ct), Volume(labels, ijk_to_ct), placement, bone_distance, soft_tissue, ct_vertebrae
    )


def flexed(vertebrae: tuple[Vertebra, ...], angle_deg: float) -> tuple[Vertebra, ...]:
    """The vertebrae bent forward (backward where negative) by an angle in degrees at every disc, the middle one staying in its place.

    Notes
    -----
    Each vertebra turns against the next lower one about an axis to the side through the hind part of the lower one's upper endplate, a
    sixth of the body's depth behind its middle: about where lumbar vertebrae turn in flexion and extension [1]_.

    References
    ----------
    .. [1] Pearcy MJ, Bogduk N (1988), Instantaneous axes of rotation of the lumbar intervertebral joints, Spine 13:1033-1041.
    """
    # Superior turns forward: about the patient's right-left axis, z toward y
    turn = np.eye(4)
    turn[:3, :3] = _rotation(0, -math.radians(angle_deg))
    motions = [np.eye(4)]
    for lower in vertebrae[:0:-1]:
        x, y, z = lower.body_center
        pivot = np.eye(4)
        pivot[:3, 3] = x, y - lower.body_depth / 6, z + lower.body_height / 2
        about = lower.vertebra_to_reference @ pivot
        about[:3, :3] = np.eye(3)
        motions.append(motions[-1] @ about @ turn @ invert(about))
    motions = motions[::-1]
    still = invert(motions[len(motions) // 2])
    return tuple(replace(v, vertebra_to_reference=still @ motion @ v.vertebra_to_reference) for v, motion in zip(vertebrae, motions))


def _soft_tissue(anatomy: LumbarAnatomy) -> SoftTissue:
    half_segment = math.radians(anatomy.lordosis_deg) * anatomy.vertebrae / 2
    return SoftTissue(
        arc_center_y=anatomy.arc_center_y,
        skin_to_lamina=anatomy.skin_to_lamina,
        fat_thickness=anatomy.fat_thickness,
        canal_center=LAMINA_THICKNESS + anatomy.canal_depth / 2,
        canal_radii=(anatomy.canal_width / 2, anatomy.canal_depth / 2),
        body_center=anatomy.body_depth_from_lamina,
        body_radii=(anatomy.body_width / 2, anatomy.body_depth / 2),
        body_angles=(-half_segment + BODY_LIFT / anatomy.arc_radius, half_segment + BODY_LIFT / anatomy.arc_radius),
        texture=make_texture(np.random.default_rng([anatomy.seed, 3])),
    )


def _extent(anatomy: LumbarAnatomy) -> tuple[Floats, Floats]:
    """Corners of the scanned box in Reference: the labeled vertebrae, a hand's breadth of muscle, and some air behind the back."""
    half = (anatomy.vertebrae - 1) / 2 * (anatomy.body_height + anatomy.disc_height)
    front = anatomy.skin_to_lamina + anatomy.body_depth_from_lamina + anatomy.body_depth / 2 + 14.0
    return np.array([-66.0, -20.0, -half - 32.0]), np.array([66.0, front, half + 34.0])


def _bone_on_grid(vertebrae: tuple[Vertebra, ...], grid: VoxelGrid, progress: Progress | None) -> tuple[Singles, Bytes]:
    """Signed distance to bone (float32, mm, cut off at `DISTANCE_LIMIT`) and the label of the nearest vertebra, both [k, j, i]."""
    nearest = np.full(grid.shape, DISTANCE_LIMIT, dtype=np.float32)
    owner = np.zeros(grid.shape, dtype=np.uint8)
    box = np.array(np.meshgrid(*np.array(VERTEBRA_BOX).T)).reshape(3, -1).T
    for n, vertebra in enumerate(vertebrae):
        report(progress, n / len(vertebrae), f"Shaping vertebra {vertebra.name}")
        corners = transform_points(grid.reference_to_ijk @ vertebra.vertebra_to_reference, box)
        first = np.maximum(np.floor(corners.min(axis=0)).astype(int), 0)
        last = np.minimum(np.ceil(corners.max(axis=0)).astype(int), np.array(grid.size) - 1)
        if (last < first).any():
            continue
        here = tuple(slice(a, b + 1) for a, b in zip(first[::-1], last[::-1]))
        to_vertebra = invert(vertebra.vertebra_to_reference) @ grid.ijk_to_reference
        distance = vertebra.distance(*affine_coordinates(to_vertebra, first, last))
        distance = np.minimum(distance, DISTANCE_LIMIT).astype(np.float32)
        joint = (distance - nearest[here]) / 2
        neighbor = np.maximum(nearest[here], FACET_GAP / 2 - joint)
        distance = np.maximum(distance, joint + FACET_GAP / 2)
        owner[here] = np.where(distance < neighbor, vertebra.label, owner[here])
        nearest[here] = np.minimum(np.minimum(neighbor, distance), DISTANCE_LIMIT)
    report(progress, 1.0, "Vertebrae shaped")
    return nearest, owner


def affine_coordinates(ijk_to_frame: Matrix, first: Integers, last: Integers) -> tuple[Singles, Singles, Singles]:
    """Coordinates x, y, z of the voxels first..last (i, j, k, both included) in a frame, three [k, j, i] float32 arrays."""
    i, j, k = (np.arange(a, b + 1, dtype=np.float32) for a, b in zip(first, last))
    m = ijk_to_frame.astype(np.float32)
    x, y, z = (m[r, 0] * i[None, None, :] + m[r, 1] * j[None, :, None] + (m[r, 2] * k + m[r, 3])[:, None, None] for r in range(3))
    return x, y, z
