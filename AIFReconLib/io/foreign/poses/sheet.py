"""A table in text: which lines are its rows, which are headings and units. pandas holds the cells and makes numbers of them."""

from __future__ import annotations

import contextlib
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ....arrays import Floats
from ....errors import FileFormatError
from ....message import shorten
from ...disk.small_files import read_bytes
from ...sequence.decoded_images import library
from .headings import column_of, unit_of

MAXIMUM_BYTES = 2**30

_MARKS = ("#", "//", "%")
"""Of comments."""

_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?|[+-]?inf", re.IGNORECASE)
_NO_VALUE = ("", "missing", "nan", "null", "none", "n/a", "na", "-", "--")
BAD_FLOAT = -3.697314e28
"""What NDI writes where there is no number."""
_LOOKED_AT = 400
"""Lines by which separators are judged."""
_KNOWN_HEADINGS = 3
"""Headings that are known make a line of headings."""


def text_of(path: Path) -> str:
    """The text of a file, in UTF-8, UTF-16 or the encoding of Western Windows. Raises FileFormatError where it is none."""
    data = read_bytes(path, MAXIMUM_BYTES + 1, FileFormatError)
    wide = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    if len(data) > MAXIMUM_BYTES or (b"\0" in data and not wide):
        raise FileFormatError(f"{path}: this is not a text file of poses. Give .csv, .txt or .json.")
    with contextlib.suppress(UnicodeDecodeError):
        return data.decode("utf-16" if wide else "utf-8-sig")
    return data.decode("cp1252", errors="replace")


@dataclass(frozen=True, eq=False)
class Sheet:
    """A table of rows under one line of headings, or under none.

    Parameters
    ----------
    cells : list of list of str, or pandas' DataFrame
        By row.
    lines : sequence of int
        The number of each row in its file.
    headings : list of str or None
        With their units, where a line says them.
    groups : list of list of str
        Lines above the headings that say what several columns belong to, from the top; as long as the headings.
    above : list of list of str
        What else stands above, by its cells.
    skipped : str
        What of the file is not read, in words.
    item : str
        What a row is called in messages.
    """

    cells: Any
    lines: Sequence[int]
    headings: list[str] | None = None
    groups: list[list[str]] = field(default_factory=list)
    above: list[list[str]] = field(default_factory=list)
    skipped: str = ""
    item: str = "line"

    @property
    def width(self) -> int:
        """Columns that it should have."""
        return len(self.headings) if self.headings else len(self.cells[0]) if isinstance(self.cells, list) else self.cells.shape[1]

    @cached_property
    def frame(self) -> Any:
        """The cells as pandas' DataFrame. Raises FileFormatError, which names the first row that is too long or too short."""
        if not isinstance(self.cells, list):
            return self.cells
        for number, row in enumerate(self.cells):
            if not _fits(row, self.width):
                raise FileFormatError(f"{self.place(number)} must have {self.width} columns; got {len(row)}. Export it again.")
        return library("pandas", "Tables of poses").DataFrame([row[: self.width] for row in self.cells], dtype=object)

    def __len__(self) -> int:
        return len(self.cells)

    def place(self, number: int) -> str:
        """Where a row stands, in words."""
        row = number if isinstance(self.cells, list) else int(self.cells.index[number])
        return f"line {self.lines[row]} (frame {row})" if self.item == "line" else f"{self.item} {self.lines[row]}"

    def where(self, mask: Sequence[bool]) -> Sheet:
        """Some of the rows."""
        return replace(self, cells=self.frame[mask])

    def words(self, place: int) -> list[str]:
        """A column as it is written."""
        return list(map(str, self.frame[place]))

    def numbers(self, place: int, name: str) -> Floats:
        """A column as numbers, NaN where a cell is blank or says that there is none.

        Raises FileFormatError, which names the row and the column.
        """
        pandas = library("pandas", "Tables of poses")
        written = self.frame[place].reset_index(drop=True)
        numbers = pandas.to_numeric(written, errors="coerce").astype(np.float64)
        odd = written[numbers.isna()].astype(str)
        numbers[odd.index] = pandas.to_numeric(odd.str.replace(",", ".", regex=False), errors="coerce")
        wrong = numbers[odd.index].isna() & ~odd.str.lower().isin(_NO_VALUE)
        if wrong.any():
            row = int(wrong.idxmax())
            raise FileFormatError(
                f"{self.place(row)}, column {name} must be a number; got {shorten(odd[row])!r}. Export it again, with decimal points."
            )
        return np.asarray(numbers.where(~np.isclose(numbers, BAD_FLOAT, rtol=1e-4)), np.float64)


def has_none(cell: str) -> bool:
    """Whether a cell is blank, or says that there is nothing."""
    return cell.lower() in _NO_VALUE


def is_number(cell: str) -> bool:
    """Whether a cell holds a number; a comma may be the decimal mark."""
    return bool(_NUMBER.fullmatch(cell))


