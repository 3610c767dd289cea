"""What the benchmark reconstructs beside the sweep of `aifrecon benchmark`: the same turned, labels, and holes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from AIFReconLib.geometry.transforms import affine
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.sweep.frames import TrackedFrame
from AIFReconLib.workflows.benchmark import sector_probe

COLUMNS, ROWS = 640, 480
TURN_DEG = 25.0
"""How far a sweep is turned about each axis of Reference that does not lie along the grid."""

PROBE = sector_probe(COLUMNS, ROWS)


def turned(sweep: list[TrackedFrame], degrees: float) -> list[TrackedFrame]:
    """The sweep, turned about each axis of Reference."""
    turn = affine(Rotation.from_euler("xyz", [degrees] * 3, degrees=True).as_matrix())
    return [replace(frame, image_to_reference=turn @ frame.placed()[1]) for frame in sweep]


def labels_of_size(voxels: int) -> Volume:
    """A cube of so many voxels of 0.5 mm, with a plate of bone through most of it."""
    edge = max(round(voxels ** (1 / 3)), 12)
    labels = np.zeros((edge,) * 3, np.uint8)
    inner = slice(edge // 10, edge - edge // 10)
    labels[inner, inner, edge // 3 : 2 * edge // 3] = 1
    return Volume(labels, np.diag([0.5, 0.5, 0.5, 1.0]))


def half_empty(voxels: int) -> tuple[np.ndarray, np.ndarray]:
    """Values and mask [k, j, i] of a cube of which every second voxel, at random, was measured."""
    edge = max(round(voxels ** (1 / 3)), 4)
    rng = np.random.default_rng(2)
    mask = (rng.random((edge,) * 3, dtype=np.float32) < 0.5).astype(np.uint8)
    return rng.random(mask.shape, dtype=np.float32), mask
