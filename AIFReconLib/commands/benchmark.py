"""`aifrecon benchmark`: how fast this machine reconstructs."""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path

from ..benchmark import VOXELS, benchmark
from ..errors import SettingsError
from ..io.disk.atomic import check_writable, write_text
from ..message import columns
from .console import ProgressBar
from .options import Commands


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "benchmark",
        help="measure how fast this machine reconstructs",
        description="Time every method on 640 x 480 frames of 0.2 mm pixels, and say whether that keeps up with 30 frames/s live.",
    )
    parser.add_argument("--frames", type=int, default=120, metavar="N", help="frames per repeat (default: %(default)s)")
    parser.add_argument("--repeats", type=int, default=5, metavar="N", help="the median of this many is shown (default: %(default)s)")
    parser.add_argument("--spacing", type=float, nargs="+", default=[0.5, 0.3], metavar="MM", help="voxel sizes to time (default: 0.5 0.3)")
    parser.add_argument("--quick", action="store_true", help="only reconstruction, at the first voxel size, with a third of the frames")
    parser.add_argument(
        "--data", type=Path, metavar="DIR", help="also time the real recordings in this folder (default: AIFRECON_DATA_DIR, if set)"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the numbers here, to compare later")
    parser.add_argument("--markdown", type=Path, metavar="FILE", help="also write the table here, for a document")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Measure and print."""
    frames, spacings = arguments.frames, tuple(arguments.spacing)
    if frames < 2 or arguments.repeats < 1 or min(spacings) <= 0:
        raise SettingsError("A benchmark takes at least 2 frames, 1 repeat and positive voxel sizes.")
    if arguments.quick:
        frames, spacings = max(frames // 3, 2), spacings[:1]
    if arguments.data is not None and not arguments.data.is_dir():
        raise SettingsError("Input --data must be a folder; got {folder!r}.", folder=str(arguments.data))
    for path in (arguments.json, arguments.markdown):
        if path:
            check_writable(path)
    data = arguments.data or (Path(os.environ["AIFRECON_DATA_DIR"]) if os.environ.get("AIFRECON_DATA_DIR") else None)
    with ProgressBar() as progress:
        result = benchmark(
            frames,
            arguments.repeats,
            spacings,
            voxels=0 if arguments.quick else VOXELS,
            data=None if arguments.quick else data,
            progress=progress,
        )
    files = {arguments.json: json.dumps(result.to_dict(), indent=2) + "\n", arguments.markdown: result.markdown()}
    for path, text in files.items():
        if path:
            write_text(path, text)
    print(f"{result.heading()}\n")
    print(columns(result.rows()))
    for path in filter(None, files):
        print(f"\n  wrote {path}")
