"""A bone map read at the voxels where it is asked for: no memory for the others, and no time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

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
    slopes: Singles  #: (3, k, j, i). V_dir before it is normalized, along i, j, k of the map.
    to_reference: Singles  #: (3, 3). What brings slopes to Reference.
    coordinates: MapCoordinates

    def at(self, voxels: Integers, everywhere: bool = False) -> tuple[Singles, Singles]:
        """Probability (m,) and direction (m, 3), as `BoneOnGrid` has them, at voxels (m,), flat [k, j, i] of the part of the grid.

        Where the probability is 0, so is the direction, unless it is wanted `everywhere`.
        """
        coordinates = self.coordinates
        fast = optional_module("AIFReconLib.bone.numba_map")
        if fast is None:
            return self._at(voxels, everywhere)
        probability, directions = np.empty(voxels.size, np.float32), np.empty((voxels.size, 3), np.float32)
        box = coordinates.shape, coordinates.planes, coordinates.rows, coordinates.columns
        arrays = self.map_probability, self.slopes, self.to_reference
        fast.look_up(arrays, box, (coordinates.starts, coordinates.matrix), voxels, everywhere, (probability, directions))
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
            vectors += self.to_reference[:, axis] * interpolated(self.slopes[axis], places[:, some])[:, None]
        normalize(vectors)
        directions[near[some]] = vectors
        return probability, directions

    @cached_property
    def overlaps(self) -> bool:
        """Whether there is any bone on the part of the grid at all."""
        plane = np.arange(math.prod(self.coordinates.shape[1:]))
        numbers = np.random.default_rng(0).permutation(np.arange(*self.coordinates.planes))
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
