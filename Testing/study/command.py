"""What the commands of all studies share: their options, and going on where an interrupted one stopped."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from measured import keep

from AIFReconLib.errors import AIFReconError
from AIFReconLib.io.disk.atomic import write_text
from AIFReconLib.terminal.console import ProgressBar

from .patients import Row, run_study


def study_parser(name: str, page: str | None) -> argparse.ArgumentParser:
    """The parser of a study's command; the first line of its `page`, the file's docstring, says what it asks."""
    parser = argparse.ArgumentParser(prog=f"python Testing/study {name}", description=(page or "").splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, metavar="DIR", help="folder to keep the results in; made if it is not there")
    parser.add_argument("--patients", type=int, default=10, metavar="N", help="how many (default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="patients at a time (default: %(default)s)")
    parser.add_argument("--pages", action="store_true", help="also renew docs/measured, and the pages that show it")
    return parser


def parsed(parser: argparse.ArgumentParser, words: list[str]) -> argparse.Namespace:
    """The arguments, which make sense."""
    arguments = parser.parse_args(words)
    if arguments.patients < 1 or arguments.jobs < 1:
        parser.error("a study takes at least 1 patient and 1 job")
    if arguments.pages and arguments.patients < parser.get_default("patients"):
        parser.error("the pages are of whole studies: leave out --patients or --pages")
    return arguments


def carry_out(
    arguments: argparse.Namespace,
    work: Callable[[int], list[Row]],
    row: type[Row],
    write: Callable[[list[Row]], list[Path]],
    counted: str,
) -> int:
    """Run what is missing, then write the results; the answer is the exit status.

    Parameters
    ----------
    arguments : Namespace
        Of `parsed`.
    work, row
        As `run_study` takes them.
    write : callable
        Writes the results from all rows; returns the files.
    counted : str
        What a row is one of: ``registrations``.
    """

    def work_through() -> list[str]:
        arguments.output.mkdir(parents=True, exist_ok=True)
        with ProgressBar() as progress:
            rows = run_study(work, row, arguments.output, range(arguments.patients), arguments.jobs, progress)
        return [f"{len(rows)} {counted} of {arguments.patients} simulated patients", *map(str, write(rows))]

    return reported(work_through)


def reported(work_through: Callable[[], list[str]]) -> int:
    """Work, and print what was done and the files that it wrote, or in one line why not; the answer is the exit status."""
    try:
        done = work_through()
    except (AIFReconError, OSError) as error:
        print(f"study: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("study: interrupted; the same command goes on where it stopped", file=sys.stderr)
        return 130
    print("\n  wrote ".join(done))
    return 0


def page_writer(
    arguments: argparse.Namespace, name: str, text: Callable[[list[Row]], str], shown: Callable[[list[Row]], list[Row]] = list
) -> Callable[[list[Row]], list[Path]]:
    """For `carry_out`: writes one page of text, ``name.md``; where `--pages` is given also that of docs/measured, of the rows `shown`."""

    def write(rows: list[Row]) -> list[Path]:
        page = arguments.output / f"{name}.md"
        write_text(page, text(rows))
        return [page, *(keep({name: text(shown(rows))}, "make study") if arguments.pages else ())]

    return write
