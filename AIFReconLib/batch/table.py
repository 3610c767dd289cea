"""A table of cases: read, and everything found that is wrong with it before anything is computed."""

from __future__ import annotations

import csv
import difflib
import io
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..compounding.methods.table import is_own_method
from ..compounding.needs import require_bone
from ..errors import AIFReconError, FileFormatError
from ..io.disk.regular_files import files_in, require_regular_file
from ..io.disk.small_files import read_bytes
from ..io.metafile.opening import data_files
from ..io.sequence.files import recording_kind
from ..message import message_of
from ..terminal.arguments import with_values
from ..terminal.labels_options import names_labels
from ..terminal.outputs import paths_in
from ..terminal.reconstruction_options import check_bone_options, seen_source
from ..terminal.remedies import in_columns
from ..terminal.sequence_options import configured
from .columns import CASE, METHOD, REQUIRED, SWEEPS, CaseOptions, Columns

MOST_BYTES = 2**28
LONGEST_NAME = 100

_NAME = re.compile(rf"\w[\w .+-]{{0,{LONGEST_NAME - 1}}}")
_OF_WINDOWS = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)

_OF_REGISTER = ("per_segment", "level", "accept")


@dataclass(frozen=True)
class _Problem:
    """What is wrong with a table: the row as a spreadsheet counts it, the column ("" for the whole row), and a sentence."""

    row: int
    column: str
    sentence: str

    def __str__(self) -> str:
        where = f"row {self.row}, {self.column}" if self.column else f"row {self.row}"
        return f"{where}: {self.sentence}"


@dataclass(frozen=True, eq=False)
class Case:
    """One row.

    Parameters
    ----------
    name : str
        Of the folder of its results.
    folder : Path
        Of the table.
    arguments : CaseOptions
        The options that the row fills, and the defaults of the others; paths are whole.
    methods : tuple of str or None
        None: the default.
    given : dict of str to str
        The cells, by column, without those that say nothing.
    inputs : tuple of Path
        Files that are read.
    problems : tuple of _Problem
        Why it cannot be computed.
    """

    name: str
    folder: Path
    arguments: CaseOptions
    methods: tuple[str | None, ...]
    given: dict[str, str]
    inputs: tuple[Path, ...]
    problems: tuple[_Problem, ...]


@dataclass(frozen=True, eq=False)
class Cases:
    """All rows of a table.

    Parameters
    ----------
    cases : tuple of Case
    problems : tuple of _Problem
        Of the table as a whole: with any of these nothing can be computed.
    """

    cases: tuple[Case, ...]
    problems: tuple[_Problem, ...]

    @property
    def all_problems(self) -> list[_Problem]:
        """Of the table and of every row, from top to bottom."""
        return sorted([*self.problems, *(each for case in self.cases for each in case.problems)], key=lambda each: each.row)


def read_cases(path: str | Path) -> Cases:
    """The cases of a table, with what is wrong with each.

    Raises FileFormatError when the file is no such table.

    Parameters
    ----------
    path : str or Path
        CSV in UTF-8, separated by commas, semicolons or tabs, with a line of column names.
    """
    path = Path(path).absolute()
    columns = Columns()
    rows = _rows(path)
    head = [cell.strip().lower().replace("-", "_") for cell in next(rows, (0, []))[1]]
    problems = [*_of_head(head, columns)]
    cases = []
    seen: dict[str, int] = {}
    for number, cells in rows:
        if not any(cell.strip() for cell in cells):
            continue
        case = _case(number, cells, head, columns, path.parent)
        cases.append(case)
        problems += _of_name(case.name, number, seen)
        seen.setdefault(case.name.casefold(), number)
    if not cases:
        problems.append(_Problem(1, "", "there are no cases below the column names. Add a row for each."))
    return Cases(tuple(cases), tuple(problems))


