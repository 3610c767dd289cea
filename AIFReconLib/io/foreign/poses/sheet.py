"""A table in text: which lines are its rows, which are headings and units. pandas reads the numbers and words in the rows."""

from __future__ import annotations

import io
import re
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ....arrays import Floats, Integers
from ....errors import FileFormatError
from ....message import one_line, shorten
from ...disk.small_files import read_bytes
from ...sequence.decoded_images import library
from .headings import are_headings, unit_of

MAXIMUM_BYTES = 2**30

_MARKS = ("#", "//", "%")
_RECEIVED = "%time"
"""A heading of ROS, and no comment."""

_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?|[+-]?inf", re.IGNORECASE)
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+([eE][+-]?\d+)?")
_NO_VALUE = ("", "missing", "nan", "null", "none", "n/a", "na", "-", "--")
BAD_FLOAT = -3.697314e28
"""What NDI writes where there is no number."""
_LOOKED_AT = 400
"""Lines by which separators are judged."""


def text_of(path: Path) -> str:
    """The text of a file, in UTF-8, UTF-16 or the encoding of Western Windows. Raises FileFormatError where it is none."""
    data = read_bytes(path, MAXIMUM_BYTES + 1, FileFormatError)
    wide = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    if len(data) > MAXIMUM_BYTES or (b"\0" in data and not wide):
        raise FileFormatError(f"{path}: this is not a text file of poses. Give .csv, .txt or .json.")
    for encoding in ("utf-16",) if wide else ("utf-8-sig", "cp1252"):
        try:
            return data.decode(encoding)
        except UnicodeDecodeError:
            continue
    raise FileFormatError(f"{path}: this is not a text file. Export the poses again.")


@dataclass(frozen=True, eq=False)
class Sheet:
    """A table of rows under one line of headings, or under none.

    Parameters
    ----------
    rows : list of str
        As they are written.
    lines : list of int
        The number of each.
    separator : str or None
        None: white space.
    headings : list of str or None
    groups : list of list of str
        Lines above the headings that say what several columns belong to, from the top; as long as the headings.
    units : list of str
        Of the columns, where a line says them.
    above : list of list of str
        What else stands above, by its cells.
    skipped : str
        What of the file is not read, in words.
    item : str
        What a row is called in messages.
    """

    rows: list[str]
    lines: list[int]
    separator: str | None = None
    headings: list[str] | None = None
    groups: list[list[str]] = field(default_factory=list)
    units: list[str] = field(default_factory=list)
    above: list[list[str]] = field(default_factory=list)
    skipped: str = ""
    item: str = "line"

    @cached_property
    def width(self) -> int:
        """Columns that it should have."""
        return len(self.headings) if self.headings else len(cells_of(self.rows[0], self.separator))

    def place(self, number: int) -> str:
        """Where a row stands, in words."""
        return f"line {self.lines[number]} (frame {number})" if self.item == "line" else f"{self.item} {self.lines[number]}"

    def read(self, width: int, words: Iterable[int] = ()) -> Cells:
        """The cells of all rows; `words` are the columns that are no numbers.

        Raises FileFormatError, which names the first row that has more or fewer columns than `width`.
        """
        self._check(width)
        pandas = library("pandas", "Tables of poses")
        comma = any(_DECIMAL_COMMA.fullmatch(cell) for row in self.rows[:_LOOKED_AT] for cell in cells_of(row, self.separator))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # rows are judged by `_check`
                frame = pandas.read_csv(
                    io.StringIO("\n".join(self.rows)),
                    sep=self.separator or r"\s+",
                    header=None,
                    names=range(width),
                    index_col=False,
                    dtype=dict.fromkeys(words, str),
                    na_filter=False,
                    decimal="," if comma and self.separator != "," else ".",
                    skipinitialspace=True,
                    skip_blank_lines=False,
                    low_memory=False,
                )
        except ValueError as error:  # pandas' own are such
            raise FileFormatError(f"it cannot be read as a table ({one_line(shorten(str(error), 200))}). Export it again.") from None
        return Cells(self, frame, np.arange(len(frame)))

    def _check(self, width: int) -> None:
        quoted = any('"' in row for row in self.rows[:_LOOKED_AT])
        counts = np.fromiter((row.count(self.separator) + 1 if self.separator else len(row.split()) for row in self.rows), np.intp)
        wrong = np.flatnonzero(counts != width)
        for number in wrong.tolist():
            cells = cells_of(self.rows[number], self.separator)
            if len(cells) != width and not (len(cells) == width + 1 and not cells[-1]):
                raise FileFormatError(f"{self.place(number)} must have {width} columns; got {len(cells)}. Export it again.")
            if not quoted and len(cells) == width:
                return