def sheets_of(text: str) -> list[Sheet]:
    """The tables in a text that have rows, in their order: what stands above headings is no row, and other headings begin another table."""
    written = [(number, line) for number, line in enumerate(text.splitlines(), start=1) if line and not line.isspace()]
    separator = _separator([line for _, line in written if not _is_comment(line)])
    lines = [(number, _is_comment(line), _cells(line, separator)) for number, line in written]
    heads = [place for place, (_, _, cells) in enumerate(lines) if _are_headings(cells)]
    # Names of tools, which may be words that are known, stand above headings
    heads = [place for place in heads if place + 1 not in heads]
    if not heads:
        return _without_known_headings([line for line in lines if not line[1]])
    starts = [heads[0], *(place for before, place in pairwise(heads) if lines[place][2] != lines[before][2])]
    ends = zip([0, *(start + 1 for start in starts)], starts, [*starts[1:], len(lines)])
    found = (_under(lines[first:start], lines[start][2], lines[start + 1 : end], end == len(lines)) for first, start, end in ends)
    return [sheet for sheet in found if len(sheet)]


_Lines = list[tuple[int, bool, list[str]]]
"""The number of each in its file, whether it is a comment, and its cells."""


def _under(over: _Lines, headings: list[str], below: _Lines, is_last: bool) -> Sheet:
    """The table below a line of headings, with what stands over them."""
    rows = [(number, cells) for number, is_comment, cells in below if not is_comment and cells != headings]
    if rows and all(unit_of(cell) is not None for cell in rows[0][1] if cell):
        headings = [f"{heading} ({unit})" if unit else heading for heading, unit in zip(headings, rows.pop(0)[1])]
    while rows and not is_last and not _fits(rows[-1][1], len(headings)):
        rows.pop()  # the title of the next table
    above = [cells for _, _, cells in over]
    groups: list[list[str]] = []
    while above and not above[-1][0] and any(above[-1]):
        groups.insert(0, _filled(above.pop(), len(headings)))
    skipped = f"lines 1 to {over[len(above) - 1][0]}, which are above its headings" if above else ""
    return Sheet([cells for _, cells in rows], [number for number, _ in rows], headings, groups, above, skipped)


def _without_known_headings(lines: _Lines) -> list[Sheet]:
    """A table of numbers; a line of words directly above it are its headings."""
    mostly = [2 * sum(map(is_number, cells)) >= sum(map(bool, cells)) > 0 for _, _, cells in lines]
    if not any(mostly):
        return []
    width = Counter(len(cells) for is_row, (_, _, cells) in zip(mostly, lines) if is_row).most_common(1)[0][0]
    first = next(place for place, (_, _, cells) in enumerate(lines) if mostly[place] and _fits(cells, width))
    above = [cells for _, _, cells in lines[:first]]
    headings = above.pop() if above and _fits(above[-1], width) and not any(map(is_number, above[-1])) else None
    skipped = f"lines 1 to {lines[len(above) - 1][0]}, which hold no poses" if above else ""
    rows = lines[first:]
    return [Sheet([cells for _, _, cells in rows], [number for number, _, _ in rows], headings, above=above, skipped=skipped)]


def _are_headings(cells: Sequence[str]) -> bool:
    """Whether they say what columns hold; names of tools above their columns, which may be called X, Y and Z, stand again and again."""
    if any(map(is_number, cells)) or 2 * sum(bool(one) and one == other for one, other in pairwise(cells)) > len(cells):
        return False
    return len({role for cell in cells if cell for _, role in column_of(cell).readings()}) >= _KNOWN_HEADINGS


def _fits(cells: Sequence[str], width: int) -> bool:
    return len(cells) == width or (len(cells) == width + 1 and not cells[-1])


def _filled(cells: list[str], width: int) -> list[str]:
    """Cells of a line above headings; one that stands once over several columns is that of all of them."""
    filled, last = [], ""
    for cell in [*cells, *[""] * (width - len(cells))][:width]:
        last = cell or last
        filled.append(last)
    return filled


def _cells(line: str, separator: str | None) -> list[str]:
    """The cells of a line, without quotes around them; a comment over a table may have separators of its own."""
    if _is_comment(line):
        line = line.strip().lstrip("#%/").strip()
        separator = separator if separator and separator in line else None
    if separator and '"' in line:
        line = re.sub(r'"[^"]*"', lambda quoted: quoted[0].replace(separator, " "), line)
    return [cell.strip().strip("\"'").strip() for cell in line.split(separator)]


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(_MARKS)


def _separator(lines: Sequence[str]) -> str | None:
    """What separates the cells: the mark by which most of them are numbers, in lines of equal length. None: white space."""
    middle = max(len(lines) - _LOOKED_AT, 0) // 2

    def worth(separator: str | None) -> tuple[float, float]:
        rows = [_cells(line, separator) for line in lines[middle : middle + _LOOKED_AT]]
        width, count = Counter(map(len, rows)).most_common(1)[0]
        cells = [cell for row in rows for cell in row if cell]
        if width < 2 or not cells:
            return 0.0, 0.0
        return round(sum(map(is_number, cells)) / len(cells), 2), count / len(rows)

    marks: tuple[str | None, ...] = (";", "\t", ",", None)
    return max(marks, key=worth) if lines else None