def _rows(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Cells, with the number of the row as a spreadsheet counts it."""
    data = read_bytes(path, MOST_BYTES, FileFormatError)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileFormatError(f"{path}: it is not text in UTF-8. Save it as CSV UTF-8.") from None
    first = text.partition("\n")[0]
    delimiter = max(",;\t", key=first.count)
    try:
        yield from enumerate(csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True), start=1)
    except csv.Error as error:
        raise FileFormatError(f"{path}: it cannot be read as CSV ({error!s}). Save it as CSV UTF-8.") from None


def _of_head(head: list[str], columns: Columns) -> Iterator[_Problem]:
    for name in REQUIRED:
        if name not in head:
            yield _Problem(1, name, "the table has no such column, which every case needs. Add it.")
    for name in dict.fromkeys(filter(None, head)):
        if head.count(name) > 1:
            yield _Problem(1, name, "the column is there twice. Remove one.")
        if name not in columns.names:
            near = difflib.get_close_matches(name, columns.names, n=1)
            meant = f", perhaps {near[0]} is meant. Correct it." if near else ". Remove it; aifrecon batch --help lists all."
            yield _Problem(1, name, f"there is no such column{meant}")


def _of_name(name: str, row: int, seen: dict[str, int]) -> Iterator[_Problem]:
    """What is wrong with the name of a case, which is that of a folder on every system."""
    if not name:
        yield _Problem(row, CASE, "the case has no name. Give each its own.")
    elif not _NAME.fullmatch(name) or name.endswith((" ", ".")) or _OF_WINDOWS.fullmatch(name):
        yield _Problem(row, CASE, f"{name!r} cannot be the name of a folder. Use letters, digits, and . _ + - between them.")
    elif name.casefold() in seen:
        yield _Problem(row, CASE, f"{name} is the name of row {seen[name.casefold()]} too. Give each its own.")


@contextmanager
def _told(problems: list[_Problem], row: int, column: str) -> Iterator[None]:
    """Within, an error is a problem of this cell."""
    try:
        yield
    except AIFReconError as error:
        problems.append(_Problem(row, column, in_columns(error)))


def _case(row: int, cells: list[str], head: list[str], columns: Columns, folder: Path) -> Case:
    """The case of a row."""
    given = {name: cell.strip() for name, cell in zip(head, cells, strict=False) if cell.strip() and name}
    problems: list[_Problem] = []
    if len(cells) > len(head):
        extra = f"there are more cells than columns: {cells[len(head)]!r} has no column. Quote cells that hold a comma."
        problems.append(_Problem(row, "", extra))
    values: dict[str, Any] = {}
    for column in given:
        if column != CASE and column in columns.names:
            with _told(problems, row, column):
                values[column] = columns.read(column, given[column], folder)
    methods = values.pop(METHOD, (None,))
    readable = not problems
    named = [(column, path) for column, value in values.items() for path in paths_in(value)]
    if SWEEPS not in values and SWEEPS in head:
        problems.append(_Problem(row, SWEEPS, "no recording is named. Give one or more, with ; between them."))
    # A recording may be a folder
    named = [(column, file) for column, path in named for file in (_files_of(path) if column == SWEEPS else [path])]
    problems += [_Problem(row, column, why) for column, path in named if (why := _why_not_a_file(path)) is not None]
    files = [path for _, path in named]
    detached = [data for path in files if path.suffix.lower() in (".mhd", ".nhdr") for data in data_files(path)]
    arguments = CaseOptions()
    vars(arguments).update(values)
    if readable:
        # What a file of settings says is known only now
        if arguments.settings is not None and _why_not_a_file(arguments.settings) is None:
            with _told(problems, row, "settings"):
                arguments.complete()
        _contradict(problems, row, arguments, methods, values, columns)
    inputs = tuple(dict.fromkeys([*files, *detached]))
    return Case(given.get(CASE, ""), folder, arguments, tuple(methods), given, inputs, tuple(problems))


def _contradict(
    problems: list[_Problem],
    row: int,
    arguments: CaseOptions,
    methods: Iterable[str | None],
    values: Mapping[str, object],
    columns: Columns,
) -> None:
    """Add what does not go together."""
    for rivals in columns.rivals():
        both = [name for name in rivals if values.get(name)]
        if len(both) > 1:
            problems.append(_Problem(row, both[1], f"{both[0]} is given too. Give one of them."))
    if not arguments.register:
        without = "it says how a CT is registered. Say yes under register too."
        problems += [_Problem(row, name, without) for name in _OF_REGISTER if values.get(name)]
    elif not names_labels(arguments):
        no_bone = "a CT is registered by its bone. Name its labels under bone_labels, or the CT under ct."
        problems.append(_Problem(row, "register", no_bone))
    with _told(problems, row, "config"):
        configured(arguments, arguments.sweeps)
    source = seen_source(arguments)
    with _told(problems, row, "bone_transform" if source is None else source.removeprefix("--").replace("-", "_")):
        check_bone_options(arguments)
    has_bone = bool(names_labels(arguments) or arguments.bone_probability or source)
    for method in methods:
        try:
            recipe = with_method(arguments, method).recipe
            require_bone(recipe.method_for(has_bone), recipe, has_bone)
        except AIFReconError as error:
            about = str(error).partition("Input ")[2].partition(" ")[0]
            problems.append(_Problem(row, about if about in columns.names else METHOD, in_columns(error)))


def _files_of(path: Path) -> list[Path]:
    """The file of a recording, or those of one that is a folder."""
    return files_in(path) if path.is_dir() and recording_kind(path) is not None else [path]


def with_method(arguments: CaseOptions, method: str | None) -> CaseOptions:
    """The same options with one of the methods; None leaves it as it is."""
    return arguments if method is None else with_values(arguments, method=method)


def method_files(case: Case) -> Iterator[Path]:
    """The modules of the methods of one's own, whose results change with them."""
    for method in case.methods:
        if method is not None and is_own_method(method) and (module := sys.modules.get(method.partition(":")[0])):
            yield from [Path(file) for file in [module.__file__] if file]


def _why_not_a_file(path: Path) -> str | None:
    """What is wrong with a file, as far as can be told without reading it."""
    try:
        require_regular_file(path, FileFormatError)
        return None if path.stat().st_size else f"{path}: the file is empty. Copy it again."
    except FileFormatError as error:
        return message_of(error)
    except OSError as error:
        return f"{path}: the file cannot be read ({error.strerror or str(error)}). Check its permissions."
