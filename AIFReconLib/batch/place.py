"""Where results may go: they replace results only, and whatever else lies in their place is refused before any work."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from pathlib import Path

from ..errors import OutputError
from ..io.disk.atomic import output_errors
from ..terminal.outputs import real_path
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

    Raises OutputError when the folder holds an input, a link or a file that no run of the command has written; names the first.
    """
    cases = list(cases)
    inside = real_path(output)
    for case in cases:
        for path in [*case.inputs, *method_files(case)]:
            # A link is one where it lies and where it leads to
            for place in (real_path(path), real_path(path.parent) / path.name):
                if place.is_relative_to(inside):
                    raise OutputError(
                        f"Cannot write results to {output}: it holds {path}, an input of {case.name}. Choose a folder for results alone."
                    )
    of_all = [output / name for name in OF_ALL]
    with output_errors(output):
        new = not (output / RECORDS).is_dir()
        for path in (output / RECORDS, *of_all):
            if path.is_symlink() or (new and path.exists()) or real_path(path) == real_path(table):
                raise _refused(path)
        for name in (case.name for case in cases):
            kept, record = record_path(output, name), read_record(output, name)
            # A link would be followed
            for path in (kept, kept.with_name(f"{name}{ALTERNATIVES}")):
                if path.is_symlink() or (path == kept and record is None and path.exists()):
                    raise _refused(path)
            if real_path(output / name) in map(real_path, of_all):
                raise _refused(output / name)
            require_results(output / name, () if record is None else record.outputs, output / name)


def require_results(folder: Path, known: Collection[str], where: Path) -> None:
    """Return if a folder, which belongs at `where`, is none yet or holds nothing but results, known by their names.

    Raises OutputError otherwise.
    """
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise _refused(where)
    for path in folder.iterdir() if folder.exists() else ():
        if path.name not in (*known, *OF_THE_DESKTOP) or path.is_symlink() or path.is_dir():
            raise _refused(where / path.name)


def _refused(path: Path) -> OutputError:
    return OutputError(
        f"Cannot write results: {path} is in their place, and no run of aifrecon batch has written it. Move it, or choose another --output."
    )
