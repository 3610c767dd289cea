"""A bone map on every voxel of a reconstruction, and what engines read of one that is placed in either way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Integers, Matrix, Singles
from .at_voxels import BoneAtVoxels


@dataclass(frozen=True, eq=False)
class BoneOnGrid:
    """A bone map sampled on the grid of a reconstruction."""

    probability: Singles  #: [k, j, i], 0 to 1
    directions_reference: Singles
    """[k, j, i, 3], unit vectors or zero. Where bone faces away from the sound, in Reference: along the beam on the near side of a
    surface."""
    map_probability: Singles
    """[k, j, i], 0 to 1. The probability in the map's own voxels: what a frame asks for that leaves the grid, or the part of it that is
    reconstructed."""
    ijk_to_map: Matrix  #: (4, 4). From the voxels of the whole grid to those of the map.

    @property
    def overlaps(self) -> bool:
        """Whether there is any bone on the grid at all."""
        return bool(self.probability.any())

    def at(self, voxels: Integers) -> tuple[Singles, Singles]:
        """Probability (m,) and direction (m, 3) at voxels (m,), flat [k, j, i]."""
        return self.probability.reshape(-1)[voxels], self.directions_reference.reshape(-1, 3)[voxels]


PlacedBone = BoneOnGrid | BoneAtVoxels
"""What engines read: `at` some voxels, and what scan lines ask for, `map_probability` by `ijk_to_map`."""


def everywhere(placed: PlacedBone | None) -> tuple[Singles, Singles]:
    """Probability (voxels,) and direction (voxels, 3) on all voxels; nothing where it is read at some alone."""
    if isinstance(placed, BoneOnGrid):
        return placed.probability.reshape(-1), placed.directions_reference.reshape(-1, 3)
    return np.empty(0, np.float32), np.empty((0, 3), np.float32)
