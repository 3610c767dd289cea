"""`aifrecon batch`: a table of cases becomes volumes, metrics and one page, overnight."""

from __future__ import annotations

import contextlib
import sys
import textwrap
from pathlib import Path
from typing import Annotated, ClassVar

from ..batch.cohort import Cohort, duration
from ..batch.columns import Columns
from ..batch.engine import cluster_at, local_workers, require
from ..batch.memory import shared_out
from ..batch.page import PAGE, WARNING, page
from ..batch.place import require_place
from ..batch.records import DONE, FAILED, LOST
from ..batch.results import results_table, write_tables
from ..batch.table import Cases, read_cases
from ..errors import FileFormatError, OutputError, SettingsError
from ..io.disk.atomic import write_text
from ..terminal.arguments import Names, Options, count, load_method_here
from ..terminal.console import ProgressBar, show
from ..terminal.reconstruction_options import gigabytes

MOST_SHOWN = 20
"""Cases that are not done, with their reasons, on the terminal."""


class _BatchOptions(Options):
    """Compute every case of a table on this computer's cores or on a Dask cluster: volumes, registration, coverage, metrics and previews
    in a folder each, and results.csv, results.parquet and index.html of all.

    Parameters
    ----------
    table : CASES.csv
        a row per case
    output : DIR
        folder of all results; made if it is not there
    dry_run
        only check every row, and list all that is wrong
    retry_failed
        also compute again what failed and has not changed since
    method : MODULE:FUNCTION
        a method of your own that the table names; may be repeated
    workers : N
        processes (default: as many on this computer as cores and memory allow)
    memory : GB
        that all of them may take (default: what is free)
    scheduler : ADDRESS
        use the cluster of this Dask scheduler instead, e.g. tcp://10.0.0.5:8786

    Examples
    --------
    a row per case; several files or methods in a cell with ; between them:
      case,sweeps,config,bone_labels,register,method
      P01,P01/sweep.igs.mha,PlusDeviceSet.xml,P01/lumbar.nrrd,yes,average;weighted

      aifrecon batch cases.csv --output results --dry-run
      aifrecon batch cases.csv --output results

    Columns are as the options of reconstruct, register, coverage and evaluate of the same names. Paths are relative
    to the table; yes or no for options without a value. The same command again computes what is missing or has
    changed.
    """

    table: Path
    output: Path
    dry_run: bool = False
    retry_failed: bool = False
    method: list[str] = []
    workers: Annotated[int, count] | None = None
    memory: Annotated[int, gigabytes] | None = None
    scheduler: str | None = None

    WORDS: ClassVar[Names] = ("table",)
    NOTES: ClassVar[str] = "\n\ncolumns: case and sweeps, and as needed\n" + textwrap.fill(", ".join(Columns().names), 100)


def run(asked: _BatchOptions) -> int:
    """Read the table, check, compute what is missing, write tables and page, and say what happened."""
    if asked.scheduler and (asked.workers or asked.memory):
        raise SettingsError("--workers and --memory are of this computer; a cluster has its own. Leave them out, or --scheduler.")
    for name in asked.method:
        load_method_here(name)
    table = read_cases(asked.table)
    if not table.problems:  # names among them
        require_place(table.cases, asked.table, asked.output.absolute())
    if asked.dry_run:
        return _dry_run(table)
    if table.problems:
        raise FileFormatError(
            f"{asked.table}: {table.problems[0]} {len(table.all_problems)} problem(s) in all: aifrecon batch --dry-run lists them."
        )
    for package in ("jinja2", "pandas", "psutil", "pyarrow"):
        require(package)
    cohort = Cohort(list(table.cases), asked.output.absolute())
    cohort.prepare(asked.retry_failed)
    try:
        if cohort.to_do:
            _compute(cohort, asked)
    except KeyboardInterrupt:
        # What is done by now is worth a look
        with contextlib.suppress(OutputError):
            _write(cohort, asked)
        raise
    code = _tell(cohort)
    for path in _write(cohort, asked):
        print(f"  wrote {path}")
    return code


def _write(cohort: Cohort, asked: _BatchOptions) -> list[Path]:
    table = results_table(cohort.cases, cohort.records)
    write_text(cohort.output / PAGE, page(asked.table.stem, table))
    return [*write_tables(cohort.output, table), cohort.output / PAGE]


def _dry_run(table: Cases) -> int:
    """List what is wrong; the answer is the exit code."""
    for problem in table.all_problems:
        print(problem)
    wrong = len({each.row for each in table.all_problems})
    print(f"{len(table.cases)} cases, " + (f"{wrong} row(s) with problems" if wrong else "nothing wrong"))
    return 2 if wrong else 0


def _compute(cohort: Cohort, asked: _BatchOptions) -> None:
    at = asked.scheduler
    workers = cluster_at(at, cohort.output) if at else local_workers(shared_out(cohort.to_do, asked.workers, asked.memory))
    with ProgressBar() as progress:
        cohort.compute(workers, lambda text: show(sys.stderr, f"{text}\n"), progress)


def _tell(cohort: Cohort) -> int:
    """Say what became of the cases; the answer is the exit code."""
    states = {state: cohort.count(state) for state in (DONE, FAILED, LOST)}
    seconds = sum(record.seconds for record in cohort.records.values())
    already = len(cohort.cases) - len(cohort.to_do) - sum(bool(case.problems) for case in cohort.cases)
    print(f"{states[DONE]} of {len(cohort.cases)} cases done ({already} were before), {duration(seconds)} of computing")
    bad = [record for record in cohort.records.values() if record.state != DONE]
    for record in bad[:MOST_SHOWN]:
        print(f"  {record.case}: {record.state}: {record.message}")
    if len(bad) > MOST_SHOWN:
        print(f"  and {len(bad) - MOST_SHOWN} more, in results.csv")
    doubtful = {record.case: row["notes"] for record in cohort.records.values() for row in record.results if WARNING in str(row["notes"])}
    for case, notes in list(doubtful.items())[:MOST_SHOWN]:
        print(f"  {case}: {notes}")
    return 1 if bad else 0
