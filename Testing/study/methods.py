"""Does AIF-recon do what it promises, on many simulated patients, and where does it not? Every method, with right and wrong CTs and poses.

    python Testing/study methods --output study-output

writes study.md and study.png. About ten minutes per patient and core; an interrupted study goes on where it stopped.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from measured import keep

from AIFReconLib.evaluation.figures import require_matplotlib
from AIFReconLib.io.disk.atomic import write_text
from AIFReconLib.terminal.recipe_options import load_method_here

from .command import carry_out, parsed, study_parser
from .method_cases import Row, patient_rows
from .method_figure import study_figure
from .method_page import in_the_pages, study_page


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

    def prepare() -> None:
        require_matplotlib()
        for name in arguments.method:
            load_method_here(name)

    def write(rows: list[Row]) -> list[Path]:
        page, figure = arguments.output / "study.md", arguments.output / "study.png"
        write_text(page, study_page(rows))
        study_figure(figure, rows)
        return [page, figure, *(keep(in_the_pages(rows), "make study") if arguments.pages else ())]

    return carry_out(arguments, partial(patient_rows, own=tuple(arguments.method)), Row, write, "reconstructions", prepare)
