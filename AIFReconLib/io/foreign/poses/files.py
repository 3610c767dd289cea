"""Files of poses: CSV and text with or without headings, and JSON."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from ....arrays import Floats, Matrix
from ....errors import AIFReconError, FileFormatError, SettingsError
from ....message import listed, said
from ....remedies import Remedy
from ...disk.small_files import read_bytes
from .headings import (
    ANGLES,
    FRAME,
    IMAGE,
    LENGTHS,
    MATRIX,
    OCCLUDED,
    RECEIVED,
    STATUS,
    TIME,
    TOOL,
    TRANSLATION,
    UNNAMED_EULER,
    UNORDERED_QUATERNION,
    Column,
    column_of,
)
from .json_sheet import sheet_of_json
from .rotations import PoseFormat, PoseValueError, poses_of, rotation_kind
from .sheet import Sheet, is_number, number_at, number_in, sheets_of
from .statuses import statuses_of
from .times import Times, times_of
from .tools import Rows, Track, rows_of, track_of

MAXIMUM_BYTES = 2**28


@dataclass(frozen=True, eq=False)
class PoseTable:
    """The poses in a file.

    Parameters
    ----------
    matrices : (n, 4, 4) float64 array
        Lengths in `length_unit`; NaN where a row has no pose.
    times : (n,) float64 array or None, s
    images : tuple of str or None
        The image that each belongs to, by name.
    statuses : tuple of str or None
        Names of Plus's statuses.
    understood : tuple of str
        How the file was read, in words.
    length_unit : str
        One of mm, cm, m.
    knows_length : bool
        Whether file or user says that unit.
    """

    matrices: Matrix
    times: Floats | None
    images: tuple[str, ...] | None
    statuses: tuple[str, ...] | None
    understood: tuple[str, ...]
    length_unit: str = "mm"
    knows_length: bool = False


def read_poses(path: str | Path, form: PoseFormat | None = None) -> PoseTable:
    """The poses in a .csv, .txt, .tsv, .json or .npy file.

    Raises FileFormatError, which names the row and the column, or the key, that cannot be used; SettingsError when a convention is left
    open, or the tool.

    Parameters
    ----------
    path : str or Path
        Rows under headings, whatever stands above and between, or of numbers alone: 16 or 12 of a matrix, 3 or 4 rows of 4 each, x y z
        and a quaternion or Euler angles, each with a time in front or not. Of several tools, side by side or one below the other, the
        one that `form` names. NumPy: (n, 4, 4), (n, 3, 4), (n, 16) or (n, 12). JSON: a list of poses, or of objects with matrix, or
        translation and quaternion or euler.
    form : PoseFormat
        What the file does not say.
    """
    path, form = Path(path), form or PoseFormat()
    text = _numpy_text(path) if path.suffix.lower() == ".npy" else _text(path)
    try:
        if path.suffix.lower() == ".json":
            sheet, places = sheet_of_json(text)
            return _of_sheets([sheet], form, places)
        return _of_sheets(sheets_of(text), form)
    except AIFReconError as error:
        raise type(error)(f"{path}: {said(error)}", error) from None


def _numpy_text(path: Path) -> str:
    """An array of matrices, a line each."""
    try:
        array = np.load(io.BytesIO(read_bytes(path, MAXIMUM_BYTES, FileFormatError)), allow_pickle=False)
        lines = np.asarray(array, np.float64).reshape(len(array), -1) if array.ndim in (2, 3) else np.empty((0, 0))
    except (ValueError, TypeError, EOFError, OSError) as error:
        raise FileFormatError(f"{path}: it cannot be read as an array of numbers. Save it with numpy.save.") from error
    if lines.shape[1] not in (12, 16):
        raise FileFormatError(f"{path}: poses must be (n, 4, 4), (n, 3, 4), (n, 16) or (n, 12); got {array.shape}.")
    return "\n".join(" ".join(map(repr, line)) for line in lines.tolist())


def _text(path: Path) -> str:
    data = read_bytes(path, MAXIMUM_BYTES + 1, FileFormatError)
    try:
        if len(data) > MAXIMUM_BYTES or b"\0" in data:
            raise FileFormatError(f"{path}: this is not a text file of poses. Give .csv, .txt or .json.")
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileFormatError(f"{path}: this is not a text file (UTF-8). Export the poses again.") from None


def _of_sheets(sheets: Sequence[Sheet], form: PoseFormat, places: Sequence[str] | None = None) -> PoseTable:
    """The poses of the first table that holds some."""
    sheets = [sheet for sheet in sheets if sheet.rows]
    if not sheets:
        raise FileFormatError("it holds no poses. Give a file with one pose per frame.")
    for sheet in sheets[:-1]:
        columns = _columns(sheet, form)
        if columns is not None and track_of(columns, sheet.rows, form.tool)[0].is_whole:
            break
    else:
        sheet = sheets[0] if len(sheets) == 1 else sheets[-1]
    others = [f"left out: {len(sheets) - 1} other tables in the file"] if len(sheets) > 1 else []
    others += [f"left out: {sheet.skipped}"] if sheet.skipped else []
    columns = _columns(sheet, form)
    if columns is None:
        places, rows = _of_blocks(sheet.rows)
        columns, how = [column_of(name) for name in MATRIX], [f"{len(sheet.rows) // len(rows)} rows of four numbers each"]
        table = _table(rows, columns, form, places)
    else:
        how, table = [], _table(sheet.rows, columns, form, places, rate=_rate(sheet, columns), above=sheet.above)
    return replace(table, understood=(*table.understood, *how, *others))


def _columns(sheet: Sheet, form: PoseFormat) -> list[Column] | None:
    """What each column holds; None where the rows are parts of matrices."""
    if form.columns is not None:
        return [column_of(word) if word != "-" else Column("-") for word in form.columns]
    if sheet.headings is None:
        width = len(sheet.rows[0][1])
        if all(len(cells) == 4 for _number, cells in sheet.rows):
            return None
        return [column_of(name) for name in _names_of_numbers(width, form)]
    wide = [*sheet.headings]
    above = [tuple(group[place] for group in sheet.groups if group[place]) for place in range(len(wide))]
    # What stands above all columns tells none from another
    common = {word for word in above[-1] if all(word in each for each in above if each)} if any(above) else set()
    units = [*sheet.units, *[""] * len(wide)]
    return [
        column_of(heading, tuple(dict.fromkeys(word for word in words if word not in common or _says_kind(word))), unit)
        for heading, words, unit in zip(wide, above, units)
    ]


def _says_kind(word: str) -> bool:
    return word.lower() in ("rotation", "position", "orientation", "translation", "quaternion")


def _names_of_numbers(count: int, form: PoseFormat) -> list[str]:
    """What the columns of a table without headings are, by their number."""
    if count in (16, 17, 12, 13):
        names = list(MATRIX[: 16 if count >= 16 else 12])
        return [TIME, *names] if count in (13, 17) else names
    if form.quaternion_order and not form.euler_order and count in (7, 8):
        return [*([TIME] if count == 8 else []), *TRANSLATION, *UNORDERED_QUATERNION]
    if form.euler_order and not form.quaternion_order and count in (6, 7):
        return [*([TIME] if count == 7 else []), *TRANSLATION, *UNNAMED_EULER]
    raise SettingsError(f"{count} columns without names can be many things.", Remedy.NAME_THE_COLUMNS)


def _rate(sheet: Sheet, columns: Sequence[Column]) -> float | None:
    """Frames per second, which Vicon Nexus writes alone in the line below the title, where no column is the time."""
    alone = [cells[0] for cells in sheet.above if len([cell for cell in cells if cell]) == 1 and is_number(cells[0])]
    rate = number_in(alone[-1]) if alone and not any(column.role == TIME for column in columns) else 0.0
    return rate if rate > 0.0 else None


def _of_blocks(rows: Rows) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Matrices of three or four lines each, as one row each."""
    last = [[number_in(cell) if is_number(cell) else np.nan for cell in cells] for _number, cells in rows[3::4]]
    height = 4 if len(rows) % 4 == 0 and (len(rows) % 3 or last == [[0.0, 0.0, 0.0, 1.0]] * len(last)) else 3
    if len(rows) % height:
        raise FileFormatError(
            f"lines of four numbers must come in fours or threes, one matrix each; got {len(rows)} lines. Export it again."
        )
    places, joined = [], []
    for number, start in enumerate(range(0, len(rows), height)):
        part = rows[start : start + height]
        cells = [cell for _line, line in part for cell in line]
        joined.append((part[0][0], cells if height == 4 else [*cells, "0", "0", "0", "1"]))
        places.append(f"lines {part[0][0]} to {part[-1][0]} (frame {number})")
    return places, joined


