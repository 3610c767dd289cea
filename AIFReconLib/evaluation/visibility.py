"""What the beams of a sweep could reach: surface points with their best angle of incidence, and the shadows.

This is geometry alone: fan, thickness of the beam and occlusion by bone. How strong an echo would be is not asked.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..arrays import Bytes, Floats, Integers, Mask, Matrix
from ..bone.canal import canals_of
from ..effective_settings import resolve_imaging
from ..geometry.box import box_around
from ..geometry.labels import centers_of_mass
from ..geometry.transforms import image_plane_axes, pixel_spacing, transform_points
from ..geometry.volume import Volume, VoxelGrid
from ..imaging.beams import LINEAR, ProbeGeometry
from ..imaging.region import ImageRegion
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import joined
from ..sweep.poses import sweep_poses
from .lines import StraightLines, lines_to_canal
from .surface import BoneSurface, bone_surface, distance_from_labels, interspinous_border

BEAM_THICKNESS = 3.0
"""mm across the imaging plane within which a beam sees. Abdominal and cardiac probes of 3 to 7 MHz: 2 to 5 mm at -6 dB
(Goldstein 1988, Slice thickness measurements, J Ultrasound Med 7:487-498)."""

GRAZING_DEG = 85.0
"""A beam farther than this from a point's normal does not count as reaching it."""

LIFT = 1.0
"""mm (or one voxel) above a surface point from where bone is looked for toward the probe, so that a point does not hide itself."""

RAY_STEP = 1.0
"""mm between looks along a beam."""

MAP_PITCH = 2.5
"""mm between the points of the map of shadows."""

OUTSIDE, SHADOWED, REACHED = 0, 1, 2
"""Of a point: in no beam, only in beams that bone stops before it, in a beam that reaches it."""

FACE = 1.0
"""mm along the beams within which pixels are the probe's face."""

FACE_POINTS = 16
"""Of each frame, along its face."""

PLACES_AT_ONCE = 4_000
"""Places on few rays that are looked at together."""

MOST_LOOKS = 200
"""Along a ray that are left out at once where bone is far."""


@dataclass(frozen=True, eq=False)
class SweepBeams:
    """Where the beams of a sweep ran.

    Parameters
    ----------
    image_to_reference : (frames, 4, 4) float64 array, pixels to mm
    frame_size : (columns, rows)
    region : ImageRegion
        The pixels that are ultrasound.
    thickness : float, mm
        Full width of the beam across the imaging plane, the same at every depth.
    """

    image_to_reference: Matrix
    frame_size: tuple[int, int]
    probe: ProbeGeometry
    region: ImageRegion
    thickness: float = BEAM_THICKNESS

    @classmethod
    def of_sequence(
        cls,
        sequence: TrackedSequence | Iterable[TrackedSequence],
        recipe: Recipe | None = None,
        thickness: float = BEAM_THICKNESS,
    ) -> SweepBeams:
        """The beams of one or more sequences, with the recipe of `reconstruct`; `thickness` in mm across the image plane."""
        recipe = recipe or Recipe()
        sequence = joined(sequence, recipe)
        poses = sweep_poses(sequence, recipe.image_to_reference, recipe.reference)
        usable = poses.require_usable(sequence.name)
        imaging = resolve_imaging(sequence, poses, True, recipe)
        return cls(poses.image_to_reference[usable], sequence.frame_size, imaging.known_probe(), imaging.region, thickness)

    def skin(self) -> Floats:
        """Points on the skin: where the face of the probe was in each frame, (n, 3) mm."""
        rows, columns = np.nonzero(self.region.mask(*self.frame_size))
        x, y = pixel_spacing(self.image_to_reference[0])
        if self.probe.kind == LINEAR:
            depth, across = rows * y, columns * x
        else:
            right, down = (columns - self.probe.apex[0]) * x, (rows - self.probe.apex[1]) * y
            depth, across = np.hypot(right, down), np.arctan2(right, down)
        face = np.flatnonzero(depth <= depth.min() + FACE)
        face = face[np.argsort(across[face])]
        face = face[np.unique(np.linspace(0, len(face) - 1, min(len(face), FACE_POINTS)).round().astype(int))]
        pixels = np.stack([columns[face], rows[face], np.zeros(len(face))], axis=1).astype(np.float64)
        return np.concatenate([transform_points(pose, pixels) for pose in self.image_to_reference])


@dataclass(frozen=True, eq=False)
class BoneTruth:
    """What a reconstruction is measured against: made once, used for every volume of a sweep.

    Parameters
    ----------
    distance : Volume of float32, mm
        Signed distance to bone, negative inside.
    border : (n,) bool array
        Points of the surface that bound an interspinous gap.
    best_cosine : (n,) float64 array or None
        Of the best angle of incidence; NaN where no beam reaches. None: no sweep is known.
    shadows : Volume of uint8 or None
        OUTSIDE, SHADOWED or REACHED, on a coarse grid.
    lines : StraightLines or None
        From the skin to the canal. None without a sweep, or where no canal is closed by bone.
    """

    surface: BoneSurface
    distance: Volume
    border: Mask
    best_cosine: Floats | None = None
    shadows: Volume | None = None
    lines: StraightLines | None = None


