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

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Floats, Integers, Mask, Matrix, Numbers, Reals, Singles
from ..errors import GeometryError
from ..geometry.transforms import pixel_spacing
from ..geometry.volume import Volume, VoxelGrid
from ..imaging.extent import grid_around_sweep
from ..progress import Progress, report
from ..recipe.recipe import Recipe
from ..remedies import Remedy
from ..resolve import Imaging, resolve_imaging
from ..sweep.frames import TrackedSequence
from ..sweep.joined import joined
from ..sweep.poses import SweepPoses, sweep_poses, tracked_frames
from .map import BoneMap
from .scan_line_reader import ScanLineReader, running_sum

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

HALF_THICKNESS = 0.75
"""mm before and behind an echo that are drawn as bone."""

SLAB = 4.0
"""mm behind the surface that count as inside of bone, and in front of it as outside; nothing is known beyond."""


@dataclass(frozen=True, eq=False)
class BoneEchoes:
    """What one frame shows of bone: at most one echo per scan line."""

    pixels: Floats  #: (n, 2). Column and row of each.
    beams: Floats  #: (n, 2). One mm along the sound there, in pixels (column, row).
    scores: Singles  #: (n,). `LEAST_SCORE` to 1.


class BoneEchoFinder:
    """Looks for bone in images of one size, spacing and probe.

    Per scan line, with e the smoothed intensity, b the mean intensity from 1 to 10 mm behind, and m the mean of the frame's pixels
    above 0::

        score = (e - b) / (e + b + m)

    It tends to 1 for a bright echo over darkness, is about 0 where an echo has tissue behind it, and small in darkness, where e and b are
    small against m. Multiplying all intensities by a factor does not change it. The strongest score of a line counts if it reaches
    `LEAST_SCORE`, lies below the skin, and the neighboring lines agree; the echo then lies at the brightest e within `CREST`.

    `size` is (columns, rows), `spacing` (x, y) in mm; `imaging` must know region and probe.
    """

    def __init__(self, size: tuple[int, int], spacing: tuple[float, float], imaging: Imaging):
        self._lines = lines = ScanLineReader(size, spacing, imaging)
        self._spacing, self._pitch, self._step = np.asarray(spacing), lines.pitch, lines.step
        self._columns, self._rows, self._known = lines.columns, lines.rows, lines.known
        self._sigma = ECHO_ACROSS / self._pitch, ECHO_ALONG / self._step
        self._reach = np.maximum(scipy.ndimage.gaussian_filter(self._known.astype(np.float32), self._sigma), np.float32(1e-3))
        samples = np.arange(self._rows.shape[1])
        self._from, self._to = (np.minimum(samples + round(mm / self._step), samples.size) for mm in (SHADOW_FROM, SHADOW_TO))
        known_before = running_sum(self._known)
        self._behind = (known_before[:, self._to] - known_before[:, self._from]).astype(np.float32)
        depth = (samples - self._known.argmax(axis=1)[:, None]) * self._step
        self._eligible = self._known & (depth >= SKIN) & (self._behind * self._step >= SHADOW_LEAST)

    @property
    def lines(self) -> int:
        """Scan lines that are looked at: the most echoes that an image can have."""
        return len(self._columns)

    def find(self, image: Numbers) -> BoneEchoes:
        """The bone echoes of an image, (rows, columns); values below 0 and not finite count as 0."""
        scores, samples, bone = self._strongest(image)
        # Scan lines are straight: places between samples, and the way along the beam, follow from the two around
        before = np.clip(np.floor(samples[bone]).astype(np.int64), 0, max(self._rows.shape[1] - 2, 0))
        after = np.minimum(before + 1, self._rows.shape[1] - 1)
        start, stop = (np.stack([self._columns[bone, at], self._rows[bone, at]], axis=-1) for at in (before, after))
        way = stop - start
        beams = way / np.maximum(np.linalg.norm(way * self._spacing, axis=1, keepdims=True), 1e-9)
        return BoneEchoes(start + (samples[bone] - before)[:, None] * way, beams, scores[bone])

    def _strongest(self, image: Numbers) -> tuple[Singles, Floats, Integers]:
        """The score and place of the strongest echo of every line, (lines,) each, and the numbers of the lines where it is bone."""
        scores: Singles = np.zeros(self.lines, dtype=np.float32)
        samples: Floats = np.zeros(self.lines)
        echo, score = self.look(image)
        if score is not None:
            strongest = score.argmax(axis=1)
            scores = np.take_along_axis(score, strongest[:, None], axis=1)[:, 0]
            samples = self._crest(echo, strongest)
        return scores, samples, np.flatnonzero(self._agreed(samples, scores >= LEAST_SCORE))

    def drawn(self, image: Numbers) -> Singles:
        """Bone in every pixel of an image, (rows, columns) float32: the score of an echo, `HALF_THICKNESS` mm before and behind it."""
        scores, samples, bone = self._strongest(image)
        near = np.abs(np.arange(self._rows.shape[1]) - samples[bone, None]) * self._step <= HALF_THICKNESS
        lines: Singles = np.zeros(self._rows.shape, dtype=np.float32)
        lines[bone] = np.where(near, scores[bone, None], np.float32(0.0))
        return self._lines.draw(lines)

    def look(self, image: Numbers) -> tuple[Singles, Singles | None]:
        """Smoothed intensity e and score of every sample, (lines, samples) each; no score where the image is black."""
        values = self._lines.read(image)
        lit = values[values > 0]
        if not lit.size:
            return values, None
        echo: Singles = (scipy.ndimage.gaussian_filter(values, self._sigma, output=np.float32) / self._reach).astype(np.float32)
        sums = running_sum(values)
        behind = (sums[:, self._to] - sums[:, self._from]).astype(np.float32) / np.maximum(self._behind, 1)
        score: Singles = np.where(self._eligible, (echo - behind) / (echo + behind + lit.mean()), 0.0).astype(np.float32)
        return echo, score

    def _crest(self, echo: Reals, samples: Integers) -> Floats:
        """Where each line is brightest up to `CREST` before these samples, between samples by a parabola, (lines,) float64."""
        reach, lines = round(CREST / self._step), np.arange(len(samples))
        near = np.clip(samples[:, None] + np.arange(-reach, 1), 0, echo.shape[1] - 1)
        crest = near[lines, np.take_along_axis(echo, near, axis=1).argmax(axis=1)]
        before, top, after = (echo[lines, np.clip(crest + shift, 0, echo.shape[1] - 1)].astype(np.float64) for shift in (-1, 0, 1))
        bend = before - 2 * top + after
        shift = np.divide(0.5 * (before - after), bend, out=np.zeros(len(crest)), where=bend < 0)
        between: Floats = np.clip(crest + np.clip(shift, -0.5, 0.5), 0, echo.shape[1] - 1)
        return between

    def _agreed(self, samples: Floats, found: Mask) -> Mask:
        """Which lines that found bone have enough neighbors that found it at about the same depth, (lines,) bool."""
        reach = max(round(NEIGHBORHOOD / self._pitch), 1)
        depth = np.pad(np.where(found, samples * self._step, np.inf), reach, constant_values=np.inf)
        agreeing = np.zeros(len(samples))
        here = np.where(found, samples * self._step, 0.0)
        for shift in (*range(-reach, 0), *range(1, reach + 1)):
            agreeing += np.abs(depth[reach + shift : reach + shift + len(here)] - here) <= NEIGHBOR_DEPTH
        return found & (agreeing >= NEIGHBORS_NEEDED * 2 * reach)


