"""The surface of the bone that a reconstruction shows, as arrays: what a view in 3D draws of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Integers, Singles
from ..geometry.level_surface import level_surface, triangles_of

if TYPE_CHECKING:
    from .shown_bone import ShownBone

ITERATIONS, PASS_BAND = 25, 0.08
"""Of the windowed sinc filter: the staircase of the cells goes, the shape of a process stays."""


@dataclass(frozen=True, eq=False)
class ShownBoneMesh:
    """Triangles in Reference, smoothed for display."""

    points: Singles  #: (n, 3), mm
    normals: Singles  #: (n, 3)
    triangles: Integers  #: (m, 3). Numbers of points
    distances: Singles | None  #: (n,), mm. To the CT's bone, where there is one


def bone_surface(shown: ShownBone) -> ShownBoneMesh | None:
    """The surface of a `ShownBone`; None where it shows none.

    Notes
    -----
    Flying edges, then a windowed sinc filter (Taubin, Zhang and Golub 1996), which keeps the size.
    """
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkPolyDataNormals, vtkWindowedSincPolyDataFilter

    from .shown_bone import LEVEL

    placed = level_surface(shown.field, LEVEL, 0.0)
    if not placed.GetNumberOfPolys():
        return None
    smooth = vtkWindowedSincPolyDataFilter()
    smooth.SetInputData(placed)
    smooth.SetNumberOfIterations(ITERATIONS)
    smooth.SetPassBand(PASS_BAND)
    smooth.NormalizeCoordinatesOn()
    smooth.NonManifoldSmoothingOn()
    normals = vtkPolyDataNormals()
    normals.SetInputConnection(smooth.GetOutputPort())
    normals.SplittingOff()
    normals.Update()
    surface = normals.GetOutput()
    points, triangles = triangles_of(surface)
    distances = shown.distances(points.astype(np.float64))
    return ShownBoneMesh(
        points,
        vtk_to_numpy(surface.GetPointData().GetNormals()),
        triangles,
        None if distances is None else distances.astype(np.float32),
    )
