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
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Bytes, Floats, Integers, Matrix, Singles
from ..errors import SettingsError
from ..geometry.transforms import affine, invert, transform_points
from ..geometry.volume import Volume, VoxelGrid
from ..progress import Progress, part, report
from .computed_tomography import hounsfield_units
from .morphometry import BODY_LIFT, LAMINA_THICKNESS, LEVELS, TYPICAL, VertebraSizes
from .soft_tissue import SoftTissue, make_texture
from .vertebra import DISTANCE_LIMIT, VERTEBRA_BOX, Vertebra, flexed, turned_about

FACET_GAP = 1.6
"""mm of joint space between the facets of neighbors. Within the 1 to 2 mm of cartilage and fluid in CT."""


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
        2 to 4: L3-L4, L2-L4 or L2-L5.
    body_width, body_depth, body_height, canal_width, canal_depth, transverse_width, pedicle_width : float
        Of L3; the other levels' differ from these as they typically do (`morphometry.TYPICAL`, with its sources and ranges).
    facet_width, facet_angle_deg : float
        Of L3: between the middles of the superior articular processes, and of the joints to the sagittal plane. The inferior ones follow.
    arch_height : float
        Of L3, from the top of its superior to the bottom of its inferior articular processes.
    disc_height : float
        3.1 to 11.4 mm [1]_.
    spinous_length : float
        Of L3, spinolaminar junction to tip: about 30 mm [2]_.
    spinous_slope_deg : float
        By how much the middle of the spinous processes slopes down.
    interspinous_gap : float
        Between neighboring spinous processes, where they are nearest; larger above L5, whose process is low. 12 mm on the mean at L2-L3,
        6 to 22 mm, less with age [3]_. It leaves processes of 20 to 25 mm height at L2 to L4, as in [4]_.
    skin_to_lamina : float
        35 to 55 mm; ultrasound finds the epidural space, a few mm deeper, at 47 mm on the mean in parturients (standard deviation
        7 mm) [5]_.
    lordosis_deg : float
        Between neighboring vertebrae, at most half of the standing posture's.
    irregularity : float
        Scales all that is drawn per vertebra; 0 leaves what is typical of each level.

    References
    ----------
    .. [1] Clouthier et al. (2023), J Biomech 146:111421, doi:10.1016/j.jbiomech.2022.111421 (see `morphometry`).
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
    body_width: float = _size(51.5, 2.5, 42.0, 59.0)
    body_depth: float = _size(35.0, 2.0, 29.5, 42.0)
    body_height: float = _size(29.5, 1.2, 25.0, 32.5)
    disc_height: float = _size(8.0, 1.2, 5.0, 11.5)
    canal_width: float = _size(23.0, 1.2, 20.0, 28.0)
    canal_depth: float = _size(15.0, 1.0, 13.0, 20.0)
    transverse_width: float = _size(88.0, 4.0, 74.0, 100.0)
    spinous_length: float = _size(32.0, 1.5, 26.0, 37.0)
    interspinous_gap: float = _size(10.0, 1.3, 6.0, 14.0)
    skin_to_lamina: float = _size(45.0, 4.0, 35.0, 55.0)
    lordosis_deg: float = _size(6.0, 1.3, 1.0, 10.0)
    pedicle_width: float = _size(9.0, 1.0, 6.0, 12.5)
    facet_width: float = _size(37.0, 1.5, 32.0, 42.0)
    facet_angle_deg: float = _size(24.0, 6.0, 5.0, 45.0)
    arch_height: float = _size(49.0, 1.8, 43.0, 55.0)
    spinous_slope_deg: float = _size(19.0, 3.0, 10.0, 28.0)
    irregularity: float = 1.0

    def __post_init__(self) -> None:
        if self.vertebrae not in (2, 3, 4):
            raise SettingsError(f"Input vertebrae must be 2, 3 or 4; got {self.vertebrae!r}.")

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
        gaps = np.clip(gaps, 6.5, 13.5) if self.irregularity else gaps
        first = LEVELS.index("L3" if self.vertebrae == 2 else "L2")
        names = LEVELS[first : first + self.vertebrae]
        sizes = _with_gaps([self.sizes_of(name, 1.0 + 0.015 * jitter[n, 5]) for n, name in enumerate(names)], gaps, self)
        step = math.radians(self.lordosis_deg)
        return tuple(
            Vertebra(n + 1, name, _pose_on_arc(self, ((self.vertebrae - 1) / 2 - n) * step, jitter[n]), sizes[n], jitter[n, 6])
            for n, name in enumerate(names)
        )

    def sizes_of(self, level: str, scale: float = 1.0) -> VertebraSizes:
        """Sizes of a vertebra of this person: typical of its level, and as much larger as this L3 is; `scale` is its own."""
        here, usual = TYPICAL[level], type(self)
        width, high = self.facet_width / usual.facet_width, self.arch_height / usual.arch_height
        drop = here.spinous_length * (math.tan(math.radians(self.spinous_slope_deg)) - math.tan(math.radians(usual.spinous_slope_deg)))
        same = {size.name for size in fields(VertebraSizes)} & {size.name for size in fields(usual)} - {"facet_angle_deg"}
        changed = {name: getattr(here, name) * getattr(self, name) / getattr(usual, name) for name in same}
        changed |= {"superior_width": here.superior_width * width, "inferior_width": here.inferior_width * width}
        changed |= {"superior_height": here.superior_height * high, "inferior_height": here.inferior_height * high}
        changed |= {"pedicle_height": here.pedicle_height * self.body_height / usual.body_height}
        grown = {name: value * scale for name, value in changed.items() if name not in ("spinous_length", "canal_depth")}
        angle = here.facet_angle_deg + self.facet_angle_deg - usual.facet_angle_deg
        edges = {"spinous_top": here.spinous_top - drop, "spinous_bottom": here.spinous_bottom - drop}
        return replace(here, **(changed | grown | edges), facet_angle_deg=angle)


