"""A table in text: which lines are its rows, which are headings and units. pandas makes numbers of its cells."""

from __future__ import annotations

import contextlib
import csv
import io
import re
import string
import warnings
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import compress, pairwise
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

_COMMENT = re.compile(r"\s*(#|//|%)")
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?|[+-]?inf", re.IGNORECASE)
_NO_VALUE = ("", "missing", "nan", "null", "none", "n/a", "na", "-", "--")
_AROUND = string.whitespace + "\"'"
BAD_FLOAT = -3.697314e28
"""What NDI writes where there is no number."""
_LOOKED_AT = 400
"""Lines in the middle of a text by which separators and widths are judged."""
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
    rows : list of str
        As they are written.
    lines : list of int
        The number of each in its file.
    separator : str or None
        Of cells; None: white space.
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

    rows: list[str]
    lines: Sequence[int]
    separator: str | None = None
    headings: list[str] | None = None
    groups: list[list[str]] = field(default_factory=list)
    above: list[list[str]] = field(default_factory=list)
    skipped: str = ""
    item: str = "line"

    @cached_property
    def width(self) -> int:
        """Columns that it should have."""
        return len(self.headings or cells_of(self.rows[0], self.separator))

    def __len__(self) -> int:
        return len(self.rows)

    def place(self, number: int) -> str:
        """Where a row stands, in words."""
        return f"line {self.lines[number]} (frame {number})" if self.item == "line" else f"{self.item} {self.lines[number]}"

    def where(self, mask: Sequence[bool]) -> Sheet:
        """Some of the rows."""
        return replace(self, rows=list(compress(self.rows, mask)), lines=list(compress(self.lines, mask)))

    def _frame(self, **how: Any) -> Any:
        """The cells as pandas' DataFrame. Raises FileFormatError, which names the first row that is too long or too short."""
        for number, row in enumerate(self.rows):
            if len(row.split(self.separator)) != self.width and not _fits(cells := cells_of(row, self.separator), self.width):
                raise FileFormatError(f"{self.place(number)} must have {self.width} columns; got {len(cells)}. Export it again.")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a separator behind the last cell
            return library("pandas", "Tables of poses").read_csv(
                io.StringIO("\n".join(self.rows)),
                sep=self.separator or r"\s+",
                names=range(self.width),
                index_col=False,
                skipinitialspace=True,
                skip_blank_lines=False,
                low_memory=False,
                quoting=csv.QUOTE_NONE,
                keep_default_na=False,
                **how,
            )

    @cached_property
    def _numbers(self) -> Any:
        return self._frame(na_values=[*_NO_VALUE, *map(str.upper, _NO_VALUE), "NaN"])

    def words(self, place: int) -> list[str]:
        """A column as it is written."""
        return [word.strip(_AROUND) for word in self._frame(usecols=[place], dtype=str, na_filter=False)[place]]

    def numbers(self, place: int, name: str) -> Floats:
        """A column as numbers, NaN where a cell is blank or says that there is none.

        Raises FileFormatError, which names the row and the column.
        """
        numbers = self._numbers[place]
        if numbers.dtype.kind not in "iuf":
            pandas = library("pandas", "Tables of poses")
            words = pandas.Series(self.words(place), dtype=object)
            numbers = pandas.to_numeric(words.str.replace(",", ".", regex=False), errors="coerce")
            wrong = numbers.isna() & ~words.str.lower().isin(_NO_VALUE)
            if wrong.any():
                row = int(wrong.idxmax())
                must = f"{self.place(row)}, column {name} must be a number; got {shorten(words[row])!r}"
                raise FileFormatError(f"{must}. Export it again, with decimal points.")
        values = numbers.to_numpy(np.float64)
        return np.where(np.isclose(values, BAD_FLOAT, rtol=1e-4), np.nan, values)


def has_none(cell: str) -> bool:
    """Whether a cell is blank, or says that there is nothing."""
    return cell.lower() in _NO_VALUE


def is_number(cell: str) -> bool:
    """Whether a cell holds a number; a comma may be the decimal mark."""
    return bool(_NUMBER.fullmatch(cell))


_Lines = list[tuple[int, str]]
"""Each with its number in its file."""


def sheets_of(text: str) -> list[Sheet]:
    """The tables in a text that have rows, in their order: what stands above headings is no row, and other headings begin another table."""
    separator = _separator([line for line in text.splitlines() if line.strip() and not _COMMENT.match(line)])
    if separator and '"' in text:
        text = re.sub('"[^"\n]*"', lambda quoted: quoted[0].replace(separator, " "), text)
    lines = [(number, line) for number, line in enumerate(text.splitlines(), start=1) if line and not line.isspace()]
    mark = re.escape(separator) if separator else r"\s"
    with_number = re.compile(rf"(?:^|{mark})[\s\"']*(?:{_NUMBER.pattern})[\s\"']*(?:$|{mark})", re.IGNORECASE).search
    heads = [place for place, (_, line) in enumerate(lines) if not with_number(line) and _are_headings(cells_of(line, separator))]
    # Names of tools, which may be words that are known, stand above headings
    heads = [place for place in heads if place + 1 not in heads]
    if not heads:
        return _without_known_headings([line for line in lines if not _COMMENT.match(line[1])], separator)
    starts = [heads[0], *(place for before, place in pairwise(heads) if lines[place][1] != lines[before][1])]
    ends = zip([0, *(start + 1 for start in starts)], starts, [*starts[1:], len(lines)])
    found = (_under(lines[first : start + 1], lines[start + 1 : end], separator, end == len(lines)) for first, start, end in ends)
    return [sheet for sheet in found if len(sheet)]