def bone_truth(
    labels: Volume, sweep: SweepBeams | None = None, distance: Volume | None = None, progress: Progress | None = None
) -> BoneTruth:
    """The true bone and what the sweep could reach of it.

    Parameters
    ----------
    labels : Volume of integers, placed in Reference
        Any label above 0 is bone; a label per vertebra tells where the interspinous gaps are.
    distance : Volume of float, mm, or None
        The signed distance to bone where it is known better than labels can tell.
    """
    report(progress, 0.0, "Finding the bone surface")
    distance = distance_from_labels(labels) if distance is None else distance
    report(progress, 0.3, "Finding the bone surface")
    surface = bone_surface(distance, labels)
    border = interspinous_border(surface, centers_of_mass(labels))
    if sweep is None:
        report(progress, 1.0, "Found the bone surface")
        return BoneTruth(surface, distance, border)
    _, best_cosine = look(surface.points_reference, sweep, distance, surface.normals_reference, part(progress, 0.4, 0.7))
    grid = _map_grid(distance.grid, MAP_PITCH)
    k, j, i = np.indices(grid.shape).reshape(3, -1)
    points = transform_points(grid.ijk_to_reference, np.stack([i, j, k], axis=1))
    status, _ = look(points, sweep, distance, progress=part(progress, 0.7, 1.0))
    shadows = Volume(status.reshape(grid.shape), grid.ijk_to_reference)
    canals = canals_of(labels, np.unique(surface.labels[np.isfinite(best_cosine)]))
    return BoneTruth(surface, distance, border, best_cosine, shadows, lines_to_canal(sweep.skin(), canals, distance))


def look(
    points_reference: Floats,
    sweep: SweepBeams,
    distance: Volume,
    normals_reference: Floats | None = None,
    progress: Progress | None = None,
) -> tuple[Bytes, Floats]:
    """Whether a beam of the sweep reaches each point, and how squarely.

    Parameters
    ----------
    points_reference : (n, 3) array, mm
    distance : Volume of float, mm
        Signed distance to bone. Beyond it there is none.
    normals_reference : (n, 3) array of unit vectors or None
        With normals the points are on a surface: beams must come from its outer side, within `GRAZING_DEG`. Without, they are
        places, and one in bone is in shadow.

    Returns
    -------
    status : (n,) uint8 array
        OUTSIDE, SHADOWED or REACHED.
    best_cosine : (n,) float64 array
        Of the smallest angle between a beam that reaches the point and its inward normal; NaN where none does, or without normals.

    Notes
    -----
    A point is in a frame's beam when its projection falls on a pixel of the region, and it lies within half the thickness of the
    plane. The beam then runs parallel to the plane, from the apex (sector) or down the image's columns (linear).
    """
    points = np.asarray(points_reference, dtype=np.float64)
    status = np.full(len(points), OUTSIDE, dtype=np.uint8)
    best = np.full(len(points), -np.inf)
    kept = sweep.region.mask(*sweep.frame_size)
    bone = BoneRays(distance)
    for number, image_to_reference in enumerate(sweep.image_to_reference):
        report(progress, number / len(sweep.image_to_reference), "Following the beams")
        _, seen, _, beams, lengths = in_beams(points, image_to_reference[None], sweep, kept)
        status[seen] = np.maximum(status[seen], SHADOWED)
        if normals_reference is None:
            starts, cosines = points[seen], np.ones(len(seen))
            open_ = status[seen] != REACHED
        else:
            normals = normals_reference[seen]
            starts = points[seen] + max(LIFT, distance.grid.spacing.max()) * normals
            cosines = -(beams * normals).sum(axis=1)
            open_ = (cosines >= math.cos(math.radians(GRAZING_DEG))) & (cosines > best[seen])
        free = ~bone.blocks(starts[open_], beams[open_], lengths[open_])
        reached = seen[open_][free]
        status[reached], best[reached] = REACHED, cosines[open_][free]
    report(progress, 1.0, "Followed the beams")
    best[(status != REACHED) | (normals_reference is None)] = np.nan
    return status, best


