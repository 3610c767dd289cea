"""`aifrecon simulate`: a lumbar phantom with its CT and a tracked sweep, as files."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..simulation.scan import TrackingErrors
from ..simulation.ultrasound import UltrasoundEffects
from ..terminal.console import ProgressBar
from ..terminal.options import Commands, refuse_to_overwrite
from ..workflows.simulate import FILES, PATHS, planned_path, write_simulated_patient


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "simulate",
        description="Write a simulated patient: CT and segmentation, their registration, and a tracked ultrasound sweep with its "
        "configuration. The same seed gives the same patient.",
    )
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="folder to write into; made if it is not there")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="which patient (default: 0)")
    parser.add_argument("--path", choices=tuple(PATHS), default="multi-angle", help="how the probe moves (default: multi-angle)")
    parser.add_argument("--frames", type=int, default=144, metavar="N", help="frames of the sweep (default: %(default)s)")
    parser.add_argument("--plan", type=Path, metavar="PLAN.json", help="scan by this plan of aifrecon plan instead, with all its frames")
    parser.add_argument("--gain", type=float, default=0.0, metavar="DB", help="turn the scanner's gain up by this")
    parser.add_argument("--depth-gain", type=float, default=0.0, metavar="DB", help="the same, little by little down to the last row")
    parser.add_argument("--gray-curve", type=float, default=1.0, metavar="POWER", help="power of the gray scale; above 1 is darker")
    parser.add_argument("--breathing", type=float, default=0.0, metavar="MM", help="the patient breathes, so far to either side")
    parser.add_argument("--shifting", type=float, default=0.0, metavar="MM", help="the patient lies elsewhere in each pass, by about this")
    parser.add_argument("--step", type=float, default=0.0, metavar="MM", help="the patient moves once, in mid-scan, by this")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Simulate and write."""
    planned = None
    if arguments.plan:
        refuse_to_overwrite(arguments, "output", more=[arguments.output / name for name in FILES])
        planned = planned_path(arguments.plan)
    name, frames = ("planned", len(planned)) if planned else (arguments.path, arguments.frames)
    effects = UltrasoundEffects(gain_db=arguments.gain, depth_gain_db=arguments.depth_gain, gray_curve=arguments.gray_curve)
    errors = TrackingErrors(breathing=arguments.breathing, shifting=arguments.shifting, step=arguments.step)
    with ProgressBar() as progress:
        path = planned or arguments.path
        files = write_simulated_patient(arguments.output, arguments.seed, path, arguments.frames, progress, effects, errors)
    print(f"simulated patient {arguments.seed}, {name} sweep of {frames} frames")
    for path in (files.sequence, files.configuration, files.ct, files.labels, files.ct_to_reference):
        print(f"  wrote {path}")
