"""Surfaces as VTK's XML files (.vtp), which Slicer opens as models; written without VTK."""

from __future__ import annotations

import base64
import struct
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ...arrays import Floats, Integers, Numbers
from ...errors import OutputError
from ...geometry.transforms import LPS_FROM_RAS, transform_points
from ..disk.atomic import write_text

_TYPES = {"float32": "Float32", "int32": "Int32", "uint8": "UInt8"}


def check_surface_path(path: Path) -> None:
    """Return if a surface can be written under this name.

    Raises
    ------
    OutputError
        When it does not end with .vtp.
    """
    if path.suffix.lower() != ".vtp":
        raise OutputError("{path}: a surface is written as VTK's XML. Choose a name that ends with .vtp.", path=path)


def write_surface(points_reference: Floats, triangles: Integers, point_data: Mapping[str, Numbers], path: str | Path) -> None:
    """Write a surface, completely or not at all.

    Parameters
    ----------
    points_reference : (n, 3) array, mm
        Reference is taken as RAS, and the file holds LPS, which its header says: so it lies in Slicer where it belongs.
    triangles : (m, 3) int array
    point_data : mapping of str to (n,) array
        float32, int32 or uint8.
    path : str or Path

    Raises
    ------
    OutputError
        When it cannot be written.
    """
    points = transform_points(LPS_FROM_RAS, points_reference).astype(np.float32)
    corners = triangles.astype(np.int32)
    ends = np.arange(3, 3 * len(corners) + 1, 3, dtype=np.int32)
    arrays = "".join(_array(name, values) for name, values in point_data.items())
    text = (
        '<?xml version="1.0"?>\n'
        '<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian">\n<PolyData>\n'
        '<FieldData><Array type="String" Name="SPACE" NumberOfTuples="1" format="ascii">76 80 83 0</Array></FieldData>\n'
        f'<Piece NumberOfPoints="{len(points)}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="{len(corners)}">\n'
        f"<PointData>\n{arrays}</PointData>\n"
        f"<Points>\n{_array('Points', points)}</Points>\n"
        f"<Polys>\n{_array('connectivity', corners.reshape(-1))}{_array('offsets', ends)}</Polys>\n"
        "</Piece>\n</PolyData>\n</VTKFile>\n"
    )
    write_text(Path(path), text)


def _array(name: str, values: Numbers) -> str:
    data = np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<")).tobytes()
    shown = base64.b64encode(struct.pack("<I", len(data)) + data).decode("ascii")
    parts = values.shape[1] if values.ndim == 2 else 1
    return f'<DataArray type="{_TYPES[values.dtype.name]}" Name="{name}" NumberOfComponents="{parts}" format="binary">{shown}</DataArray>\n'
