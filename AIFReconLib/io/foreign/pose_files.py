"""Files of poses: CSV and text with or without a header line, and JSON."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...arrays import Floats, Matrix
from ...errors import FileFormatError, SettingsError
from ...message import listed, one_line, said, shorten
from ...remedies import Remedy
from ..disk.small_files import read_bytes
from ..metafile.text_values import parse_number
from .pose_rows import (
    EULER,
    IMAGE,
    MATRIX,
    QUATERNION,
    STATUS,
    TIME,
    TRANSLATION,
    UNNAMED_EULER,
    UNORDERED_QUATERNION,
    PoseFormat,
    PoseValueError,
    canonical_names,
    kind_of_pose,
    pose_of,
    time_of,
)

MAXIMUM_BYTES = 2**28

Row = dict[str, "float | str"]


@dataclass(frozen=True, eq=False)
class PoseTable:
    """The poses in a file.

    Parameters
    ----------
    matrices : (n, 4, 4) float64 array
        Lengths as the file has them; NaN where a row has no pose.
    times : (n,) float64 array or None, s
    images : tuple of str or None
        The image that each belongs to, by name.
    statuses : tuple of str or None
    understood : tuple of str
        How the file was read, in words.
    """

    matrices: Matrix
    times: Floats | None
    images: tuple[str, ...] | None
    statuses: tuple[str, ...] | None
    understood: tuple[str, ...]


def read_poses(path: str | Path, form: PoseFormat | None = None) -> PoseTable:
    """The poses in a .csv, .txt, .tsv or .json file.

    Parameters
    ----------
    path : str or Path
        Rows of named columns, or of numbers alone: 16 or 12 of a matrix, 4 rows of 4 each, x y z and a quaternion or Euler angles,
        each with a time in front or not. JSON: a list of poses, or of objects with matrix, or translation and quaternion or euler.
    form : PoseFormat
        What the file does not say.

    Raises
    ------
    FileFormatError
        Names the row and the column, or the key, that cannot be used.
    SettingsError
        When a convention is left open.
    """
    path, form = Path(path), form or PoseFormat()
    text = _text(path)
    rows, understood = _json_rows(path, text) if path.suffix.lower() == ".json" else _text_rows(path, text, form)
    if not rows:
        raise FileFormatError(f"{path}: it holds no poses. Give a file with one pose per frame.")
    try:
        kind = kind_of_pose(list(rows[0][1]), form)
    except SettingsError as error:
        raise SettingsError(f"{path}: {said(error)}", error) from None
    matrices = np.full((len(rows), 4, 4), np.nan)
    for number, (place, row) in enumerate(rows):
        if set(row) != set(rows[0][1]):
            raise FileFormatError(f"{path}: {place} must hold {', '.join(rows[0][1])} as the first; got {', '.join(row)}. Export it again.")
        try:
            pose = pose_of({name: value for name, value in row.items() if not isinstance(value, str)}, form)
        except PoseValueError as error:
            raise FileFormatError(f"{path}: {place} {said(error)}", error) from None
        if pose is not None:
            matrices[number] = pose
    times = [time_of({name: value for name, value in row.items() if not isinstance(value, str)}) for _, row in rows]
    return PoseTable(
        matrices,
        None if None in times else np.array(times, dtype=np.float64),
        _words(rows, IMAGE),
        _words(rows, STATUS),
        (f"{len(rows)}, {kind}", *understood),
    )


def _words(rows: list[tuple[str, Row]], name: str) -> tuple[str, ...] | None:
    return tuple(str(row[name]) for _, row in rows) if name in rows[0][1] else None


def _text(path: Path) -> str:
    data = read_bytes(path, MAXIMUM_BYTES + 1, FileFormatError)
    try:
        if len(data) > MAXIMUM_BYTES or b"\0" in data:
            raise FileFormatError(f"{path}: this is not a text file of poses. Give .csv, .txt or .json.")
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileFormatError(f"{path}: this is not a text file (UTF-8). Export the poses again.") from None


def _text_rows(path: Path, text: str, form: PoseFormat) -> tuple[list[tuple[str, Row]], tuple[str, ...]]:
    """Rows as (place, fields) of a table in text."""
    table: list[tuple[int, list[str]]] = []
    comment = None
    for number, line in enumerate(text.splitlines(), start=1):
        if line.lstrip().startswith(("#", "%", "//")):
            comment = comment if table else line.lstrip(" #%/")
        elif line.strip():
            table.append((number, _cells(line)))
    if not table:
        return [], ()
    header = None
    if not any(map(_is_number, table[0][1])):
        header = table.pop(0)[1]
    elif comment and len(_cells(comment)) == len(table[0][1]) and any(canonical_names(_cells(comment))):
        header = _cells(comment)
    if not table:
        return [], ()
    if form.columns is not None:
        header = list(form.columns)
    if header is None and all(len(cells) == 4 for _, cells in table):
        return _matrix_blocks(path, table), ("four rows of four numbers each",)
    names: Sequence[str | None] = _names_of_numbers(path, len(table[0][1]), form) if header is None else canonical_names(header)
    unused = [word for word, name in zip(header or (), names) if name is None and word != "-"]
    rows: list[tuple[str, Row]] = [
        (f"line {number} (frame {n})", _row(path, number, n, cells, names)) for n, (number, cells) in enumerate(table)
    ]
    return rows, ((f"columns that are not used: {', '.join(unused)}",) if unused else ())


def _cells(line: str) -> list[str]:
    """The words of a line, separated by semicolons, commas or white space."""
    separator = next((mark for mark in ";,\t" if mark in line), None)
    cells = [cell.strip().strip("\"'") for cell in line.strip().split(separator)]
    # Where semicolons part the cells, a comma is that of a number, as spreadsheets write it in much of Europe
    return [cell.replace(",", ".") if DECIMAL_COMMA.fullmatch(cell) else cell for cell in cells] if separator == ";" else cells


DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+([eE][+-]?\d+)?")


def _is_number(text: str) -> bool:
    try:
        parse_number(text)
    except ValueError:
        return False
    return True


def _names_of_numbers(path: Path, count: int, form: PoseFormat) -> list[str]:
    """What the columns of a table without a header are, by their number."""
    if count in (16, 17, 12, 13):
        names = list(MATRIX[: 16 if count >= 16 else 12])
        return [TIME, *names] if count in (13, 17) else names
    if form.quaternion_order and not form.euler_order and count in (7, 8):
        return [*([TIME] if count == 8 else []), *TRANSLATION, *UNORDERED_QUATERNION]
    if form.euler_order and not form.quaternion_order and count in (6, 7):
        return [*([TIME] if count == 7 else []), *TRANSLATION, *UNNAMED_EULER]
    raise SettingsError(f"{path}: {count} columns without names can be many things.", Remedy.NAME_THE_COLUMNS)


def _row(path: Path, line: int, number: int, cells: list[str], names: Sequence[str | None]) -> Row:
    if len(cells) == len(names) + 1 and not cells[-1]:
        cells = cells[:-1]  # a separator at the end of the line
    if len(cells) != len(names):
        raise FileFormatError(f"{path}: line {line} (frame {number}) must have {len(names)} columns; got {len(cells)}. Export it again.")
    row: Row = {}
    for cell, name in zip(cells, names):
        if name is None:
            continue
        try:
            row[name] = cell if name in (IMAGE, STATUS) else parse_number(cell) if cell else np.nan
        except ValueError:
            raise FileFormatError(
                f"{path}: line {line} (frame {number}), column {name} must be a number; got {shorten(cell)!r}. Export it again, with "
                "decimal points."
            ) from None
    return row


def _matrix_blocks(path: Path, table: list[tuple[int, list[str]]]) -> list[tuple[str, Row]]:
    """Matrices of four lines each."""
    if len(table) % 4:
        raise FileFormatError(
            f"{path}: lines of four numbers must come in fours, one matrix each; got {len(table)} lines. Export it again."
        )
    rows: list[tuple[str, Row]] = []
    for start in range(0, len(table), 4):
        row: Row = {}
        for place in range(4):
            line, cells = table[start + place]
            row |= _row(path, line, start // 4, cells, list(MATRIX[4 * place : 4 * place + 4]))
        first, last = table[start][0], table[start + 3][0]
        rows.append((f"lines {first} to {last} (frame {start // 4})", row))
    return rows


_JSON_LISTS = ("frames", "poses", "transforms", "data")
_JSON_PARTS = {
    "matrix": "matrix transform pose",
    "translation": "translation position origin",
    "quaternion": "quaternion orientation rotation q quat",
    "euler": "euler angles eulerangles",
}
_PART_OF = {spelling: name for name, spellings in _JSON_PARTS.items() for spelling in spellings.split()}
_PART_FIELDS: dict[str, dict[int, tuple[str, ...]]] = {
    "matrix": {16: MATRIX, 12: MATRIX[:12]},
    "translation": {3: TRANSLATION},
    "quaternion": {4: UNORDERED_QUATERNION},
    "euler": {3: UNNAMED_EULER},
}
_PART_AXES = {"translation": "", "quaternion": "q", "euler": "r"}
_AXES = {"translation": TRANSLATION, "quaternion": QUATERNION, "euler": EULER}


def _json_rows(path: Path, text: str) -> tuple[list[tuple[str, Row]], tuple[str, ...]]:
    """Rows as (place, fields) of a JSON file."""
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise FileFormatError(f"{path}: this is not JSON ({one_line(str(error))}). Export it again.") from None
    if isinstance(document, dict):
        key = next((key for key in _JSON_LISTS if isinstance(document.get(key), list)), None)
        if key is None:
            raise FileFormatError(f"{path}: it must hold a list of poses, or an object with one under {', '.join(_JSON_LISTS)}.")
        document = document[key]
    if not isinstance(document, list):
        raise FileFormatError(f"{path}: it must hold a list of poses; got {type(document).__name__}. Export it again.")
    unused: dict[str, None] = {}
    rows: list[tuple[str, Row]] = []
    for number, item in enumerate(document):
        place = f"pose {number}"
        row: Row = {}
        for key, value in (item if isinstance(item, dict) else {"matrix": item}).items():
            plain = re.sub("[^a-z0-9]", "", key.lower())
            part, name = _PART_OF.get(plain), canonical_names([key])[0]
            if part:
                row |= _json_part(path, listed([place, key]), part, value)
            elif name in (IMAGE, STATUS):
                row[name] = str(value)
            elif name:
                row[name] = _json_number(path, listed([place, key]), value)
            else:
                unused[key] = None
        rows.append((place, row))
    return rows, ((f"keys that are not used: {', '.join(unused)}",) if unused else ())


def _json_part(path: Path, place: str, part: str, value: object) -> Row:
    """The fields of a list or object of numbers."""
    if isinstance(value, dict) and part != "matrix":
        names = {name: key for key in value if (name := _PART_AXES[part] + key.lower()) in _AXES[part]}
        if len(names) != len(value):
            raise FileFormatError(
                "{path}: {place} must have the keys {expected}; got {found}. Export it again.".format(
                    path=path,
                    place=place,
                    expected=listed(name.removeprefix(_PART_AXES[part]) for name in _AXES[part]),
                    found=", ".join(map(repr, value)),
                )
            )
        return {name: _json_number(path, listed([place, key]), value[key]) for name, key in names.items()}
    numbers = [number for line in value for number in (line if isinstance(line, list) else [line])] if isinstance(value, list) else [value]
    fields = _PART_FIELDS[part].get(len(numbers))
    if fields is None:
        expected = listed(_PART_FIELDS[part], " or ")
        raise FileFormatError(f"{path}: {place} must be {expected} numbers; got {len(numbers)}. Export it again.")
    return {name: _json_number(path, place, number) for name, number in zip(fields, numbers)}


def _json_number(path: Path, place: str, value: object) -> float:
    if value is None:
        return float("nan")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise FileFormatError(f"{path}: {place} must be a number; got {shorten(repr(value))}. Export it again.")
    try:
        return float(value)
    except OverflowError:  # JSON's whole numbers have no limit
        return math.inf if value > 0 else -math.inf