def bone_from_sweep(
    sequence: TrackedSequence | Iterable[TrackedSequence],
    poses: SweepPoses | None = None,
    imaging: Imaging | None = None,
    spacing: float = SPACING,
    progress: Progress | None = None,
    recipe: Recipe | None = None,
) -> BoneMap:
    """A bone map drawn from the sweep itself, in Reference.

    Parameters
    ----------
    sequence : TrackedSequence or several in one Reference
    poses, imaging : SweepPoses, Imaging or None
        Where they are known already, as `sweep_poses` and `resolve_imaging` return them.
    spacing : float, mm
        Of the map, not of the reconstruction.
    progress : Progress or None
    recipe : Recipe or None
        As in `reconstruct`; what `poses` or `imaging` tell comes before it.

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
    sequence, recipe = joined(sequence), recipe or Recipe()
    poses = sweep_poses(sequence, recipe.image_to_reference, recipe.reference) if poses is None else poses
    usable = poses.require_usable(sequence.name)
    imaging = resolve_imaging(sequence, poses, True, recipe) if imaging is None else imaging
    matrices = poses.image_to_reference[usable]
    grid = _padded(grid_around_sweep(matrices, sequence.frame_size, imaging.region, (spacing,) * 3, 32), round(3 * SIGMA / spacing) + 1)
    best = np.zeros(grid.voxels, dtype=np.float32)
    weight, distance = np.zeros(grid.voxels), np.zeros(grid.voxels)
    offsets = np.arange(-SLAB, SLAB + 0.25 * spacing, 0.5 * spacing)
    # Sweeps that were joined may differ in depth
    ends, finders = np.cumsum([len(each) for each in sequence.sweeps]), {}
    for done, frame in enumerate(tracked_frames(sequence, poses, usable)):
        report(progress, done / len(usable), "Looking for bone in the sweep")
        image, pose = frame.placed()
        sweep = int(np.searchsorted(ends, frame.number, side="right"))
        if sweep not in finders:
            finders[sweep] = BoneEchoFinder(sequence.frame_size, pixel_spacing(pose), imaging)
        echoes = finders[sweep].find(image)
        image_to_ijk = grid.reference_to_ijk @ pose
        np.maximum.at(best, _voxels(echoes.pixels, image_to_ijk, grid), echoes.scores)
        along = echoes.pixels[:, None, :] + offsets[None, :, None] * echoes.beams[:, None, :]
        at = _voxels(along.reshape(-1, 2), image_to_ijk, grid)
        weights = np.repeat(echoes.scores, offsets.size)
        np.add.at(weight, at, weights)
        np.add.at(distance, at, weights * np.tile(offsets, len(echoes.scores)))
    seen = best > 0
    if not seen.any():
        raise GeometryError(f"{sequence.name}: no frame shows bone, a bright echo with darkness behind it.", Remedy.BONE_OF_CT)
    sigma = SIGMA / spacing
    probability = scipy.ndimage.gaussian_filter(best.reshape(grid.shape), sigma, mode="constant")
    np.minimum(probability / np.percentile(probability.reshape(-1)[seen], 90), 1.0, out=probability)
    smooth = scipy.ndimage.gaussian_filter(distance.reshape(grid.shape), sigma, mode="constant")
    inside = (smooth > 0) & (scipy.ndimage.gaussian_filter(weight.reshape(grid.shape), sigma, mode="constant") > 0.05 * LEAST_SCORE)
    report(progress, 1.0, "Looked for bone in the sweep")
    return BoneMap(Volume(probability, grid.ijk_to_reference), Volume(inside.astype(np.uint8), grid.ijk_to_reference))


def _padded(grid: VoxelGrid, voxels: int) -> VoxelGrid:
    """The grid with so many more voxels on every side."""
    return VoxelGrid.from_spacing(grid.origin - voxels * grid.spacing, [n + 2 * voxels for n in grid.size], grid.spacing)


def _voxels(pixels: Floats, image_to_ijk: Matrix, grid: VoxelGrid) -> Integers:
    """Flat voxel numbers [k, j, i] of pixels (n, 2), kept within the grid."""
    ijk = np.floor(pixels @ image_to_ijk[:3, :2].T + image_to_ijk[:3, 3] + 0.5).astype(np.int64)
    i, j, k = np.clip(ijk, 0, np.array(grid.size) - 1).T
    flat: Integers = (k * grid.size[1] + j) * grid.size[0] + i
    return flat
