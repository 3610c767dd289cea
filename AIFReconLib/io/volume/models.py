"""Surface models of bone as other programs write them: STL, PLY, OBJ and VTP, in mm."""

from __future__ import annotations

import base64
import re
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from ...arrays import Floats, Integers, Numbers
from ...errors import FileFormatError, VolumeFormatError
from ...machine.memory import available_memory, require_bytes
from ..disk.small_files import read_bytes
from ..disk.xml_tree import parse_xml

MODEL_SUFFIXES = (".stl", ".ply", ".obj", ".vtp")

RAS, LPS = "ras", "lps"

TOO_SMALL, TOO_LARGE = 3.0, 3000.0
"""mm across, below and above which a model is in another unit."""

LARGEST_XML = 2**30
"""Bytes of a VTK file."""

_COPIES = 12
"""Bytes taken for each byte of a file while it is read."""

_PLY_TYPES = {
    "char": "i1",
    "int8": "i1",
    "uchar": "u1",
    "uint8": "u1",
    "short": "i2",
    "int16": "i2",
    "ushort": "u2",
    "uint16": "u2",
    "int": "i4",
    "int32": "i4",
    "uint": "u4",
    "uint32": "u4",
    "float": "f4",
    "float32": "f4",
    "double": "f8",
    "float64": "f8",
}
_VTK_TYPES = {f"{word}{bits}": f"{letter}{bits // 8}" for word, letter in (("Int", "i"), ("UInt", "u")) for bits in (8, 16, 32, 64)}
_VTK_TYPES |= {"Float32": "f4", "Float64": "f8"}


@dataclass(frozen=True, eq=False)
class SurfaceModel:
    """A closed surface of triangles."""

    points: Floats  #: (n, 3), mm, as the file has them
    triangles: Integers  #: (m, 3), places in `points`
    space: str | None  #: "ras" or "lps" where the file says which; None where it does not


def read_model(path: Path) -> SurfaceModel:
    """The surface in a .stl, .ply, .obj or .vtp file.

    Raises VolumeFormatError when the file is damaged, holds no surface, or one that cannot be in mm.
    """
    data = read_bytes(path, 2**31, VolumeFormatError)
    require_bytes(path, _COPIES * len(data), available_memory())
    reader = {".stl": _stl, ".ply": _ply, ".obj": _obj, ".vtp": _vtp}[path.suffix.lower()]
    try:
        points, triangles, said = reader(path, data)
        points, triangles = np.asarray(points, np.float64).reshape(-1, 3), np.asarray(triangles, np.int64).reshape(-1, 3)
    except (ValueError, IndexError, KeyError, OverflowError, MemoryError, zlib.error) as cause:
        if isinstance(cause, FileFormatError):
            raise
        raise VolumeFormatError(f"{path}: it cannot be read as a surface model. Export the model again.") from cause
    if not len(triangles):
        raise VolumeFormatError(f"{path}: it holds no triangles. Export the closed surface of the bone.")
    if triangles.min() < 0 or triangles.max() >= len(points) or not np.isfinite(points).all():
        raise VolumeFormatError(f"{path}: its points are not all there, or no numbers. Export the model again.")
    across = float(np.ptp(points[triangles.ravel()], axis=0).max())
    if not TOO_SMALL <= across <= TOO_LARGE:
        raise VolumeFormatError(f"{path}: it is {across:.3g} across, so it is not in mm. Export the model in mm.")
    return SurfaceModel(points, triangles, said)


def _space_in(text: str) -> str | None:
    """The frame that a header names in passing, as Slicer does: ``SPACE=LPS``."""
    found = set(re.findall(r"(?<![A-Za-z])(RAS|LPS)(?![A-Za-z])", text))
    return found.pop().lower() if len(found) == 1 else None


def _stl(path: Path, data: bytes) -> tuple[Floats, Integers, str | None]:
    """Three corners a triangle; a file that begins with ``solid`` may still be binary."""
    count = int(np.frombuffer(data[80:84].ljust(4, b"\0"), "<u4")[0])
    if len(data) >= 84 and len(data) == 84 + 50 * count:
        facets = np.frombuffer(data, np.dtype([("numbers", "<f4", 12), ("rest", "<u2")]), count, 84)
        return *_joined(facets["numbers"][:, 3:].reshape(-1, 3).astype(np.float64)), _space_in(data[:80].decode("latin-1"))
    if not data.lstrip().startswith(b"solid"):
        raise VolumeFormatError(f"{path}: it is cut short: {count} triangles are promised. Copy or export the file again.")
    numbers = re.findall(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)", data)
    if b"endsolid" not in data[-200:] or len(numbers) % 3:
        raise VolumeFormatError(f"{path}: it is cut short: no endsolid. Copy or export the file again.")
    return *_joined(np.array(numbers, dtype="S32").astype(np.float64)), _space_in(data.partition(b"\n")[0].decode("latin-1"))


