"""Does AIF-recon do what it promises, on patients of two kinds, and where does it not? Every method, with right and wrong CTs and poses.

    python Testing/study methods --output study-output

writes study.md and study.png. Some three minutes per patient and core; an interrupted study goes on where it stopped. The patients of real
shape need shared/data/lumbar-shape.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial

from AIFReconLib.terminal.arguments import load_method_here

from .command import Study
from .method_cases import KINDS, Row, patient_rows
from .method_figure import study_figure
from .method_page import in_the_pages, study_page
from .patients import data_folder


def options(parser: argparse.ArgumentParser) -> None:
    """Methods of one's own."""
    told = "also measure this method of your own; in a folder of its own"
    parser.add_argument("--method", action="append", default=[], metavar="MODULE:FUNCTION", help=told)


def tasks(arguments: argparse.Namespace) -> tuple[Callable[[tuple[str, int]], list[Row]], dict[str, tuple[str, int]]]:
    """Patients of both kinds."""
    for name in arguments.method:
        load_method_here(name)
    data_folder("lumbar-shape")
    given = {f"{kind.replace(' ', '-')}-{seed:03d}": (kind, seed) for seed in range(arguments.patients) for kind in KINDS}
    return partial(patient_rows, own=tuple(arguments.method)), given


STUDY = Study(
    patient_rows,
    Row,
    "reconstructions",
    lambda rows: {"study": study_page(rows)},
    in_the_pages,
    {"study.png": study_figure},
    options=options,
    tasks=tasks,
)
