"""Predictions of bone in frames, weighed by where sound came, and the one map in space that they add up to, frame after frame."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Floats, Integers, Matrix, Numbers, Singles
from ..geometry.box import Box
from ..geometry.volume import Volume, VoxelGrid
from ..progress import Progress, report
from ..resolve import Imaging
from .map import GAUSSIAN_REACH, BoneMap
from .scan_line_reader import Rectangle, ScanLineReader, running_sum

SPACING = 1.0
"""mm between voxels of the map."""

SIGMA, LARGEST_SIGMA = 1.0, 4.0
"""mm. The least and the largest smoothing of the map in 3D."""

PITCH, STEP = 1.0, 0.5
"""mm. Scan lines and samples closer than this are read as one: the map is no finer."""

LIT_WINDOW = 1.2
"""mm along a scan line over which its brightness is averaged before it is asked how far sound came."""

DARK = 0.1
"""An image whose mean is below this share of white has lost contact, or has no gain."""

UNLIT = 0.02
"""What a sample counts that no sound reached, against one that it did."""

BEHIND = 3.0
"""mm behind bone that a frame shows, from where on what it shows counts little: sound does not pass."""

NEGLIGIBLE = 0.02
"""A probability below it counts as none: networks are never quite sure, and most of an image is no bone."""

HALVED = 0.05
"""mm^2 of lit image per mm^3 at which the mean of the predictions is halved: where no frame passed, nothing is known."""

FULL_SHARE, FULL_PERCENTILE = 0.5, 90
"""Bone is certain where the map reaches this percentile of its voxels above this share of its largest value."""

LEAST_FULL = 0.2
"""What that is taken for at least: frames that are nowhere sure of bone make no certain map."""


def white_of(image: Numbers) -> float | None:
    """The largest gray level of an image of whole numbers; None of others."""
    return float(np.iinfo(image.dtype.name).max) if image.dtype.kind in "iu" else None


@dataclass(frozen=True, eq=False)
class Prediction:
    """Where bone is in one frame, as a network or a rule has it."""

    probability: Singles  #: (rows, columns), 0 to 1. Of any size.
    rectangle: Rectangle | None = None
    """(x, y, width, height). What it covers, in pixels of the frame; None: all of it."""


@dataclass(frozen=True, eq=False)
class BoneSamples:
    """A prediction at samples of a frame's scan lines, and how much each counts."""

    pixels: Floats  #: (n, 2). Column and row of each.
    beams: Floats
    """(lines, 2). Along the sound in mm, of unit length, for each scan line; `line` (n,) says which is whose."""
    line: Integers  #: (n,)
    probability: Singles  #: (n,)
    weight: Singles  #: (n,), mm^2. The area that each stands for, times how lit it was.


class PredictionSampler:
    """Reads predictions along scan lines and weighs them, for images of one size, spacing and probe.

    A frame knows of bone where its sound came. With the image's brightness q along a line (mean of `LIT_WINDOW`), S the largest q from a
    sample to the end of its line and m the mean of what is not black in the image (of whole numbers at least `DARK` of their largest), a
    sample is lit by min(1, S / m)^2; behind bone that the frame itself shows, `BEHIND` mm and more, by one minus the largest probability
    before.

    `size` is (columns, rows), `spacing` (x, y) in mm; `imaging` must know region and probe.
    """

    def __init__(self, size: tuple[int, int], spacing: tuple[float, float], imaging: Imaging):
        self.lines = lines = ScanLineReader(size, spacing, imaging, PITCH, STEP)
        self._whole: Rectangle = (0.0, 0.0, float(size[0]), float(size[1]))
        self._at = np.nonzero(lines.known)
        self._pixels = np.stack([lines.columns[self._at], lines.rows[self._at]], axis=-1)
        way = np.stack([lines.columns[:, -1] - lines.columns[:, 0], lines.rows[:, -1] - lines.rows[:, 0]], axis=-1) * spacing
        self._beams = way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9) / spacing
        samples = np.arange(lines.known.shape[1])
        half = max(round(0.5 * (LIT_WINDOW / lines.step - 1)), 0)
        self._first, self._stop = np.maximum(samples - half, 0), np.minimum(samples + half + 1, samples.size)
        known = running_sum(lines.known)
        self._known = np.maximum(known[:, self._stop] - known[:, self._first], 1.0)
        self._behind = max(round(BEHIND / lines.step), 1)
        self._area = np.float32(lines.pitch * lines.step)

    def sample(self, image: Numbers, prediction: Prediction) -> BoneSamples:
        """A prediction along the scan lines; `image` (rows, columns) is what it was made of."""
        probability = self.lines.read_rectangle(prediction.probability, prediction.rectangle or self._whole)
        weight = self._area * np.maximum(self._lit(image) * self._passed(probability), np.float32(UNLIT))
        return BoneSamples(self._pixels, self._beams, self._at[0], probability[self._at], weight[self._at])

    def _lit(self, image: Numbers) -> Singles:
        values = self.lines.read(image)
        bright = values[values > 0]
        if not bright.size:
            return np.zeros_like(values)
        level = max(float(bright.mean()), DARK * (white_of(image) or 0.0))
        sums = running_sum(values)
        smooth = (sums[:, self._stop] - sums[:, self._first]) / self._known
        farthest = np.maximum.accumulate(smooth[:, ::-1], axis=1)[:, ::-1]
        lit: Singles = (np.minimum(farthest / level, 1.0) ** 2).astype(np.float32)
        return lit

    def _passed(self, probability: Singles) -> Singles:
        """How much of the sound bone has let through before each sample, as far as the frame shows it."""
        passed = np.ones_like(probability)
        shift = self._behind
        passed[:, shift:] -= np.maximum.accumulate(probability, axis=1)[:, : probability.shape[1] - shift]
        return np.maximum(passed, 0.0)