def _joined(corners: Floats) -> tuple[Floats, Integers]:
    """Points and triangles of corners (3 m, 3)."""
    points, places = np.unique(corners, axis=0, return_inverse=True)
    return points, places.reshape(-1, 3)


def _fans(corners: list[Integers]) -> Integers:
    """Triangles of polygons."""
    triangles = [np.stack([one[:1].repeat(len(one) - 2), one[1:-1], one[2:]], axis=1) for one in corners if len(one) > 2]
    return np.concatenate(triangles) if triangles else np.empty((0, 3), np.int64)


def _obj(path: Path, data: bytes) -> tuple[Floats, Integers, str | None]:
    """``v x y z`` and ``f a b c ...`` with numbers from 1, or from the end below 0; what is beside a slash is not needed."""
    points: list[list[float]] = []
    faces: list[Integers] = []
    text = data.decode("latin-1")
    for line in text.splitlines():
        kind, _, rest = line.strip().partition(" ")
        if kind == "v":
            points.append([float(word) for word in rest.split()[:3]])
        elif kind == "f":
            corners = np.array([int(word.partition("/")[0]) for word in rest.split()])
            faces.append(np.where(corners > 0, corners - 1, corners + len(points)))
    return np.array(points), _fans(faces), _space_in("\n".join(line for line in text.splitlines()[:50] if line.startswith("#")))


def _ply(path: Path, data: bytes) -> tuple[Floats, Integers, str | None]:
    """Elements in the order of the header; of vertices x, y, z are taken, of faces their list of corners."""
    head, mark, body = data.partition(b"end_header\n")
    if not mark:
        head, mark, body = data.partition(b"end_header\r\n")
    lines = head.decode("latin-1").splitlines()
    if not mark or not lines or lines[0].strip() != "ply":
        raise VolumeFormatError(f"{path}: it has no header of a PLY file. Export the model again.")
    form = next(line.split()[1] for line in lines if line.startswith("format "))
    elements: list[tuple[str, int, list[list[str]]]] = []
    for line in lines:
        words = line.split()
        if words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
    rows = _AsciiRows(body) if form == "ascii" else _BinaryRows(body, "<" if form == "binary_little_endian" else ">")
    points: Floats = np.empty((0, 3))
    triangles: Integers = np.empty((0, 3), np.int64)
    for name, count, properties in elements:
        if any(words[0] == "list" for words in properties):
            corners = rows.lists(count, properties)
            triangles = _fans(corners) if name == "face" else triangles
        else:
            values = rows.table(count, properties)
            points = np.stack([values[axis] for axis in "xyz"], axis=1) if name == "vertex" else points
    return points, triangles, _space_in("\n".join(line for line in lines if line.startswith("comment")))


class _AsciiRows:
    def __init__(self, body: bytes):
        self._lines = body.decode("latin-1").split("\n")
        self._at = 0

    def _next(self, count: int) -> list[list[str]]:
        rows = [line.split() for line in self._lines[self._at : self._at + count]]
        self._at += count
        if len(rows) < count or not all(rows):
            raise ValueError
        return rows

    def table(self, count: int, properties: list[list[str]]) -> dict[str, Floats]:
        rows = self._next(count)
        return {words[-1]: np.array([float(row[place]) for row in rows]) for place, words in enumerate(properties)}

    def lists(self, count: int, properties: list[list[str]]) -> list[Integers]:
        before = next(place for place, words in enumerate(properties) if words[0] == "list")
        return [np.array(row[before + 1 : before + 1 + int(row[before])], dtype=np.int64) for row in self._next(count)]


class _BinaryRows:
    def __init__(self, body: bytes, order: str):
        self._body, self._order, self._at = body, order, 0

    def _take(self, kind: np.dtype[Any], count: int) -> np.ndarray[Any, np.dtype[Any]]:
        values = np.frombuffer(self._body, kind, count, self._at)
        self._at += values.nbytes
        return values

    def table(self, count: int, properties: list[list[str]]) -> dict[str, Floats]:
        row = np.dtype([(words[-1], self._order + _PLY_TYPES[words[0]]) for words in properties])
        values = self._take(row, count)
        return {words[-1]: values[words[-1]].astype(np.float64) for words in properties}

    def lists(self, count: int, properties: list[list[str]]) -> list[Integers]:
        if len(properties) == 1 and count:
            # All triangles, as nearly always: read in one piece
            sizes, kind = (np.dtype(self._order + _PLY_TYPES[word]) for word in properties[0][1:3])
            row = np.dtype([("n", sizes), ("corners", kind, 3)])
            if len(self._body) - self._at >= count * row.itemsize:
                faces = np.frombuffer(self._body, row, count, self._at)
                if (faces["n"] == 3).all():
                    self._at += count * row.itemsize
                    return list(faces["corners"].astype(np.int64))
        found: list[Integers] = []
        for _ in range(count):
            for words in properties:
                if words[0] != "list":
                    self._take(np.dtype(self._order + _PLY_TYPES[words[0]]), 1)
                    continue
                (length,) = self._take(np.dtype(self._order + _PLY_TYPES[words[1]]), 1)
                corners = self._take(np.dtype(self._order + _PLY_TYPES[words[2]]), int(length))
                if words[-1] in ("vertex_indices", "vertex_index"):
                    found.append(corners.astype(np.int64))
        return found


