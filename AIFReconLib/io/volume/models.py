"""Surface models of bone as other programs write them: STL, PLY, OBJ and VTK's files, read by VTK."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Floats, Integers
from ...errors import VolumeFormatError
from ...geometry.level_surface import triangles_of
from ..disk.regular_files import require_regular_file
from ..disk.small_files import read_bytes
from .surfaces import polydata

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkPolyData

MODEL_SUFFIXES = (".stl", ".ply", ".obj", ".vtp", ".vtk")

RAS, LPS = "ras", "lps"

UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}
"""mm in each unit that models come in."""

_IN_WORDS = {"m": "meters", "in": "inches"}

SMALLEST, LARGEST = 30.0, 3000.0
"""mm across, below and above which a model is hardly one of bone in mm: a lumbar spine is 20 to 30 cm."""

LARGEST_BONE = 1000.0
"""mm across, up to which another unit is suggested."""

_FACET = np.dtype([("numbers", "<f4", 12), ("attribute", "<u2")])
_HEADER = 84
"""Bytes of a binary STL file before its facets: a text, and how many facets there are."""


@dataclass(frozen=True, eq=False)
class SurfaceModel:
    """A surface of triangles; those of one body run one way around it."""

    points: Floats  #: (n, 3), mm, as the file has them
    triangles: Integers  #: (m, 3), places in `points`
    space: str | None  #: "ras" or "lps" where the file says which; None where it does not


def read_model(path: Path, unit: str | None = None) -> SurfaceModel:
    """The surface in a .stl, .ply, .obj, .vtp or .vtk file.

    Parameters
    ----------
    path : Path
    unit : str or None
        One of `UNITS` that its coordinates are in. By default mm, where the size is one that bone has.

    Raises
    ------
    VolumeFormatError
        When the file is damaged, holds no surface, or one whose size says that it is in another unit; when VTK is not installed.
    """
    if find_spec("vtkmodules") is None:
        raise VolumeFormatError(f"{path}: reading surface models needs VTK. Install it with: pip install vtk")
    require_regular_file(path, VolumeFormatError)
    surface, stated = _stl(path) if path.suffix.lower() == ".stl" else _by_vtk(path)
    points, triangles = _triangles(path, surface)
    across = float(np.ptp(points, axis=0).max())
    if unit is None and not SMALLEST <= across <= LARGEST:
        likely = {name: across * mm for name, mm in UNITS.items() if SMALLEST <= across * mm <= LARGEST_BONE}
        sizes = "".join(f"; in {_IN_WORDS.get(name, name)} it would be {size:.3g} mm" for name, size in likely.items())
        told = f"{path}: it is {across:.3g} across, which is hardly bone in mm{sizes}."
        raise VolumeFormatError(told, "Say with {bone_unit} what it is in (mm, cm, m or in), or export it in mm.")
    return SurfaceModel(points * UNITS[unit or "mm"], triangles, stated)


def _space_in(text: str) -> str | None:
    """The frame that a header names in passing, as Slicer does: ``SPACE=LPS``."""
    found = set(re.findall(r"(?<![A-Za-z])(RAS|LPS)(?![A-Za-z])", text))
    return found.pop().lower() if len(found) == 1 else None


def _stl(path: Path) -> tuple[vtkPolyData, str | None]:
    """Three corners a triangle. VTK refuses capitals, and what follows behind the last triangle."""
    data = read_bytes(path, None, VolumeFormatError)
    count = int.from_bytes(data[_HEADER - 4 : _HEADER], "little")
    if len(data) >= _HEADER + _FACET.itemsize * count and len(data) >= _HEADER:
        corners = np.frombuffer(data, _FACET, count, _HEADER)["numbers"][:, 3:]
        return polydata(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)), _space_in(data[: _HEADER - 4].decode("latin-1"))
    if not re.match(rb"\s*solid", data, re.IGNORECASE) or not re.search(rb"\bfacet\b", data, re.IGNORECASE):
        raise VolumeFormatError(f"{path}: it is cut short: {count} triangles are promised. Copy or export the file again.")
    words = re.findall(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", data, re.IGNORECASE)
    solids, ends = (len(re.findall(rb"^\s*" + word, data, re.IGNORECASE | re.MULTILINE)) for word in (rb"solid\b", rb"end\s?solid\b"))
    if ends < solids or len(words) % 3:
        raise VolumeFormatError(f"{path}: it is cut short: no endsolid. Copy or export the file again.")
    try:
        numbers = np.array(words).astype(np.float64)
    except ValueError as cause:
        raise _unreadable(path) from cause
    return polydata(numbers, np.arange(len(numbers)).reshape(-1, 3)), _space_in(data.lstrip().partition(b"\n")[0].decode("latin-1"))


def _by_vtk(path: Path) -> tuple[vtkPolyData, str | None]:
    """The surface as VTK reads it, and the space that its field, its header or its comments name."""
    from vtkmodules.vtkCommonCore import vtkStringArray
    from vtkmodules.vtkIOGeometry import vtkOBJReader
    from vtkmodules.vtkIOLegacy import vtkPolyDataReader
    from vtkmodules.vtkIOPLY import vtkPLYReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    suffix = path.suffix.lower()
    reader = {".ply": vtkPLYReader, ".obj": vtkOBJReader, ".vtp": vtkXMLPolyDataReader, ".vtk": vtkPolyDataReader}[suffix]()
    with _errors() as told:
        reader.SetFileName(str(path))
        reader.Update()
        surface = reader.GetOutput()
        if told() or surface is None or reader.GetErrorCode():
            raise _unreadable(path)
    texts = reader.GetComments() if suffix == ".ply" else surface.GetFieldData().GetAbstractArray("SPACE")
    if isinstance(texts, vtkStringArray):
        return surface, _space_in("\n".join(map(texts.GetValue, range(texts.GetNumberOfValues()))))
    stated = {".obj": "GetComment", ".vtk": "GetHeader"}.get(suffix)
    return surface, _space_in(getattr(reader, stated)() or "") if stated else None


@contextmanager
def _errors() -> Iterator[Callable[[], str]]:
    """Within the block VTK's errors are kept, and none is printed."""
    from vtkmodules.vtkCommonCore import vtkLogger, vtkOutputWindow, vtkStringOutputWindow

    window, kept, shown = vtkOutputWindow.GetInstance(), vtkStringOutputWindow(), vtkLogger.GetCurrentVerbosityCutoff()
    vtkOutputWindow.SetInstance(kept)
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        yield kept.GetOutput
    finally:
        vtkLogger.SetStderrVerbosity(shown)
        vtkOutputWindow.SetInstance(window)


