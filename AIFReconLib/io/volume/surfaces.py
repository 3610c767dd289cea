"""Surfaces written by VTK as its XML files (.vtp), which Slicer loads as models."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Numbers
from ...errors import OutputError
from ...geometry.level_surface import padded_image, triangles_of
from ...geometry.transforms import transform_points
from ...geometry.volume import Volume
from ..disk.atomic import atomic_output, check_writable

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPolyData

SUFFIX = ".vtp"

SPACE = "SPACE"
"""Name of the field that tells Slicer how coordinates count; a file without it is taken for LPS."""

PASSES = 15
"""Of smoothing. More take out the voxels' steps no better."""

HALF_A_VOXEL = 0.5
"""How far smoothing may move a point, so that thin processes do not waste away."""


def is_surface_path(path: str | Path) -> bool:
    """Whether the name is that of a surface."""
    return Path(path).suffix.lower() == SUFFIX


def check_surface_path(path: str | Path) -> None:
    """Return if a surface can be written to `path`; to be asked before a long computation.

    Raises OutputError when the suffix is another than .vtp, no file can be created there, or VTK is not installed.
    """
    if not is_surface_path(path):
        raise OutputError(f"Cannot write {path}: the suffix of a surface must be {SUFFIX}. Choose another name.")
    check_writable(path)
    if find_spec("vtkmodules") is None:
        raise OutputError(f"Cannot write {path}: surfaces need VTK. Install it with: pip install vtk")


def write_surface(path: str | Path, points: ArrayLike, triangles: ArrayLike = (), **point_data: ArrayLike) -> None:
    """Write points, the triangles between them and what is known at each.

    Raises OutputError when the file cannot be written; nothing is left then.

    Parameters
    ----------
    path : str or Path
        Ends in .vtp.
    points : (n, 3) array_like, mm
        RAS; the file says so.
    triangles : (m, 3) array_like of int
        Places in `points`, counterclockwise seen from outside. Without any, every point is drawn as itself.
    **point_data : (n,) or (n, k) array_like
        By name.
    """
    check_surface_path(path)
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkStringArray
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    places = np.array(points, np.float32).reshape(-1, 3)
    corners = np.array(triangles, np.int64).reshape(-1, 3)
    surface = polydata(places, corners if len(corners) else np.arange(len(places))[:, None])
    for name, values in point_data.items():
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
        array.SetName(name)
        surface.GetPointData().AddArray(array)
    space = vtkStringArray()
    space.SetName(SPACE)
    space.InsertNextValue("RAS")
    surface.GetFieldData().AddArray(space)
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(surface)
    with atomic_output(path) as temporary:
        writer.SetFileName(str(temporary))
        if not writer.Write():
            raise OutputError(f"Cannot write {path}: the file came out incomplete. Check that the disk is not full.")


def polydata(points: Numbers, cells: Numbers) -> vtkPolyData:
    """A surface of VTK of points (n, 3) and of triangles (m, 3) between them, or of points that are seen as they are, (m, 1)."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

    places, members, surface = vtkPoints(), vtkCellArray(), vtkPolyData()
    places.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    members.SetData(cells.shape[1], numpy_to_vtkIdTypeArray(cells.astype(np.int64).ravel(), deep=True))
    surface.SetPoints(places)
    (surface.SetPolys if cells.shape[1] == 3 else surface.SetVerts)(members)
    return surface


def write_labels_surface(labels: Volume, path: str | Path) -> None:
    """Write the closed surface of labels, each label's own, with the point data ``label``.

    Raises OutputError as of `check_surface_path`; nothing is left then.

    Parameters
    ----------
    labels : Volume of int
        In Reference; 0 is nothing.
    path : str or Path
        Ends in .vtp.

    Notes
    -----
    Surfaces of neighbors meet without a gap (VTK's surface nets: Frisken SF (2022), SurfaceNets for multi-label segmentations with
    preservation of sharp boundaries, Journal of Computer Graphics Techniques 11(1)) and are smoothed by at most half a voxel.
    """
    check_surface_path(path)
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkSurfaceNets3D

    nets = vtkSurfaceNets3D()
    nets.SetInputData(padded_image(labels.array.astype(np.int32), 0))
    nets.SetBackgroundLabel(0)
    values = np.unique(labels.array)
    for place, value in enumerate(values[values != 0].tolist()):
        nets.SetLabel(place, value)
    nets.SetOutputMeshTypeToTriangles()
    nets.SmoothingOn()
    nets.AutomaticSmoothingConstraintsOff()
    nets.GetSmoother().SetNumberOfIterations(PASSES)
    nets.GetSmoother().SetConstraintStrategyToConstraintDistance()
    nets.GetSmoother().SetConstraintDistance(HALF_A_VOXEL)
    nets.Update()
    surface = nets.GetOutput()
    ijk, triangles = triangles_of(surface)
    owner = np.zeros(len(ijk), np.int32)
    if len(triangles):
        sides = vtk_to_numpy(surface.GetCellData().GetScalars()).astype(np.int32)
        # Each triangle has a label on either side; the one that is not nothing owns it, where two meet the higher one
        np.maximum.at(owner, triangles.ravel(), np.repeat(sides.max(1), 3))
    if np.linalg.det(labels.ijk_to_reference[:3, :3]) < 0:
        triangles = triangles[:, ::-1]
    write_surface(path, transform_points(labels.ijk_to_reference, ijk.astype(float)), triangles, label=owner)