class BoneAccumulator:
    """Adds up the predictions of frames on the voxels of a map.

    A voxel's probability is the mean of the predictions there, weighted by how lit their frames were, over voxels that a Gaussian weights
    too (so that gaps between frames are closed), and falls to 0 where none passed. It is then divided by its percentile `FULL_PERCENTILE`
    where it is high, for a surface is thin: its smoothed probability is below what was predicted on it, and on what is certain bone it
    should be 1. V_dir is its gradient with the sign of the mean beam there, smoothed by as much again, so that it has a side on the very
    ridge. Frames may be added by one thread while another asks for `news`: a frame that is added meanwhile comes with the next.

    The voxels of `grid` are cubes along perpendicular axes; `sigma` (mm) smooths the map as wide as the spacing of frames asks.
    """

    def __init__(self, grid: VoxelGrid, sigma: float = SIGMA):
        self.grid, self.sigma = grid, sigma
        self._bone, self._lit = (np.zeros(grid.shape, dtype=np.float32) for _ in range(2))
        self._beams = np.zeros((3, *grid.shape), dtype=np.float32)
        self._full = 0.0
        self._changed: tuple[Integers, Integers] | None = None
        self._lock = threading.Lock()

    def add(self, samples: BoneSamples, image_to_reference: Matrix) -> None:
        """Add a frame at its pose, pixels to mm."""
        column, row = samples.pixels.T
        to_ijk = (self.grid.reference_to_ijk @ image_to_reference)[:3]
        # Axis by axis: rows of three take several times as long
        i, j, k = (np.floor(of_column * column + of_row * row + (shift + 0.5)).astype(np.int64) for of_column, of_row, _, shift in to_ijk)
        within = np.logical_and.reduce([(n >= 0) & (n < size) for n, size in zip((i, j, k), self.grid.size, strict=True)])
        if not within.any():
            return
        i, j, k = (n[within] for n in (i, j, k))
        weight, probability = (values[within] for values in (samples.weight, samples.probability))
        at = (k * self.grid.size[1] + j) * self.grid.size[0] + i
        np.add.at(self._lit.reshape(-1), at, weight)
        some = np.flatnonzero(probability >= NEGLIGIBLE)
        at, bone = at[some], weight[some] * probability[some]
        np.add.at(self._bone.reshape(-1), at, bone)
        # A gradient per voxel times these is its slope along the beam, whatever the voxels' axes
        beams = samples.beams @ image_to_reference[:3, :2].T @ np.linalg.inv(self.grid.ijk_to_reference[:3, :3]).T
        beam = beams.astype(np.float32)[samples.line[within][some]]
        for axis in range(3):
            np.add.at(self._beams[axis].reshape(-1), at, bone * beam[:, axis])
        low, high = (np.array([end(n) for n in (i, j, k)]) for end in (np.min, np.max))
        with self._lock:
            if self._changed is not None:
                low, high = np.minimum(low, self._changed[0]), np.maximum(high, self._changed[1])
            self._changed = low, high

    @property
    def shows_bone(self) -> bool:
        """Whether any frame showed any."""
        return bool(self._bone.any())

    def renew(self) -> None:
        """The next `news` are of the whole map."""
        self._changed = np.zeros(3, dtype=np.int64), np.array(self.grid.size) - 1

    def map(self, progress: Progress | None = None) -> BoneMap:
        """The map as far as it is known."""
        whole = tuple(slice(0, n) for n in self.grid.shape)
        return self._drawn((whole[0], whole[1], whole[2]), progress)

    def news(self, pause: Callable[[], object] = lambda: None) -> tuple[BoneMap, Box] | None:
        """The part of the map that has changed since this was asked last, and the box of its voxels [k, j, i] that hold good.

        `pause` is called between steps, so that others get the processor. Certain bone is what was surest until now.
        """
        with self._lock:
            changed, self._changed = self._changed, None
        if changed is None:
            return None
        reach = np.ceil(GAUSSIAN_REACH * self.sigma / self.grid.spacing).astype(int) + 1
        # What has changed spreads by two Gaussians, and bone is all that it can change
        near = self._box(*changed, 2 * reach)
        shown = self._bone[near] > 0
        along = [np.flatnonzero(shown.any(axis=others)) for others in ((1, 2), (0, 2), (0, 1))]
        if not along[0].size:
            return None
        low, high = (np.array([side.start + at[end] for side, at in zip(near, along, strict=True)])[::-1] for end in (0, -1))
        # The voxels at the border want as many more around them
        return self._drawn(self._box(low, high, 4 * reach), None, pause), self._box(low, high, 2 * reach)

    def _box(self, low: Integers, high: Integers, margin: Integers) -> Box:
        """The voxels [k, j, i] from `low` to `high` (i, j, k) and so many around them."""
        first, stop = np.maximum(low - margin, 0).tolist(), np.minimum(high + margin + 1, self.grid.size).tolist()
        return slice(first[2], stop[2]), slice(first[1], stop[1]), slice(first[0], stop[0])

    def _drawn(self, box: Box, progress: Progress | None, pause: Callable[[], object] = lambda: None) -> BoneMap:
        """The map of a box of voxels [k, j, i]."""
        sigma = self.sigma / self.grid.spacing[::-1]

        def smooth(values: Singles) -> Singles:
            pause()
            blurred: Singles = scipy.ndimage.gaussian_filter(values, sigma, mode="constant", truncate=GAUSSIAN_REACH, output=np.float32)
            return blurred

        report(progress, 0.0, "Drawing the bone map")
        mean = smooth(self._bone[box]) / (smooth(self._lit[box]) + np.float32(HALVED * np.prod(self.grid.spacing)))
        report(progress, 0.3, "Drawing the bone map")
        largest = float(mean.max(initial=0.0))
        if largest > 0:
            self._full = max(self._full, float(np.percentile(mean[mean >= FULL_SHARE * largest], FULL_PERCENTILE)))
        probability = np.minimum(mean / np.float32(max(self._full, LEAST_FULL)), np.float32(1.0))
        pause()
        slopes = np.stack([scipy.ndimage.sobel(probability, axis=2 - axis, mode="nearest") for axis in range(3)])
        facing = np.zeros_like(probability)
        for axis in range(3):
            facing += slopes[axis] * smooth(self._beams[(axis, *box)])
        report(progress, 0.7, "Drawing the bone map")
        slopes *= np.where(facing < 0, np.float32(-1.0), np.float32(1.0))
        slopes = np.stack([smooth(slope) for slope in slopes])
        report(progress, 1.0, "Drew the bone map")
        matrix = self.grid.ijk_to_reference.copy()
        matrix[:3, 3] += matrix[:3, :3] @ [side.start for side in box[::-1]]
        return BoneMap(Volume(probability, matrix), slopes=slopes)


def cubes_over(grid: VoxelGrid, margin: float = 0.0) -> VoxelGrid:
    """Cubes of `SPACING` mm over the same box, along its axes, and so much (mm) around it."""
    ratio, before = SPACING / grid.spacing, margin / grid.spacing
    size = np.ceil((np.asarray(grid.size) - 1 + 2 * before) / ratio).astype(int) + 1
    matrix = grid.ijk_to_reference.copy()
    matrix[:3, 3] -= matrix[:3, :3] @ before
    matrix[:3, :3] *= ratio
    i, j, k = (int(n) for n in size)
    return VoxelGrid((i, j, k), matrix)