def _triangles(path: Path, surface: vtkPolyData) -> tuple[Floats, Integers]:
    """Points (n, 3) and triangles (m, 3): equal points joined, strips and polygons taken apart, the triangles of a body turned alike."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkCleanPolyData, vtkPolyDataNormals, vtkTriangleFilter

    count = surface.GetNumberOfPoints()
    corners = np.concatenate([vtk_to_numpy(cells.GetConnectivityArray()) for cells in (surface.GetPolys(), surface.GetStrips())])
    if not ((corners >= 0) & (corners < count)).all() or (count and not np.isfinite(vtk_to_numpy(surface.GetPoints().GetData())).all()):
        raise VolumeFormatError(f"{path}: its points are not all there, or no numbers. Export the model again.")
    split, joined, alike = vtkTriangleFilter(), vtkCleanPolyData(), vtkPolyDataNormals()
    split.PassVertsOff()
    split.PassLinesOff()
    joined.SetTolerance(0.0)
    alike.SplittingOff()
    alike.ConsistencyOn()
    split.SetInputData(surface)
    joined.SetInputConnection(split.GetOutputPort())
    alike.SetInputConnection(joined.GetOutputPort())
    alike.Update()
    points, triangles = triangles_of(alike.GetOutput())
    if not len(triangles):
        raise VolumeFormatError(f"{path}: it holds no triangles. Export the closed surface of the bone.")
    return points.astype(np.float64), triangles.astype(np.int64)


def _unreadable(path: Path) -> VolumeFormatError:
    return VolumeFormatError(f"{path}: it cannot be read as a surface model. Export the model again.")
