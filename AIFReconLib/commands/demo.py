"""`aifrecon demo`: the whole, on a simulated patient, through the files and calls that a user would use."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from ..bone import BoneMap
from ..console import ProgressBar
from ..evaluation.figures import compare_figure
from ..io.sequence_files import read_sequence
from ..io.transform_files import read_transform
from ..io.volume_files import read_labels, read_volume
from ..progress import part
from ..reconstruct import reconstruct
from ..settings import METHODS, ReconstructionSettings
from .simulate import write_simulated_patient

SPACING = 1.0
"""mm; coarse enough for the demo to take seconds."""

HOLE_LIMIT = 2.0
"""mm; closes the gaps between the frames of a pass."""

FRAMES = 270
BONE_SIGMA = 4.0
"""mm; the paper's 10 voxels on a CT of 0.4 mm."""

SHOWN = ("average", "aif", "aif-compensated", "weighted")


def add_to(commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "demo",
        help="simulate a lumbar scan, reconstruct it with every method, draw it",
        description="Simulate a patient with a registered CT and a tracked sweep, write them as files, reconstruct the sweep with every "
        "method, and draw the results beside the CT.",
    )
    parser.add_argument(
        "--output", type=Path, default=Path("demo-output"), metavar="DIR", help="folder to write into (default: %(default)s)"
    )
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="which patient (default: 0)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Simulate, reconstruct, draw."""
    started = time.perf_counter()
    folder: Path = arguments.output
    with ProgressBar() as progress:
        files = write_simulated_patient(folder, arguments.seed, frames=FRAMES, progress=part(progress, 0.0, 0.5))
        sequence = read_sequence(files.sequence, config=files.configuration)
        ct_to_reference = read_transform(files.ct_to_reference)
        bone = BoneMap.from_labels(read_labels(files.labels), sigma_mm=BONE_SIGMA, labels_to_reference=ct_to_reference)
        volumes, written = {}, []
        for number, method in enumerate(METHODS):
            step = part(progress, 0.5 + 0.45 * number / len(METHODS), 0.5 + 0.45 * (number + 1) / len(METHODS))
            settings = ReconstructionSettings(method=method, spacing=SPACING, hole_limit=HOLE_LIMIT)
            result = reconstruct(sequence, settings, bone, progress=step)
            written.append(folder / f"reconstruction-{method}.nrrd")
            result.intensity.write(written[-1])
            if method in SHOWN:
                volumes[method] = result.intensity
        figure = folder / "comparison.png"
        compare_figure(
            figure,
            read_volume(files.ct).placed_by(ct_to_reference),
            volumes,
            files.center_ras,
            bone=read_labels(files.labels).placed_by(ct_to_reference),
            mask=result.mask,
            title=f"Simulated lumbar spine, {len(sequence)} tracked frames",
        )
    seconds = time.perf_counter() - started
    print(f"reconstructed {len(sequence)} frames of a simulated lumbar spine with {len(METHODS)} methods, {seconds:.0f} s")
    print(f"  look at   {figure}")
    print(f"  volumes   {folder / 'reconstruction-*.nrrd'}")
    print(
        f"  inputs    {files.sequence.name}, {files.configuration.name}, {files.ct.name}, {files.labels.name}, {files.ct_to_reference.name}"
    )
    print("the same by hand, for one method:")
    print(
        f"  aifrecon reconstruct {files.sequence} --config {files.configuration} \\\n"
        f"      --bone-labels {files.labels} --bone-sigma-mm {BONE_SIGMA:g} --bone-transform {files.ct_to_reference} \\\n"
        f"      --spacing {SPACING:g} --hole-limit {HOLE_LIMIT:g} --output volume.nrrd"
    )
