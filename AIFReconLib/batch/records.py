"""What is known of each case: a small file that says whether it is done, from which inputs, by which settings and version."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TypeAlias

from .. import __version__
from ..errors import OutputError
from ..io.disk.atomic import write_text
from ..io.disk.regular_files import file_stamp
from .table import Case, method_files

Row: TypeAlias = dict[str, float | str | None]
"""What was measured of a case by one method, by name."""

Facts: TypeAlias = dict[str, object]
"""As JSON has them."""

RECORDS = ".batch"
"""Folder of the records, within that of the results."""

DONE, FAILED, LOST, RUNNING = "done", "failed", "not finished", "running"
"""`FAILED`: for what is in its files or settings; `LOST`: for what is not, as a full disk, and so tried again by every run."""


@dataclass(frozen=True)
class Record:
    """What became of a case.

    Parameters
    ----------
    case : str
    state : str
    made_of : dict
        Version, settings and inputs, by which it is known again.
    message : str
        What went wrong, in words.
    run : str
        Which run of the command began it last.
    attempts : int
        How often that run has begun it.
    seconds : float
    results : list of dict
        A flat table of what was measured, a row per method.
    outputs : dict of str to int
        Files of its folder, and their bytes.
    """

    case: str
    state: str
    made_of: Facts
    message: str = ""
    run: str = ""
    attempts: int = 0
    seconds: float = 0.0
    results: list[Row] = field(default_factory=list)
    outputs: dict[str, int] = field(default_factory=dict)


def made_of(case: Case, folder: Path) -> Facts:
    """What the results of a case depend on; inputs are named from `folder`, that of the table, so that both may move together."""
    files = [*case.inputs, *method_files(case)]
    return {"version": __version__, "settings": case.given, "inputs": {_named(path, folder): _stamp(path) for path in files}}


def _named(path: Path, folder: Path) -> str:
    return (path.relative_to(folder) if path.is_relative_to(folder) else path).as_posix()


def _stamp(path: Path) -> list[int] | None:
    found = file_stamp(path)
    return None if found is None else list(found)


def record_path(output: Path, name: str) -> Path:
    """Where the record of a case lies."""
    return output / RECORDS / f"{name}.json"


def read_record(output: Path, name: str) -> Record | None:
    """The record of a case; None where there is none that can be used."""
    try:
        kept = json.loads(record_path(output, name).read_text("utf-8"))
        return Record(**kept)
    except (OSError, ValueError, TypeError):
        return None


def write_record(output: Path, record: Record) -> None:
    """Keep a record.

    Raises
    ------
    OutputError
    """
    write_text(record_path(output, record.case), json.dumps(asdict(record), indent=1) + "\n")


def try_to_keep(output: Path, records: Iterable[Record]) -> None:
    """Keep records as far as the disk takes them; those that it does not are tried again by the next run."""
    for record in records:
        try:
            write_record(output, record)
        except OutputError:
            return


def is_current(record: Record | None, made: Mapping[str, object], output: Path) -> bool:
    """Whether a record is of what is there: the same inputs, settings and version, and, of what is done, the same files."""
    if record is None or record.made_of != made:
        return False
    files = {output / record.case / name: size for name, size in record.outputs.items()}
    return all((stamp := file_stamp(path)) is not None and stamp[0] == size for path, size in files.items())
