"""A bone map read at the voxels where it is asked for: no memory for the others, and no time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from ...arrays import Floats, Integers, Matrix, Singles
from ...machine.threads import optional_module
from .coordinates import MapCoordinates

SHORTEST = 1e-30
"""Length below which a gradient has no direction: its components would lose digits in float32."""


@dataclass(frozen=True, eq=False)
class BoneAtVoxels:
    """A bone map and where the voxels of a reconstruction lie in it."""

    map_probability: Singles  #: [k, j, i], 0 to 1. The probability in the map's own voxels.
    ijk_to_map: Matrix  #: (4, 4). From the voxels of the whole grid to those of the map.
    potential: Singles  #: [k, j, i]. What V_dir is the gradient of, on the map's voxels.
    slopes: Singles | None
    """(3, k, j, i). How it rises along i, j, k of the map, where that is not its Sobel gradient."""
    to_reference: Singles  #: (3, 3). What brings slopes to Reference.
    coordinates: MapCoordinates

    def at(self, voxels: Integers, everywhere: bool = False) -> tuple[Singles, Singles]:
        """Probability (m,) and direction (m, 3), as `BoneOnGrid` has them, at voxels (m,), flat [k, j, i] of the part of the grid.

        Where the probability is 0, so is the direction, unless it is wanted `everywhere`; then all slopes are made beforehand.
        """
        coordinates = self.coordinates
        fast = optional_module("AIFReconLib.bone.numba_map")
        if fast is None:
            return self._at(voxels, everywhere)
        probability, directions = np.empty(voxels.size, np.float32), np.empty((voxels.size, 3), np.float32)
        box = coordinates.shape, coordinates.planes, coordinates.rows, coordinates.columns
        slopes, occupied = self.all_slopes if everywhere else self.slopes, self.occupied if everywhere else None
        arrays = self.map_probability.reshape(-1), self.potential, self.to_reference
        slopes = None if slopes is None else slopes.reshape(-1)
        fast.look_up(arrays, slopes, box, (coordinates.starts, coordinates.matrix), voxels, occupied, (probability, directions))
        return probability, directions

    def _at(self, voxels: Integers, everywhere: bool) -> tuple[Singles, Singles]:
        """The same by scipy."""
        coordinates = self.coordinates
        k, j, i = np.unravel_index(voxels, coordinates.shape)
        probability, directions = np.zeros(voxels.size, np.float32), np.zeros((voxels.size, 3), np.float32)
        near = np.flatnonzero(coordinates.within(k, j, i))
        places = coordinates.of_voxels(k[near], j[near], i[near])
        probability[near] = found = interpolated(self.map_probability, places)
        some = np.arange(near.size) if everywhere else np.flatnonzero(found)
        vectors = np.zeros((some.size, 3), np.float32)
        for axis in range(3):
            vectors += self.to_reference[:, axis] * interpolated(self.all_slopes[axis], places[:, some])[:, None]
        normalize(vectors)
        directions[near[some]] = vectors
        return probability, directions

    @cached_property
    def all_slopes(self) -> Singles:
        """Slopes, (3, k, j, i), as an array: 0 where the grid does not reach."""
        if self.slopes is not None:
            return self.slopes
        shape = self.potential.shape
        slopes = np.zeros((3, *shape), np.float32)
        near = self.coordinates.reached(shape)
        # With a voxel more on each side, which the gradient looks at; at the border of the map there is none
        wider = tuple(slice(max(s.start - 1, 0), s.stop + 1) for s in near)
        within = tuple(slice(s.start - w.start, s.stop - w.start) for s, w in zip(near, wider, strict=True))
        if all(s.stop > s.start for s in near):
            for axis in range(3):
                slopes[(axis, *near)] = scipy.ndimage.sobel(self.potential[wider], axis=2 - axis, mode="nearest")[within]
        return slopes

    @cached_property
    def occupied(self) -> NDArray[np.int32]:
        """Where anything of the map is not 0, (planes + 1, rows + 1, 2) int32: at [k + 1, j + 1], the first i and the last of these places.

        Voxels between k and k + 1, j and j + 1, i and i + 1 are made of nothing else; none where the last is below the first.
        """
        planes, rows, columns = self.map_probability.shape
        first, last = np.full((planes + 2, rows + 2), columns, np.int32), np.full((planes + 2, rows + 2), -2, np.int32)
        for k in range(planes):
            some = self.map_probability[k] != 0
            for rise in self.all_slopes[:, k]:
                some |= rise != 0
            any_there = np.flatnonzero(some.any(axis=1))
            first[k + 1, any_there + 1] = some.argmax(axis=1)[any_there] - 1
            last[k + 1, any_there + 1] = columns - 1 - some[:, ::-1].argmax(axis=1)[any_there]
        for ends, pick in ((first, np.minimum), (last, np.maximum)):
            pick(ends[:-1], ends[1:], out=ends[:-1])
            pick(ends[:, :-1], ends[:, 1:], out=ends[:, :-1])
        return np.stack([first[:-1, :-1], last[:-1, :-1]], axis=-1)

    @cached_property
    def overlaps(self) -> bool:
        """Whether there is any bone on the part of the grid at all."""
        planes, rows, columns = self.coordinates.shape
        plane = np.arange(rows * columns)
        # Far apart first: where there is bone, one of the first planes has some
        numbers = sorted(range(*self.coordinates.planes), key=lambda k: (-(k & -k) if k else -planes, k))
        return any(bool(self.at(k * plane.size + plane)[0].any()) for k in numbers)


def interpolated(array: Singles, places: Floats) -> Singles:
    """An array [k, j, i] between its voxels, linearly, at places (3, ...); around it lie zeros."""
    result = np.empty(places.shape[1:], np.float32)
    # "constant" would drop voxels on the very border, which rounding puts a hair outside
    scipy.ndimage.map_coordinates(array, places, output=result, order=1, mode="grid-constant", prefilter=False)
    return result


def normalize(vectors: Singles) -> None:
    """Scale vectors (n, 3) to unit length in place; those too short to have a direction become zero."""
    x, y, z = vectors.T.astype(np.float64)
    length = np.sqrt((x * x + y * y) + z * z)
    too_short = length < SHORTEST
    length[too_short] = 1.0
    vectors /= length[:, None].astype(np.float32)
    vectors[too_short] = 0.0