def _table(
    rows: Rows,
    columns: Sequence[Column],
    form: PoseFormat,
    places: Sequence[str] | None = None,
    rate: float | None = None,
    above: Sequence[Sequence[str]] = (),
) -> PoseTable:
    """The poses of rows of cells."""
    places = places or [f"line {line} (frame {number})" for number, (line, _cells) in enumerate(rows)]
    kept = []
    for place, (line, cells) in zip(places, rows):
        if len(cells) != len(columns) and not (len(cells) == len(columns) + 1 and not cells[-1]):
            raise FileFormatError(f"{place} must have {len(columns)} columns; got {len(cells)}. Export it again.")
        kept.append((line, list(cells[: len(columns)])))
    track, told, is_chosen = track_of(columns, kept, form.tool)
    by_line = {line: place for place, (line, _cells) in zip(places, kept)}
    if track.is_whole:
        chosen, told_rows = rows_of(track, kept, form.tool, is_chosen)
    else:
        chosen, told_rows = kept, []
    where = [by_line[line] for line, _cells in chosen]
    values = {name: _numbers(name, place, chosen, where) for name, place in track.columns.items() if _is_numeric(name)}
    kind = rotation_kind(values, form, _unit(track, ANGLES))
    length = form.length_unit or _unit(track, tuple(LENGTHS)) or _length_above(above)
    try:
        matrices = poses_of(values, kind, form)
    except PoseValueError as error:
        raise FileFormatError(f"{where[error.number]} {said(error)}", error) from None
    times = times_of(track.described, chosen, form.time_unit)
    if times.seconds is None and rate is not None and FRAME in track.columns:
        frames = _numbers(FRAME, track.columns[FRAME], chosen, where)
        times = Times((frames - frames[0]) / rate, (f"time: frame numbers at {rate:g} frames/s, as the file says",))
    statuses, told_status = _statuses(track, chosen, matrices, form)
    used = set(track.described)
    unused = [column.heading for place, column in enumerate(columns) if place not in used and column.heading not in ("", "-")]
    understood = [f"{len(chosen)}, {kind.told(length or 'mm', form)}", *told, *told_rows, *times.told, *told_status]
    understood += [f"columns that are not used: {listed(dict.fromkeys(unused))}"] if unused else []
    images = _words(IMAGE, track, chosen)
    return PoseTable(matrices, times.seconds, images, statuses, tuple(understood), length or "mm", length is not None)


