"""What the benchmark reconstructs: a made-up sweep, bone in it, and holes."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from .arrays import Bytes, Singles
from .bone.map import BoneMap
from .geometry.transform_graph import TransformName, TransformSample
from .geometry.volume import Volume, VoxelGrid
from .imaging.beams import SECTOR, ProbeGeometry
from .sweep.frames import FrameRecord, TrackedFrame, TrackedSequence

COLUMNS, ROWS, PIXEL = 640, 480, 0.2
"""Size of the benchmark's images, and their pixel pitch in mm."""

FAN_DEG = 30.0
TURN_DEG = 25.0
"""How far a sweep is turned about each axis of Reference that does not lie along the grid."""

LIVE_FRAMES_PER_SECOND = 30.0
PROBE = ProbeGeometry(SECTOR, (COLUMNS / 2, -100.0))


def fan_sweep(frames: int, turn_deg: float = 0.0) -> list[TrackedFrame]:
    """Speckle images, turned step by step through 30 degrees about the x axis of Reference, then all about each of its axes."""
    turned = np.eye(4)
    turned[:3, :3] = Rotation.from_euler("xyz", [turn_deg] * 3, degrees=True).as_matrix()
    image = np.random.default_rng(1).integers(0, 256, (ROWS, COLUMNS), dtype=np.uint8)
    sweep = []
    for number, angle in enumerate(np.radians(np.linspace(-FAN_DEG / 2, FAN_DEG / 2, frames))):
        pose = np.eye(4)
        pose[:3, 0] = PIXEL, 0.0, 0.0
        pose[:3, 1] = 0.0, PIXEL * np.cos(angle), PIXEL * np.sin(angle)
        pose[:3, 2] = 0.0, -PIXEL * np.sin(angle), PIXEL * np.cos(angle)
        pose[0, 3] = -PIXEL * COLUMNS / 2
        sweep.append(TrackedFrame(image, turned @ pose, number / LIVE_FRAMES_PER_SECOND, number=number))
    return sweep


def recorded(sweep: list[TrackedFrame]) -> TrackedSequence:
    """The sweep as a sequence that can be written to a file."""
    name = TransformName("Image", "Reference")
    records = [FrameRecord(timestamp=f.timestamp, transforms={name: TransformSample(f.image_to_reference)}) for f in sweep]
    return TrackedSequence(np.stack([f.image for f in sweep]), records)


def slab_of_bone(grid: VoxelGrid) -> BoneMap:
    """A block of bone in the middle of the grid, as a CT of 1 mm voxels would show it."""
    span = np.array(grid.size) * grid.spacing
    size = np.maximum(np.ceil(span), 8).astype(int)
    labels = np.zeros(size[::-1], np.uint8)
    labels[tuple(slice(n // 3, 2 * n // 3 + 1) for n in labels.shape)] = 1
    matrix = np.eye(4)
    matrix[:3, 3] = grid.origin
    return BoneMap.from_labels(Volume(labels, matrix), sigma_mm=4.0)


def labels_of_size(voxels: int) -> Volume:
    """A cube of so many voxels of 0.5 mm, with a plate of bone through most of it."""
    edge = max(round(voxels ** (1 / 3)), 12)
    labels = np.zeros((edge,) * 3, np.uint8)
    inner = slice(edge // 10, edge - edge // 10)
    labels[inner, inner, edge // 3 : 2 * edge // 3] = 1
    return Volume(labels, np.diag([0.5, 0.5, 0.5, 1.0]))


def half_empty(voxels: int) -> tuple[Singles, Bytes]:
    """Values and mask [k, j, i] of a cube of which every second voxel, at random, was measured."""
    edge = max(round(voxels ** (1 / 3)), 4)
    rng = np.random.default_rng(2)
    mask = (rng.random((edge,) * 3, dtype=np.float32) < 0.5).astype(np.uint8)
    return rng.random(mask.shape, dtype=np.float32), mask
