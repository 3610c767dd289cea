"""`aifrecon demo`: the whole, on a simulated patient, through the files and calls that a user would use."""

from __future__ import annotations

import textwrap
import time
from datetime import date
from pathlib import Path

from ..bone.echoes.surface import bone_from_sweep
from ..bone.map import BoneMap
from ..compounding.methods.table import BONE_METHODS, COMPARED_METHODS, METHODS, method_named
from ..compounding.methods.weighted import WEIGHTED
from ..compounding.state import Reconstruction
from ..effective_settings import resolve_settings
from ..evaluation.figures import ComparisonFigure, require_matplotlib
from ..evaluation.metrics import evaluate
from ..evaluation.quantities import IN_WORDS, BoneMetrics, achieved, metrics_csv, table
from ..evaluation.report import Report, file_sizes, software_versions, write_report
from ..evaluation.visibility import SweepBeams, bone_truth
from ..guidance.coverage import coverage
from ..guidance.snapshot import Share
from ..io.disk.atomic import write_text
from ..io.sequence.files import read_sequence
from ..io.transform.files import read_transform
from ..io.volume.files import read_volume
from ..io.volume.label_files import read_labels
from ..message import columns
from ..progress import part
from ..recipe.recipe import Recipe
from ..reconstruction import reconstruct
from ..registration.labeled_bone import LabeledBone
from ..simulation.ultrasound import UltrasoundEffects
from ..terminal.arguments import Options
from ..terminal.console import ProgressBar, program
from ..workflows.simulate import FILES, check_simulated_folder, write_simulated_patient

SPACING = 1.0
"""mm; coarse enough for the demo to take seconds."""

HOLE_LIMIT = 2.0
"""mm; closes the gaps between the frames of a pass."""

FRAMES = 270
BONE_SIGMA = 4.0
"""mm; the paper's 10 voxels on a CT of 0.4 mm."""

PATH = "multi-angle"

WIDTH = 80
"""Letters of a line of text."""


PRINTED = (
    *("bone_cnr", "oblique_cnr", "bone_detectability", "bone_coverage", "interspinous_coverage"),
    *("lines_called_free", "bone_thickness", "speckle_snr"),
)
"""Metrics that are printed; the page and the CSV hold all."""

KNOBS = UltrasoundEffects(gain_db=6.0)
"""The scanner is turned up: no constant was chosen on such images."""

WITHOUT_CT = "weighted, no CT"
"""What the picture calls the volume whose bone the sweep tells by itself."""


class _DemoOptions(Options):
    """Simulate a patient with a registered CT and a tracked sweep, write them as files, reconstruct the sweep with every method, draw the
    results beside the CT, and measure how well each shows bone.

    Parameters
    ----------
    output : DIR
        folder to write into
    seed : N
        which patient
    """

    output: Path = Path("demo-output")
    seed: int = 0


