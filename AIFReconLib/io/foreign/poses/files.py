"""Files of poses: CSV and text with or without headings, JSON, and arrays of NumPy."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ....arrays import Floats, Matrix
from ....errors import AIFReconError, FileFormatError, SettingsError
from ....message import Sentence, listed, message_of
from ....remedies import WHICH_MARKER
from ...disk.small_files import read_bytes
from ...disk.tables import read_table
from ..options import ImportOptions
from .headings import (
    ANGLES,
    FRAME,
    IMAGE,
    LENGTHS,
    MATRIX,
    OCCLUDED,
    STATUS,
    TABLES,
    TIME,
    TOOL,
    TRANSLATION,
    UNNAMED_EULER,
    UNORDERED_QUATERNION,
    Column,
    column_of,
    in_words_of_the_table,
    layout_of,
    plain_word,
)
from .json_sheet import sheet_of_json
from .rotations import poses_of
from .sheet import MAXIMUM_BYTES, Sheet, is_number, sheets_of, text_of
from .statuses import statuses_in
from .times import times_of
from .tracks import Track, in_blocks, name_the_columns, rows_of, track_of

_NO_NUMBERS = (IMAGE, STATUS, OCCLUDED, TOOL, TIME)

_KINDS = {"Rotation", "Position"}
"""What Motive writes above the axes of both."""


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


def read_poses(path: str | Path, form: ImportOptions | None = None) -> PoseTable:
    """The poses in a .csv, .txt, .tsv, .json or .npy file.

    Raises FileFormatError, which names the row and the column, or the key, that cannot be used; SettingsError when a convention is left
    open, or the tool, or what the columns are.

    Parameters
    ----------
    path : str or Path
        Rows under headings, whatever stands above and between, or of numbers alone: 16 or 12 of a matrix, 3 or 4 rows of 4 each, x y z
        and a quaternion or Euler angles, each with a time in front or not. Of several tools, side by side or one below the other, the
        one that `form` names. NumPy: (n, 4, 4), (n, 3, 4), (n, 16) or (n, 12). JSON: a list of poses, or of objects with matrix, or
        translation and quaternion or euler.
    form : ImportOptions
        What the file does not say.
    """
    path, form = Path(path), form or ImportOptions()
    with _naming(path):
        if path.suffix.lower() == ".npy":
            return _of_array(path, form)
        sheets = _sheets(path)
        if not sheets:
            raise FileFormatError("it holds no poses. Give a file with one pose per frame.")
        for sheet in sheets:
            try:
                table = _of_sheet(sheet, form)
                break
            except SettingsError as error:
                if sheet is sheets[-1] or "known columns" not in str(error):
                    raise
    left_out = [f"{len(sheets) - 1} other tables in the file"] * (len(sheets) > 1) + [sheet.skipped] * bool(sheet.skipped)
    return replace(table, understood=(*table.understood, *(f"left out: {what}" for what in left_out)))


def read_times(path: str | Path, unit: str | None = None) -> tuple[Floats, list[str] | None]:
    """Times in s of a table of one row an image, and the images' names where it has them.

    Without headings the table is of times alone. Raises FileFormatError or SettingsError when the times cannot be told.
    """
    path = Path(path)
    with _naming(path):
        sheet = next(iter(_sheets(path)), None)
        if sheet is None or (sheet.headings is None and sheet.width != 1):
            raise FileFormatError("times of images must be a table with a column 'time', or one number a line.")
        columns = dict(enumerate(map(column_of, sheet.headings or [TIME])))
        times, _ = times_of(columns, sheet, unit)
        if times is None:
            raise FileFormatError("it must have a time in every row, in a column 'time'.")
    named = [place for place, column in columns.items() if column.role == IMAGE]
    return times, sheet.words(named[0]) if named else None


@contextlib.contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Errors within begin with the name of this file."""
    try:
        yield
    except AIFReconError as error:
        raise type(error)(f"{path}: {str(message_of(error)).removeprefix(f'{path}: ')}", error) from None


def _sheets(path: Path) -> list[Sheet]:
    """The tables in a file that have rows. Raises FileFormatError where it is no text, or no JSON by its suffix."""
    text = text_of(path)
    return [sheet for sheet in [sheet_of_json(text)] if len(sheet)] if path.suffix.lower() == ".json" else sheets_of(text)


