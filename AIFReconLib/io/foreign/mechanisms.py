"""Descriptions of mechanisms (TOML or JSON), and tables of what their axes read, which together give poses."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from ...arrays import Floats, Matrix
from ...errors import FileFormatError
from ...geometry.mechanism import FIXED, SHIFT, TURN, Axis, Mechanism
from ...geometry.transforms import why_not_rigid
from ...message import listed, shorten
from ..disk.tables import JSON, TOML, read_table
from ..sequence.metafiles import METAFILES
from .options import ImportOptions
from .poses.files import PoseTable, naming, posed, read_sheets
from .poses.headings import ANGLES, IMAGE, LENGTHS, STATUS, TIME, Column, column_of
from .poses.sheet import Sheet
from .poses.tracks import Track

METERS = 1000.0
MOST_AXES = 64
_KEYS = {
    "axis": ("name", "kind", "direction", "point", "scale", "zero"),
    "joint": ("name", "type", "axis", "xyz", "rpy", "scale", "zero"),
}
_KINDS = {
    "axis": {SHIFT: SHIFT, TURN: TURN},
    "joint": {"prismatic": SHIFT, "revolute": TURN, "continuous": TURN, "fixed": FIXED},
}
_STEPS = (("scale", 1.0), ("zero", 0.0))


def read_mechanism(path: str | Path) -> Mechanism:
    """The mechanism that a file describes.

    Raises FileFormatError, which names what is missing, or cannot be used.

    Parameters
    ----------
    path : str or Path
        .toml or .json. Either ``axis``, a list of tables in order from the base to the probe: name, kind (shift or turn), direction, and
        of a turn the point that it goes through in mm, all in the base and as they lie with all axes at zero. Or ``joint``, a list as URDF
        has them: name, type (prismatic, revolute, continuous, fixed), axis, xyz in m and rpy in rad. Each may have scale and zero: where
        the table reads r, it has moved by (r - zero) * scale. And ``home``, the probe's pose when all are at zero: 4 rows of 4 numbers, mm.
    """
    path = Path(path)
    if path.suffix.lower() not in (JSON, TOML):
        raise FileFormatError(f"{path}: a mechanism is described in .toml or .json. Give such a file.")
    read = read_table(path, FileFormatError, "Correct the file.")
    table: dict[str, Any] = read if isinstance(read, dict) else {}
    form = "axis" if "axis" in table else "joint"
    items = table.get(form)
    if set(table) - {form, "home"} or not isinstance(items, list) or not 0 < len(items) <= MOST_AXES:
        raise FileFormatError(
            f"{path}: a mechanism must have a list of axis or of joint (1 to {MOST_AXES}), and may have home; "
            f"got {shorten(listed(table)) or 'nothing'}."
        )
    axes = [_axis(f"{path}: {form} {number}", form, item) for number, item in enumerate(items, start=1)]
    home = _numbers(f"{path}: home must be 4 rows of 4 numbers, in mm", table.get("home", np.eye(4)), (4, 4))
    if reason := why_not_rigid(home):
        raise FileFormatError(f"{path}: home must be a rotation and a translation; it is {reason}. Correct the numbers.")
    mechanism = Mechanism(tuple(axes), home)
    names = [axis.name.lower() for axis in mechanism.moving]
    if len(set(names)) < len(names) or not names:
        raise FileFormatError(f"{path}: its axes must have a name each, and one must move; got {listed(names) or 'none'}.")
    return mechanism


def read_joint_poses(path: str | Path, mechanism: Mechanism, form: ImportOptions | None = None) -> PoseTable:
    """The poses of what a mechanism carries, from a table with a column for each of its axes, by their names.

    Raises FileFormatError, which names the line and the column that cannot be used; SettingsError when the times or what the table says of
    a pose cannot be understood.

    Parameters
    ----------
    path : str or Path
        Columns besides: time, image, status. Without headings the columns are the axes in order, with the time in front or not. Or a
        recording (.mha, .nrrd and the like) whose frames have a field for each axis.
    mechanism : Mechanism
    form : ImportOptions
        Units of shifts and of turns in the table where its headings say none (mm and degrees if neither does), and names of its columns.
    """
    path, form = Path(path), form or ImportOptions()
    with naming(path):
        if path.suffix.lower() in METAFILES.suffixes:
            return _of_fields(path, mechanism, form)
        sheets = read_sheets(path)
        if not sheets:
            raise FileFormatError("it holds no values of the axes. Give a table with one row per frame.")
        return _poses(sheets[0], mechanism, form)


def _poses(sheet: Sheet, mechanism: Mechanism, form: ImportOptions) -> PoseTable:
    track = Track("", _columns(sheet, mechanism, form))
    moved, told = [], []
    for axis in mechanism.moving:
        column = track.described[place := track.columns[axis.name.lower()]]
        lengths = axis.kind == SHIFT
        said_here = column.unit if column.unit in (LENGTHS if lengths else ANGLES) else None
        unit = said_here or (form.units or "mm" if lengths else form.angle_unit or "deg")
        amount = LENGTHS[unit] if lengths else math.pi / 180 if unit == "deg" else 1.0
        moved.append((sheet.numbers(place, column.heading) - axis.zero) * axis.scale * amount)
        told.append(f"{axis.name} ({axis.kind}, {unit})")
    matrices = mechanism.poses(np.stack(moved, axis=1))
    return posed(matrices, track, sheet, form, [f"{len(matrices)}, of a mechanism: {listed(told)}"])


def _of_fields(path: Path, mechanism: Mechanism, form: ImportOptions) -> PoseTable:
    """The same, of the fields of a recording's frames."""
    records = METAFILES.read(path, None).records
    fields = [{name.lower(): value for name, value in record.fields.items()} for record in records]
    axes = [axis.name.lower() for axis in mechanism.moving]
    missing = next((name for name in axes if not any(name in each for each in fields)), None)
    if missing is not None:
        there = listed(dict.fromkeys(name for each in fields for name in each)) or "none"
        raise FileFormatError(f"its frames must have a field {missing}, for the axis of this name; got {shorten(there, 200)}.")
    rows = [[each.get(name, "nan") for name in axes] for each in fields]
    table = _poses(Sheet(rows, range(len(rows)), axes, item="frame"), mechanism, form)
    times = [record.timestamp for record in records]
    return replace(table, times=None if None in times else np.array(times, dtype=np.float64))


