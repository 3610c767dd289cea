"""The surface of the bone that a reconstruction shows: triangles in RAS, smoothed for display, with their distance to the CT's bone."""

import numpy as np
import vtk
from vtk.util import numpy_support

from ..transforms import vtkMatrixOf

DISTANCE = "Distance to the CT's bone (mm)"
FARTHEST = 6.0
"""mm that has the last color, as has all beyond."""

AT = (0.0, 2.5, 4.0, FARTHEST)
COLORS = np.array([(0.94, 0.88, 0.76), (0.94, 0.88, 0.76), (1.00, 0.62, 0.10), (0.80, 0.05, 0.10)])
"""Bone keeps the color of bone where the CT has it too: the surface lies some 2 mm outside of what it is drawn around."""

ITERATIONS, PASS_BAND = 25, 0.08
"""Of the windowed sinc filter: the staircase of the cells goes, the shape of a process stays."""


def spineSurface(shown) -> vtk.vtkPolyData:
    """The surface of a `ShownBone`.

    Notes
    -----
    Flying edges, then a windowed sinc filter (Taubin, Zhang and Golub 1996), which keeps the size. Called on any thread: nothing is drawn.
    """
    from AIFReconLib.inspection.shown_bone import LEVEL

    field = shown.field
    # A rim of nothing closes surfaces at the border of the volume
    array = np.pad(field.array, 1)
    image = vtk.vtkImageData()
    image.SetDimensions(*array.shape[::-1])
    image.SetOrigin(-1.0, -1.0, -1.0)
    image.GetPointData().SetScalars(numpy_support.numpy_to_vtk(array.ravel(), deep=True))
    edges = vtk.vtkFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, LEVEL)
    edges.ComputeNormalsOff()
    edges.ComputeScalarsOff()
    edges.Update()
    if not edges.GetOutput().GetNumberOfPolys():
        return vtk.vtkPolyData()
    place = vtk.vtkTransform()
    place.SetMatrix(vtkMatrixOf(field.ijk_to_reference))
    placed = vtk.vtkTransformPolyDataFilter()
    placed.SetInputConnection(edges.GetOutputPort())
    placed.SetTransform(place)
    smooth = vtk.vtkWindowedSincPolyDataFilter()
    smooth.SetInputConnection(placed.GetOutputPort())
    smooth.SetNumberOfIterations(ITERATIONS)
    smooth.SetPassBand(PASS_BAND)
    smooth.NormalizeCoordinatesOn()
    smooth.NonManifoldSmoothingOn()
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputConnection(smooth.GetOutputPort())
    normals.SplittingOff()
    # VTK lets nothing else of Python run while it computes: other threads have their turn between two filters
    for each in (placed, smooth, normals):
        each.Update()
    surface = vtk.vtkPolyData()
    surface.ShallowCopy(normals.GetOutput())
    distances = shown.distances(numpy_support.vtk_to_numpy(surface.GetPoints().GetData()).astype(np.float64))
    if distances is not None:
        scalars = numpy_support.numpy_to_vtk(distances.astype(np.float32), deep=True)
        scalars.SetName(DISTANCE)
        surface.GetPointData().SetScalars(scalars)
    return surface


def distanceColors(count: int = 256) -> np.ndarray:
    """(count, 3) colors from 0 to `FARTHEST` mm."""
    distances = np.linspace(0.0, FARTHEST, count)
    return np.column_stack([np.interp(distances, AT, channel) for channel in COLORS.T])
