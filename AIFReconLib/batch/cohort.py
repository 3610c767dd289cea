"""All cases of a table, computed by workers: what is done already is left alone, what cannot be computed is said and costs nothing else."""

from __future__ import annotations

import time
import uuid
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from ..io.disk.atomic import output_errors
from ..io.disk.workspace import remove_left_behind
from ..message import listed
from ..progress import Progress, report
from .case import CaseTask, carry_out
from .engine import TRIES, Lost, completed, dashboard
from .records import DONE, FAILED, LOST, RECORDS, Record, is_current, made_of, read_record, try_to_keep
from .table import Case

if TYPE_CHECKING:
    from distributed import Client


@dataclass
class Cohort:
    """The cases of a table and what is known of each.

    Parameters
    ----------
    cases : list of Case
        In the order of the table.
    table_folder, output : Path
    records : dict of str to Record
        By the name of the case; grows while cases are computed.
    to_do : list of Case
        What is to be computed.
    """

    cases: list[Case]
    table_folder: Path
    output: Path
    records: dict[str, Record] = field(default_factory=dict)
    to_do: list[Case] = field(default_factory=list)

    def count(self, state: str) -> int:
        """How many cases are in a state."""
        return sum(record.state == state for record in self.records.values())

    def prepare(self, retry_failed: bool) -> None:
        """Look what is there, and what is to be done; with `retry_failed` also what has failed and is unchanged since.

        Raises OutputError when the folder cannot be written to.
        """
        with output_errors(self.output):
            (self.output / RECORDS).mkdir(parents=True, exist_ok=True)
        self.records, self.to_do = {}, []
        for case in self.cases:
            made = made_of(case, self.table_folder)
            if case.problems:
                # Said again by every run, for it is seen without computing
                sentence = listed([f"{each.column}: {each.sentence}" if each.column else each.sentence for each in case.problems], " ")
                self.records[case.name] = Record(case.name, FAILED, made, sentence)
                continue
            record = read_record(self.output, case.name)
            final = (DONE,) if retry_failed else (DONE, FAILED)
            if record is not None and record.state in final and is_current(record, made, self.output):
                self.records[case.name] = record
            else:
                self.to_do.append(case)

    def compute(self, workers: AbstractContextManager[Client], say: Callable[[str], None], progress: Progress | None = None) -> None:
        """Compute what is to be done.

        Parameters
        ----------
        workers : context manager
            Of `local_workers` or `cluster_at`.
        say : callable
            Told of workers, once they are there.
        progress : Progress or None
            Told after every case.
        """
        run = uuid.uuid4().hex
        tasks = {case.name: CaseTask(case, self.table_folder, self.output, run) for case in self.to_do}
        unknown: list[Record] = []
        started = time.monotonic()
        try:
            with workers as client:
                say(dashboard(client))
                report(progress, *self._so_far(started, 0))
                for done, (name, made) in enumerate(completed(client, carry_out, tasks), start=1):
                    record = self._lost(tasks[name], made) if isinstance(made, Lost) else made
                    if isinstance(made, Lost):
                        unknown.append(record)
                    self.records[name] = record
                    report(progress, *self._so_far(started, done))
        finally:
            try_to_keep(self.output, unknown)
            self._take_unheard(tasks)
            # Workers that were ended have left the folder in which they wrote
            remove_left_behind(self.output)

    def _take_unheard(self, tasks: dict[str, CaseTask]) -> None:
        """Cases that were done when nobody listened any more."""
        for name, task in tasks.items():
            record = None if name in self.records else read_record(self.output, name)
            if record is not None and record.run == task.run and record.state == DONE:
                self.records[name] = record

    def _lost(self, task: CaseTask, lost: Lost) -> Record:
        """The record of a case whose process did not survive it."""
        sentence = (
            f"It was not finished: {lost.reason}, from outside or for more memory than it may take. Run the same again, with more "
            "--memory or fewer --workers."
        )
        return Record(task.case.name, LOST, made_of(task.case, self.table_folder), sentence, task.run, TRIES)

    def _so_far(self, started: float, done: int) -> tuple[float, str]:
        """How far the work is, from 0 to 1 and in words."""
        left = len(self.to_do) - done
        failed = self.count(FAILED) + self.count(LOST)
        message = f"{len(self.cases) - left} of {len(self.cases)} cases, {failed} failed"
        if done and left:
            message = f"{message}, {duration(left * (time.monotonic() - started) / done)} left"
        return (len(self.cases) - left) / len(self.cases), message


def duration(seconds: float) -> str:
    """A time as one says it: ``45 s``, ``12 min``, ``3 h 05 min``."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    if minutes < 90:
        return f"{minutes} min"
    return f"{minutes // 60} h {minutes % 60:02d} min"