@dataclass(frozen=True, eq=False)
class Cells:
    """The cells of some rows of a table, by column from 0; `frame` is pandas' DataFrame."""

    sheet: Sheet
    frame: Any
    rows: Integers

    def __len__(self) -> int:
        return len(self.frame)

    def place(self, number: int) -> str:
        """Where a row stands, in words."""
        return self.sheet.place(int(self.rows[number]))

    def where(self, mask: Sequence[bool]) -> Cells:
        """Some of the rows."""
        return Cells(self.sheet, self.frame[mask], self.rows[np.asarray(mask)])

    def words(self, place: int) -> list[str]:
        """A column as it is written."""
        return [word.strip().strip("\"'") for word in self.frame[place].astype(str).tolist()]

    def are_numbers(self, place: int) -> bool:
        """Whether a column holds numbers alone, or nothing."""
        try:
            self.numbers(place, "")
        except FileFormatError:
            return False
        return True

    def numbers(self, place: int, name: str) -> Floats:
        """A column as numbers, NaN where a cell is blank or says that there is none.

        Raises FileFormatError, which names the row and the column.
        """
        column = self.frame[place]
        if column.dtype.kind in "iuf":
            values = np.asarray(column.to_numpy(), np.float64)
            return np.where(np.isclose(values, BAD_FLOAT, rtol=1e-4), np.nan, values)
        plain = column.astype(str).str.strip().str.strip("\"'")
        if self.sheet.separator != ",":
            plain = plain.where(~plain.str.fullmatch(_DECIMAL_COMMA.pattern), plain.str.replace(",", "."))
        numbers = library("pandas", "Tables of poses").to_numeric(plain, errors="coerce")
        wrong = numbers.isna() & ~plain.str.lower().isin(_NO_VALUE)
        if wrong.any():
            number = int(np.argmax(wrong.to_numpy()))
            word = shorten(str(plain.iloc[number]))
            raise FileFormatError(
                f"{self.place(number)}, column {name} must be a number; got {word!r}. Export it again, with decimal points."
            )
        return np.asarray(numbers.to_numpy(), np.float64)


def has_none(cell: str) -> bool:
    """Whether a cell is blank, or says that there is nothing."""
    return cell.lower() in _NO_VALUE


def is_number(cell: str) -> bool:
    """Whether a cell holds a number; a comma may be the decimal mark."""
    return bool(_NUMBER.fullmatch(cell))


def cells_of(line: str, separator: str | None) -> list[str]:
    """The cells of a line, without quotes around them."""
    if separator and '"' in line:
        line = re.sub(r'"[^"]*"', lambda quoted: quoted[0].replace(separator, " "), line)
    cells = line.split(separator) if separator else line.split()
    return [cell.strip().strip("\"'").strip() for cell in cells]