def _vtp(path: Path, data: bytes) -> tuple[Floats, Integers, str | None]:
    """VTK's XML: arrays in the text, in base64, or appended in base64, compressed or not."""
    root = parse_xml(path, VolumeFormatError, "Save the model from Slicer again.", LARGEST_XML)
    if root.get("type") != "PolyData" or re.search(rb"<AppendedData[^>]*encoding=\"raw\"", data):
        raise VolumeFormatError(f"{path}: it is no VTK surface that can be read here. Save the model from Slicer again.")
    arrays = _VtkArrays(root)
    points: list[Floats] = []
    triangles: list[Integers] = []
    before = 0
    for piece in root.iter("Piece"):
        places = arrays.of(piece, "Points", None).reshape(-1, 3)
        ends = arrays.of(piece, "Polys", "offsets").astype(np.int64)
        corners = arrays.of(piece, "Polys", "connectivity").astype(np.int64)
        triangles.append(_fans(np.split(corners + before, ends[:-1])) if len(ends) else np.empty((0, 3), np.int64))
        if len(arrays.of(piece, "Strips", "offsets")):
            raise VolumeFormatError(f"{path}: it holds strips. Save the model from Slicer as triangles.")
        points.append(places.astype(np.float64))
        before += len(places)
    said = arrays.space()
    return np.concatenate(points), np.concatenate(triangles), said


class _VtkArrays:
    """The arrays of a VTK file."""

    def __init__(self, root: Element):
        self._root = root
        self._order = ">" if root.get("byte_order") == "BigEndian" else "<"
        self._count = np.dtype(self._order + ("u8" if root.get("header_type") == "UInt64" else "u4"))
        self._compressed = root.get("compressor") is not None
        if self._compressed and root.get("compressor") != "vtkZLibDataCompressor":
            raise ValueError
        appended = root.find("AppendedData")
        self._appended = "" if appended is None else (appended.text or "").strip().lstrip("_")

    def of(self, piece: Element, group: str, name: str | None) -> Numbers:
        inside = piece.find(group)
        found = [one for one in ([] if inside is None else inside.iter("DataArray")) if name in (None, one.get("Name"))]
        return self._values(found[0], _VTK_TYPES[found[0].get("type", "")]) if found else np.empty(0)

    def space(self) -> str | None:
        for one in self._root.iter("Array"):
            if one.get("Name") == "SPACE" and one.get("format") == "ascii":
                letters = "".join(chr(int(code)) for code in (one.text or "").split() if 0 < int(code) < 256)
                return _space_in(letters)
        return None

    def _values(self, element: Element, kind: str) -> Numbers:
        text = element.text or ""
        if element.get("format") == "ascii":
            return np.array(text.split(), dtype=np.float64).astype(kind)
        if element.get("format") == "appended":
            text = self._appended[int(element.get("offset", "0")) :]
        return np.frombuffer(self._decoded(text.strip()), self._order + kind)

    def _decoded(self, text: str) -> bytes:
        size = self._count.itemsize
        if not self._compressed:
            # One text: the number of bytes, then they
            (length,) = np.frombuffer(_base64(text, size), self._count)
            return _base64(text, size + int(length))[size:]
        (blocks,) = np.frombuffer(_base64(text, size), self._count)
        head = np.frombuffer(_base64(text, size * (3 + int(blocks))), self._count).astype(np.int64)
        start = -(-size * len(head) // 3) * 4
        packed = _base64(text[start:], int(head[3:].sum()))
        ends = np.cumsum(head[3:])
        whole, last = int(head[1]), int(head[2])
        return b"".join(
            zlib.decompressobj().decompress(packed[end - length : end], (last or whole) if number == len(ends) - 1 else whole)
            for number, (end, length) in enumerate(zip(ends.tolist(), head[3:].tolist()))
        )


def _base64(text: str, count: int) -> bytes:
    """The first so many bytes that a text in base64 holds."""
    data = base64.b64decode(text[: -(-count // 3) * 4])[:count]
    if len(data) < count:
        raise ValueError
    return data
