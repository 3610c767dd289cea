"""The mean shape of the lumbar vertebrae of 87 patients (shared/data/lumbar-shape), and how far behind a vertebra of ours lies from it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from AIFReconLib.arrays import Floats, Mask
from AIFReconLib.evaluation.surface import bone_surface
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.io.volume.models import read_model
from AIFReconLib.simulation.vertebra import VERTEBRA_BOX, Vertebra

TURNS_DEG = (-30.0, 0.0, 30.0)
"""From where a surface is seen from behind: straight, and from as far to either side as the simulated probe is tilted."""

CELL, DEEPER = 1.0, 2.0
"""mm. In a cell of this size seen, what lies this much deeper than the nearest point is hidden by it."""

THINNED = 12
"""One of so many points is used to find the motion; all are measured."""


def mean_points(folder: Path, level: str) -> Floats:
    """Points on the mean shape of a level about 0.5 mm apart, (n, 3), mm, RAS: corners of its triangles and their middles."""
    model = read_model(folder / f"{level}.stl")
    return np.concatenate([model.points, model.points[model.triangles].mean(axis=1)])


def own_points(vertebra: Vertebra, spacing: float = 0.9) -> Floats:
    """Points on a vertebra of the phantom about as dense, (n, 3), mm, vertebra frame."""
    low, high = np.array(VERTEBRA_BOX)
    grid = VoxelGrid.from_spacing(low, (np.ceil((high - low) / spacing).astype(int) + 1).tolist(), spacing)
    x, y, z = (low[axis] + spacing * np.arange(grid.size[axis], dtype=np.float32) for axis in range(3))
    z, y, x = np.meshgrid(z, y, x, indexing="ij", copy=False)
    return bone_surface(Volume(vertebra.distance(x, y, z), grid.ijk_to_reference), pitch=0.0).points_reference


def seen_from_behind(points: Floats, back_wall_y: float) -> Mask:
    """Which points are seen from behind and lie behind the body's back wall: arch and processes."""
    seen = np.zeros(len(points), bool)
    for turn in TURNS_DEG:
        turned = Rotation.from_euler("z", turn, degrees=True).apply(points)
        column, row = (np.floor(turned[:, axis] / CELL).astype(int) for axis in (0, 2))
        cell = (column - column.min()) * (np.ptp(row) + 1) + row - row.min()
        nearest = np.full(cell.max() + 1, np.inf)
        np.minimum.at(nearest, cell, turned[:, 1])
        seen |= turned[:, 1] <= nearest[cell] + DEEPER
    return seen & (points[:, 1] < back_wall_y)


def distances_behind(vertebra: Vertebra, folder: Path, rounds: int = 15) -> Floats:
    """Distances, mm, from what is seen from behind of each of both surfaces to the other one, after a rigid fit of just that."""
    own, back_wall_y = own_points(vertebra), vertebra.body_center[1] - vertebra.sizes.body_depth / 2
    moving = mean_points(folder, vertebra.name)
    moving += (own.min(axis=0) + own.max(axis=0) - moving.min(axis=0) - moving.max(axis=0)) / 2
    target = own[seen_from_behind(own, back_wall_y)]
    target_tree = cKDTree(target)
    for _ in range(rounds):
        seen = moving[seen_from_behind(moving, back_wall_y)]
        there = target_tree.query(seen[::THINNED])[1]
        back = cKDTree(seen).query(target[::THINNED])[1]
        source = np.concatenate([seen[::THINNED], seen[back]])
        goal = np.concatenate([target[there], target[::THINNED]])
        middle = source.mean(axis=0)
        turn, _ = Rotation.align_vectors(goal - goal.mean(axis=0), source - middle)
        moving = turn.apply(moving - middle) + goal.mean(axis=0)
    seen = moving[seen_from_behind(moving, back_wall_y)]
    return np.concatenate([cKDTree(own).query(seen)[0], cKDTree(moving).query(target)[0]])
