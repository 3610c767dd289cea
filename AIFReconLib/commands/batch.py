"""`aifrecon batch`: a table of cases becomes volumes, metrics and one page, overnight."""

from __future__ import annotations

import argparse
import contextlib
import sys
import textwrap
from pathlib import Path

from ..batch.cohort import Cohort, duration
from ..batch.columns import Columns
from ..batch.engine import cluster_at, local_workers, require
from ..batch.memory import shared_out
from ..batch.page import PAGE, page
from ..batch.place import require_place
from ..batch.records import DONE, FAILED, LOST
from ..batch.results import results_table, write_tables
from ..batch.table import Cases, read_cases
from ..errors import FileFormatError, OutputError, SettingsError
from ..io.disk.atomic import write_text
from ..terminal.console import ProgressBar, show
from ..terminal.options import Commands
from ..terminal.recipe_options import load_method_here
from ..terminal.reconstruction_options import gigabytes

EXAMPLE = """example, a row per case; several files or methods in a cell with ; between them:
  case,sweeps,config,bone_labels,register,method
  P01,P01/sweep.igs.mha,PlusDeviceSet.xml,P01/lumbar.nrrd,yes,average;weighted

  aifrecon batch cases.csv --output results --dry-run
  aifrecon batch cases.csv --output results

columns: case and sweeps, and as needed
{columns}
as the options of reconstruct, register, coverage and evaluate of the same names. Paths are relative to the table; yes or no for options
without a value. The same command again computes what is missing or has changed."""

MOST_SHOWN = 20
"""Cases that are not done, with their reasons, on the terminal."""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    names = textwrap.fill(", ".join(Columns().names[2:]), 110, initial_indent="  ", subsequent_indent="  ")
    parser = commands.add_parser(
        "batch",
        description="Compute every case of a table on this computer's cores or on a Dask cluster: volumes, registration, coverage, metrics "
        "and previews in a folder each, and results.csv, results.parquet and index.html of all.",
        examples=EXAMPLE.format(columns=names),
    )
    parser.add_argument("table", type=Path, metavar="CASES.csv", help="a row per case")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="folder of all results; made if it is not there")
    parser.add_argument("--dry-run", action="store_true", help="only check every row, and list all that is wrong")
    parser.add_argument("--retry-failed", action="store_true", help="also compute again what failed and has not changed since")
    parser.add_argument(
        "--method",
        action="append",
        default=[],
        metavar="MODULE:FUNCTION",
        help="a method of your own that the table names; may be repeated",
    )
    where = parser.add_argument_group("where", "by default as many processes on this computer as cores and memory allow")
    where.add_argument("--workers", type=int, metavar="N", help="processes")
    where.add_argument("--memory", type=gigabytes, metavar="GB", help="that all of them may take (default: what is free)")
    where.add_argument("--scheduler", metavar="ADDRESS", help="use the cluster of this Dask scheduler instead, e.g. tcp://10.0.0.5:8786")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Read the table, check, compute what is missing, write tables and page, and say what happened."""
    _check(arguments)
    for name in arguments.method:
        load_method_here(name)
    table = read_cases(arguments.table)
    if not table.problems:  # names among them
        require_place(table.cases, arguments.table, arguments.output.absolute())
    if arguments.dry_run:
        return _dry_run(table)
    if table.problems:
        raise FileFormatError(
            f"{arguments.table}: {table.problems[0]} {len(table.all_problems)} problem(s) in all: aifrecon batch --dry-run lists them."
        )
    for package in ("jinja2", "pandas", "psutil", "pyarrow"):
        require(package)
    cohort = Cohort(list(table.cases), arguments.output.absolute())
    cohort.prepare(arguments.retry_failed)
    try:
        if cohort.to_do:
            _compute(cohort, arguments)
    except KeyboardInterrupt:
        # What is done by now is worth a look
        with contextlib.suppress(OutputError):
            _write(cohort, arguments)
        raise
    code = _tell(cohort)
    for path in _write(cohort, arguments):
        print(f"  wrote {path}")
    return code


def _write(cohort: Cohort, arguments: argparse.Namespace) -> list[Path]:
    table = results_table(cohort.cases, cohort.records)
    write_text(cohort.output / PAGE, page(arguments.table.stem, table))
    return [*write_tables(cohort.output, table), cohort.output / PAGE]


def _check(arguments: argparse.Namespace) -> None:
    if arguments.workers is not None and arguments.workers < 1:
        raise SettingsError(f"Input --workers must be at least 1; got {arguments.workers}.")
    if arguments.scheduler and (arguments.workers or arguments.memory):
        raise SettingsError("--workers and --memory are of this computer; a cluster has its own. Leave them out, or --scheduler.")


def _dry_run(table: Cases) -> int:
    """List what is wrong; the answer is the exit code."""
    for problem in table.all_problems:
        print(problem)
    wrong = len({each.row for each in table.all_problems})
    print(f"{len(table.cases)} cases, " + (f"{wrong} row(s) with problems" if wrong else "nothing wrong"))
    return 2 if wrong else 0


def _compute(cohort: Cohort, arguments: argparse.Namespace) -> None:
    def say(text: str) -> None:
        if not arguments.quiet:
            show(sys.stderr, f"{text}\n")

    if arguments.scheduler:
        workers = cluster_at(arguments.scheduler, cohort.output)
    else:
        workers = local_workers(shared_out(cohort.to_do, arguments.workers, arguments.memory))
    with ProgressBar() as progress:
        cohort.compute(workers, say, progress)


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
    return 1 if bad else 0
