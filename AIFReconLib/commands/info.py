"""`aifrecon info`: what a sequence holds, and what keeps it from being reconstructed."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from ..inspection.diagnosis import diagnose
from .console import ProgressBar
from .options import Commands
from .reconstruct import add_tracking_options
from .sequence_options import add_sequence_options, sequence_from


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "info",
        help="say what a sequence holds and what is missing",
        description="Show frames, transforms, rate, pixel spacing and tracking of a sequence, say in words what is missing, and estimate "
        "from a sweep that goes to and fro whether images and poses are out of step.",
    )
    parser.add_argument("sequence", type=Path, metavar="SEQUENCE", help="tracked frames, e.g. sweep.igs.mha")
    parser.add_argument("--json", action="store_true", help="print JSON instead of text")
    add_tracking_options(parser)
    add_sequence_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read and report."""
    with ProgressBar() as progress:
        report = diagnose(sequence_from(arguments), arguments.image_to_reference, arguments.reference, progress)
    print(json.dumps(report.to_dict(), indent=2) if arguments.json else report.to_text())
