"""`aifrecon info`: what a sequence holds, and what keeps it from being reconstructed."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..diagnosis import diagnose
from ..io.sequence_files import read_sequence
from .reconstruct import add_tracking_options


def add_to(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "info",
        help="say what a sequence holds and what is missing",
        description="Show frames, transforms, rate and pixel spacing of a tracked sequence, and say in words what is missing.",
    )
    parser.add_argument("sequence", type=Path, metavar="SEQUENCE", help="tracked frames, e.g. sweep.igs.mha")
    add_tracking_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read and report."""
    sequence = read_sequence(arguments.sequence, config=arguments.config)
    print(diagnose(sequence, arguments.image_to_reference, arguments.reference).to_text())
