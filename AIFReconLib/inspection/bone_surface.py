"""The surface of the bone that a reconstruction shows, as arrays: what a view in 3D draws of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Integers, Singles

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
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkCommonTransforms import vtkTransform
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkPolyDataNormals, vtkWindowedSincPolyDataFilter
    from vtkmodules.vtkFiltersGeneral import vtkTransformPolyDataFilter

    from .shown_bone import LEVEL

    # A rim of nothing closes surfaces at the border of the volume
    array = np.pad(shown.field.array, 1)
    image = vtkImageData()
    image.SetDimensions(*array.shape[::-1])
    image.SetOrigin(-1.0, -1.0, -1.0)
    image.GetPointData().SetScalars(numpy_to_vtk(array.ravel(), deep=True))
    edges = vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, LEVEL)
    edges.ComputeNormalsOff()
    edges.ComputeScalarsOff()
    edges.Update()
    if not edges.GetOutput().GetNumberOfPolys():
        return None
    place = vtkTransform()
    place.SetMatrix(shown.field.ijk_to_reference.ravel().tolist())
    placed = vtkTransformPolyDataFilter()
    placed.SetInputConnection(edges.GetOutputPort())
    placed.SetTransform(place)
    smooth = vtkWindowedSincPolyDataFilter()
    smooth.SetInputConnection(placed.GetOutputPort())
    smooth.SetNumberOfIterations(ITERATIONS)
    smooth.SetPassBand(PASS_BAND)
    smooth.NormalizeCoordinatesOn()
    smooth.NonManifoldSmoothingOn()
    normals = vtkPolyDataNormals()
    normals.SetInputConnection(smooth.GetOutputPort())
    normals.SplittingOff()
    normals.Update()
    surface = normals.GetOutput()
    points = vtk_to_numpy(surface.GetPoints().GetData())
    distances = shown.distances(points.astype(np.float64))
    return ShownBoneMesh(
        points,
        vtk_to_numpy(surface.GetPointData().GetNormals()),
        vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3),
        None if distances is None else distances.astype(np.float32),
    )
