"""A study of many simulated patients: each is a task of its own whose rows are kept in a file, so that an interrupted study goes on
where it stopped."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import as_completed
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import pandas as pd

from AIFReconLib.batch.engine import LocalExecutor
from AIFReconLib.errors import FileFormatError
from AIFReconLib.io.disk.atomic import write_text
from AIFReconLib.machine.threads import usable_cores
from AIFReconLib.progress import Progress, report

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Row = TypeVar("Row", bound="DataclassInstance")
"""A dataclass of what JSON can hold: one reconstruction of a patient, and its numbers."""

Given = TypeVar("Given")
"""What a task is called with."""


def data_folder(name: str) -> Path:
    """A folder of AIFRECON_DATA_DIR, else of shared/data beside the repository; FileFormatError where it is not there."""
    beside = Path(__file__).resolve().parents[3] / "shared" / "data"
    folder = Path(os.environ.get("AIFRECON_DATA_DIR") or beside) / name
    if not folder.is_dir():
        raise FileFormatError(f"{folder} is not there. Set AIFRECON_DATA_DIR to the folder that holds {name}/.")
    return folder


def run_tasks(
    work: Callable[[Given], list[Row]],
    given: Mapping[str, Given],
    row: type[Row],
    folder: Path,
    jobs: int = 2,
    progress: Progress | None = None,
    counted: str = "tasks",
) -> list[Row]:
    """Make, or read where they are there already, the rows of every task, by the workers of `aifrecon batch`.

    Parameters
    ----------
    work : callable
        The rows of one task. A function of a module: it runs in another process.
    given : mapping of str to object
        What it is called with, by the name of the file that keeps its rows.
    row : type
        The dataclass of the rows.
    folder : Path
        Holds one file per task; exists.
    jobs : int
        Tasks at a time, each in a process of its own.
    counted : str
        What tasks are called.

    Raises
    ------
    FileFormatError
        When a file of an earlier run cannot be read.
    """
    files = {name: folder / f"{name}.json" for name in given}
    missing = [name for name, file in files.items() if not file.exists()]
    if missing:
        processes = min(jobs, len(missing))
        with LocalExecutor(processes, max(usable_cores() // processes, 1)) as executor:
            futures = {executor.submit(work, given[name]): files[name] for name in missing}
            for done, future in enumerate(as_completed(futures), 1 + len(given) - len(missing)):
                write_text(futures[future], json.dumps([asdict(each) for each in future.result()], indent=1) + "\n")
                report(progress, done / len(given), f"{done} of {len(given)} {counted} done")
    return [each for file in files.values() for each in read_rows(file, row)]


def read_rows(path: Path, row: type[Row]) -> list[Row]:
    """The rows of one patient's file."""
    try:
        return [row(**values) for values in json.loads(path.read_text("utf-8"))]
    except (ValueError, TypeError) as error:
        raise FileFormatError(f"{path}: it is no result of the study ({error}). Delete it, and run the study again.") from None


def quartiles(rows: Iterable[Any], name: str, **wanted: str) -> list[float]:
    """Lower quartile, median and upper one of the metric `name` in the rows, which have `metrics`, whose other values are as `wanted`."""
    numbers = [row.metrics[name] for row in rows if all(getattr(row, key) == value for key, value in wanted.items())]
    spread: list[float] = pd.Series(numbers, dtype=float).quantile([0.25, 0.5, 0.75]).tolist()
    return spread