def _columns(sheet: Sheet, mechanism: Mechanism, form: ImportOptions) -> dict[int, Column]:
    """What each column holds: an axis under its name in small letters, or time, image, status."""
    axes = [axis.name.lower() for axis in mechanism.moving]
    headings = list(form.column_names or sheet.headings or [TIME, *axes][len(axes) + 1 - sheet.width :])
    if len(headings) != sheet.width:
        raise FileFormatError(
            f"without headings there must be {len(axes)} columns ({listed(axes)}), or the time in front; got {sheet.width}."
        )
    columns = {}
    for place, column in enumerate(map(column_of, headings)):
        bare = re.sub(r"[(\[][^)\]]*[)\]]", "", column.heading).strip().lower()
        role = bare if bare in axes else column.role if column.role in (TIME, IMAGE, STATUS) else None
        columns[place] = replace(column, role=role)
    roles = [column.role for column in columns.values()]
    wrong = next((name for name in axes if roles.count(name) != 1), None)
    if wrong is not None:
        raise FileFormatError(f"it must have one column {wrong}, for the axis of this name; got {listed(headings)}. Correct the headings.")
    return columns


def _axis(where: str, form: str, item: object) -> Axis:
    """An axis, or a joint of URDF: its origin (xyz, rpy about fixed axes) is in the frame of the one before."""
    if not isinstance(item, dict):
        raise FileFormatError(f"{where} must be a table of names and values. Correct the file.")
    name, known, kinds = item.get("name"), _KEYS[form], _KINDS[form]
    kind = kinds.get(str(item.get(known[1])))
    if kind is None:
        raise FileFormatError(f"{where}: {known[1]} must be {listed(kinds, ' or ')}; got {shorten(repr(item.get(known[1])))}.")
    if not isinstance(name, str) or not re.fullmatch(r"[^\s,;]+", name):
        raise FileFormatError(f"{where}: name must be a word, the heading of its column; got {shorten(repr(name))}.")
    if unknown := sorted(set(item) - set(known)):
        raise FileFormatError(f"{where} ({name}): {listed(unknown)} is not known; known are {listed(sorted(known))}.")
    if form == "axis" and (kind == TURN) != ("point" in item):
        raise FileFormatError(f"{where} ({name}): a turn must have a point that its axis goes through, in mm; a shift must have none.")
    before = np.eye(4)
    before[:3, 3] = METERS * _vector(where, item, "xyz")
    before[:3, :3] = scipy.spatial.transform.Rotation.from_euler("xyz", _vector(where, item, "rpy")).as_matrix()
    direction = _vector(where, item, known[2], () if form == "axis" else (1.0, 0.0, 0.0))
    if not direction.any():
        raise FileFormatError(f"{where}: {known[2]} must not be 0 0 0.")
    scale, zero = (float(_numbers(f"{where}: {key} must be a number", item.get(key, value), ())) for key, value in _STEPS)
    if not scale:
        raise FileFormatError(f"{where}: scale must not be 0.")
    return Axis(name, kind, direction / np.linalg.norm(direction), _vector(where, item, "point"), before, scale, zero)


def _vector(where: str, item: Mapping[str, object], key: str, otherwise: tuple[float, ...] = (0.0, 0.0, 0.0)) -> Floats:
    return _numbers(f"{where}: {key} must be three numbers", item.get(key, otherwise), (3,))


def _numbers(must: str, value: object, shape: tuple[int, ...]) -> Matrix:
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        array = np.array([np.nan])
    if array.shape != shape or not (np.abs(array) < 1e9).all():
        raise FileFormatError(f"{must}; got {shorten(repr(value))}.")
    return array
