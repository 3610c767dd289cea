"""`aifrecon simulate`: a lumbar phantom with its CT and a tracked sweep, as files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from ..simulation.scan import TrackingErrors
from ..simulation.ultrasound import UltrasoundEffects
from ..terminal.arguments import Options
from ..terminal.console import ProgressBar
from ..terminal.outputs import check_outputs
from ..workflows.simulate import FILES, PATHS, planned_path, write_simulated_patient


class _SimulateOptions(Options):
    """Write a simulated patient: CT and segmentation, their registration, and a tracked ultrasound sweep with its configuration. The same
    seed gives the same patient.

    Parameters
    ----------
    output : DIR
        folder to write into; made if it is not there
    seed : N
        which patient
    path
        how the probe moves
    frames : N
        frames of the sweep
    plan : PLAN.json
        scan by this plan of aifrecon plan instead, with all its frames
    gain : DB
        turn the scanner's gain up by this
    depth_gain : DB
        the same, little by little down to the last row
    gray_curve : POWER
        power of the gray scale; above 1 is darker
    breathing : MM
        the patient breathes, so far to either side
    shifting : MM
        the patient lies elsewhere in each pass, by about this
    step : MM
        the patient moves once, in mid-scan, by this
    """

    output: Path
    seed: int = 0
    path: Annotated[str, tuple(PATHS)] = "multi-angle"
    frames: int = 144
    plan: Path | None = None
    gain: float = 0.0
    depth_gain: float = 0.0
    gray_curve: float = 1.0
    breathing: float = 0.0
    shifting: float = 0.0
    step: float = 0.0


def run(asked: _SimulateOptions) -> None:
    """Simulate and write."""
    planned = None
    if asked.plan:
        check_outputs(asked, more=[asked.output / name for name in FILES])
        planned = planned_path(asked.plan)
    name, frames = ("planned", len(planned)) if planned else (asked.path, asked.frames)
    effects = UltrasoundEffects(gain_db=asked.gain, depth_gain_db=asked.depth_gain, gray_curve=asked.gray_curve)
    errors = TrackingErrors(breathing=asked.breathing, shifting=asked.shifting, step=asked.step)
    with ProgressBar() as progress:
        path = planned or asked.path
        files = write_simulated_patient(asked.output, asked.seed, path, asked.frames, progress, effects, errors)
    print(f"simulated patient {asked.seed}, {name} sweep of {frames} frames")
    for file in (files.sequence, files.configuration, files.ct, files.labels, files.ct_to_reference):
        print(f"  wrote {file}")