def _of_array(path: Path, form: ImportOptions) -> PoseTable:
    """An array of matrices."""
    try:
        array = np.load(io.BytesIO(read_bytes(path, MAXIMUM_BYTES, FileFormatError)), allow_pickle=False)
        lines = np.asarray(array, np.float64).reshape(len(array), -1) if array.ndim in (2, 3) else np.empty((0, 0))
    except (ValueError, TypeError, EOFError, OSError) as error:
        raise FileFormatError("it cannot be read as an array of numbers. Save it with numpy.save.") from error
    if lines.shape[1] not in (12, 16) or not len(lines):
        raise FileFormatError(f"poses must be (n, 4, 4), (n, 3, 4), (n, 16) or (n, 12); got {array.shape}.")
    matrices, how = poses_of(dict(zip(MATRIX, lines.T)), form, form.units or "mm", None, "pose {}".format)
    return PoseTable(matrices, None, None, None, (f"{len(matrices)}, {how}",), form.units or "mm", form.units is not None)


def _of_sheet(sheet: Sheet, form: ImportOptions) -> PoseTable:
    names = form.column_names
    layout = layout_of(sheet.headings or (), sheet.above) if names is None else _layout(names)
    if layout:
        written = layout.get("columns", ())
        names = tuple(written.split() if isinstance(written, str) else written) or None
        unsaid = {each.name: layout[each.name] for each in fields(form) if each.name in layout and getattr(form, each.name) is None}
        form = replace(form, **unsaid)
    if names is None and sheet.headings is None and sheet.width == 4:
        sheet = _in_single_rows(sheet)
    columns, is_known = _columns(sheet, names, form, layout), "maker" in layout
    track, told, is_chosen = track_of(columns, sheet, form.tool, is_known)
    sheet, told_rows = rows_of(track, sheet, None if is_chosen else form.tool)
    values = {role: sheet.numbers(place, role) for role, place in track.columns.items() if role not in _NO_NUMBERS}
    length = form.units or _unit(track, tuple(LENGTHS)) or _length_above(sheet.above)
    matrices, how = poses_of(values, form, length or "mm", _unit(track, ANGLES), sheet.place)
    moved = np.asarray(np.isfinite(matrices).all(axis=(1, 2)) & matrices[:, :3, 3].any(axis=1))
    times, told_times = times_of(track.described, sheet, form.time_unit)
    if times is None and FRAME in values and (rate := _rate(sheet)):
        times = (values[FRAME] - values[FRAME][0]) / rate
        told_times.append(f"time: frame numbers at {rate:g} frames/s, as the file says")
    statuses, told_statuses = statuses_in(track, sheet, moved, form.status_ok or ())
    of_patient = track_of(columns, sheet, form.reference_tool, is_known)[0].described if form.reference_tool else {}
    unused = [column for place, column in enumerate(columns) if place not in {*track.described, *of_patient} and column.heading != "-"]
    another = WHICH_MARKER if is_chosen and not form.reference_tool else ""
    taken = (f"{column.role}_{column.unit or ''}".rstrip("_") + f"={place + 1}" for place, column in track.described.items())
    understood = [f"{len(matrices)}, {how}", *([f"as {layout['maker']} writes"] if is_known else []), *told, *told_rows]
    understood += [f"used: {in_words_of_the_table(track.described.values())}"] if sheet.headings else []
    understood += [Sentence(f"not used: {in_words_of_the_table(unused)}", another)] if unused else []
    understood += [f"columns: {listed(taken, ' ')}", *told_times, *told_statuses]
    images = tuple(sheet.words(track.columns[IMAGE])) if IMAGE in track.columns else None
    return PoseTable(matrices, times, images, statuses, tuple(understood), length or "mm", length is not None)


def _layout(columns: tuple[str, ...]) -> dict[str, Any]:
    """The layout that one word names: a maker's, or a file of one's own; empty where the words are columns."""
    word = columns[0] if len(columns) == 1 else ""
    if not word.lower().endswith(".json"):
        return next((maker for maker in TABLES["makers"] if maker["name"] == word.lower()), {"columns": columns})
    layout: Any = read_table(Path(word), FileFormatError, "Correct the file.")
    if not isinstance(layout, dict) or not isinstance(layout.get("columns"), str):
        raise FileFormatError(f"{word}: it must be an object with columns, in JSON. Correct the file.")
    return {"units" if name == "length_unit" else name: value for name, value in layout.items()}


