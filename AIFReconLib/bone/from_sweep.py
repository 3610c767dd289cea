"""Where the sweep itself shows bone: a bright echo with darkness behind it. A first step toward working without a CT.

References
----------
Foroughi P, Boctor E, Swartz MJ, Taylor RH, Fichtinger G (2007), "Ultrasound bone segmentation using dynamic programming", IEEE
Ultrasonics Symposium: echo and shadow together make bone; neighboring scan lines must agree. Hacihaliloglu I, Abugharbieh R, Hodgson AJ,
Rohling RN, Guy P (2012), "Automatic bone localization and fracture detection from volumetric ultrasound images using 3-D local phase
features", Ultrasound in Medicine and Biology 38(1): ridges from local phase instead. Curless B, Levoy M (1996), "A volumetric method for
building complex models from range images", SIGGRAPH: averaged signed distances along lines of sight. The rule here is simpler than any of
them and shares no code.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from ..arrays import Array, Floats, Integers, Mask, Matrix, Numbers, Reals, Singles
from ..errors import BeamGeometryError, GeometryError
from ..geometry.transforms import pixel_spacing
from ..geometry.volume import Volume, VoxelGrid
from ..imaging.extent import grid_around_sweep
from ..imaging.scan_lines import scan_line_samples
from ..progress import Progress, report
from ..resolve import Imaging
from ..sweep.frames import TrackedSequence
from ..sweep.poses import SweepPoses, tracked_frames
from .map import BoneMap

SPACING = 1.0
"""mm between voxels of the map."""

SIGMA = 1.5
"""mm. Smoothing of the map in 3D; joins frames that lie up to some 3 mm apart."""

ECHO_ALONG, ECHO_ACROSS = 0.4, 0.8
"""mm. Smoothing of the image along scan lines (about the axial resolution) and across them, against speckle."""

SHADOW_FROM, SHADOW_TO, SHADOW_LEAST = 1.0, 10.0, 3.0
"""mm behind an echo: where its shadow is measured, and how much of that must lie in the image."""

SKIN = 8.0
"""mm below the transducer in which nothing counts: skin, gel and reverberation are bright and never bone."""

LEAST_SCORE = 0.4
"""Score from which an echo counts as bone."""

CREST = 1.0
"""mm in which the echo's brightest place is looked for: the score alone peaks on its far flank, where the shadow is deepest."""

NEIGHBORHOOD, NEIGHBOR_DEPTH, NEIGHBORS_NEEDED = 2.0, 2.0, 0.5
"""Where neighbors of an echo are, mm to the sides; how much deeper or higher theirs may be, mm; which part of the lines must have one."""

SLAB = 4.0
"""mm behind the surface that count as inside of bone, and in front of it as outside; nothing is known beyond."""


@dataclass(frozen=True, eq=False)
class BoneEchoes:
    """What one frame shows of bone: at most one echo per scan line.

    Parameters
    ----------
    pixels : (n, 2) float64 array
        Column and row of each.
    beams : (n, 2) float64 array
        One mm along the sound there, in pixels (column, row).
    scores : (n,) float32 array
        `LEAST_SCORE` to 1.
    """

    pixels: Floats
    beams: Floats
    scores: Singles


