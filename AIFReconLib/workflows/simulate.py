"""A simulated patient: CT, segmentation, registration and a tracked sweep, in memory or as the files that a user would have."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..arrays import Floats, Matrix
from ..errors import AIFReconError, FileFormatError, OutputError, SettingsError
from ..geometry.transforms import invert, pixel_spacing
from ..guidance.plan import passes_of
from ..io.disk.atomic import output_errors, write_text
from ..io.disk.tables import read_table
from ..io.sequence.writer import write_sequence
from ..io.transform.files import write_transform
from ..progress import Progress, part
from ..simulation.anatomy import LumbarAnatomy, LumbarPhantom, make_lumbar_phantom
from ..simulation.phased_array import PhasedArray
from ..simulation.scan import (
    FRAME_RATE,
    ProbePath,
    ScannedBack,
    TrackingErrors,
    freehand_sweep,
    multi_angle_sweep,
    plus_configuration_xml,
    random_rigid,
    simulate_sweep,
    single_angle_sweep,
)
from ..simulation.ultrasound import UltrasoundEffects
from ..sweep.frames import TrackedSequence

PATHS: dict[str, Callable[[ScannedBack, int], ProbePath]] = {
    "multi-angle": multi_angle_sweep,
    "single-angle": single_angle_sweep,
    "freehand": freehand_sweep,
}


FILES = ("sweep.igs.mha", "PlusDeviceSet.xml", "ct.nrrd", "lumbar-segmentation.nrrd", "CTToReference.tfm")

BETWEEN_PASSES = 2.0
"""s in which the probe is taken to the next pass of a plan."""


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


def planned_path(path: Path) -> ProbePath:
    """The way of the simulated probe through all passes of a plan file, two seconds between passes.

    Raises FileFormatError when the file is no plan, or one for another probe.
    """
    table = read_table(path, FileFormatError)
    try:
        passes = passes_of(table)
    except (ValueError, AIFReconError) as error:
        raise FileFormatError(f"{path}: it is no plan ({error}). Make one with aifrecon plan.") from None
    probe = PhasedArray()
    poses: Matrix = np.concatenate([image_to_reference for _, image_to_reference in passes])
    spacing = pixel_spacing(poses[0])
    if not np.allclose(spacing, probe.pixel_spacing, rtol=0.01):
        raise FileFormatError(
            f"{path}: it is for images of {spacing[0]:.3f} x {spacing[1]:.3f} mm per pixel, and the simulated probe's have "
            f"{probe.pixel_spacing:.3f}.",
            "Plan without {probe_like}, or with a simulated sweep.",
        )
    to_transducer = poses @ invert(probe.image_to_transducer)
    number = np.concatenate([np.full(len(image_to_reference), n) for n, (_, image_to_reference) in enumerate(passes)])
    return ProbePath(to_transducer, np.arange(len(poses)) / FRAME_RATE + BETWEEN_PASSES * number)


def simulated(
    seed: int,
    path: str | ProbePath | Callable[[LumbarPhantom, int], ProbePath] = "multi-angle",
    frames: int = 144,
    *,
    anatomy: LumbarAnatomy | None = None,
    spacing: float = 1.0,
    effects: UltrasoundEffects | None = None,
    errors: TrackingErrors | None = None,
    progress: Progress | None = None,
) -> tuple[LumbarPhantom, TrackedSequence]:
    """A patient and a sweep of it, by `seed`; arguments as for `write_simulated_patient`, the CT has voxels of `spacing` mm."""
    place = random_rigid(25.0, 8.0, np.random.default_rng([seed, 7]))
    anatomy = anatomy or LumbarAnatomy.from_seed(seed)
    phantom = make_lumbar_phantom(anatomy, spacing=spacing, ct_to_reference=place, progress=part(progress, 0.0, 0.4))
    path = PATHS[path] if isinstance(path, str) else path
    way = path if isinstance(path, ProbePath) else path(phantom, frames)
    drawn = part(progress, 0.4, 1.0)
    sweep = simulate_sweep(phantom, PhasedArray(), way, errors=errors, effects=effects, seed=seed, progress=drawn)
    return phantom, sweep


def check_simulated_folder(folder: Path, names: Sequence[str]) -> None:
    """Return if files of these names can be written: simulated ones replace none but simulated ones, of whatever seed.

    Raises OutputError when one of them is there, and the folder has not the configuration that a simulation writes.
    """
    there = [name for name in names if os.path.lexists(folder / name)]
    configuration = folder / FILES[1]
    if there and not (configuration.is_file() and configuration.read_bytes() == plus_configuration_xml(PhasedArray()).encode()):
        raise OutputError(f"{folder}: it holds {there[0]}, which was not simulated and would be replaced. Choose another folder.")


def write_simulated_patient(
    folder: Path,
    seed: int = 0,
    path: str | ProbePath = "multi-angle",
    frames: int = 144,
    progress: Progress | None = None,
    effects: UltrasoundEffects | None = None,
    errors: TrackingErrors | None = None,
) -> SimulatedFiles:
    """Simulate a patient and a sweep, and write them as a user would have them.

    Parameters
    ----------
    folder : Path
    seed, frames : int
    path : "multi-angle", "single-angle" or "freehand", or a ProbePath
        By one of one's own, `frames` do not count.
    progress : Progress or None
    effects : UltrasoundEffects or None
        Among them the scanner's gain and gray curve.
    errors : TrackingErrors or None
        Among them how the patient moves.

    Notes
    -----
    The CT lies in a frame of its own, turned and shifted against Reference, and its registration is written beside it as Slicer
    would save it.
    """
    if frames < 2 or seed < 0:
        raise SettingsError("A simulation takes at least 2 frames and a seed of 0 or more.")
    check_simulated_folder(folder, FILES)
    with output_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
    sequence, configuration, ct, labels, placed = (folder / name for name in FILES)
    # First, because by it a folder is known as one of simulated files
    write_text(configuration, plus_configuration_xml(PhasedArray()))
    phantom, sweep = simulated(seed, path, frames, effects=effects, errors=errors, progress=part(progress, 0.0, 0.9))
    phantom.ct.write(ct)
    phantom.labels.write(labels)
    write_transform(phantom.ct_to_reference, placed)
    write_sequence(sweep, sequence, progress=part(progress, 0.9, 1.0))
    junctions = phantom.spinolaminar_junctions()
    return SimulatedFiles(sequence, configuration, ct, labels, placed, junctions[len(junctions) // 2])