def _is_numeric(name: str) -> bool:
    return name not in (IMAGE, STATUS, OCCLUDED, TOOL, TIME, FRAME, RECEIVED)


def _numbers(name: str, place: int, rows: Rows, where: Sequence[str]) -> Floats:
    return np.array([number_at(at, name, cells[place]) for at, (_line, cells) in zip(where, rows)])


def _unit(track: Track, units: Sequence[str]) -> str | None:
    """What the headings of these columns say of their unit, where all that say one say the same."""
    found = {column.unit for column in track.described.values() if column.role and column.unit in units}
    if len(found) > 1:
        raise SettingsError(f"The columns of one pose are in {listed(sorted(map(str, found)), ' and ')}. Export them in one unit.")
    return next(iter(found), None)


def _length_above(above: Sequence[Sequence[str]]) -> str | None:
    """The unit of lengths that the lines above the headings say, as OptiTrack Motive writes it."""
    for cells in above:
        for name, value in pairwise(cells):
            if name.lower() == "length units":
                return column_of("x", (), value).unit
    return None


def _statuses(track: Track, rows: Rows, matrices: Matrix, form: PoseFormat) -> tuple[tuple[str, ...] | None, list[str]]:
    for role in (STATUS, OCCLUDED):
        words = _words(role, track, rows)
        if words is not None:
            moved = np.asarray(np.isfinite(matrices).all(axis=(1, 2)) & matrices[:, :3, 3].any(axis=1))
            heading = track.described[track.columns[role]].heading
            statuses, told = statuses_of(words, heading, role, moved, form.good_statuses)
            return statuses, [told]
    return None, []


def _words(role: str, track: Track, rows: Rows) -> tuple[str, ...] | None:
    place = track.columns.get(role)
    return None if place is None else tuple(cells[place] for _line, cells in rows)
