"""Does AIF-recon do what it promises, on patients of two kinds, and where does it not? Every method, with right and wrong CTs and poses.

    python Testing/study methods --output study-output

writes study.md and study.png. Some three minutes per patient and core; an interrupted study goes on where it stopped. The patients of real
shape need shared/data/lumbar-shape.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from measured import keep

from AIFReconLib.evaluation.figures import require_matplotlib
from AIFReconLib.io.disk.atomic import write_text
from AIFReconLib.terminal.arguments import load_method_here
from AIFReconLib.terminal.console import ProgressBar

from .command import parsed, reported, study_parser
from .lumbar_shapes import shapes_folder
from .method_cases import KINDS, Row, patient_rows
from .method_figure import study_figure
from .method_page import in_the_pages, study_page
from .patients import run_tasks


def main(words: list[str]) -> int:
    """Run what is missing, then write the page and the picture; the answer is the exit status."""
    parser = study_parser("methods", __doc__)
    parser.add_argument(
        "--method",
        action="append",
        default=[],
        metavar="MODULE:FUNCTION",
        help="also measure this method of your own; in a folder of its own",
    )
    arguments = parsed(parser, words)

    def work_through() -> list[str]:
        require_matplotlib()
        for name in arguments.method:
            load_method_here(name)
        shapes_folder()
        arguments.output.mkdir(parents=True, exist_ok=True)
        given = {f"{kind.replace(' ', '-')}-{seed:03d}": (kind, seed) for seed in range(arguments.patients) for kind in KINDS}
        with ProgressBar() as progress:
            work = partial(patient_rows, own=tuple(arguments.method))
            rows = run_tasks(work, given, Row, arguments.output, arguments.jobs, progress, "patients")
        return [f"{len(rows)} reconstructions of {len(given)} patients", *map(str, write(rows))]

    def write(rows: list[Row]) -> list[Path]:
        page, figure = arguments.output / "study.md", arguments.output / "study.png"
        write_text(page, study_page(rows))
        study_figure(figure, rows)
        return [page, figure, *(keep(in_the_pages(rows), "make study") if arguments.pages else ())]

    return reported(work_through)
