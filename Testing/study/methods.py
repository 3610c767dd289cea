"""Does AIF-recon do what it promises, on many simulated patients, and where does it not? Every method, with right and wrong CTs and poses.

    python Testing/study methods --output study-output

writes study.md and study.png. About six minutes per patient and core; an interrupted study goes on where it stopped.
"""

from __future__ import annotations

import argparse
import sys
from functools import partial
from pathlib import Path

from AIFReconLib.errors import AIFReconError
from AIFReconLib.evaluation.figures import require_matplotlib
from AIFReconLib.io.disk.atomic import write_text
from AIFReconLib.terminal.console import ProgressBar
from AIFReconLib.terminal.options import load_method_here

from .method_cases import Row, patient_rows
from .method_figure import study_figure
from .method_page import study_page
from .patients import run_study


def main(words: list[str]) -> int:
    """Run what is missing, then write the page and the picture; the answer is the exit status."""
    parser = argparse.ArgumentParser(prog="python Testing/study methods", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, metavar="DIR", help="folder to keep the results in; made if it is not there")
    parser.add_argument("--patients", type=int, default=10, metavar="N", help="how many (default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="patients at a time (default: %(default)s)")
    parser.add_argument(
        "--method",
        action="append",
        default=[],
        metavar="MODULE:FUNCTION",
        help="also measure this method of your own; in a folder of its own",
    )
    arguments = parser.parse_args(words)
    if arguments.patients < 1 or arguments.jobs < 1:
        parser.error("a study takes at least 1 patient and 1 job")
    page, figure = arguments.output / "study.md", arguments.output / "study.png"
    try:
        require_matplotlib()
        for name in arguments.method:
            load_method_here(name)
        arguments.output.mkdir(parents=True, exist_ok=True)
        with ProgressBar() as progress:
            rows = run_study(
                partial(patient_rows, own=tuple(arguments.method)),
                Row,
                arguments.output,
                range(arguments.patients),
                arguments.jobs,
                progress,
            )
        write_text(page, study_page(rows))
        study_figure(figure, rows)
    except (AIFReconError, OSError) as error:
        print(f"study: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("study: interrupted; the same command goes on where it stopped", file=sys.stderr)
        return 130
    print(f"{len(rows)} reconstructions of {arguments.patients} simulated patients\n  wrote {page}\n  wrote {figure}")
    return 0