def run(asked: _DemoOptions) -> None:
    """Simulate, reconstruct, measure, draw."""
    started = time.perf_counter()
    require_matplotlib()
    folder: Path = asked.output
    check_simulated_folder(folder, [*FILES, "comparison.png", "metrics.csv", "report.html", *(f"reconstruction-{m}.nrrd" for m in METHODS)])
    bar = ProgressBar()
    with bar as progress:
        files = write_simulated_patient(folder, asked.seed, PATH, FRAMES, part(progress, 0.0, 0.5), effects=KNOBS)
        sequence = read_sequence(files.sequence, config=files.configuration)
        ct_to_reference = read_transform(files.ct_to_reference)
        labels = read_labels(files.labels).placed_by(ct_to_reference)
        paper, ours = BoneMap.from_labels(labels, sigma_mm=BONE_SIGMA), LabeledBone(labels, None, sequence)
        truth = bone_truth(labels, SweepBeams.of_sequence(sequence), progress=part(progress, 0.5, 0.57))
        met = coverage(sequence, labels, progress=part(progress, 0.57, 0.6))
        metrics: dict[str, BoneMetrics] = {}
        settings: dict[str, Recipe] = {}

        def made(number: int, method: str) -> Reconstruction:
            step = part(progress, 0.6 + 0.35 * number / len(METHODS), 0.6 + 0.35 * (number + 1) / len(METHODS))
            asked = Recipe(method=method, spacing=SPACING, hole_limit=HOLE_LIMIT)
            settings[method] = resolve_settings(asked, sequence.configuration, True)
            bone = ours if method_named(method).follows_agreement else paper
            result = reconstruct(sequence, settings[method], bone, beside=(), progress=part(step, 0.0, 0.8))
            result.intensity.write(folder / f"reconstruction-{method}.nrrd")
            metrics[method] = evaluate(result.intensity, truth, result.mask)
            return result

        # What the picture shows comes first, and the picture before the rest
        results = {method: made(number, method) for number, method in enumerate(COMPARED_METHODS)}
        result = results[COMPARED_METHODS[0]]
        figure = folder / "comparison.png"
        ct = read_volume(files.ct).placed_by(ct_to_reference)
        title = f"Simulated lumbar spine, {len(sequence)} tracked frames"
        shown = {method: one.intensity for method, one in results.items()}
        seen = bone_from_sweep(sequence)
        shown[WITHOUT_CT] = reconstruct(sequence, settings[WEIGHTED.name], seen, progress=part(progress, 0.95, 0.97)).intensity
        ComparisonFigure(shown, files.center_ras, ct, labels, result.mask, title).write(figure)
        bar.clear()
        print(f"look at {figure}; the other methods and the report follow", flush=True)
        others = [method for method in METHODS if method not in results]
        for number, method in enumerate(others, len(results)):
            made(number, method)
        metrics = {method: metrics[method] for method in METHODS}
        write_text(folder / "metrics.csv", metrics_csv(metrics, result.frames_inserted, BONE_METHODS))
        facts = {
            "Patient": f"simulated, seed {asked.seed}",
            "Sweep": f"simulated, {PATH}, {result.frames_inserted} frames used of {FRAMES}; seed {asked.seed}",
            "Volumes": f"{' x '.join(map(str, result.grid.size))} voxels of {SPACING:g} mm",
            "Bone map": f"the CT's segmentation: for weighted by distance, for the paper's methods smoothed by {BONE_SIGMA:g} mm",
            "Registration and tracking": "exact",
            "Interspinous borders": f"hit {hit_of(met.interspinous)}",
        }
        report = Report(
            title="A simulated lumbar spine, reconstructed with every method",
            date=date.today().isoformat(),
            metrics=metrics,
            frames=result.frames_inserted,
            inputs=file_sizes([files.sequence, files.configuration, files.ct, files.labels, files.ct_to_reference]),
            facts=facts,
            settings=settings,
            versions=software_versions(),
            figure_png=figure.read_bytes(),
            figure_caption="Cuts through the middle spinous process: the CT with its segmentation outlined, and four of the methods. "
            "Blue: not scanned.",
        )
        write_report(folder / "report.html", report)
    seconds = time.perf_counter() - started
    print(f"reconstructed {len(sequence)} frames of a simulated lumbar spine with {len(METHODS)} methods, {seconds:.0f} s\n")
    print("\n".join(textwrap.wrap(achieved(metrics, result.frames_inserted), WIDTH)), end="\n\n")
    print(columns(zip(*table(metrics, PRINTED), strict=True)))
    print("\n" + "\n".join(textwrap.fill(words, WIDTH, initial_indent="  ", subsequent_indent="    ") for words in IN_WORDS))
    print(f"\n  hit by a beam: {hit_of(met.all)} of all bone within reach,")
    print(f"    {hit_of(met.interspinous)} of interspinous borders")
    print(f"\n  look at   {figure}")
    print(f"  read      {folder / 'report.html'} (all numbers and what they mean), metrics.csv")
    print(f"  volumes   {folder / 'reconstruction-*.nrrd'}")
    print(
        f"  inputs    {files.sequence.name}, {files.configuration.name}, {files.ct.name}, {files.labels.name}, {files.ct_to_reference.name}"
    )
    print("the same by hand, for one method:")
    print(
        f"  {program()} reconstruct {files.sequence} --config {files.configuration} \\\n"
        f"      --bone-labels {files.labels} --bone-transform {files.ct_to_reference} \\\n"
        f"      --spacing {SPACING:g} --hole-limit {HOLE_LIMIT:g} --output volume.nrrd"
    )


def hit_of(share: Share) -> str:
    """How much of a part of the bone was hit, in a few words."""
    return f"{share.met:.0%} ({share.below_45_deg:.0%} below 45 degrees, {share.expected_visibility:.0%} expected to show)"