def _with_gaps(sizes: list[VertebraSizes], gaps: Floats, anatomy: LumbarAnatomy) -> list[VertebraSizes]:
    """The same with spinous processes made higher or lower, on both sides of a gap alike and by 4 mm at most, toward these gaps."""
    radius, step = anatomy.arc_radius - anatomy.body_depth_from_lamina, math.radians(anatomy.lordosis_deg)
    for n, (upper, lower) in enumerate(pairwise(sizes)):
        pitch = step * (radius - (upper.spinous_length + lower.spinous_length) / 2 + 10.0)
        taken = float(np.clip(pitch + upper.spinous_bottom - lower.spinous_top - gaps[n + 1], -8.0, 8.0)) / 2
        sizes[n : n + 2] = (
            replace(upper, spinous_bottom=upper.spinous_bottom - taken),
            replace(lower, spinous_top=lower.spinous_top + taken),
        )
    return sizes


def _pose_on_arc(anatomy: LumbarAnatomy, angle: float, jitter: Floats) -> Matrix:
    """Vertebra to Reference at an angle (radians, superior positive) along the arc, with small tilts and shifts."""
    turn = np.deg2rad(np.array([0.7, 1.2, 1.5]) * jitter[:3])
    tilt = turned_about(0, angle + turn[0]) @ turned_about(1, turn[1]) @ turned_about(2, turn[2])
    radius = anatomy.arc_radius - anatomy.body_depth_from_lamina
    return affine(tilt, (0.7 * jitter[3], anatomy.arc_center_y + radius * math.cos(angle) + 0.5 * jitter[4], radius * math.sin(angle)))


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
    soft_tissue = soft_tissue_of(anatomy)
    report(progress, 0.7, "Simulating the CT")
    hounsfield = hounsfield_units(soft_tissue, placed_grid, distance, ct_noise, np.random.default_rng([anatomy.seed, 4]))
    ijk_to_ct = invert(placement) @ placed_grid.ijk_to_reference
    labels = np.where(distance <= 0, owner, 0).astype(np.uint8)
    report(progress, 1.0, "Phantom made")
    return LumbarPhantom(
        anatomy, vertebrae, Volume(hounsfield, ijk_to_ct), Volume(labels, ijk_to_ct), placement, bone_distance, soft_tissue, ct_vertebrae
    )


def soft_tissue_of(anatomy: LumbarAnatomy) -> SoftTissue:
    """The soft tissue around a spine of these sizes."""
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
    """Corners of the scanned box in Reference: the vertebrae, a hand's breadth of muscle, some air behind."""
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
