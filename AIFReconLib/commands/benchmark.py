"""`aifrecon benchmark`: whether this machine keeps up with a live scan, by each method."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from .. import __version__
from ..io.disk.atomic import write_text
from ..message import columns
from ..recipe.recipe import DEFAULT_SPACING
from ..terminal.console import ProgressBar
from ..terminal.options import Commands, check_files
from ..workflows.benchmark import MeasuredSpeed, answer, busy_warning, machine, measured_speed, verdict


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "benchmark",
        description="Receive and insert made-up images with every method, and say whether this machine keeps up with a live scan of that "
        "size and rate.",
    )
    parser.add_argument(
        "--size", type=int, nargs=2, default=[640, 480], metavar=("COLUMNS", "ROWS"), help="of your images (default: 640 480)"
    )
    parser.add_argument("--rate", type=float, default=30.0, metavar="FPS", help="frames/s of your scan (default: %(default)g)")
    parser.add_argument("--spacing", type=float, default=DEFAULT_SPACING, metavar="MM", help="distance of voxels (default: %(default)s)")
    parser.add_argument("--frames", type=int, default=120, metavar="N", help="frames per repeat (default: %(default)s)")
    parser.add_argument("--repeats", type=int, default=5, metavar="N", help="the median of this many is shown (default: %(default)s)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the numbers here, to compare later")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Measure, print, and answer."""
    check_files(arguments.json)
    with ProgressBar() as progress:
        found = measured_speed(tuple(arguments.size), arguments.rate, arguments.spacing, arguments.frames, arguments.repeats, progress)
    if arguments.json:
        write_text(arguments.json, json.dumps(_report(found, arguments.spacing), indent=2) + "\n")
    size, millions = " x ".join(map(str, found.size)), found.voxels / 1e6
    print(f"{machine()}\nAIFRecon {__version__}; {size} pixels into {millions:.1f} million voxels, with {found.engine}\n")
    rows = [("method", "frames/s", f"at {found.rate:g}/s")]
    rows += [(m, f"{found.rate / share:.0f}", f"{100 * share:.0f}% of the time, {verdict(share)}") for m, share in found.shares.items()]
    print(columns(rows))
    print(f"\n{answer(found.shares, found.size, found.rate)}")
    for text in filter(None, (found.warning, busy_warning(found.busy))):
        print(text)
    if arguments.json:
        print(f"\n  wrote {arguments.json}")


def _report(found: MeasuredSpeed, spacing: float) -> dict[str, object]:
    """The numbers, for JSON."""
    methods = {
        method: {"seconds_per_frame": seconds, "frames_per_second": 1 / seconds, "live": verdict(seconds * found.rate)}
        for method, seconds in found.seconds.items()
    }
    return {
        "machine": machine(),
        "version": __version__,
        "size": found.size,
        "rate": found.rate,
        "spacing_mm": spacing,
        "voxels": found.voxels,
        "engine": found.engine,
        "busy": found.busy,
        "methods": methods,
    }
