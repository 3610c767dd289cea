"""`aifrecon simulate`: a lumbar phantom with its CT and a tracked sweep, as files."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..arrays import Floats
from ..errors import OutputError, SettingsError
from ..io.disk.atomic import write_text
from ..io.sequence.writer import write_sequence
from ..io.transform.files import write_transform
from ..progress import Progress, part
from ..simulation.anatomy import LumbarAnatomy, make_lumbar_phantom
from ..simulation.phased_array import PhasedArray
from ..simulation.scan import (
    ProbePath,
    ScannedBack,
    freehand_sweep,
    multi_angle_sweep,
    plus_configuration_xml,
    random_rigid,
    simulate_sweep,
    single_angle_sweep,
)
from ..terminal.console import ProgressBar
from ..terminal.options import Commands

PATHS: dict[str, Callable[[ScannedBack, int], ProbePath]] = {
    "multi-angle": multi_angle_sweep,
    "single-angle": single_angle_sweep,
    "freehand": freehand_sweep,
}


@dataclass(frozen=True)
class SimulatedFiles:
    """Where the files of a simulated patient are, and where to look in them."""

    sequence: Path
    configuration: Path
    ct: Path
    labels: Path
    ct_to_reference: Path
    center_ras: Floats
    """A place worth looking at: the root of the middle spinous process, (3,) mm in Reference."""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "simulate",
        help="make a simulated lumbar spine, its CT and a tracked sweep",
        description="Write a simulated patient: CT and segmentation, their registration, and a tracked ultrasound sweep with its "
        "configuration. The same seed gives the same patient.",
    )
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="folder to write into; made if it is not there")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="which patient (default: 0)")
    parser.add_argument("--path", choices=tuple(PATHS), default="multi-angle", help="how the probe moves (default: multi-angle)")
    parser.add_argument("--frames", type=int, default=144, metavar="N", help="frames of the sweep (default: %(default)s)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Simulate and write."""
    with ProgressBar() as progress:
        files = write_simulated_patient(arguments.output, arguments.seed, arguments.path, arguments.frames, progress)
    print(f"simulated patient {arguments.seed}, {arguments.path} sweep of {arguments.frames} frames")
    for path in (files.sequence, files.configuration, files.ct, files.labels, files.ct_to_reference):
        print(f"  wrote {path}")


def write_simulated_patient(
    folder: Path, seed: int = 0, path: str = "multi-angle", frames: int = 144, progress: Progress | None = None
) -> SimulatedFiles:
    """Simulate a patient and a sweep, and write them as a user would have them.

    Parameters
    ----------
    folder : Path
    seed : int
    path : "multi-angle", "single-angle" or "freehand"
    frames : int
    progress : Progress or None

    Notes
    -----
    The CT lies in a frame of its own, turned and shifted against Reference, and its registration is written beside it as Slicer
    would save it.
    """
    if frames < 2 or seed < 0:
        raise SettingsError("A simulation takes at least 2 frames and a seed of 0 or more.")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError("{folder}: cannot be made ({reason}). Choose another folder.", folder=folder, reason=error.strerror) from None
    files = SimulatedFiles(
        folder / "sweep.igs.mha",
        folder / "PlusDeviceSet.xml",
        folder / "ct.nrrd",
        folder / "lumbar-segmentation.nrrd",
        folder / "CTToReference.tfm",
        np.zeros(3),
    )
    ct_to_reference = random_rigid(25.0, 8.0, np.random.default_rng([seed, 7]))
    phantom = make_lumbar_phantom(LumbarAnatomy.from_seed(seed), ct_to_reference=ct_to_reference, progress=part(progress, 0.0, 0.2))
    trajectory = PATHS[path](phantom, frames)
    phantom.ct.write(files.ct)
    phantom.labels.write(files.labels)
    write_transform(phantom.ct_to_reference, files.ct_to_reference)
    probe = PhasedArray()
    write_text(files.configuration, plus_configuration_xml(probe))
    sweep = simulate_sweep(phantom, probe, trajectory, seed=seed, progress=part(progress, 0.25, 0.9))
    write_sequence(sweep, files.sequence, progress=part(progress, 0.9, 1.0))
    junctions = phantom.spinolaminar_junctions()
    return SimulatedFiles(
        files.sequence, files.configuration, files.ct, files.labels, files.ct_to_reference, junctions[len(junctions) // 2]
    )
