"""A made-up sweep over a plane of bone, oblique to everything, with what an estimator that knows it all would say of every frame."""

from __future__ import annotations

import numpy as np
from sweeps import image_pose

from AIFReconLib.bone.echoes.found import SweepEchoes
from AIFReconLib.bone.predicted_bone import PointsOfFrames
from AIFReconLib.bone.predictions import Prediction
from AIFReconLib.effective_settings import Imaging
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.imaging.beams import LINEAR, ProbeGeometry
from AIFReconLib.imaging.region import ImageRegion
from AIFReconLib.sweep.frames import FrameRecord, TrackedFrame, TrackedSequence
from AIFReconLib.sweep.poses import SweepPoses

COLUMNS, ROWS, SPACING = 60, 80, (0.5, 0.5)
IMAGING = Imaging(ImageRegion(), ProbeGeometry(LINEAR))
THICKNESS = 1.5
"""mm to either side of the plane that are said to be bone."""


class PlaneSweep:
    """Frames 1 mm apart, turned by a few degrees each, over a plane 20 mm deep."""

    def __init__(self, count=12, turn=3.0, spacing=SPACING):
        first = image_pose(spacing, (25.0, -35.0, 50.0), (12.0, -40.0, 75.0))
        self.normal = first[:3, 1] / np.linalg.norm(first[:3, 1]) + 0.3 * first[:3, 0] / np.linalg.norm(first[:3, 0])
        self.normal /= np.linalg.norm(self.normal)
        """Along the sound, from tissue into bone."""
        across = first[:3, 2] / np.linalg.norm(first[:3, 2])
        self.point = transform_points(first, np.array([[COLUMNS / 2, ROWS / 2, 0.0]]))[0]
        poses = []
        for number in range(count):
            tilt = image_pose((1.0, 1.0), (turn * (number - count / 2), 0.0, 0.0))
            about = np.eye(4)
            about[:3, 3] = [COLUMNS / 2 * spacing[0], 0.0, 0.0]
            pixels = np.diag([*spacing, 0.5, 1.0])
            pose = first @ np.linalg.inv(pixels) @ about @ tilt @ np.linalg.inv(about) @ pixels
            pose[:3, 3] += (number - count / 2) * across
            poses.append(pose)
        self.poses = np.array(poses)
        rng = np.random.default_rng(0)
        self.images = np.where(self.depths() < 0, rng.integers(60, 120, (count, ROWS, COLUMNS)), 3).astype(np.uint8)
        self.images[np.abs(self.depths()) < 0.6] = 220
        self.sequence = TrackedSequence.from_arrays(self.images, self.poses, 5.0 + 0.1 * np.arange(count))
        self.swept = SweepPoses(self.poses, (None,) * count, ())

    def depths(self, columns=COLUMNS, rows=ROWS, rectangle=(0.0, 0.0, COLUMNS, ROWS)) -> np.ndarray:
        """mm behind the plane of every pixel of images of this size that cover a rectangle of the frames, (frames, rows, columns)."""
        x, y, width, height = rectangle
        column = x + (np.arange(columns) + 0.5) * width / columns - 0.5
        row = y + (np.arange(rows) + 0.5) * height / rows - 0.5
        pixels = np.stack([*np.meshgrid(column, row), np.zeros((rows, columns))], axis=-1)
        return np.array([(transform_points(pose, pixels.reshape(-1, 3)) - self.point) @ self.normal for pose in self.poses]).reshape(
            -1, rows, columns
        )

    def predictions(self, **size) -> np.ndarray:
        """1 near the plane, 0 elsewhere, (frames, rows, columns) float32."""
        return (np.abs(self.depths(**size)) <= THICKNESS).astype(np.float32)

    def echoes(self) -> list[SweepEchoes]:
        """What each frame tells by these predictions."""
        points, said = PointsOfFrames(IMAGING), self.predictions()
        frames = [TrackedFrame(image, pose, number=n) for n, (image, pose) in enumerate(zip(self.images, self.poses))]
        return [points.of(frame, Prediction(said[n])) for n, frame in enumerate(frames)]

    def on_plane(self, depth=0.0, step=2.0, half=4) -> np.ndarray:
        """Points in Reference that lie `depth` mm behind the plane, about the middle of the sweep, (n, 3)."""
        along = np.linalg.svd(self.normal[None])[2][1:]
        steps = step * (np.arange(2 * half + 1) - half)
        return np.array(
            [self.point + depth * self.normal + a * along[0] + b * along[1] for a in steps for b in steps if a * a + b * b <= 25]
        )


def as_sequence(images, times=None) -> TrackedSequence:
    """Images without transforms, as a network's predictions are saved."""
    return TrackedSequence(
        np.asarray(images), [FrameRecord(timestamp=None if times is None else float(times[n])) for n in range(len(images))]
    )


def bent(count=90, seed=0) -> SweepEchoes:
    """Echoes scattered about a bent sheet far from the origin, seen from several sides, and some in its shadow."""
    random = np.random.default_rng(seed)
    x, y, deep = random.uniform(0, 9, count), random.uniform(0, 8, count), np.where(np.arange(count) % 6, 0.0, random.uniform(4, 9, count))
    beams = np.stack([random.uniform(-0.5, 0.5, count), random.uniform(-0.2, 0.2, count), np.ones(count)], axis=1)
    points = np.stack([x - 412.3, y + 88.1, 1020.7 + 0.05 * x**2 + 0.3 * y + deep + random.normal(0, 0.3, count)], axis=1)
    beams /= np.linalg.norm(beams, axis=1, keepdims=True)
    return SweepEchoes(points, beams, random.uniform(0.35, 1, count).astype(np.float32), np.arange(count))
