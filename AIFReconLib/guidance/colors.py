"""How squarely each piece of bone was met, in a few steps that a color can tell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ..arrays import Bytes, Floats, Integers
from .bone import GuidedBone
from .coverage import BELOW_45, BELOW_60
from .mesh import NEAR, BoneMesh, bone_mesh

OUT_OF_REACH, NOT_MET, GRAZED, ASLANT, SQUARELY = range(5)
"""No beam from the back gets there; none has been there; the best one came at more than 60 degrees, at 45 to 60, below 45."""


@dataclass(frozen=True, eq=False)
class ColoredBone:
    """The surface of bone, ready to be colored by what was met.

    Parameters
    ----------
    mesh : BoneMesh
        Where the bone lies that it was made of.
    nearest : (n,) int array
        The reachable point of that bone that each corner of the mesh stands for; -1 where there is none.
    """

    mesh: BoneMesh
    nearest: Integers

    @classmethod
    def of(cls, bone: GuidedBone) -> ColoredBone:
        """The whole surface of a bone, out of reach or not."""
        mesh = bone_mesh(bone.distance)
        _, nearest = cKDTree(bone.surface.points_reference).query(mesh.points_reference, distance_upper_bound=NEAR)
        return cls(mesh, np.where(nearest < len(bone), nearest, -1))

    def levels(self, best_cosine: Floats) -> Bytes:
        """`OUT_OF_REACH` to `SQUARELY` at each corner, (n,), from the best cosines of the bone's points (NaN: not met)."""
        with np.errstate(invalid="ignore"):
            steps = NOT_MET + np.isfinite(best_cosine).astype(np.uint8) + (best_cosine > BELOW_60) + (best_cosine > BELOW_45)
        # The last one stands for all that is out of reach
        return np.append(steps.astype(np.uint8), np.uint8(OUT_OF_REACH))[self.nearest]
