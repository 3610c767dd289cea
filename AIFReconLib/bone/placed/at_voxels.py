"""A bone map read at the voxels where it is asked for: no memory for the others, and no time."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import ndimage

from ...arrays import Floats, Integers, Matrix, Numbers, Singles
from ...machine.threads import optional_module
from .placement import Placement

SHORTEST = 1e-30
"""Length below which a gradient has no direction: its components would lose digits in float32."""

NO_SLOPES: Singles = np.empty((3, 0, 0, 0), np.float32)


@dataclass(frozen=True, eq=False)
class BoneAtVoxels:
    """A bone map and where the voxels of a reconstruction lie in it.

    Parameters
    ----------
    map_probability : [k, j, i] float32 array, 0 to 1
        The probability in the map's own voxels.
    ijk_to_map : (4, 4) array
        From the voxels of the whole grid to those of the map.
    potential : [k, j, i] float32 array
        What V_dir is the gradient of, on the map's voxels.
    slopes : (3, k, j, i) float32 array or None
        How it rises along i, j, k of the map, where that is not its Sobel gradient.
    to_reference : (3, 3) float32 array
        What brings slopes to Reference.
    placement : Placement
    """

    map_probability: Singles
    ijk_to_map: Matrix
    potential: Singles
    slopes: Singles | None
    to_reference: Singles
    placement: Placement

    def at(self, voxels: Integers) -> tuple[Singles, Singles]:
        """Probability (m,) and direction (m, 3), as `BoneOnGrid` has them, at voxels (m,), flat [k, j, i] of the part of the grid.

        Where the probability is 0, so is the direction.
        """
        place = self.placement
        fast = optional_module("AIFReconLib.bone.numba_map")
        if fast is None:
            return self._at(voxels)
        probability, directions = np.empty(voxels.size, np.float32), np.zeros((voxels.size, 3), np.float32)
        part = place.shape, place.planes, place.rows, place.columns
        slopes = NO_SLOPES if self.slopes is None else self.slopes
        arrays = self.map_probability, self.potential, slopes, self.to_reference
        fast.look_up(arrays, part, place.starts, place.matrix, voxels, probability, directions)
        return probability, directions

    def _at(self, voxels: Integers) -> tuple[Singles, Singles]:
        """The same by scipy."""
        place = self.placement
        k, j, i = np.unravel_index(voxels, place.shape)
        probability, directions = np.zeros(voxels.size, np.float32), np.zeros((voxels.size, 3), np.float32)
        near = np.flatnonzero(place.within(k, j, i))
        places = place.places(k[near], j[near], i[near])
        found = interpolated(self.map_probability, places)
        some = np.flatnonzero(found)
        probability[near] = found
        vectors = np.zeros((some.size, 3), np.float32)
        for axis in range(3):
            slope = interpolated(self._slopes[axis], places[:, some])
            for component in range(3):
                vectors[:, component] += self.to_reference[component, axis] * slope
        normalize(vectors)
        directions[near[some]] = vectors
        return probability, directions

    @cached_property
    def _slopes(self) -> Singles:
        if self.slopes is not None:
            return self.slopes
        return np.stack([ndimage.sobel(self.potential, axis=2 - axis, mode="nearest") for axis in range(3)])

    @cached_property
    def overlaps(self) -> bool:
        """Whether there is any bone on the part of the grid at all."""
        planes, rows, columns = self.placement.shape
        plane = np.arange(rows * columns)
        # Far apart first: where there is bone, one of the first planes has some
        numbers = sorted(range(*self.placement.planes), key=lambda k: (-(k & -k) if k else -planes, k))
        return any(bool(self.at(k * plane.size + plane)[0].any()) for k in numbers)


def interpolated(array: Numbers, places: Floats) -> Singles:
    """An array [k, j, i] between its voxels, linearly, at places (3, ...); around it lie zeros."""
    result = np.empty(places.shape[1:], np.float32)
    # "constant" would drop voxels on the very border, which rounding puts a hair outside
    ndimage.map_coordinates(array, places, output=result, order=1, mode="grid-constant", prefilter=False)
    return result


def normalize(vectors: Singles) -> None:
    """Scale vectors (..., 3) to unit length in place; those too short to have a direction become zero."""
    x, y, z = np.moveaxis(vectors.astype(np.float64), -1, 0)
    length = np.sqrt((x * x + y * y) + z * z)
    too_short = length < SHORTEST
    length[too_short] = 1.0
    vectors /= length[..., None].astype(np.float32)
    vectors[too_short] = 0.0