def in_beams(
    points: Floats, image_to_reference: Matrix, sweep: SweepBeams, kept: Mask
) -> tuple[Integers, Integers, Floats, Floats, Floats]:
    """Points within the beams of frames, (frames, 4, 4): numbers of the frames (m,), in their order, and of the points (m,), their pixels
    (m, 2), beam directions in Reference (m, 3), and mm from where the beam begins (m,)."""
    right, down = np.array([image_plane_axes(pose) for pose in image_to_reference]).transpose(1, 0, 2)
    spacing = np.array([pixel_spacing(pose) for pose in image_to_reference])
    across = np.cross(right, down)
    elevation = across @ points.T
    elevation -= (image_to_reference[:, :3, 3] * across).sum(axis=1)[:, None]
    frame, near = np.divmod(np.flatnonzero(np.abs(elevation) <= sweep.thickness / 2), max(len(points), 1))
    to_reference = image_to_reference[:, :3].copy()
    to_reference[:, :, 2] = across
    to_pixels = np.linalg.inv(to_reference[:, :, :3])[:, :2]
    pixels = np.einsum("mij,mj->mi", to_pixels[frame], points[near] - to_reference[frame, :, 3])
    column, row = np.floor(pixels + 0.5).astype(np.int64).T
    columns, rows = sweep.frame_size
    within = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    within[within] = kept[row[within], column[within]]
    frame, near, pixels = frame[within], near[within], pixels[within]
    if sweep.probe.kind == LINEAR:
        return frame, near, pixels, down[frame], np.maximum(pixels[:, 1], 0.0) * spacing[frame, 1]
    x, y = ((pixels - sweep.probe.apex) * spacing[frame]).T
    length = np.hypot(x, y)
    with np.errstate(invalid="ignore"):
        beams = np.where(length[:, None] > 0, (x[:, None] * right[frame] + y[:, None] * down[frame]) / length[:, None], 0.0)
    return frame, near, pixels, beams, length


class BoneRays:
    """Where bone is, for rays to be stopped by.

    Parameters
    ----------
    distance : Volume of float, mm
        Signed distance to bone; bone is where it is not above 0. No place is farther from bone than it says.
    """

    def __init__(self, distance: Volume):
        box = box_around(distance.array <= 0)
        inside = np.asarray(distance.array[box], dtype=np.float32)
        # Looks until bone can be there at all: rays look into the nearest voxels, half a diagonal beside them at most
        free = np.ceil((inside - float(np.linalg.norm(distance.grid.spacing))) / RAY_STEP)
        looks = np.pad(np.where(inside <= 0, 0, np.clip(free, 1, MOST_LOOKS)).astype(np.uint8), 1, constant_values=1)
        self._size = np.array(looks.shape[::-1], dtype=np.int32)
        # Beyond the last one of a row lies the rim of the next; beyond all, one more plane of it
        self._looks = np.append(looks.reshape(-1), np.ones(self._size[0] * (self._size[1] + 1) + 1, dtype=np.uint8))
        self._to_ijk = distance.grid.reference_to_ijk.copy()
        self._to_ijk[:3, 3] -= [part.start - 1 for part in box[::-1]]

    def blocks(self, starts: Floats, beams: Floats, lengths: Floats) -> Mask:
        """Whether bone lies between each start and `lengths` mm (m,) against its beam, (m,) bool; looked for every `RAY_STEP`."""
        # Voxel numbers in the padded array, rounded by truncation
        position = (transform_points(self._to_ijk, starts) + 0.5).astype(np.float32).T.copy()
        step = (-RAY_STEP * beams @ self._to_ijk[:3, :3].T).astype(np.float32).T.copy()
        with np.errstate(divide="ignore", invalid="ignore"):
            # Looks at which a ray meets the two planes of each axis that bound the box
            low, high = -position / step, (self._size[:, None] - position) / step
        look = np.ceil(np.fmax(np.fmin(low, high).max(axis=0), 0)).astype(np.float32)
        last = np.floor(np.fmin(np.fmax(low, high).min(axis=0), np.ceil(lengths / RAY_STEP) - 1)).astype(np.float32)
        blocked = np.zeros(len(starts), dtype=bool)
        ray = np.flatnonzero((look <= last) & np.isfinite(look))
        (x, y, z), (dx, dy, dz), look, last = position[:, ray], step[:, ray], look[ray], last[ray]
        while len(ray):
            # Of few rays several looks at once
            several = np.arange(max(PLACES_AT_ONCE // len(ray), 1), dtype=np.float32)[:, None]
            at = np.minimum(look + several, last)
            i, j, k = ((start + at * by).astype(np.int32) for start, by in ((x, dx), (y, dy), (z, dz)))
            free = self._looks[i + self._size[0] * (j + self._size[1] * k)]
            stopped, look = (free == 0).any(axis=0), (at + free).max(axis=0)
            blocked[ray[stopped]] = True
            on = np.flatnonzero(~stopped & (look <= last))
            if len(on) < len(ray):
                ray, x, y, z, dx, dy, dz, look, last = (each.take(on) for each in (ray, x, y, z, dx, dy, dz, look, last))
        return blocked


def _map_grid(grid: VoxelGrid, pitch: float) -> VoxelGrid:
    """A coarser grid over the same box, with voxels of about `pitch` mm."""
    factors = np.maximum(np.round(pitch / grid.spacing), 1.0)
    size = np.maximum(np.ceil(np.array(grid.size) / factors), 1).astype(int)
    to_fine = np.diag([*factors, 1.0])
    to_fine[:3, 3] = (factors - 1) / 2
    return VoxelGrid(tuple(size), grid.ijk_to_reference @ to_fine)
