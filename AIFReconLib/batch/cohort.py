"""All cases of a table: what is done is left alone, what cannot be computed is said and costs nothing else."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from ..errors import OutputError
from ..io.disk.atomic import output_errors
from ..io.disk.workspace import remove_left_behind
from ..message import listed, shorten
from ..progress import Progress, report
from .case import carry_out
from .engine import Workers, completed
from .records import DONE, FAILED, LOST, RECORDS, Record, is_current, made_of, read_record, write_record
from .table import Case


@dataclass
class Cohort:
    """The cases of a table and what is known of each.

    Parameters
    ----------
    cases : list of Case
        In the order of the table.
    output : Path
    records : dict of str to Record
        By the name of the case; grows while cases are computed.
    to_do : list of Case
        What is to be computed.
    """

    cases: list[Case]
    output: Path
    records: dict[str, Record] = field(default_factory=dict)
    to_do: list[Case] = field(default_factory=list)

    def count(self, state: str) -> int:
        """How many cases are in a state."""
        return sum(record.state == state for record in self.records.values())

    def prepare(self, retry_failed: bool) -> None:
        """Look what is there, and what is to be done; with `retry_failed` also what has failed.

        Raises OutputError when the folder cannot be written to.
        """
        with output_errors(self.output):
            (self.output / RECORDS).mkdir(parents=True, exist_ok=True)
        self.records, self.to_do = {}, []
        for case in self.cases:
            if case.problems:
                # Said again by every run, for it is seen without computing
                sentence = listed([f"{each.column}: {each.sentence}" if each.column else each.sentence for each in case.problems], " ")
                self.records[case.name] = Record(case.name, FAILED, made_of(case), sentence)
            elif not self._take(case, (DONE,) if retry_failed else (DONE, FAILED)):
                self.to_do.append(case)

    def compute(self, workers: AbstractContextManager[Workers], say: Callable[[str], None], progress: Progress | None = None) -> None:
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
        started = time.monotonic()
        try:
            with workers as (executor, memory, words):
                say(words)
                report(progress, *self._so_far(started, 0))
                work = partial(carry_out, output=self.output, memory=memory)
                for done, (case, made) in enumerate(completed(executor, work, self.to_do), start=1):
                    self.records[case.name] = self._lost(case, made) if isinstance(made, Exception) else made
                    report(progress, *self._so_far(started, done))
        finally:
            for case in self.to_do:
                # Done when nobody listened any more
                if case.name not in self.records:
                    self._take(case, (DONE,))
            # Workers that were ended have left the folder in which they wrote
            remove_left_behind(self.output)

    def _take(self, case: Case, states: tuple[str, ...]) -> bool:
        """Whether a case is known to be in one of these states, and nothing of it has changed since."""
        record = read_record(self.output, case.name)
        if record is None or record.state not in states or not is_current(record, case, self.output):
            return False
        self.records[case.name] = record
        return True

    def _lost(self, case: Case, error: Exception) -> Record:
        """The record of a case whose process did not survive it."""
        sentence = (
            "It was not finished: its process was ended twice, from outside or for more memory than it may take, or its scheduler is gone "
            f"({shorten(f'{type(error).__name__}: {error}')}). Run the same again, with more --memory or fewer --workers."
        )
        record = Record(case.name, LOST, made_of(case), sentence)
        # A disk that does not take it has the next run try again all the same
        with suppress(OutputError):
            write_record(self.output, record)
        return record

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
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60:02d} min"
