"""Bone echoes where the images showed them: another calibration moves them without a second look at the images."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from ..arrays import Floats, Integers, Mask, Matrix, Singles
from ..bone.echoes.found import SweepEchoes
from ..bone.echoes.search import sweep_echoes
from ..errors import GeometryError, NoUsableFramesError
from ..geometry.transforms import affine, invert, pixel_spacing
from ..progress import Progress
from ..recipe.recipe import LONGEST_GAP, Recipe
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import sweeps_of
from ..sweep.poses import SweepPoses, poses_of_each

SAME_ANGLE_DEG = 10.0
"""Frames whose images are turned by less than this against each other were taken from one angle."""

SAME_SIZE = 1e-3
"""Part by which the sizes of pixels of one calibration may differ: files round."""

MOST_FRAMES = 600
"""Frames of all sweeps together that are looked at."""


@dataclass(frozen=True, eq=False)
class Correction:
    """What is wrong with a calibration, as a change of the image plane and of time.

    A point q of the image plane, in mm as the old calibration has it, goes to ``center + turn @ (scale * (q - center)) + shift``.
    """

    turn: Matrix  #: (3, 3), a rotation
    shift: Floats  #: (3,), mm: across, along the image, and out of it
    scale: Floats  #: (2,). New size of a pixel over the old one, across and along.
    delay: float  #: s. Poses belong to images that were taken so much before.
    center: Floats  #: (3,), mm, in the image plane

    @classmethod
    def none(cls, center: Floats) -> Correction:
        """That of a calibration in which nothing is wrong."""
        return cls(np.eye(3), np.zeros(3), np.ones(2), 0.0, center)

    @classmethod
    def of_plane(cls, plane: Matrix, center: Floats) -> Correction:
        """That of a rigid `plane`, (4, 4), with no delay."""
        return cls(plane[:3, :3], plane[:3, :3] @ center + plane[:3, 3] - center, np.ones(2), 0.0, center)

    def then(self, other: Correction) -> Correction:
        """Of the calibration that this corrects, what corrects it further; both but for sizes and delay."""
        return Correction.of_plane(self.plane @ other.plane, self.center)

    @property
    def plane(self) -> Matrix:
        """(4, 4): of the image plane in mm, from where the new calibration is applied to where the old one would have it."""
        linear = self.turn @ np.diag([*self.scale, 1.0])
        return affine(linear, self.center + self.shift - linear @ self.center)

    def of_pixels(self, spacing: tuple[float, float]) -> Matrix:
        """(4, 4): old calibration @ this = new calibration, and image_to_reference @ this = the mended pose; `spacing` is the old one."""
        in_mm = np.diag([*spacing, 1.0, 1.0])
        return invert(in_mm) @ self.plane @ in_mm


@dataclass(frozen=True, eq=False)
class _PlaneTrack:
    """Where the image plane was all through one sweep."""

    times: Floats  #: (n,), s, rising
    planes: Matrix  #: (n, 4, 4), mm in the image plane to mm in Reference

    @cached_property
    def turns(self) -> Floats:
        """(n - 1, 3): rotation vectors from each plane to the next, about axes of the former."""
        between = self.planes[:-1, :3, :3].transpose(0, 2, 1) @ self.planes[1:, :3, :3]
        vectors: Floats = scipy.spatial.transform.Rotation.from_matrix(between).as_rotvec()
        return vectors

    def at(self, times: Floats) -> Matrix:
        """The planes at times (m,), (m, 4, 4): between two frames, or beyond the last of an unbroken run as the two before it moved."""
        runs = np.concatenate([[0], np.cumsum(np.diff(self.times) > LONGEST_GAP)])
        nearest = np.searchsorted((self.times[1:] + self.times[:-1]) / 2, times)
        # Of the nearest frame's run; its ends go on as they came, and a frame that is alone in its run stays where it is
        first, last = np.searchsorted(runs, runs[nearest]), np.searchsorted(runs, runs[nearest], side="right") - 1
        low = np.clip(np.searchsorted(self.times, times, side="right") - 1, first, np.maximum(last - 1, first))
        high = np.minimum(low + 1, last)
        span = self.times[high] - self.times[low]
        share = np.where(span > 0, (times - self.times[low]) / np.where(span > 0, span, 1.0), 0.0)
        result = self.planes[low].copy()
        vectors = self.turns[np.minimum(low, max(len(self.turns) - 1, 0))] if len(self.turns) else np.zeros((len(times), 3))
        turned = scipy.spatial.transform.Rotation.from_rotvec(vectors * share[:, None]).as_matrix()
        result[:, :3, :3] = self.planes[low, :3, :3] @ turned
        result[:, :3, 3] += share[:, None] * (self.planes[high, :3, 3] - self.planes[low, :3, 3])
        return result


@dataclass(frozen=True, eq=False)
class ImagedEchoes:
    """Bone echoes in the image plane, and the frames that showed them."""

    points: Floats  #: (n, 3), mm in the image plane, z = 0
    beams: Floats  #: (n, 3), unit vectors in the image plane
    scores: Singles  #: (n,)
    frames: Integers  #: (n,). Rows of what is told of each frame below.
    numbers: Integers  #: (frames,). Of each frame that shows an echo, counted over all sweeps.
    times: Floats  #: (frames,), s. Of each frame that shows an echo; NaN where there are none.
    planes: Matrix  #: (frames, 4, 4). Where the old calibration places each image plane, mm to Reference.
    sweeps: Integers  #: (frames,). Which of `tracks` it belongs to.
    angles: Integers  #: (frames,). Frames of one number were taken from about one angle.
    tracks: tuple[_PlaneTrack, ...]  #: One for each sweep
    spacing: tuple[float, float]  #: mm. Of a pixel, by the old calibration.
    frame_size: tuple[int, int]  #: columns, rows

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, chosen: Mask | Integers) -> ImagedEchoes:
        return replace(self, points=self.points[chosen], beams=self.beams[chosen], scores=self.scores[chosen], frames=self.frames[chosen])

    @property
    def center(self) -> Floats:
        """(3,), mm. The middle of the echoes in the image plane."""
        center: Floats = self.points.mean(axis=0)
        return center

    def moved(self, plane: Matrix) -> ImagedEchoes:
        """The same by the calibration after which this rigid motion of the image plane, (4, 4), comes first."""
        tracks = tuple(replace(track, planes=track.planes @ plane) for track in self.tracks)
        return replace(self, planes=self.planes @ plane, tracks=tracks)

    @property
    def timed(self) -> bool:
        """Whether a delay can be looked for: frames have times and the probe moved."""
        return bool(np.isfinite(self.times).all()) and all(len(np.unique(track.times)) > 1 for track in self.tracks)

    def planes_at(self, delay: float) -> Matrix:
        """Where each frame's image plane was `delay` s after its time stamp, (frames, 4, 4)."""
        if delay == 0 or not self.timed:
            return self.planes
        result = self.planes.copy()
        for number, track in enumerate(self.tracks):
            mine = self.sweeps == number
            result[mine] = track.at(self.times[mine] + delay)
        return result

    def placed(self, correction: Correction) -> SweepEchoes:
        """The echoes in Reference, by the old calibration with this correction."""
        planes = self.planes_at(correction.delay)[self.frames] @ correction.plane
        points = np.einsum("nij,nj->ni", planes[:, :3, :3], self.points) + planes[:, :3, 3]
        beams = np.einsum("nij,nj->ni", planes[:, :3, :3], self.beams)
        return SweepEchoes(points, beams / np.linalg.norm(beams, axis=1, keepdims=True), self.scores, self.frames)

    def mended(self, correction: Correction) -> ImagedEchoes:
        """The same echoes by a calibration that is corrected so; its delay is left out."""
        size, change = np.array([*correction.scale, 1.0]), correction.plane
        change[:3, :3] = correction.turn
        beams = self.beams * size
        return replace(
            self.moved(change),
            points=self.points * size,
            beams=beams / np.linalg.norm(beams, axis=1, keepdims=True),
            spacing=(self.spacing[0] * correction.scale[0], self.spacing[1] * correction.scale[1]),
        )

    def spread(self, most: int) -> ImagedEchoes:
        """At most so many, as many of each angle, evenly in space within it: no angle and no place rules."""
        placed = self.placed(Correction.none(self.center))
        of = self.angles[self.frames]
        numbers = np.unique(of)
        kept = []
        for number in numbers:
            mine = np.flatnonzero(of == number)
            # Scores pick within a cube; row numbers come back through `frames`
            rows = SweepEchoes(placed.points[mine], placed.beams[mine], placed.scores[mine], mine)
            kept.append(rows.thinned(max(most // len(numbers), 1)).frames)
        return self[np.sort(np.concatenate(kept))]


def imaged_echoes(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    recipe: Recipe | None = None,
    progress: Progress | None = None,
    known: SweepEchoes | None = None,
) -> ImagedEchoes:
    """The bone echoes of one or more sweeps in one Reference, as the images show them; errors are those of `sweep_echoes`.

    `known` are those that it has found of the same sweeps already.
    """
    recipe = recipe or Recipe()
    sweeps = sweeps_of(sequences, recipe)
    found = known or sweep_echoes(sweeps, recipe, most_frames=MOST_FRAMES, progress=progress)
    poses = poses_of_each(sweeps, recipe.image_to_reference, recipe.reference)
    sizes = [pixel_spacing(pose.image_to_reference[pose.usable[0]]) for pose in poses]
    spacing = sizes[0]
    if not np.allclose(sizes, spacing, rtol=SAME_SIZE):
        raise GeometryError(
            "Sweeps that are calibrated together must have pixels of one size. Calibrate those of each depth by themselves."
        )
    planes, tracks = _planes(sweeps, poses, spacing)
    numbers, frames = np.unique(found.frames, return_inverse=True)
    shown = planes[numbers]
    to_plane = np.linalg.inv(shown)[frames]
    points = np.einsum("nij,nj->ni", to_plane[:, :3, :3], found.points) + to_plane[:, :3, 3]
    beams = np.einsum("nij,nj->ni", to_plane[:, :3, :3], found.beams)
    return ImagedEchoes(
        points,
        beams,
        found.scores,
        frames,
        numbers,
        np.concatenate([sweep.timestamps for sweep in sweeps])[numbers],
        shown,
        np.repeat(np.arange(len(sweeps)), [len(sweep) for sweep in sweeps])[numbers],
        _angles(shown),
        tracks,
        spacing,
        sweeps[0].frame_size,
    )


def replaced(echoes: ImagedEchoes, sequences: TrackedSequence | Iterable[TrackedSequence], recipe: Recipe | None = None) -> ImagedEchoes:
    """The same echoes of the same images, placed by the poses of other sequences; raises as `sweep_poses` where those place nothing."""
    recipe = recipe or Recipe()
    sweeps = sweeps_of(sequences, recipe)
    planes, tracks = _planes(sweeps, poses_of_each(sweeps, recipe.image_to_reference, recipe.reference), echoes.spacing)
    shown = planes[echoes.numbers]
    lost = ~np.isfinite(shown).all(axis=(1, 2))
    if lost.any():
        raise NoUsableFramesError(f"{int(lost.sum())} frames have no pose any more.")
    return replace(echoes, planes=shown, tracks=tracks, angles=_angles(shown))


def _planes(
    sweeps: Sequence[TrackedSequence], poses: Sequence[SweepPoses], spacing: tuple[float, float]
) -> tuple[Matrix, tuple[_PlaneTrack, ...]]:
    """Where the image plane of every frame lies, (frames of all, 4, 4), mm to mm, NaN where nothing places it; and that of each in time."""
    tracks, planes = [], []
    for sweep, pose in zip(sweeps, poses, strict=True):
        matrices = pose.image_to_reference @ invert(np.diag([*spacing, 1.0, 1.0]))
        matrices[:, :3, 2] = np.cross(matrices[:, :3, 0], matrices[:, :3, 1])
        usable = pose.usable
        usable = usable[np.argsort(sweep.timestamps[usable], kind="stable")]
        tracks.append(_PlaneTrack(sweep.timestamps[usable], matrices[usable]))
        planes.append(matrices)
    return np.concatenate(planes), tuple(tracks)


def _angles(planes: Matrix) -> Integers:
    """Numbers of the angles from which frames (n, 4, 4) were taken: one within `SAME_ANGLE_DEG` of an angle's first frame is of it."""
    numbers = np.full(len(planes), -1)
    number = 0
    while (numbers < 0).any():
        first = planes[int(np.argmax(numbers < 0)), :3, :3]
        cosine = (np.einsum("ij,nij->n", first, planes[:, :3, :3]) - 1) / 2
        numbers[(numbers < 0) & (cosine >= np.cos(np.radians(SAME_ANGLE_DEG)))] = number
        number += 1
    return numbers
