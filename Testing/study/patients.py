"""A study of many simulated patients: each is a task of its own whose rows are kept in a file, so that an interrupted study goes on
where it stopped."""

from __future__ import annotations

import json
import os
import statistics
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import BrokenExecutor, as_completed
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from AIFReconLib.batch.engine import LocalExecutor
from AIFReconLib.errors import FileFormatError, InsufficientMemoryError
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


@dataclass(frozen=True)
class Spread:
    """Median and quartiles of a number over the patients."""

    median: float
    low: float
    high: float

    @classmethod
    def of(cls, numbers: Iterable[float]) -> Spread:
        """Of `numbers`, those that are not NaN; NaN where none is."""
        known = sorted(number for number in numbers if number == number)
        if not known:
            return cls(float("nan"), float("nan"), float("nan"))
        if len(known) == 1:
            return cls(known[0], known[0], known[0])
        low, median, high = statistics.quantiles(known, n=4, method="inclusive")
        return cls(median, low, high)


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
    missing = {name: one for name, one in given.items() if not _file(folder, name).exists()}

    def tell(done: int) -> None:
        report(progress, done / max(len(given), 1), f"{done} of {len(given)} {counted} done")

    done = len(given) - len(missing)
    tell(done)
    if missing:
        processes = min(jobs, len(missing))
        with LocalExecutor(processes, max(usable_cores() // processes, 1)) as executor:
            futures = {executor.submit(work, one): name for name, one in missing.items()}
            for future in as_completed(futures):
                name = futures[future]
                try:
                    made = future.result()
                except BrokenExecutor:
                    raise InsufficientMemoryError(
                        f"A process of the study was ended from outside, for memory most likely, after {done} of {len(given)} {counted}. "
                        "Run it again with fewer --jobs; it goes on where it stopped."
                    ) from None
                write_text(_file(folder, name), json.dumps([asdict(each) for each in made], indent=1) + "\n")
                done += 1
                tell(done)
    return [each for name in given for each in read_rows(_file(folder, name), row)]


def read_rows(path: Path, row: type[Row]) -> list[Row]:
    """The rows of one patient's file."""
    try:
        return [row(**values) for values in json.loads(path.read_text("utf-8"))]
    except (ValueError, TypeError) as error:
        raise FileFormatError(f"{path}: it is no result of the study ({error}). Delete it, and run the study again.") from None


def spread_of(rows: Iterable[Any], name: str, **wanted: str) -> Spread:
    """Over the patients, of the metric `name` in the rows, which have `metrics`, whose other values are as `wanted`."""
    return Spread.of(row.metrics[name] for row in rows if all(getattr(row, key) == value for key, value in wanted.items()))


def table_head(labels: Iterable[str]) -> list[str]:
    """The first two lines of a Markdown table whose first column names its lines."""
    labels = tuple(labels)
    return [table_line("", labels), "|---" * (len(labels) + 1) + "|"]


def table_line(name: str, cells: Iterable[str]) -> str:
    """A line of it."""
    return f"| {name} | " + " | ".join(cells) + " |"


def _file(folder: Path, name: str) -> Path:
    return folder / f"{name}.json"
