"""What a network should say of a frame, by labels that lie where the bone truly is, and how well an estimator says it."""

from __future__ import annotations

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from AIFReconLib.bone.echoes.found import BoneEchoes
from AIFReconLib.bone.predicted_bone import BoneEstimator
from AIFReconLib.bone.predictions import Prediction
from AIFReconLib.bone.scan_line_reader import ScanLineReader
from AIFReconLib.effective_settings import Imaging
from AIFReconLib.geometry.transforms import pixel_spacing
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.sweep.frames import TrackedFrame, TrackedSequence
from AIFReconLib.sweep.poses import SweepPoses, tracked_frames

NEAR = 1.5
"""mm from the surface that are bone to a network, and within which an answer is right."""

AROUND = 8.0
"""mm from the labeled bone within which answers are judged: the next bone may have no labels."""


class TrueBone:
    """Labels as an estimator that is always right: bone within `NEAR` of the surface and first along the beam.

    Parameters
    ----------
    labels : Volume of integers, in Reference
    imaging : Imaging
        Region and probe; both known.
    """

    def __init__(self, labels: Volume, imaging: Imaging):
        bone, spacing = labels.array > 0, labels.grid.spacing[::-1]
        inside, outside = (ndimage.distance_transform_edt(part, sampling=spacing) for part in (bone, ~bone))
        self._distance = (outside - inside).astype(np.float32)
        self._to_labels, self._imaging = labels.grid.reference_to_ijk, imaging
        self._readers: dict[tuple[object, ...], ScanLineReader] = {}
        self._nearest: dict[int, np.ndarray] = {}

    def reader(self, frame: TrackedFrame) -> ScanLineReader:
        """The scan lines of a frame."""
        image, pose = frame.placed()
        size, spacing = (int(image.shape[1]), int(image.shape[0])), pixel_spacing(pose)
        key = (size, *np.round(spacing, 6))
        if key not in self._readers:
            self._readers[key] = ScanLineReader(size, spacing, self._imaging)
        return self._readers[key]

    def along(self, frame: TrackedFrame) -> tuple[np.ndarray, np.ndarray]:
        """Distance from the surface of every sample, (lines, samples) mm, negative inside; first sample in bone, -1 without."""
        lines, pose = self.reader(frame), frame.placed()[1]
        to_ijk = self._to_labels @ pose
        ijk = to_ijk[:3, :2] @ np.stack([lines.columns.ravel(), lines.rows.ravel()]) + to_ijk[:3, 3:]
        distance = ndimage.map_coordinates(self._distance, ijk[::-1], order=1, mode="nearest").reshape(lines.columns.shape)
        inside = (distance <= 0) & lines.known
        return distance, np.where(inside.any(axis=1), inside.argmax(axis=1), -1)

    def on_lines(self, frame: TrackedFrame) -> np.ndarray:
        """1 where bone should be said, (lines, samples) float32."""
        lines, (distance, first) = self.reader(frame), self.along(frame)
        sample = np.arange(distance.shape[1]) - first[:, None]
        reach = NEAR / lines.step
        return ((np.abs(distance) <= NEAR) & (first[:, None] >= 0) & (sample <= reach) & (sample >= -3 * reach)).astype(np.float32)

    def estimate(self, frame: TrackedFrame) -> Prediction:
        """See `BoneEstimator`."""
        lines, (rows, columns) = self.reader(frame), frame.placed()[0].shape
        key = id(lines)
        if key not in self._nearest:
            samples = cKDTree(np.stack([lines.columns.ravel(), lines.rows.ravel()], axis=1))
            pixels = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1)
            self._nearest[key] = np.asarray(samples.query(pixels)[1])
        return Prediction(self.on_lines(frame).ravel()[self._nearest[key]])

    def notes(self) -> tuple[str, ...]:
        """Nothing."""
        return ()


def drawn(echoes: BoneEchoes, lines: ScanLineReader) -> np.ndarray:
    """The score of each echo at the sample nearest to it, (lines, samples); 0 at all others."""
    probability = np.zeros(lines.columns.size, np.float32)
    samples = cKDTree(np.stack([lines.columns.ravel(), lines.rows.ravel()], axis=1))
    probability[samples.query(echoes.pixels)[1]] = echoes.scores
    return probability.reshape(lines.columns.shape)


def worth_of(
    estimator: BoneEstimator, truth: TrueBone, sequence: TrackedSequence, poses: SweepPoses, every: int, sure: float
) -> tuple[float, float, float]:
    """Ask the estimator about every so many frames; per line its surest sample within `AROUND` of the bone counts, from `sure` on.

    Returns
    -------
    precision, recall : float
        Of lines where bone is said, how many say it within `NEAR` of where it begins; of lines with bone, how many are told so.
    median_mm : float
        Distance of right answers from where bone begins.
    """
    said = there = 0
    errors = [np.empty(0)]
    for frame in tracked_frames(sequence, poses, poses.usable[::every]):
        lines, (distance, first) = truth.reader(frame), truth.along(frame)
        told = estimator.estimate(frame)
        if told is None:
            continue
        assert not isinstance(told, np.ndarray), "estimators of the library say what a prediction covers"
        if isinstance(told, BoneEchoes):
            probability = drawn(told, lines)
        else:
            image = frame.placed()[0]
            whole = (0.0, 0.0, float(image.shape[1]), float(image.shape[0]))
            probability = lines.read_rectangle(told.probability, told.rectangle or whole)
        probability = np.where(np.abs(distance) <= AROUND, probability, 0.0)
        best = probability.max(axis=1)
        # The middle of what is as sure as the surest
        top = probability >= np.maximum(best, 1e-6)[:, None] * 0.98
        place = (top * np.arange(top.shape[1])).sum(axis=1) / np.maximum(top.sum(axis=1), 1)
        says, off = best >= sure, np.abs(place - first) * lines.step
        hit = says & (first >= 0) & (off <= NEAR)
        said, there = said + int(says.sum()), there + int((first >= 0).sum())
        errors.append(off[hit])
    right = np.concatenate(errors)
    return right.size / max(said, 1), right.size / max(there, 1), float(np.median(right)) if right.size else np.nan