def _columns(sheet: Sheet, names: Sequence[str] | None, form: ImportOptions, layout: dict[str, Any]) -> list[Column]:
    """What each column holds; `names` are those that are said."""
    names = names or (_names_of_numbers(sheet, form) if sheet.headings is None else None)
    if names is not None and any("=" in word for word in names):
        return _assigned(sheet, names)
    if names is not None:
        if len(names) != sheet.width:
            raise name_the_columns(f"Input columns must name {sheet.width} columns; got {len(names)}.", sheet)
        return [column_of(word) if word != "-" else Column("-") for word in names]
    headings, roles = sheet.headings or [], layout.get("headings", {})
    over = [dict.fromkeys(group[place] for group in sheet.groups if group[place]) for place in range(len(headings))]
    # What stands above all columns tells none from another
    common = set.intersection(*(set(words) for words in over if words)) - _KINDS if any(over) else set()
    above = [tuple(word for word in words if word not in common) for words in over]
    columns = [replace(column_of(heading, words), above=words) for heading, words in zip(headings, above)]
    known = [roles.get(plain_word(heading)) for heading in headings]
    columns = [replace(column, role=role, words=(role,)) if role else column for column, role in zip(columns, known)]
    return in_blocks(columns, sheet, layout["starts"]) if "starts" in layout else columns


def _assigned(sheet: Sheet, words: Sequence[str]) -> list[Column]:
    """Columns by their number from 1 or their heading, as in ``time_ms=3 x=Tx``; the others are not used."""
    columns = [Column("-")] * sheet.width
    for word in words:
        name, _, which = word.partition("=")
        there = [place for place, heading in enumerate(sheet.headings or ()) if heading == which]
        place = int(which) - 1 if which.isdecimal() else there[0] if len(there) == 1 else -1
        if not 0 <= place < sheet.width or column_of(name).role is None:
            raise name_the_columns(f"Input columns must be names of columns with their number (1 to {sheet.width}); got {word!r}.", sheet)
        columns[place] = column_of(name)
    return columns


def _names_of_numbers(sheet: Sheet, form: ImportOptions) -> Sequence[str]:
    """What the columns of a table without headings are, by their number."""
    known = {12: MATRIX[:12], 16: MATRIX}
    if form.quaternion_order and not form.euler_order:
        known[7] = (*TRANSLATION, *UNORDERED_QUATERNION)
    if form.euler_order and not form.quaternion_order:
        known[6] = (*TRANSLATION, *UNNAMED_EULER)
    if sheet.width in known:
        return known[sheet.width]
    if sheet.width - 1 in known:
        return TIME, *known[sheet.width - 1]
    raise name_the_columns(f"{sheet.width} columns without names can be many things.", sheet)


def _rate(sheet: Sheet) -> float:
    """Frames per second, which Vicon Nexus writes alone in the line below the title; 0 where no line does."""
    alone = [cells[0] for cells in sheet.above if is_number(cells[0]) and not any(cells[1:])]
    return float(alone[-1].replace(",", ".")) if alone else 0.0


def _in_single_rows(sheet: Sheet) -> Sheet:
    """Matrices of three or four lines of four numbers each, in a row each."""
    lines = np.stack([sheet.numbers(place, str(place + 1)) for place in range(4)], axis=1)
    count = len(lines)
    height = 4 if count % 4 == 0 and (count % 3 or (lines[3::4] == (0.0, 0.0, 0.0, 1.0)).all()) else 3
    if count % height:
        raise FileFormatError(f"lines of four numbers must come in fours or threes, one matrix each; got {count} lines. Export it again.")
    rows = [" ".join(map(str, row)) for row in lines.reshape(-1, 4 * height).tolist()]
    return replace(sheet, rows=rows, lines=sheet.lines[::height], separator=None)


def _unit(track: Track, units: Sequence[str]) -> str | None:
    """What the headings of these columns say of their unit, where all that say one say the same."""
    found = {column.unit for column in track.described.values() if column.role and column.unit in units}
    if len(found) > 1:
        raise SettingsError(f"The columns of one pose are in {listed(sorted(map(str, found)), ' and ')}. Export them in one unit.")
    return next(iter(found), None)


def _length_above(above: Sequence[Sequence[str]]) -> str | None:
    """The unit of lengths that the lines above the headings say, as OptiTrack Motive writes it."""
    units = [value for cells in above for name, value in pairwise(cells) if name.lower() == "length units"]
    return column_of(f"x ({units[0]})").unit if units else None
