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

CLOSED = 1e-3
"""Of the area of a body's triangles, by which their sum as vectors may be off zero in one that is closed."""

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
        Places in `points_reference`. Those of one body run one way around it, or no way in particular; bodies may overlap.

    Notes
    -----
    A voxel is inside where the line from it along -k enters the surface more or fewer times than it leaves it (the nonzero winding rule;
    Foley et al., Computer Graphics: Principles and Practice, 2nd ed., 19.5), so that a body within another that runs the other way is a
    cavity. Lines along which triangles run no way in particular are judged by whether they cross an odd number of times.
    """
    corners = transform_points(grid.reference_to_ijk, points_reference)[_turned_alike(points_reference, triangles)]
    crossed = np.zeros((grid.shape[0] + 1, *grid.shape[1:]), np.int8)
    flat = corners[:, :, :2]
    first = np.maximum(np.ceil(flat.min(axis=1) - ASIDE), 0).astype(np.int64)
    last = np.minimum(np.floor(flat.max(axis=1) - ASIDE), np.array(grid.size[:2]) - 1).astype(np.int64)
    wide = np.maximum(last - first + 1, 0)
    lines = wide.prod(axis=1)
    groups = np.searchsorted(np.cumsum(lines), np.arange(AT_ONCE, lines.sum() + AT_ONCE, AT_ONCE)) + 1
    for chosen in np.split(np.arange(len(lines)), groups[groups < len(lines)]):
        _cross(crossed, corners[chosen], first[chosen], wide[chosen])
    np.add.accumulate(crossed, axis=0, out=crossed)
    at_end = crossed[-1].copy()
    open_lines, unsure = at_end % 2 != 0, (at_end != 0) & (at_end % 2 == 0)
    crossed[:, unsure] %= 2
    met = int((crossed[:-1].any(axis=0) | open_lines).sum())
    if open_lines.sum() > MOST_OPEN * met:
        raise GeometryError(f"Input surface must be closed; {open_lines.sum() / met:.0%} of the lines through it do not leave it again.")
    crossed[:, open_lines] = 0
    inside: Mask = crossed.view(bool)
    np.not_equal(crossed, 0, out=inside)
    return inside[:-1]


def _turned_alike(points: Floats, triangles: Integers) -> Integers:
    """The triangles (m, 3), those of closed bodies that run against the largest one turned over.

    Mirrored bodies do. Cavities do too, and stay as they are: their box lies within that of another body.
    """
    ends = (triangles[:, [0, 1]].ravel(), triangles[:, [1, 2]].ravel())
    import scipy  # late: the panel opens without it

    graph = scipy.sparse.coo_matrix((np.ones(len(ends[0]), np.int8), ends), shape=(len(points), len(points)))
    count, body_of_point = scipy.sparse.csgraph.connected_components(graph, directed=False)
    if count == 1:
        return triangles
    body = body_of_point[triangles[:, 0]]
    a, b, c = (points[triangles[:, n]] - points[triangles[0, 0]] for n in range(3))
    areas = np.cross(b - a, c - a)
    left_open = np.linalg.norm([np.bincount(body, axis, count) for axis in areas.T], axis=0)
    closed = left_open < CLOSED * np.bincount(body, np.linalg.norm(areas, axis=1), count)
    volumes = np.where(closed, np.bincount(body, (a * np.cross(b, c)).sum(axis=1), count), 0.0)
    against = np.flatnonzero(volumes * volumes[np.abs(volumes).argmax()] < 0)
    if not len(against):
        return triangles
    lows, highs = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(lows, body_of_point, points)
    np.maximum.at(highs, body_of_point, points)
    others = np.setdiff1d(np.flatnonzero(volumes), against)
    turned = [n for n in against if not ((lows[others] <= lows[n]) & (highs[others] >= highs[n])).all(axis=1).any()]
    flipped = triangles.copy()
    chosen = np.isin(body, turned)
    flipped[chosen] = flipped[chosen, ::-1]
    return flipped


def _cross(crossed: Integers, corners: Floats, first: Integers, wide: Integers) -> None:
    """Count, at the first voxel behind it, each crossing of one of these triangles (m, 3, 3) by a line along +k: 1 or -1 by its side."""
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
    owner = owner[hit]
    depth = a[owner, 2] + u[hit] * (b - a)[owner, 2] + v[hit] * (c - a)[owner, 2]
    k = np.clip(np.ceil(depth), 0, len(crossed) - 1).astype(np.int64)
    np.add.at(crossed, (k, j[hit], i[hit]), np.where(area[owner] > 0, np.int8(1), np.int8(-1)))
