"""Where the voxels of a reconstruction lie in a bone map, each by the same sums, however many are asked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Floats, Integers, Mask, Matrix
from ...geometry.volume import VoxelGrid

SLABS = 32
"""Slabs of planes from whose first plane coordinates are counted; always as many, so that results depend on no machine."""

Range = tuple[int, int]


@dataclass(frozen=True, eq=False)
class MapCoordinates:
    """Where voxels of a grid, or of some of its planes, lie among those of a map."""

    shape: tuple[int, int, int]  #: (planes, rows, columns). Of the part of the grid.
    planes: Range
    rows: Range
    columns: Range
    """(first, stop). Of that part, outside of which the map and its rim of zeros have no voxel."""
    starts: Floats
    """(planes, 3), [k, j, i] of the map. Of each plane, the place of its voxel at the first of `rows` and `columns`."""
    matrix: Floats  #: (3, 3). Steps [k, j, i] of the map, along planes, rows and columns.

    @classmethod
    def of(cls, source: VoxelGrid, grid: VoxelGrid, planes: Range) -> MapCoordinates:
        """That of the `planes` (first, stop) of a grid in a map on the voxels `source`."""
        first, stop = planes
        shape = stop - first, *grid.shape[1:]
        starts = np.zeros((stop - first, 3))
        if source.matches(grid):
            starts[:, 0] = np.arange(first, stop)
            return cls(shape, (0, stop - first), (0, shape[1]), (0, shape[2]), starts, np.eye(3))
        to_source = source.reference_to_ijk @ grid.ijk_to_reference
        matrix = np.ascontiguousarray(to_source[2::-1, 2::-1])
        box = _overlap(to_source, grid, source)
        if box is None:
            return cls(shape, (0, 0), (0, 0), (0, 0), starts, matrix)
        (begin, end), rows, columns = box
        offset = to_source[2::-1, 3] + matrix @ [begin, rows[0], columns[0]]
        edges = np.linspace(0, end - begin, min(SLABS, end - begin) + 1).astype(int)
        # Counted from the first plane of its slab of the whole, whichever planes are wanted: so places round alike
        k = np.arange(max(begin, first), min(end, stop))
        slab = edges[np.searchsorted(edges, k - begin, side="right") - 1]
        starts[k - first] = (offset + matrix[:, 0] * slab[:, None]) + (k - begin - slab)[:, None] * matrix[:, 0]
        mine = (int(k[0]) - first, int(k[-1]) + 1 - first) if k.size else (0, 0)
        return cls(shape, mine, rows, columns, starts, matrix)

    def of_voxels(self, k: Integers, j: Integers, i: Integers) -> Floats:
        """Where voxels lie in the map, (3, ...) float64 [k, j, i]."""
        down, right = j - self.rows[0], i - self.columns[0]
        return np.stack([(self.starts[k, axis] + down * self.matrix[axis, 1]) + right * self.matrix[axis, 2] for axis in range(3)])

    def within(self, k: Integers, j: Integers, i: Integers) -> Mask:
        """Which voxels the map may reach, bool."""
        pairs = (k, self.planes), (j, self.rows), (i, self.columns)
        inside: Mask = np.logical_and.reduce([(at >= first) & (at < stop) for at, (first, stop) in pairs])
        return inside


def _overlap(to_source: Matrix, grid: VoxelGrid, source: VoxelGrid) -> tuple[Range, Range, Range] | None:
    """The box [k, j, i] of the grid outside of which the source and its rim of zeros have no voxel; None when they do not meet."""
    to_grid = np.linalg.inv(to_source)
    near, far = (-1, -1, -1), source.size
    corners = np.array([(i, j, k) for k in (near[2], far[2]) for j in (near[1], far[1]) for i in (near[0], far[0])], dtype=np.float64)
    ijk = corners @ to_grid[:3, :3].T + to_grid[:3, 3]
    first = np.maximum(np.floor(ijk.min(axis=0)).astype(int) - 1, 0)
    stop = np.minimum(np.ceil(ijk.max(axis=0)).astype(int) + 2, grid.size)
    if (first >= stop).any():
        return None
    k, j, i = ((int(a), int(b)) for a, b in zip(first[::-1], stop[::-1], strict=True))
    return k, j, i
