"""Where results may go: they replace results only, and whatever else lies in their place is refused before any work."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path

from ..errors import OutputError
from ..io.disk.atomic import output_errors
from ..terminal.options import as_compared, real_path
from .page import PAGE
from .records import ALTERNATIVES, RECORDS, read_record, record_path
from .results import CSV, PARQUET
from .table import Case, method_files

OF_ALL = (CSV, PARQUET, PAGE)
"""Files beside the folders of the cases."""

OF_THE_DESKTOP = (".DS_Store", "Thumbs.db", "desktop.ini")
"""What systems put into every folder that is looked at."""


def require_place(cases: Iterable[Case], table: Path, output: Path) -> None:
    """Return if nothing but results of the same table would be replaced.

    Parameters
    ----------
    cases : iterable of Case
    table, output : Path

    Raises
    ------
    OutputError
        When the folder holds an input, a link or a file that no run of the command has written; names the first.
    """
    cases = list(cases)
    inside = Path(as_compared(real_path(output)))
    for case in cases:
        for path in [*case.inputs, *method_files(case)]:
            # A link is one where it lies and where it leads to
            for place in (real_path(path), real_path(path.parent) / path.name):
                if Path(as_compared(place)).is_relative_to(inside):
                    raise OutputError(
                        "Cannot write results to {folder}: it holds {path}, an input of {case}. Choose a folder for results alone.",
                        folder=output,
                        path=path,
                        case=case.name,
                    )
    names = [as_compared(Path(name)) for name in OF_ALL]
    with output_errors(output):
        strangers = [
            *(path for path in _of_all(cases, output) if path.is_symlink()),
            *(output / case.name for case in cases if as_compared(Path(case.name)) in names),
            *(output / name for name in OF_ALL if as_compared(real_path(output / name)) == as_compared(real_path(table))),
            *(path for case in cases for path in _strangers_of(output, case.name)),
        ]
        if not (output / RECORDS).is_dir():
            strangers += [path for path in _of_all([], output) if os.path.lexists(path)]
    if strangers:
        raise _refused(strangers[0])


def _of_all(cases: Iterable[Case], output: Path) -> Iterator[Path]:
    """Everything that is written but for the folders of the cases, which may be no link: it would be followed."""
    yield from (output / name for name in (RECORDS, *OF_ALL))
    for case in cases:
        path = record_path(output, case.name)
        yield from (path, path.with_name(f"{case.name}{ALTERNATIVES}"))


def _strangers_of(output: Path, name: str) -> Iterator[Path]:
    record = read_record(output, name)
    if record is None and record_path(output, name).exists():
        yield record_path(output, name)
    yield from strangers(output / name, () if record is None else record.outputs)


def require_results(folder: Path, known: Collection[str], where: Path) -> None:
    """Return if a folder, which lay at `where`, holds nothing but known results.

    Raises
    ------
    OutputError
    """
    for path in strangers(folder, known):
        raise _refused(where / path.relative_to(folder))


def strangers(folder: Path, known: Collection[str]) -> Iterator[Path]:
    """What lies in the place of a folder of results and is none.

    Parameters
    ----------
    folder : Path
    known : collection of str
        Results, by their paths within the folder.
    """
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        yield folder
        return
    for root, folders, files in os.walk(folder, onerror=_raise):
        for path in [Path(root, name) for name in (*files, *folders)]:
            is_one = path.is_symlink() or not path.is_dir()
            if is_one and path.name not in OF_THE_DESKTOP and path.relative_to(folder).as_posix() not in known:
                yield path


def _raise(error: OSError) -> None:
    if not isinstance(error, FileNotFoundError):
        raise error


def _refused(path: Path) -> OutputError:
    return OutputError(
        "Cannot write results: {path} is in their place, and no run of aifrecon batch has written it. Move it, or choose another --output.",
        path=path,
    )