def _under(over: _Lines, below: _Lines, separator: str | None, is_last: bool) -> Sheet:
    """The table below a line of headings, the last of those over it."""
    *before, (_, head) = over
    headings = cells_of(head, separator)
    rows = [(number, line) for number, line in below if line != head and not _COMMENT.match(line)]
    if rows and all(unit_of(cell) is not None for cell in cells_of(rows[0][1], separator) if cell):
        headings = [f"{name} ({unit})" if unit else name for name, unit in zip(headings, cells_of(rows.pop(0)[1], separator))]
    while rows and not is_last and not _fits(cells_of(rows[-1][1], separator), len(headings)):
        rows.pop()  # the title of the next table
    above = [cells_of(line, separator) for _, line in before]
    groups: list[list[str]] = []
    while above and not above[-1][0] and any(above[-1]):
        groups.insert(0, _filled(above.pop(), len(headings)))
    skipped = f"lines 1 to {before[len(above) - 1][0]}, which are above its headings" if above else ""
    return Sheet([line for _, line in rows], [number for number, _ in rows], separator, headings, groups, above, skipped)


def _without_known_headings(lines: _Lines, separator: str | None) -> list[Sheet]:
    """A table of numbers; a line of words directly above it are its headings."""

    def numbers_in(line: str) -> int:
        """How many cells a line of numbers has; 0 for others."""
        cells = cells_of(line, separator)
        return len(cells) * (2 * sum(map(is_number, cells)) >= sum(map(bool, cells)) > 0)

    widths = Counter(filter(None, (numbers_in(line) for _, line in _middle(lines)))).most_common(1)
    if not widths:
        return []
    width = widths[0][0]
    first = next(n for n, (_, line) in enumerate(lines) if numbers_in(line) and _fits(cells_of(line, separator), width))
    above = [cells_of(line, separator) for _, line in lines[:first]]
    headings = above.pop() if above and _fits(above[-1], width) and not any(map(is_number, above[-1])) else None
    skipped = f"lines 1 to {lines[len(above) - 1][0]}, which hold no poses" if above else ""
    numbers, rows = map(list, zip(*lines[first:]))
    return [Sheet(rows, numbers, separator, headings, above=above, skipped=skipped)]


def _are_headings(cells: Sequence[str]) -> bool:
    """Whether they say what columns hold; names of tools above their columns, which may be called X, Y and Z, stand again and again."""
    if any(map(is_number, cells)) or 2 * sum(bool(one) and one == other for one, other in pairwise(cells)) > len(cells):
        return False
    return len({role for cell in cells if cell for _, role in column_of(cell).readings()}) >= _KNOWN_HEADINGS


def _fits(cells: Sequence[str], width: int) -> bool:
    return len(cells) == width or (len(cells) == width + 1 and not cells[-1])


def _filled(cells: list[str], width: int) -> list[str]:
    """Cells of a line above headings; one that stands once over several columns is that of all of them."""
    filled = [*cells, *[""] * (width - len(cells))][:width]
    for place in range(1, width):
        filled[place] = filled[place] or filled[place - 1]
    return filled


def cells_of(line: str, separator: str | None) -> list[str]:
    """The cells of a line, without quotes around them; a comment over a table may have separators of its own."""
    if _COMMENT.match(line):
        line = line.strip().lstrip("#%/").strip()
        separator = separator if separator and separator in line else None
    return [cell.strip(_AROUND) for cell in line.split(separator)]


def _middle(lines: Sequence[Any]) -> Sequence[Any]:
    """The lines that are looked at."""
    first = max(len(lines) - _LOOKED_AT, 0) // 2
    return lines[first : first + _LOOKED_AT]


def _separator(lines: Sequence[str]) -> str | None:
    """What separates the cells: the mark by which most of them are numbers, in lines of equal length. None: white space."""

    def worth(separator: str | None) -> tuple[float, float]:
        rows = [cells_of(line, separator) for line in _middle(lines)]
        width, count = Counter(map(len, rows)).most_common(1)[0]
        cells = [cell for row in rows for cell in row if cell]
        if width < 2 or not cells:
            return 0.0, 0.0
        return round(sum(map(is_number, cells)) / len(cells), 2), count / len(rows)

    marks: tuple[str | None, ...] = (";", "\t", ",", None)
    return max(marks, key=worth) if lines else None