class BoneEchoFinder:
    """Looks for bone in images of one size, spacing and probe.

    Parameters
    ----------
    size : (columns, rows)
    spacing : (x, y), mm
    imaging : Imaging
        Region and probe; both must be known.

    Notes
    -----
    Per scan line, with e the smoothed intensity, b the mean intensity from 1 to 10 mm behind, and m the mean of the frame's pixels
    above 0::

        score = (e - b) / (e + b + m)

    It tends to 1 for a bright echo over darkness, is about 0 where an echo has tissue behind it, and small in darkness, where e and b are
    small against m. Multiplying all intensities by a factor does not change it. The strongest score of a line counts if it reaches
    `LEAST_SCORE`, lies below the skin, and the neighboring lines agree; the echo then lies at the brightest e within `CREST`.
    """

    def __init__(self, size: tuple[int, int], spacing: tuple[float, float], imaging: Imaging):
        if imaging.probe is None:
            raise BeamGeometryError(
                "Bone is looked for along the beams, whose directions are not known. "
                "Give --probe linear, or --probe sector with --apex-px COLUMN ROW."
            )
        mask = imaging.region.mask(*size)
        at_row, at_column = np.nonzero(mask)
        lines = scan_line_samples(at_column, at_row, spacing, imaging.probe)
        self._columns, self._rows, self._step = lines.columns, lines.rows, lines.step
        columns, rows = np.rint(self._columns).astype(np.int64), np.rint(self._rows).astype(np.int64)
        within = (columns >= 0) & (columns < size[0]) & (rows >= 0) & (rows < size[1])
        self._known = within & mask[np.clip(rows, 0, size[1] - 1), np.clip(columns, 0, size[0] - 1)]
        across = np.hypot(np.diff(self._columns, axis=0) * spacing[0], np.diff(self._rows, axis=0) * spacing[1])
        # A sector's lines diverge: their distance at half depth stands for all
        self._pitch = max(float(across[:, across.shape[1] // 2].mean()), 1e-3) if across.size else 1.0
        self._sigma = ECHO_ACROSS / self._pitch, ECHO_ALONG / self._step
        self._reach = np.maximum(ndimage.gaussian_filter(self._known.astype(np.float32), self._sigma), np.float32(1e-3))
        samples = np.arange(self._rows.shape[1])
        self._from, self._to = (np.minimum(samples + round(mm / self._step), samples.size) for mm in (SHADOW_FROM, SHADOW_TO))
        known_before = _running_sum(self._known)
        self._behind = known_before[:, self._to] - known_before[:, self._from]
        depth = (samples - self._known.argmax(axis=1)[:, None]) * self._step
        self._eligible = self._known & (depth >= SKIN) & (self._behind * self._step >= SHADOW_LEAST)

    def find(self, image: Numbers) -> BoneEchoes:
        """The bone echoes of an image, (rows, columns); values below 0 and not finite count as 0."""
        image = np.maximum(np.nan_to_num(image.astype(np.float32), nan=0.0, posinf=0.0), 0.0)
        values = ndimage.map_coordinates(image, np.stack([self._rows, self._columns]), np.float32, order=1, mode="nearest")
        values[~self._known] = 0.0
        lit = values[values > 0]
        scores: Singles = np.zeros(len(values), dtype=np.float32)
        samples: Integers = np.zeros(len(values), dtype=np.int64)
        if lit.size:
            echo = ndimage.gaussian_filter(values, self._sigma, output=np.float32) / self._reach
            sums = _running_sum(values)
            behind = (sums[:, self._to] - sums[:, self._from]) / np.maximum(self._behind, 1)
            score = np.where(self._eligible, (echo - behind) / (echo + behind + lit.mean()), 0.0)
            samples = score.argmax(axis=1)
            scores = np.take_along_axis(score, samples[:, None], axis=1)[:, 0].astype(np.float32)
            samples = self._crest(echo, samples)
        bone = np.flatnonzero(self._agreed(samples, scores >= LEAST_SCORE))
        at = bone, samples[bone]
        before = at[0], np.maximum(at[1] - 1, 0)
        pixels = np.stack([self._columns[at], self._rows[at]], axis=-1)
        beams = (pixels - np.stack([self._columns[before], self._rows[before]], axis=-1)) / self._step
        return BoneEchoes(pixels, beams, scores[bone])

    def _crest(self, echo: Reals, samples: Integers) -> Integers:
        reach = round(CREST / self._step)
        near = np.clip(samples[:, None] + np.arange(-reach, 1), 0, echo.shape[1] - 1)
        crest: Integers = near[np.arange(len(near)), np.take_along_axis(echo, near, axis=1).argmax(axis=1)]
        return crest

    def _agreed(self, samples: Integers, found: Mask) -> Mask:
        """Which lines that found bone have enough neighbors that found it at about the same depth, (lines,) bool."""
        reach = max(round(NEIGHBORHOOD / self._pitch), 1)
        depth = np.pad(np.where(found, samples * self._step, np.inf), reach, constant_values=np.inf)
        agreeing = np.zeros(len(samples))
        own = np.where(found, samples * self._step, 0.0)
        for shift in (*range(-reach, 0), *range(1, reach + 1)):
            agreeing += np.abs(depth[reach + shift : reach + shift + len(own)] - own) <= NEIGHBOR_DEPTH
        return found & (agreeing >= NEIGHBORS_NEEDED * 2 * reach)


def bone_from_sweep(
    sequence: TrackedSequence, poses: SweepPoses, imaging: Imaging, spacing: float = SPACING, progress: Progress | None = None
) -> BoneMap:
    """A bone map drawn from the sweep itself, in Reference.

    Parameters
    ----------
    sequence : TrackedSequence
    poses : SweepPoses
    imaging : Imaging
        As `resolve_imaging` returns it, with its probe known.
    spacing : float, mm
        Of the map, not of the reconstruction.
    progress : Progress or None

    Raises
    ------
    BeamGeometryError
        When the probe is not known.
    GeometryError
        When no frame shows bone.

    Notes
    -----
    `probability`: each voxel takes the largest score of the echoes in it; Gaussian of `SIGMA` mm; divided by the 90th percentile of
    what it is at voxels with echoes, and limited to 1. (The paper divides by the maximum; here one dense spot would dim the rest.)
    `inside`: every echo tells of `SLAB` mm behind it along its own beam that they are bone, and of as many before it that they are not;
    where the mean of these signed distances, weighted by the scores, is positive, is bone. All usable frames take part.
    """
    usable = poses.require_usable(sequence.name)
    matrices = poses.image_to_reference[usable]
    grid = _padded(grid_around_sweep(matrices, sequence.frame_size, imaging.region, (spacing,) * 3, 32), round(3 * SIGMA / spacing) + 1)
    best = np.zeros(grid.voxels, dtype=np.float32)
    weight, distance = np.zeros(grid.voxels), np.zeros(grid.voxels)
    offsets = np.arange(-SLAB, SLAB + 0.25 * spacing, 0.5 * spacing)
    finder = BoneEchoFinder(sequence.frame_size, pixel_spacing(matrices[0]), imaging)
    for done, frame in enumerate(tracked_frames(sequence, poses, usable)):
        report(progress, done / len(usable), "Looking for bone in the sweep")
        image, image_to_reference = frame.placed()
        echoes = finder.find(image)
        image_to_ijk = grid.reference_to_ijk @ image_to_reference
        np.maximum.at(best, _voxels(echoes.pixels, image_to_ijk, grid), echoes.scores)
        along = echoes.pixels[:, None, :] + offsets[None, :, None] * echoes.beams[:, None, :]
        at = _voxels(along.reshape(-1, 2), image_to_ijk, grid)
        weights = np.repeat(echoes.scores, offsets.size)
        np.add.at(weight, at, weights)
        np.add.at(distance, at, weights * np.tile(offsets, len(echoes.scores)))
    seen = best > 0
    if not seen.any():
        raise GeometryError(
            "{sequence}: no frame shows bone, a bright echo with darkness behind it. Give --bone-labels, or no bone.",
            sequence=sequence.name,
        )
    sigma = SIGMA / spacing
    probability = ndimage.gaussian_filter(best.reshape(grid.shape), sigma, mode="constant")
    np.minimum(probability / np.percentile(probability.reshape(-1)[seen], 90), 1.0, out=probability)
    smooth = ndimage.gaussian_filter(distance.reshape(grid.shape), sigma, mode="constant")
    inside = (smooth > 0) & (ndimage.gaussian_filter(weight.reshape(grid.shape), sigma, mode="constant") > 0.05 * LEAST_SCORE)
    report(progress, 1.0, "Looked for bone in the sweep")
    return BoneMap(Volume(probability, grid.ijk_to_reference), Volume(inside.astype(np.uint8), grid.ijk_to_reference))


def _running_sum(lines: Array) -> Floats:
    """Sums before each sample of a line: (lines, samples + 1)."""
    return np.cumsum(np.pad(lines, ((0, 0), (1, 0))), axis=1, dtype=np.float64)


def _padded(grid: VoxelGrid, voxels: int) -> VoxelGrid:
    """The grid with so many more voxels on every side."""
    return VoxelGrid.from_spacing(grid.origin - voxels * grid.spacing, [n + 2 * voxels for n in grid.size], grid.spacing)


def _voxels(pixels: Floats, image_to_ijk: Matrix, grid: VoxelGrid) -> Integers:
    """Flat voxel numbers [k, j, i] of pixels (n, 2), kept within the grid."""
    ijk = np.floor(pixels @ image_to_ijk[:3, :2].T + image_to_ijk[:3, 3] + 0.5).astype(np.int64)
    i, j, k = np.clip(ijk, 0, np.array(grid.size) - 1).T
    flat: Integers = (k * grid.size[1] + j) * grid.size[0] + i
    return flat
