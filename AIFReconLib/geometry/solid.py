"""Closed surfaces of triangles: their inside as voxels, and small ones around points."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Integers, Mask
from ..errors import GeometryError
from .transforms import transform_points
from .volume import VoxelGrid

ASIDE = np.array([1.3e-4, 2.7e-4])
"""Voxels by which the lines pass the voxels' centers: none meets an edge or a corner."""

MOST_OPEN = 0.02
"""Share of the lines through a surface that may leave it once less than they enter it: small holes in it."""

AT_ONCE = 1 << 22
"""Pairs of a line and a triangle that are looked at together."""

CORNERS = np.concatenate([np.eye(3), -np.eye(3)])
FACES = np.array([(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)])
"""Of an octahedron, outward."""


def octahedra(points: Floats, radius: float) -> tuple[Floats, Integers, Integers]:
    """A small octahedron around each of the points (n, 3): corners (6 n, 3), triangles (8 n, 3), and of which point each corner is."""
    number = np.arange(len(points))
    corners = (points[:, None] + radius * CORNERS).reshape(-1, 3)
    return corners, (FACES + len(CORNERS) * number[:, None, None]).reshape(-1, 3), np.repeat(number, len(CORNERS))


def inside_of_surface(points_reference: Floats, triangles: Integers, grid: VoxelGrid) -> Mask:
    """Which voxels of a grid lie within a closed surface, [k, j, i] bool.

    Raises GeometryError when the surface is not closed.

    Parameters
    ----------
    points_reference : (n, 3) array, mm
    triangles : (m, 3) array of int
        Places in `points_reference`; which way they run does not matter.

    Notes
    -----
    A voxel is inside where the line from it along -k crosses the surface an odd number of times.
    """
    corners = transform_points(grid.reference_to_ijk, points_reference)[triangles]
    crossed = np.zeros((grid.shape[0] + 1, *grid.shape[1:]), np.uint8)
    flat = corners[:, :, :2]
    first = np.maximum(np.ceil(flat.min(axis=1) - ASIDE), 0).astype(np.int64)
    last = np.minimum(np.floor(flat.max(axis=1) - ASIDE), np.array(grid.size[:2]) - 1).astype(np.int64)
    wide = np.maximum(last - first + 1, 0)
    lines = wide.prod(axis=1)
    groups = np.searchsorted(np.cumsum(lines), np.arange(AT_ONCE, lines.sum() + AT_ONCE, AT_ONCE)) + 1
    for chosen in np.split(np.arange(len(lines)), groups[groups < len(lines)]):
        _cross(crossed, corners[chosen], first[chosen], wide[chosen])
    np.bitwise_xor.accumulate(crossed, axis=0, out=crossed)
    open_lines = crossed[-1] > 0
    met = int((crossed[:-1].any(axis=0) | open_lines).sum())
    if open_lines.sum() > MOST_OPEN * met:
        raise GeometryError(f"Input surface must be closed; {open_lines.sum() / met:.0%} of the lines through it do not leave it again.")
    crossed[:, open_lines] = 0
    inside: Mask = crossed[:-1].view(bool)
    return inside


def _cross(crossed: Integers, corners: Floats, first: Integers, wide: Integers) -> None:
    """Turn every voxel over from which a line along +k starts behind its crossing of one of these triangles (m, 3, 3)."""
    lines = wide.prod(axis=1)
    owner = np.repeat(np.arange(len(lines)), lines)
    if not len(owner):
        return
    number = np.arange(len(owner)) - np.repeat(np.cumsum(lines) - lines, lines)
    j, i = np.divmod(number, wide[owner, 0])
    i, j = i + first[owner, 0], j + first[owner, 1]
    x, y = i + ASIDE[0], j + ASIDE[1]
    a, b, c = (corners[:, n] for n in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (c[:, 0] - a[:, 0]) * (b[:, 1] - a[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        u = ((x - a[owner, 0]) * (c[owner, 1] - a[owner, 1]) - (c[owner, 0] - a[owner, 0]) * (y - a[owner, 1])) / area[owner]
        v = ((b[owner, 0] - a[owner, 0]) * (y - a[owner, 1]) - (x - a[owner, 0]) * (b[owner, 1] - a[owner, 1])) / area[owner]
        hit = (u >= 0) & (v >= 0) & (u + v <= 1)
    depth = a[owner, 2] + u * (b - a)[owner, 2] + v * (c - a)[owner, 2]
    k = np.clip(np.ceil(depth[hit]), 0, len(crossed) - 1).astype(np.int64)
    np.bitwise_xor.at(crossed, (k, j[hit], i[hit]), np.uint8(1))
