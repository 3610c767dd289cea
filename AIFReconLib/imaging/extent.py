"""The box around a sweep: a grid that holds every pixel of every usable frame."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Matrix
from ..errors import GeometryError
from ..geometry.volume import VoxelGrid
from ..machine.memory import LARGEST_GRID, require_memory
from .region import ImageRegion, extreme_pixels
from .sound_speed import DepthScale

LARGEST_EXTENT = 5000.0
"""mm. Poses that span more are not those of one patient."""

TIE_TOLERANCE = 1e-6
"""Voxels. Engines multiply matrices before they round, and so place a pixel that lies between two voxels on either side."""


def grid_around_sweep(
    image_to_reference: Matrix,
    frame_size: tuple[int, int],
    region: ImageRegion,
    spacing: tuple[float, float, float],
    bytes_per_voxel: int = 1,
    depth_scale: DepthScale | None = None,
    fits_spacing: bool = False,
) -> VoxelGrid:
    """The smallest grid along the axes of Reference that holds the region of every frame.

    IGSIO's rule: the origin is the least coordinate of any pixel center and the center of voxel 0; the size is
    round((most - least) / spacing) + 1. So the last pixel is at most half a voxel past the last voxel's center. A pixel on the very
    border of two voxels, to rounding, gets both.

    Raises InsufficientMemoryError with how much is needed and which spacing would fit; GeometryError when there is no pose, or the
    poses span what no scanner does.

    Parameters
    ----------
    image_to_reference : (frames, 4, 4) array, pixels to mm
        Poses of the usable frames.
    frame_size : (columns, rows)
    spacing : (x, y, z), mm
    bytes_per_voxel : int
        What the reconstruction will take at least, so that a grid that cannot fit is refused before it is made.
    depth_scale : DepthScale or None
        Where pixels truly are, where that is not where they are shown.
    fits_spacing : bool
        The spacing along z grows until the box is a whole number of voxels deep: Plus's RecomputeOutputSpacing.
    """
    if not len(image_to_reference):
        raise GeometryError("Input poses must be at least one; got none.")
    mask = region.mask(*frame_size)
    pixels = extreme_pixels(mask)
    if depth_scale is not None:
        # What is straight as shown may not be in truth: the whole outline counts
        padded = np.pad(mask, 1)
        outline = mask & ~(padded[:-2, 1:-1] & padded[2:, 1:-1] & padded[1:-1, :-2] & padded[1:-1, 2:])
        pixels = depth_scale.moved(np.argwhere(outline)[:, ::-1].T.astype(np.float64)).T
    least, most = np.full(3, np.inf), np.full(3, -np.inf)
    along = np.ascontiguousarray(pixels.T)
    for matrix in image_to_reference:
        points = matrix[:3, :2] @ along + matrix[:3, 3, None]
        np.minimum(least, points.min(axis=1), out=least)
        np.maximum(most, points.max(axis=1), out=most)
    extent = most - least
    spacing = _fitted(spacing, extent) if fits_spacing else spacing
    voxels = np.floor(extent / np.asarray(spacing) + (0.5 + TIE_TOLERANCE)) + 1
    if not np.isfinite(extent).all() or extent.max() > LARGEST_EXTENT:
        spans = " x ".join(f"{mm:.0f}" for mm in extent)
        raise GeometryError(f"The sweep spans {spans} mm, which no scan does. Are its poses in mm and in the right frame?")
    i, j, k = (int(n) for n in voxels)
    size = (i, j, k)
    require_memory(size, spacing, bytes_per_voxel, most=LARGEST_GRID)
    return VoxelGrid.from_spacing(least, size, spacing)


def _fitted(spacing: tuple[float, float, float], extent: Floats) -> tuple[float, float, float]:
    """The spacing with z such that voxels end where the box of size `extent` (mm) does; as it was in a box thinner than a voxel."""
    x, y, z = spacing
    intervals = np.floor(extent[2] / z)
    return (x, y, float(extent[2] / intervals)) if intervals >= 1 else spacing
