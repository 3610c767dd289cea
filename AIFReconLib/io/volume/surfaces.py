"""Surfaces written as VTK's XML files (.vtp), which Slicer loads as models; writing them needs no VTK, making those of labels does."""

from __future__ import annotations

import base64
import struct
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Floats, Numbers
from ...errors import OutputError
from ...geometry.transforms import transform_points
from ...geometry.volume import Volume
from ..disk.atomic import atomic_output, check_writable

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

    Raises OutputError when the suffix is another than .vtp, or no file can be created there.
    """
    if not is_surface_path(path):
        raise OutputError(f"Cannot write {path}: the suffix of a surface must be {SUFFIX}. Choose another name.")
    check_writable(path)


def check_labels_surface_path(path: str | Path) -> None:
    """Return if the closed surface of labels can be written to `path`; to be asked before a long computation.

    Raises OutputError as of `check_surface_path`, and when VTK is not installed.
    """
    check_surface_path(path)
    if find_spec("vtkmodules") is None:
        raise OutputError(f"Cannot write {path}: the surface of labels needs VTK. Install it with: pip install vtk")


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
    places = np.ascontiguousarray(points, np.float32).reshape(-1, 3)
    corners = np.array(triangles, np.int64).reshape(-1, 3)
    members = corners if len(corners) else np.arange(len(places), dtype=np.int64)[:, None]
    ends = np.arange(1, len(members) + 1, dtype=np.int64) * members.shape[1]
    cells = _array("connectivity", members.reshape(-1)) + _array("offsets", ends)
    verts, polys = ("", cells) if len(corners) else (cells, "")
    data = "".join(_array(name, np.asarray(values)) for name, values in point_data.items())
    letters = " ".join(str(ord(letter)) for letter in "RAS") + " 0"
    text = (
        '<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n<PolyData>\n'
        f'<FieldData><Array type="String" Name="{SPACE}" NumberOfTuples="1" format="ascii">{letters}</Array></FieldData>\n'
        f'<Piece NumberOfPoints="{len(places)}" NumberOfVerts="{len(members) if verts else 0}" NumberOfLines="0" NumberOfStrips="0" '
        f'NumberOfPolys="{len(members) if polys else 0}">\n'
        f"<PointData>\n{data}</PointData>\n<Points>\n{_array('Points', places)}</Points>\n"
        f"<Verts>\n{verts}</Verts>\n<Polys>\n{polys}</Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n"
    )
    with atomic_output(path) as temporary:
        temporary.write_text(text, "ascii")


def _array(name: str, values: Numbers) -> str:
    """An array as VTK's XML has it: its length in bytes, then its numbers, in base64."""
    kind = {"f": "Float", "i": "Int", "u": "UInt", "b": "UInt"}[values.dtype.kind] + str(8 * values.dtype.itemsize)
    content = np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<")).tobytes()
    shown = base64.b64encode(struct.pack("<Q", len(content)) + content).decode("ascii")
    parts = values.shape[1] if values.ndim == 2 else 1
    return f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{parts}" format="binary">{shown}</DataArray>\n'


def write_labels_surface(labels: Volume, path: str | Path) -> None:
    """Write the closed surface of labels, each label's own, with the point data ``label``.

    Raises OutputError as of `check_labels_surface_path`; nothing is left then.

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
    check_labels_surface_path(path)
    points, triangles, label = _surface_nets(labels)
    write_surface(path, points, triangles, label=label)


def _surface_nets(labels: Volume) -> tuple[Floats, Numbers, Numbers]:
    """Points (n, 3) in Reference, triangles (m, 3), and the label at each point (n,)."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkSurfaceNets3D

    # A rim of nothing closes what the edge of the volume would cut open
    padded = np.pad(labels.array, 1).astype(np.int32)
    image = vtkImageData()
    image.SetDimensions(*padded.shape[::-1])
    image.SetOrigin(-1.0, -1.0, -1.0)
    image.GetPointData().SetScalars(numpy_to_vtk(padded.ravel(), deep=True))
    nets = vtkSurfaceNets3D()
    nets.SetInputData(image)
    nets.SetBackgroundLabel(0)
    values = np.unique(padded)
    values = values[values != 0]
    nets.SetNumberOfLabels(len(values))
    for place, value in enumerate(values.tolist()):
        nets.SetLabel(place, value)
    nets.SetOutputMeshTypeToTriangles()
    nets.SmoothingOn()
    nets.AutomaticSmoothingConstraintsOff()
    nets.GetSmoother().SetNumberOfIterations(PASSES)
    nets.GetSmoother().SetConstraintStrategyToConstraintDistance()
    nets.GetSmoother().SetConstraintDistance(HALF_A_VOXEL)
    nets.Update()
    surface = nets.GetOutput()
    if not surface.GetNumberOfPolys():
        return np.empty((0, 3)), np.empty((0, 3), np.int64), np.empty(0, np.int32)
    ijk = vtk_to_numpy(surface.GetPoints().GetData())
    triangles = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    sides = vtk_to_numpy(surface.GetCellData().GetScalars()).astype(np.int32)
    # Each triangle has a label on either side; the one that is not nothing owns it, where two meet the higher one
    owner = np.zeros(len(ijk), np.int32)
    np.maximum.at(owner, triangles.ravel(), np.repeat(sides.max(1), 3))
    if np.linalg.det(labels.ijk_to_reference[:3, :3]) < 0:
        triangles = triangles[:, ::-1]
    return transform_points(labels.ijk_to_reference, ijk.astype(float)), triangles, owner
