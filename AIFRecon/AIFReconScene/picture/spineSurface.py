"""The surface of the bone that a reconstruction shows, in the colors of its distance to the CT's bone."""

import numpy as np
import vtk
from vtk.util import numpy_support

DISTANCE = "Distance to the CT's bone (mm)"
FARTHEST = 6.0
"""mm that has the last color, as has all beyond."""

AT = (0.0, 2.5, 4.0, FARTHEST)
COLORS = np.array([(0.94, 0.88, 0.76), (0.94, 0.88, 0.76), (1.00, 0.62, 0.10), (0.80, 0.05, 0.10)])
"""Bone keeps the color of bone where the CT has it too: the surface lies some 2 mm outside of what it is drawn around."""


def surfaceOf(found) -> vtk.vtkPolyData:
    """A `BoneSurface` as VTK has it."""
    points, cells, surface = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkPolyData()
    points.SetData(numpy_support.numpy_to_vtk(found.points, deep=True))
    cells.SetData(3, numpy_support.numpy_to_vtkIdTypeArray(np.ascontiguousarray(found.triangles.ravel(), dtype=np.int64), deep=True))
    surface.SetPoints(points)
    surface.SetPolys(cells)
    surface.GetPointData().SetNormals(numpy_support.numpy_to_vtk(found.normals, deep=True))
    if found.distances is not None:
        scalars = numpy_support.numpy_to_vtk(found.distances, deep=True)
        scalars.SetName(DISTANCE)
        surface.GetPointData().SetScalars(scalars)
    return surface


def distanceColors(count: int = 256) -> np.ndarray:
    """(count, 3) colors from 0 to `FARTHEST` mm."""
    distances = np.linspace(0.0, FARTHEST, count)
    return np.column_stack([np.interp(distances, AT, channel) for channel in COLORS.T])
