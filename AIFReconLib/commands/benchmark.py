"""`aifrecon benchmark`: how fast this machine reconstructs."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from ..benchmark import benchmark
from ..console import ProgressBar, columns
from ..errors import SettingsError
from ..io.atomic import check_writable, write_text


def add_to(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "benchmark",
        help="measure how fast this machine reconstructs",
        description="Time every method on 640 x 480 frames of 0.2 mm pixels, and say whether that keeps up with 30 frames/s live.",
    )
    parser.add_argument("--frames", type=int, default=40, metavar="N", help="frames per repeat (default: %(default)s)")
    parser.add_argument("--repeats", type=int, default=5, metavar="N", help="the median of this many is shown (default: %(default)s)")
    parser.add_argument("--spacing", type=float, nargs="+", default=[0.5], metavar="MM", help="voxel sizes to time (default: 0.5)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the numbers here, to compare later")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Measure and print."""
    if arguments.frames < 2 or arguments.repeats < 1 or min(arguments.spacing) <= 0:
        raise SettingsError("A benchmark takes at least 2 frames, 1 repeat and positive voxel sizes.")
    if arguments.json:
        check_writable(arguments.json)
    with ProgressBar() as progress:
        result = benchmark(arguments.frames, arguments.repeats, tuple(arguments.spacing), progress)
    print(f"{result.machine}\n{result.frames} frames of 640 x 480, 0.2 mm pixels, 30 degree fan; medians of {result.repeats}\n")
    print(columns(result.rows()))
    if arguments.json:
        write_text(arguments.json, json.dumps(result.to_dict(), indent=2) + "\n")
        print(f"\n  wrote {arguments.json}")
