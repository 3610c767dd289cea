"""Flat cuts through volumes along the anatomical planes, for figures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ..arrays import Floats
from ..geometry.volume import Volume, VoxelGrid


@dataclass(frozen=True)
class Plane:
    """An anatomical plane: its name, and which way (RAS) the picture runs to the right and down."""

    name: str
    right_ras: tuple[float, float, float]
    down_ras: tuple[float, float, float]
    edges: tuple[str, str, str, str]
    """Letters at the left, right, top and bottom edge."""


# Posterior is up where it can be: the probe is then at the top, as on an ultrasound screen
SAGITTAL = Plane("sagittal", (0, 0, -1), (0, 1, 0), ("S", "I", "P", "A"))
AXIAL = Plane("axial", (1, 0, 0), (0, 1, 0), ("L", "R", "P", "A"))
CORONAL = Plane("coronal", (1, 0, 0), (0, 0, -1), ("L", "R", "S", "I"))


def cut(volume: Volume, plane: Plane, center_ras: ArrayLike, width: float, height: float, pitch: float = 0.5, order: int = 1) -> Floats:
    """Sample a volume on a plane.

    Parameters
    ----------
    center_ras : (3,), mm
        The middle of the picture.
    width, height, pitch : float, mm
        Size of the picture and of its pixels.
    order : int
        0 nearest, 1 linear.

    Returns
    -------
    picture : (rows, columns) float64 array
        NaN outside the volume.
    """
    columns, rows = round(width / pitch), round(height / pitch)
    across = (np.arange(columns) - (columns - 1) / 2) * pitch
    down = (np.arange(rows) - (rows - 1) / 2) * pitch
    points = (
        np.asarray(center_ras, dtype=np.float64)
        + across[None, :, None] * np.asarray(plane.right_ras, dtype=np.float64)
        + down[:, None, None] * np.asarray(plane.down_ras, dtype=np.float64)
    )
    ijk = points @ volume.grid.reference_to_ijk[:3, :3].T + volume.grid.reference_to_ijk[:3, 3]
    places = np.moveaxis(ijk[..., ::-1], -1, 0)
    return scipy.ndimage.map_coordinates(volume.array, places, np.float64, 0 if order == 0 else 1, cval=np.nan)


def whole_cut(grid: VoxelGrid, plane: Plane, center_ras: ArrayLike) -> tuple[Floats, tuple[float, float]]:
    """Middle (3,) and size, in mm, of the picture that shows all of a grid on a plane through `center_ras`; no side below a voxel."""
    across, down = np.asarray(plane.right_ras, float), np.asarray(plane.down_ras, float)
    (left, right), (top, bottom) = (extent_along(grid, way) for way in (across, down))
    normal = np.cross(across, down)
    middle: Floats = (left + right) / 2 * across + (top + bottom) / 2 * down + (np.asarray(center_ras, float) @ normal) * normal
    thinnest = float(grid.spacing.max())
    return middle, (max(right - left, thinnest), max(bottom - top, thinnest))


def extent_along(grid: VoxelGrid, direction_ras: ArrayLike) -> tuple[float, float]:
    """Least and greatest coordinate of a grid's corners along a RAS direction, mm."""
    along = grid.corners() @ np.asarray(direction_ras, dtype=np.float64)
    return float(along.min()), float(along.max())
