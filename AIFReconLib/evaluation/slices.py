"""Flat cuts through volumes, for figures: along the patient's planes, or along the axes of a frame."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ..arrays import Floats
from ..geometry.volume import Volume, VoxelGrid


@dataclass(frozen=True)
class Plane:
    """A plane: its name, and which way (RAS, or x, y, z of the frame) the picture runs to the right and down."""

    name: str
    right_ras: tuple[float, float, float]
    down_ras: tuple[float, float, float]
    edges: tuple[str, str, str, str]
    """Letters at the left, right, top and bottom edge."""


AXIAL = Plane("axial", (-1, 0, 0), (0, -1, 0), ("R", "L", "A", "P"))
SAGITTAL = Plane("sagittal", (0, -1, 0), (0, 0, -1), ("A", "P", "S", "I"))
CORONAL = Plane("coronal", (-1, 0, 0), (0, 0, -1), ("R", "L", "S", "I"))
PLANES = (AXIAL, SAGITTAL, CORONAL)
"""As Slicer shows them: the patient's right on the left, or the front."""


def planes(patient: bool) -> tuple[Plane, ...]:
    """The three planes of all pictures.

    With the patient's names and letters only where it is known how the `patient` lies, as a registered CT tells it; else the same planes by
    the axes of the frame.
    """
    if patient:
        return PLANES
    return tuple(
        replace(plane, name=f"across {across}", edges=(*axis_ends(plane.right_ras), *axis_ends(plane.down_ras)))
        for plane, across in zip(PLANES, "zxy", strict=True)
    )


def axis_ends(direction: ArrayLike) -> tuple[str, str]:
    """The axis that a direction (3,) runs along most, with the sign of where it comes from and of where it goes: +x, -x."""
    along = np.asarray(direction, dtype=np.float64)
    axis = int(np.abs(along).argmax())
    signs = "-+" if along[axis] > 0 else "+-"
    return f"{signs[0]}{'xyz'[axis]}", f"{signs[1]}{'xyz'[axis]}"


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
    (left, right), (top, bottom) = ((float(along.min()), float(along.max())) for along in (grid.corners() @ way for way in (across, down)))
    normal = np.cross(across, down)
    middle: Floats = (left + right) / 2 * across + (top + bottom) / 2 * down + (np.asarray(center_ras, float) @ normal) * normal
    thinnest = float(grid.spacing.max())
    return middle, (max(right - left, thinnest), max(bottom - top, thinnest))
