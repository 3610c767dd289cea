"""A table in text: which lines are its rows, which are headings and units, which separator and decimal mark it has."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from ....errors import FileFormatError
from ....message import shorten
from ...metafile.text_values import NotANumberError, parse_number
from .headings import are_headings, is_unit

_MARKS = ("#", "//", "%")
_RECEIVED = "%time"
"""A heading of ROS, and no comment."""

_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+([eE][+-]?\d+)?")
_NO_VALUE = frozenset(["missing", "nan", "null", "none", "n/a", "na", "-", "--"])
_LOOKED_AT = 400
"""Lines by which separators are judged."""


@dataclass(frozen=True, eq=False)
class Sheet:
    """A table of rows under one line of headings, or under none.

    Parameters
    ----------
    rows : list of (int, list of str)
        Number of the line, and its cells.
    headings : list of str or None
    groups : list of list of str
        Lines above the headings that say what several columns belong to, from the top; as long as the headings.
    units : list of str
        Of the columns, where a line says them.
    above : list of list of str
        What else stands above, by its cells.
    skipped : str
        What of the file is not read, in words.
    """

    rows: list[tuple[int, list[str]]]
    headings: list[str] | None = None
    groups: list[list[str]] = field(default_factory=list)
    units: list[str] = field(default_factory=list)
    above: list[list[str]] = field(default_factory=list)
    skipped: str = ""


@dataclass(frozen=True, eq=False)
class _Line:
    number: int
    cells: list[str]
    is_comment: bool

    @property
    def numbers(self) -> int:
        return 0 if self.is_comment else sum(map(is_number, self.cells))


def has_none(cell: str) -> bool:
    """Whether a cell is blank, or says that there is nothing."""
    return not cell or cell.lower() in _NO_VALUE


def number_in(cell: str) -> float:
    """The number in a cell, NaN where it is blank or says that there is none; a comma may be the decimal mark. Raises NotANumberError."""
    if has_none(cell):
        return float("nan")
    return parse_number(cell.replace(",", ".") if _DECIMAL_COMMA.fullmatch(cell) else cell)


def is_number(cell: str) -> bool:
    """Whether a cell holds a number."""
    try:
        return not has_none(cell) and number_in(cell) is not None
    except NotANumberError:
        return False


def number_at(place: str | int, column: str, cell: str) -> float:
    """The same; raises FileFormatError, which names the place (the number of a line, or words) and the column."""
    try:
        return number_in(cell)
    except NotANumberError:
        where = place if isinstance(place, str) else f"line {place}"
        raise FileFormatError(
            f"{where}, column {column} must be a number; got {shorten(cell)!r}. Export it again, with decimal points."
        ) from None


def sheets_of(text: str) -> list[Sheet]:
    """The tables in a text, in their order: lines above the headings are no rows, and another line of headings begins another table."""
    lines = _lines(text)
    width = Counter(len(line.cells) for line in lines if line.numbers).most_common(1)
    if not width:
        return []
    heads = [index for index, line in enumerate(lines) if not line.numbers and not _is_of_groups(line.cells) and are_headings(line.cells)]
    # Names of tools may be words that are known, too; they stand above fuller headings
    heads = [index for index in heads if index + 1 not in heads or _filled_cells(lines[index]) >= _filled_cells(lines[index + 1])]
    if not heads:
        sheet = _without_known_headings(lines, width[0][0])
        return [sheet] if sheet.rows else []
    starts = [heads[0], *(index for before, index in pairwise(heads) if lines[index].cells != lines[before].cells)]
    found = []
    for start, end in zip(starts, [*starts[1:], len(lines)]):
        above = lines[(starts[starts.index(start) - 1] + 1 if start != starts[0] else 0) : start]
        found.append(
            _under(lines[start], above, [line for line in lines[start + 1 : end] if line.cells != lines[start].cells], end < len(lines))
        )
    return found


def _under(head: _Line, above: list[_Line], below: list[_Line], another_follows: bool) -> Sheet:
    """The table below a line of headings."""
    units: list[str] = []
    if below and not below[0].numbers and all(is_unit(cell) for cell in below[0].cells if cell):
        units = below.pop(0).cells
    rows = [(line.number, line.cells) for line in below if not line.is_comment]
    if another_follows:  # between two tables stand a title and the like
        fits = [_fits(cells, len(head.cells)) for _number, cells in rows]
        rows = rows[: fits.index(False)] if False in fits else rows
    groups: list[list[str]] = []
    while above and not above[-1].cells[0] and any(above[-1].cells):
        groups.insert(0, _filled(above.pop().cells, len(head.cells)))
    first = rows[0][0] if rows else head.number
    skipped = f"lines 1 to {above[-1].number}, which are above its headings" if above and above[-1].number < first else ""
    return Sheet(rows, head.cells, groups, units, [line.cells for line in above], skipped)


def _without_known_headings(lines: list[_Line], width: int) -> Sheet:
    """A table of numbers; a line of words directly above it are its headings."""
    rows = [line for line in lines if not line.is_comment]
    begins = (n for n, line in enumerate(rows) if _fits(line.cells, width) and 2 * line.numbers >= _filled_cells(line))
    first = next(begins, len(rows))
    above = rows[:first]
    headings = above.pop().cells if above and not above[-1].numbers and _fits(above[-1].cells, width) else None
    skipped = f"lines 1 to {above[-1].number}, which hold no poses" if above else ""
    return Sheet([(line.number, line.cells) for line in rows[first:]], headings, above=[line.cells for line in above], skipped=skipped)


def _is_of_groups(cells: Sequence[str]) -> bool:
    """Whether most words stand again beside themselves, as names of tools above their columns, which may be called X, Y and Z."""
    return 2 * sum(bool(one) and one == other for one, other in pairwise(cells)) > len(cells)


def _filled_cells(line: _Line) -> int:
    return sum(map(bool, line.cells))


def _fits(cells: Sequence[str], width: int) -> bool:
    return len(cells) == width or (len(cells) == width + 1 and not cells[-1])


def _filled(cells: list[str], width: int) -> list[str]:
    """Cells of a line above headings; one that stands once over several columns is that of all of them."""
    filled, last = [], ""
    for cell in [*cells, *[""] * (width - len(cells))][:width]:
        last = cell or last
        filled.append(last)
    return filled


def _lines(text: str) -> list[_Line]:
    """The lines that are not blank, by their cells."""
    written = [(number, line.rstrip("\r\n")) for number, line in enumerate(text.splitlines(), start=1) if line.strip()]
    plain = [line for _number, line in written if not _is_comment(line)]
    middle = len(plain) // 2
    separator = _separator(plain[max(middle - _LOOKED_AT // 2, 0) : middle + _LOOKED_AT // 2])
    lines = []
    for number, line in written:
        marked = _is_comment(line)
        words = line.lstrip().lstrip("#%/").strip() if marked else line
        # A comment over a table in blanks may have its own separators
        own = separator if separator is None or separator in words or not marked else None
        lines.append(_Line(number, _cells(words, own), marked))
    return lines


def _is_comment(line: str) -> bool:
    start = line.lstrip()
    return start.startswith(_MARKS) and not start.startswith(_RECEIVED)


def _cells(line: str, separator: str | None) -> list[str]:
    cells = line.split(separator) if separator else line.split()
    return [cell.strip().strip("\"'").strip() for cell in cells]


def _separator(lines: Sequence[str]) -> str | None:
    """What separates the cells: the mark by which most of them are numbers, in lines of equal length. None: white space."""

    def worth(separator: str | None) -> tuple[float, float]:
        rows = [_cells(line, separator) for line in lines]
        width, count = Counter(map(len, rows)).most_common(1)[0]
        cells = [cell for row in rows for cell in row if cell]
        if width < 2 or not cells:
            return 0.0, 0.0
        return round(sum(map(is_number, cells)) / len(cells), 2), count / len(rows)

    return max((";", "\t", ",", None), key=worth) if lines else None
