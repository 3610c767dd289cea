"""What is known of each case: a small file that says whether it is done, from which inputs, by which settings and version."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TypeAlias

from .. import __version__
from ..errors import FileFormatError
from ..io.disk.atomic import write_text
from ..io.disk.regular_files import file_stamp
from ..io.disk.small_files import read_bytes
from .table import Case, method_files

Row: TypeAlias = dict[str, float | str | None]
"""What was measured of a case by one method, by name."""

Facts: TypeAlias = dict[str, object]
"""As JSON has them."""

RECORDS = ".batch"
"""Folder of the records, within that of the results."""

ALTERNATIVES = ".json.registration"
"""End of the name of a refused registration's report, which no record's name has."""

MOST_BYTES = 2**24

DONE, FAILED, LOST = "done", "failed", "not finished"
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
    seconds : float
    results : list of dict
        A flat table of what was measured, a row per method.
    outputs : dict of str to list of 2 int
        Files that runs have written into its folder, and the size and time of each as `stamp` has them.
    """

    case: str
    state: str
    made_of: Facts
    message: str = ""
    seconds: float = 0.0
    results: list[Row] = field(default_factory=list)
    outputs: Facts = field(default_factory=dict)


def made_of(case: Case) -> Facts:
    """What the results of a case depend on; inputs are named from the folder of the table, so that both may move together."""
    inputs = {}
    for path in [*case.inputs, *method_files(case)]:
        named = path.relative_to(case.folder) if path.is_relative_to(case.folder) else path
        inputs[named.as_posix()] = stamp(path)
    return {"version": __version__, "settings": case.given, "inputs": inputs}


def stamp(path: Path) -> list[int] | None:
    """Size and time of a file as a record has them; None where there is none."""
    found = file_stamp(path)
    return None if found is None else list(found)


def record_path(output: Path, name: str) -> Path:
    """Where the record of a case lies."""
    return output / RECORDS / f"{name}.json"


def read_record(output: Path, name: str) -> Record | None:
    """The record of a case; None where there is none that can be used."""
    try:
        return Record(**json.loads(read_bytes(record_path(output, name), MOST_BYTES, FileFormatError)))
    except (FileFormatError, ValueError, TypeError, RecursionError):
        return None


def write_record(output: Path, record: Record) -> None:
    """Keep a record. Of a case that is not done, what was in its folder before goes on being known, whoever computes it.

    Raises OutputError when it cannot be written.
    """
    before = None if record.state == DONE else read_record(output, record.case)
    if before is not None:
        record = replace(record, outputs={**before.outputs, **record.outputs})
    write_text(record_path(output, record.case), json.dumps(asdict(record), indent=1) + "\n")


def is_current(record: Record, case: Case, output: Path) -> bool:
    """Whether a record is of what is there: the same inputs, settings and version, and, of what is done, the same files."""
    files = record.outputs.items() if record.state == DONE else ()
    return record.made_of == made_of(case) and all(stamp(output / record.case / name) == kept for name, kept in files)
