"""What all studies of simulated patients are, and the command that runs one and goes on where an interrupted one stopped."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from measured import REPOSITORY, keep

from AIFReconLib.errors import AIFReconError
from AIFReconLib.evaluation.figures import require_matplotlib
from AIFReconLib.io.disk.atomic import write_text
from AIFReconLib.terminal.console import ProgressBar

from .patients import run_tasks

Texts = Callable[[list[Any]], dict[str, str]]
"""From all rows to pages, by their names without suffix."""


@dataclass(frozen=True)
class Study:
    """A study: `work` makes the `row`s of a patient from its seed, in another process, so that it is a function of a module.

    `counted` is what a row is one of. `texts` are the pages of the output folder; `shown` those of docs/measured, where they are others.
    `pictures` are drawn by name: from a path and all rows. `options` adds to the parser; `tasks` gives work and what it is called with, by
    the names of the files that keep the rows, where that is not the seeds of the patients.
    """

    work: Callable[..., list[Any]]
    row: type
    counted: str
    texts: Texts
    shown: Texts | None = None
    pictures: Mapping[str, Callable[[Path, list[Any]], object]] = field(default_factory=dict)
    patients: int = 10
    options: Callable[[argparse.ArgumentParser], object] | None = None
    tasks: Callable[[argparse.Namespace], tuple[Callable[[Any], list[Any]], dict[str, Any]]] | None = None

    def run(self, name: str, page: str | None, words: list[str]) -> int:
        """Run what is missing, then write pages and pictures; the answer is the exit status. `page` is the study's docstring."""
        parser = study_parser(name, page)
        parser.add_argument("--patients", type=int, default=self.patients, metavar="N", help="how many (default: %(default)s)")
        if self.options:
            self.options(parser)
        arguments = parser.parse_args(words)
        if arguments.pages and arguments.patients < self.patients:
            parser.error("the pages are of whole studies: leave out --patients or --pages")
        return reported(lambda: self._work_through(arguments))

    def _work_through(self, arguments: argparse.Namespace) -> list[str]:
        if self.pictures:
            require_matplotlib()
        given = {f"patient-{seed:03d}": seed for seed in range(arguments.patients)}
        work, given = self.tasks(arguments) if self.tasks else (self.work, given)
        output = arguments.output
        output.mkdir(parents=True, exist_ok=True)
        with ProgressBar() as progress:
            rows = run_tasks(work, given, self.row, output, arguments.jobs, progress, "patients")
        texts = self.texts(rows)
        written = kept_in(output, texts)
        for folder in (output, *([REPOSITORY / "docs" / "images"] if arguments.pages else [])):
            for title, draw in self.pictures.items():
                written.append(folder / title)
                draw(written[-1], rows)
        if arguments.pages:
            written += keep(self.shown(rows) if self.shown else texts, "make study")
        return [f"{len(rows)} {self.counted} of {len(given)} simulated patients", *map(str, written)]


def kept_in(folder: Path, texts: dict[str, str]) -> list[Path]:
    """Write pages; the answer is their files."""
    files = [folder / f"{title}.md" for title in texts]
    for file, text in zip(files, texts.values(), strict=True):
        write_text(file, text)
    return files


def study_parser(name: str, page: str | None) -> argparse.ArgumentParser:
    """The parser of a study's command; the first line of its `page` says what it asks."""
    parser = argparse.ArgumentParser(prog=f"python Testing/study {name}", description=(page or "").splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, metavar="DIR", help="folder to keep the results in; made if it is not there")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="tasks at a time (default: %(default)s)")
    parser.add_argument("--pages", action="store_true", help="also renew docs/measured, and the pages that show it")
    return parser


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
