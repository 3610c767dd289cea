"""A study of many simulated patients: each is a task of its own whose rows are kept in a file, so that an interrupted study goes on
where it stopped."""

from __future__ import annotations

import json
import signal
import statistics
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from AIFReconLib.errors import FileFormatError, InsufficientMemoryError
from AIFReconLib.io.disk.atomic import write_text
from AIFReconLib.message import Message
from AIFReconLib.progress import Progress, report

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Row = TypeVar("Row", bound="DataclassInstance")
"""A dataclass of what JSON can hold: one reconstruction of a patient, and its numbers."""

MOST_JOBS = 61
"""Windows waits for no more processes at a time."""


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


def run_study(
    work: Callable[[int], list[Row]], row: type[Row], folder: Path, seeds: Iterable[int], jobs: int = 2, progress: Progress | None = None
) -> list[Row]:
    """Make, or read where they are there already, the rows of every patient.

    Parameters
    ----------
    work : callable
        The rows of one patient, by its seed. A function of a module: it runs in another process.
    row : type
        The dataclass of the rows.
    folder : Path
        Holds one file per patient; exists.
    seeds : iterable of int
    jobs : int
        Patients at a time, each in a process of its own.

    Raises
    ------
    FileFormatError
        When a file of an earlier run cannot be read.
    """
    seeds = list(seeds)
    missing = [seed for seed in seeds if not _file(folder, seed).exists()]
    done = len(seeds) - len(missing)
    report(progress, done / max(len(seeds), 1), Message("{done} of {count} patients done", done=done, count=len(seeds)))
    # Not forked: the same on every system, and safe beside other threads
    pool = ProcessPoolExecutor(
        max_workers=max(min(jobs, len(missing), MOST_JOBS), 1), mp_context=get_context("spawn"), initializer=_leave_ctrl_c
    )
    try:
        tasks = {pool.submit(work, seed): seed for seed in missing}
        for task in as_completed(tasks):
            rows = [asdict(each) for each in task.result()]
            write_text(_file(folder, tasks[task]), json.dumps(rows, indent=1) + "\n")
            done += 1
            report(progress, done / len(seeds), Message("{done} of {count} patients done", done=done, count=len(seeds)))
    except BrokenProcessPool:
        raise InsufficientMemoryError(
            "A process of the study was ended from outside, for memory most likely, after {done} of {count} patients. "
            "Run it again with fewer --jobs; it goes on where it stopped.",
            done=done,
            count=len(seeds),
        ) from None
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
    return [each for seed in seeds for each in read_rows(_file(folder, seed), row)]


def read_rows(path: Path, row: type[Row]) -> list[Row]:
    """The rows of one patient's file."""
    try:
        return [row(**values) for values in json.loads(path.read_text("utf-8"))]
    except (ValueError, TypeError) as error:
        raise FileFormatError(
            "{path}: it is no result of the study ({problem}). Delete it, and run the study again.", path=path, problem=error
        ) from None


def spread_of(rows: Iterable[Any], name: str, **wanted: str) -> Spread:
    """Over the patients, of the metric `name` in the rows, which have `metrics`, whose other values are as `wanted`."""
    return Spread.of(row.metrics[name] for row in rows if all(getattr(row, key) == value for key, value in wanted.items()))


def _leave_ctrl_c() -> None:
    """In a worker: Ctrl-C is for the process that the user talks to."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _file(folder: Path, seed: int) -> Path:
    return folder / f"patient-{seed:03d}.json"
