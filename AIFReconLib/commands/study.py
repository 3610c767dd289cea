"""`aifrecon study`: the study behind the defaults, as one command."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..errors import OutputError, SettingsError
from ..evaluation.figures import require_matplotlib
from ..evaluation.study import run_study
from ..evaluation.study_figure import study_figure
from ..evaluation.study_page import study_page
from ..io.disk.atomic import write_text
from .console import ProgressBar
from .options import Commands


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "study",
        help="compare all methods on many simulated patients (takes long)",
        description="Simulate patients and scans, with right and wrong CTs and poses, reconstruct with every method, and write the "
        "medians as a page. About six minutes per patient and core; an interrupted study goes on where it stopped.",
    )
    parser.add_argument("--output", type=Path, required=True, metavar="DIR", help="folder to keep the results in; made if it is not there")
    parser.add_argument("--patients", type=int, default=10, metavar="N", help="how many (default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="patients at a time (default: %(default)s)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Run what is missing, then write the page and the picture."""
    require_matplotlib()
    if arguments.patients < 1 or arguments.jobs < 1:
        raise SettingsError("A study takes at least 1 patient and 1 job.")
    try:
        arguments.output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(
            "{output}: cannot be made ({reason}). Choose another folder.", output=arguments.output, reason=error.strerror
        ) from None
    with ProgressBar() as progress:
        rows = run_study(arguments.output, range(arguments.patients), arguments.jobs, progress)
    page, figure = arguments.output / "study.md", arguments.output / "study.png"
    write_text(page, study_page(rows))
    study_figure(figure, rows)
    print(f"{len(rows)} reconstructions of {arguments.patients} simulated patients\n  wrote {page}\n  wrote {figure}")
