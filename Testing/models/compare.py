"""What `weighted` makes of bone from a CT, from a network that is right, from a trained one, and from the echoes, as a table of metrics.

    python Testing/models/compare.py [--real FOLDER] [--model FILE.onnx]

The simulated patient is that of the demo; FOLDER holds fibula-distal.igs.mha and fibula-labels.nrrd. The exit status is 1 when a network
that is right gives less than 90% of the CNR or of the coverage that the CT gives.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from AIFReconLib.bone.echoes.surface import bone_from_sweep
from AIFReconLib.bone.map import BoneMap
from AIFReconLib.bone.network.model import OnnxModel
from AIFReconLib.bone.predicted_bone import bone_from_frames
from AIFReconLib.compounding.methods.average import AVERAGE
from AIFReconLib.compounding.methods.weighted import WEIGHTED
from AIFReconLib.effective_settings import Imaging, resolve_imaging
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.evaluation.visibility import SweepBeams, bone_truth
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.imaging.beams import LINEAR
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.transform.files import read_transform
from AIFReconLib.io.volume.label_files import read_labels
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.sweep.edits import select_frames
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import SweepPoses, sweep_poses
from AIFReconLib.workflows.simulate import write_simulated_patient
from models.truth import TrueBone

FRAMES, EVERY, HOLE_LIMIT = 135, 6, 1.0
"""Frames of the simulated scan, every which of the real one, and mm: what docs/without-ct.md shows."""

CT, RIGHT, LEAST = "CT", "network that is right", 0.9
"""Two sources by name, and how much of what the first gives the second must."""


@dataclass(frozen=True, eq=False)
class Case:
    """A sweep, where its bone truly is, and how it is read and reconstructed."""

    name: str
    sequence: TrackedSequence
    labels: Volume
    recipe: Recipe

    @property
    def poses(self) -> SweepPoses:
        """Where its frames lie."""
        return sweep_poses(self.sequence)

    @property
    def imaging(self) -> Imaging:
        """How its frames are read."""
        return resolve_imaging(self.sequence, self.poses, True, self.recipe)


def simulated(folder: Path, seed: int = 0, frames: int = FRAMES) -> Case:
    """A simulated patient, the first that of the demo."""
    files = write_simulated_patient(folder, seed, "multi-angle", frames)
    labels = read_labels(files.labels).placed_by(read_transform(files.ct_to_reference))
    sequence = read_sequence(files.sequence, config=files.configuration)
    return Case(f"simulated patient {seed}, {frames} frames", sequence, labels, Recipe(spacing=1.0))


def real(folder: Path, every: int = EVERY) -> Case:
    """A cadaver's fibula."""
    whole, labels = read_sequence(folder / "fibula-distal.igs.mha"), read_labels(folder / "fibula-labels.nrrd")
    return Case(
        f"real fibula, {len(whole)} frames by {every}", select_frames(whole, every=every), labels, Recipe(probe=LINEAR, spacing=0.5)
    )


def sources(case: Case, model: Path | None) -> Iterator[tuple[str, Callable[[], BoneMap | None]]]:
    """Who says where bone is, by name."""
    imaging, poses = case.imaging, case.poses

    def seen(estimator):
        return lambda: bone_from_frames(case.sequence, estimator, poses, imaging)

    yield AVERAGE.name, lambda: None
    yield CT, lambda: LabeledBone(case.labels, None, case.sequence, case.recipe).map(WEIGHTED.name)
    yield "CT, map of 4 mm", lambda: BoneMap.from_labels(case.labels, sigma_mm=4.0)
    yield RIGHT, seen(TrueBone(case.labels, imaging))
    if model is not None:
        yield model.name, seen(OnnxModel(model))
    yield "echoes", lambda: bone_from_sweep(case.sequence, case.recipe)


def compare(case: Case, model: Path | None) -> bool:
    """Print a line for each source; whether a network that is right gives as much of what the CT gives as it must."""
    truth = bone_truth(case.labels, SweepBeams.of_sequence(case.sequence, case.recipe))
    print(
        f"| **{case.name}**, {case.recipe.spacing:g} mm | CNR | oblique CNR | coverage | oblique coverage |\n|---|---|---|---|---|",
        flush=True,
    )
    found = {}
    for name, bone_of in sources(case, model):
        bone = bone_of()
        method = AVERAGE.name if bone is None else WEIGHTED.name
        result = reconstruct(case.sequence, replace(case.recipe, method=method, hole_limit=HOLE_LIMIT), bone, beside=())
        met = evaluate(result.intensity, truth, result.mask)
        numbers = f"{met.bone.cnr:.2f} | {met.oblique.cnr:.2f} | {met.bone.coverage:.1%} | {met.oblique.coverage:.1%}"
        print(f"| {name} | {numbers} |", flush=True)
        found[name] = np.array([met.bone.cnr, met.bone.coverage])
    shares = found[RIGHT] / found[CT]
    print(f"\nA {RIGHT} gives {shares[0]:.0%} of the CNR and {shares[1]:.0%} of the coverage of the CT.\n", flush=True)
    return bool((shares >= LEAST).all())


def main() -> int:
    """Compare on the simulated patient, and on the real bone where it is given; the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--real", type=Path, metavar="FOLDER", help="holds fibula-distal.igs.mha and fibula-labels.nrrd")
    parser.add_argument("--model", type=Path, metavar="FILE.onnx", help="a trained network")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        enough = compare(simulated(Path(folder)), arguments.model)
    if arguments.real:
        enough &= compare(real(arguments.real), arguments.model)
    return 0 if enough else 1


if __name__ == "__main__":
    raise SystemExit(main())
