"""The surface on which a volume has one value, as triangles of VTK."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Numbers
from .volume import Volume


def level_surface(field: Volume, level: float, beyond: float) -> Any:
    """The surface where a volume rises above a level, in Reference: a `vtkPolyData` of triangles. `beyond` its borders lies this.

    Triangles run counterclockwise seen from where the volume is lower. VTK is needed.

    References
    ----------
    Schroeder W, Maynard R, Geveci B (2015), "Flying edges: A high-performance scalable isocontouring algorithm", LDAV.
    """
    from vtkmodules.vtkCommonTransforms import vtkTransform
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkReverseSense
    from vtkmodules.vtkFiltersGeneral import vtkTransformPolyDataFilter

    edges = vtkFlyingEdges3D()
    edges.SetInputData(padded_image(field.array, beyond))
    edges.SetValue(0, level)
    edges.ComputeNormalsOff()
    edges.ComputeScalarsOff()
    place = vtkTransform()
    place.SetMatrix(field.ijk_to_reference.ravel().tolist())
    placed = vtkTransformPolyDataFilter()
    placed.SetInputConnection(edges.GetOutputPort())
    placed.SetTransform(place)
    last: Any = placed
    if np.linalg.det(field.ijk_to_reference[:3, :3]) < 0:
        last = vtkReverseSense()
        last.SetInputConnection(placed.GetOutputPort())
    last.Update()
    return last.GetOutput()


def padded_image(array: Numbers, beyond: float) -> Any:
    """An array [k, j, i] as a `vtkImageData`, whose points are voxel numbers, with a rim of one more voxel that closes surfaces."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData

    padded, image = np.pad(array, 1, constant_values=beyond), vtkImageData()
    image.SetDimensions(*padded.shape[::-1])
    image.SetOrigin(-1.0, -1.0, -1.0)
    image.GetPointData().SetScalars(numpy_to_vtk(padded.ravel(), deep=True))
    return image


def triangles_of(surface: Any) -> tuple[Any, Any]:
    """Points (n, 3), mm in Reference, and triangles (m, 3) of a `vtkPolyData`."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    points, cells = surface.GetPoints(), surface.GetPolys()
    if not surface.GetNumberOfPolys():
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    return vtk_to_numpy(points.GetData()), vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, 3)