def sheets_of(text: str) -> list[Sheet]:
    """The tables in a text, in their order: lines above the headings are no rows, and another line of headings begins another table."""
    written = [(number, line) for number, line in enumerate(text.splitlines(), start=1) if line and not line.isspace()]
    plain = [line for _, line in written if not _is_comment(line)]
    middle = len(plain) // 2
    separator = _separator(plain[max(middle - _LOOKED_AT // 2, 0) : middle + _LOOKED_AT // 2])
    if not any(_numbers(line, separator) for line in plain):
        return []
    heads = [index for index, (_, line) in enumerate(written) if _may_be_headings(line) and _are_headings(_cells(line, separator))]
    # Names of tools may be words that are known, too; they stand above fuller headings
    full = [sum(map(bool, _cells(written[index][1], separator))) for index in heads]
    follows = dict(zip(heads, zip([*heads[1:], -1], [*full[1:], 0])))
    heads = [index for index, mine in zip(heads, full) if follows[index][0] != index + 1 or mine >= follows[index][1]]
    if not heads:
        sheet = _without_known_headings(written, separator)
        return [sheet] if sheet.rows else []
    starts = [heads[0], *(index for before, index in pairwise(heads) if written[index][1] != written[before][1])]
    ends = [*starts[1:], len(written)]
    firsts = [0, *(start + 1 for start in starts[:-1])]
    return [_under(written, part, separator) for part in zip(firsts, starts, ends)]


def _under(written: list[tuple[int, str]], part: tuple[int, int, int], separator: str | None) -> Sheet:
    """The table below a line of headings; `part` is where the lines above begin, where the headings are, and where it ends."""
    first, start, end = part
    head = written[start][1]
    headings = _cells(head, separator)
    below = [(number, line) for number, line in written[start + 1 : end] if line != head and not _is_comment(line)]
    units: list[str] = []
    if below and not _numbers(below[0][1], separator) and all(unit_of(cell) is not None for cell in _cells(below[0][1], separator) if cell):
        units = _cells(below.pop(0)[1], separator)
    if end < len(written):  # between two tables stand a title and the like
        fits = [_fits(_cells(line, separator), len(headings)) for _, line in below]
        below = below[: fits.index(False)] if False in fits else below
    above = [_cells(line, separator) for _, line in written[first:start]]
    groups: list[list[str]] = []
    while above and not above[-1][0] and any(above[-1]):
        groups.insert(0, _filled(above.pop(), len(headings)))
    skipped = f"lines 1 to {written[first + len(above) - 1][0]}, which are above its headings" if above else ""
    rows, lines = [line for _, line in below], [number for number, _ in below]
    return Sheet(rows, lines, separator, headings, groups, units, above, skipped)


def _without_known_headings(written: list[tuple[int, str]], separator: str | None) -> Sheet:
    """A table of numbers; a line of words directly above it are its headings."""
    rows = [(number, line) for number, line in written if not _is_comment(line)]
    width = Counter(len(_cells(line, separator)) for _, line in rows if _numbers(line, separator)).most_common(1)[0][0]

    def is_row(line: str) -> bool:
        cells = _cells(line, separator)
        return _fits(cells, width) and 2 * sum(map(is_number, cells)) >= sum(map(bool, cells))

    first = next((n for n, (_, line) in enumerate(rows) if is_row(line)), len(rows))
    above = [_cells(line, separator) for _, line in rows[:first]]
    headings = above.pop() if above and _fits(above[-1], width) and not _numbers(rows[first - 1][1], separator) else None
    skipped = f"lines 1 to {rows[len(above) - 1][0]}, which hold no poses" if above else ""
    below, lines = [line for _, line in rows[first:]], [number for number, _ in rows[first:]]
    return Sheet(below, lines, separator, headings, above=above, skipped=skipped)


def _numbers(line: str, separator: str | None) -> int:
    return sum(map(is_number, cells_of(line, separator)))


def _may_be_headings(line: str) -> bool:
    """Whether a line begins with no number, and has none with a decimal mark between marks that may part cells."""
    return line[0] not in "0123456789+-." and not re.search(r"(^|[,;\s])[+-]?\d+[.,]\d+([,;\s]|$)", line)


def _are_headings(cells: Sequence[str]) -> bool:
    """Whether they say what columns hold; names of tools above their columns, which may be called X, Y and Z, stand again and again."""
    again = sum(bool(one) and one == other for one, other in pairwise(cells))
    return 2 * again <= len(cells) and not any(map(is_number, cells)) and are_headings(cells)


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
    """The same; a comment over a table in blanks may have its own separators."""
    if not _is_comment(line):
        return cells_of(line, separator)
    words = line.lstrip().lstrip("#%/").strip()
    return cells_of(words, separator if separator is None or separator in words else None)


def _is_comment(line: str) -> bool:
    if line[0] in "0123456789+-.":
        return False
    start = line.lstrip()
    return start.startswith(_MARKS) and not start.startswith(_RECEIVED)


def _separator(lines: Sequence[str]) -> str | None:
    """What separates the cells: the mark by which most of them are numbers, in lines of equal length. None: white space."""

    def worth(separator: str | None) -> tuple[float, float]:
        rows = [cells_of(line, separator) for line in lines]
        width, count = Counter(map(len, rows)).most_common(1)[0]
        cells = [cell for row in rows for cell in row if cell]
        if width < 2 or not cells:
            return 0.0, 0.0
        return round(sum(map(is_number, cells)) / len(cells), 2), count / len(rows)

    marks: Callable[[str | None], tuple[float, float]] = worth
    return max((";", "\t", ",", None), key=marks) if lines else None
