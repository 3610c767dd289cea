"""The surface of bone as triangles, for whatever shows it in color."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy

from ..arrays import Bytes, Floats, Integers, Matrix, Numbers
from ..evaluation.surface import BoneSurface
from ..geometry.level_surface import level_surface, triangles_of
from ..geometry.transforms import transform_points
from ..geometry.volume import Volume
from .bone import APART, GuidedBone, axes_across
from .bone_coverage import CoverageAccumulator
from .coverage import BELOW_45, BELOW_60
from .snapshot import BoneMesh

NEAR = 2.5
"""mm. A corner of the mesh takes the numbers of the reachable point that is nearest, within this; farther ones are not reachable."""

CELL = 2.0
"""mm, about: corners of bone in color lie so far apart. A view is drawn anew whenever something moves, and finer ones take too long."""

LIFTED = 0.7
"""mm by which bone in color lies outside of its surface: what else is drawn of the same bone stays under it."""

TILE = 1.2 * APART
"""mm. Side of what is drawn for a point of the surface of echoes."""

OUT_OF_REACH, NOT_MET, GRAZED, ASLANT, SQUARELY = range(5)
"""No beam from the back gets there; none has been there; the best one came at more than 60 degrees, at 45 to 60, below 45."""


def bone_mesh(distance: Volume) -> BoneMesh:
    """The zero level of a signed distance as triangles; VTK makes it."""
    inside = Volume(-distance.array.astype(np.float32), distance.ijk_to_reference)
    points, triangles = triangles_of(level_surface(inside, 0.0, -float(np.abs(inside.array).max()) - 1.0))
    return BoneMesh(points.astype(np.float64), triangles)


def _tiles(surface: BoneSurface) -> BoneMesh:
    """A square for each point, a little larger than what it stands for: four corners one after the other."""
    across, along = axes_across(surface.normals_reference)
    lifted = surface.points_reference + LIFTED * surface.normals_reference
    corners = np.stack([lifted + TILE / 2 * (a * across + b * along) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))], axis=1)
    first = 4 * np.arange(len(lifted))[:, None]
    triangles = np.concatenate([first + np.array(halves) for halves in ((0, 1, 2), (0, 2, 3))])
    return BoneMesh(corners.reshape(-1, 3), triangles)


def met_on_mesh(mesh: BoneMesh, met: CoverageAccumulator) -> dict[str, Numbers]:
    """What was met at the corners of a mesh, by name.

    Returns
    -------
    arrays : dict
        `best_cosine` (n,) float32, 0 where nothing was met; `frames` (n,) int32; `label` (n,) int32 and `reachable` (n,) uint8, both 0
        where no beam from the back could reach.
    """
    surface, nearest = met.bone.surface, _nearest(met.bone, mesh)
    reachable = nearest >= 0
    return {
        "best_cosine": np.where(reachable, np.nan_to_num(met.best_cosine[nearest]), 0.0).astype(np.float32),
        "frames": np.where(reachable, met.frames[nearest], 0).astype(np.int32),
        "label": np.where(reachable, surface.labels[nearest], 0).astype(np.int32),
        "reachable": np.asarray(reachable, dtype=np.uint8),
    }


def _nearest(bone: GuidedBone, mesh: BoneMesh) -> Integers:
    """The reachable point of the bone that each corner of the mesh stands for, (n,); -1 where there is none."""
    _, nearest = scipy.spatial.cKDTree(bone.surface.points_reference).query(mesh.points_reference, distance_upper_bound=NEAR)
    return np.where(nearest < len(bone), nearest, -1)


@dataclass(frozen=True, eq=False)
class ColoredBone:
    """The surface of bone, ready to be colored by what was met."""

    mesh: BoneMesh  #: Where the bone lies that it was made of
    nearest: Integers
    """(n,). The reachable point of that bone that each corner of the mesh stands for; -1 where there is none."""

    @classmethod
    def of(cls, bone: GuidedBone) -> ColoredBone:
        """The whole surface of a bone, out of reach or not; where there is no CT, a tile for each point of it."""
        if not bone.is_of_ct:
            return cls(_tiles(bone.surface), np.repeat(np.arange(len(bone)), 4))
        step = max(round(CELL / bone.distance.grid.spacing.max()), 1)
        coarse = bone.distance[::step, ::step, ::step]
        mesh = bone_mesh(replace(coarse, array=coarse.array.astype(np.float32) - np.float32(LIFTED)))
        return cls(mesh, _nearest(bone, mesh))

    def placed_by(self, motion: Matrix) -> ColoredBone:
        """The same surface in another place, (4, 4) rigid."""
        return replace(self, mesh=replace(self.mesh, points_reference=transform_points(motion, self.mesh.points_reference)))

    def levels(self, best_cosine: Floats) -> Bytes:
        """`OUT_OF_REACH` to `SQUARELY` at each corner, (n,), from the best cosines of the bone's points (NaN: not met)."""
        with np.errstate(invalid="ignore"):
            steps = NOT_MET + np.isfinite(best_cosine).astype(np.uint8) + (best_cosine > BELOW_60) + (best_cosine > BELOW_45)
        # The last one stands for all that is out of reach
        return np.append(steps.astype(np.uint8), np.uint8(OUT_OF_REACH))[self.nearest]
