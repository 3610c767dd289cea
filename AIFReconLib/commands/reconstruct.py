"""`aifrecon reconstruct`: the main job."""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np

from ..compounding.methods.table import method_named
from ..compounding.state import Reconstruction
from ..errors import BeamGeometryError, GeometryError, SettingsError
from ..inspection.summary import summary_lines
from ..inspection.tracking_report import TrackingReport
from ..io.disk.atomic import write_text
from ..io.volume.dicom_series import read_ct
from ..io.volume.files import check_volume_path, write_volume
from ..progress import Progress, part
from ..provenance.record import settings_of
from ..recipe.recipe import Recipe
from ..registration.labeled_bone import LabeledBone
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import joined
from ..sweep.poses import sweep_poses
from ..terminal.console import ProgressBar
from ..terminal.options import Commands, check_files, refuse_to_overwrite
from ..terminal.recipe_options import add_setting, recipe_from
from ..terminal.reconstruction_options import (
    SIDE_OUTPUTS,
    add_memory_option,
    add_reconstruction_options,
    bone_inputs,
    job_from,
)
from ..terminal.remedies import as_option, in_options
from ..terminal.sequence_options import add_sequence_options, add_tracking_options, of_each, sequence_from, sequence_inputs
from ..terminal.settings_options import add_settings_options, check_save_settings, save_settings, with_provenance
from ..workflows.job import ReconstructionJob
from ..workflows.reconstruct import plain_mean, reconstruct_job, tracking_of
from .info import register_command
from .preview import add_preview_option, check_preview, how_to_look, write_preview

EXAMPLE = """examples:
  aifrecon reconstruct sweep.igs.mha --config PlusDeviceSet.xml --output volume.nrrd
  aifrecon reconstruct sweep.igs.mha --config PlusDeviceSet.xml --bone-labels lumbar.nrrd \\
      --bone-transform CTToReference.tfm --output volume.nrrd
  aifrecon reconstruct sweep.igs.mha --config PlusDeviceSet.xml --bone-from-sweep --method weighted --output volume.nrrd"""

FIRST_OPTIONS = (
    "config",
    "bone_labels",
    "ct",
    "bone_transform",
    "bone_from_sweep",
    "method",
    "spacing",
    "grid_like",
    "hole_limit",
    "preview",
)
"""What most need, here and in a live scan."""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "reconstruct",
        description="Reconstruct a volume from a tracked sequence recorded by Plus (.mha, .mhd, .nrrd).",
        examples=EXAMPLE,
    )
    parser.add_argument(
        "sequences",
        type=Path,
        nargs="+",
        metavar="SEQUENCE",
        help="tracked frames, e.g. sweep.igs.mha; one or more sweeps",
    )
    parser.add_argument(
        "-o", "--output", type=Path, required=True, metavar="VOLUME", help="where to write (.nrrd, .mha, .mhd, .nii, .nii.gz, .dcm)"
    )
    add_setting(parser, "method")
    add_tracking_options(parser, several=True)
    add_sequence_options(parser)
    volume = add_reconstruction_options(parser)
    add_preview_option(volume)
    add_memory_option(volume)
    volume.add_argument("--dicom-study", type=Path, metavar="FILE", help="a DICOM file or folder of the study that .dcm outputs join")
    volume.add_argument(
        "--report",
        type=Path,
        metavar="FILE",
        help="also tell of the tracking and of what was done: .html, a page with pictures; .json, numbers",
    )
    add_settings_options(parser)
    parser.show_first(*FIRST_OPTIONS, "report", "quiet")
    parser.set_defaults(run=run)


TYPE_OF = {"score": "float32", "hits": "uint32", "mask": "uint8", "cosine": "float32"}
"""Types of the voxels of what is written beside the intensity."""


def run(arguments: argparse.Namespace) -> None:
    """Read, reconstruct, write, and say what was done."""
    started = time.perf_counter()
    outputs = {"intensity": arguments.output, **{name: getattr(arguments, name) for name in SIDE_OUTPUTS}}
    each = of_each(arguments, arguments.sequences)
    inputs = [
        *(path for one in each for path in sequence_inputs(one)),
        *bone_inputs(arguments),
        arguments.importance_mask,
        arguments.dicom_study,
    ]
    refuse_to_overwrite(arguments, "output", *SIDE_OUTPUTS, "preview", "report", "save_settings")
    recipe = recipe_from(arguments)
    for name, path in outputs.items():
        if path:
            check_volume_path(path, TYPE_OF.get(name) or recipe.output_type or "uint8")
    if arguments.dicom_study and not any(path and path.suffix.lower() == ".dcm" for path in outputs.values()):
        raise SettingsError("--dicom-study is for an output that ends with .dcm, and there is none.")
    check_preview(arguments.preview)
    check_save_settings(arguments)
    check_files(arguments.report)
    with ProgressBar() as progress:
        sequence = joined(sequence_from(one) for one in each)
        job = job_from(arguments, sequence, recipe, part(progress, 0.0, 0.05))
        output = reconstruct_job(job, part(progress, 0.05, 0.95))
        result, labeled = with_provenance(output.result, arguments, inputs), output.labeled
        for number, (name, path) in enumerate((name, path) for name, path in outputs.items() if path):
            progress(0.95 + 0.01 * number, f"Writing {path.name}")
            write_volume(getattr(result, name), path, arguments.dicom_study)
        poses = sweep_poses(sequence, recipe.image_to_reference, recipe.reference) if arguments.preview else None
        uses_bone = labeled is not None and method_named(result.method).needs_bone
        on_bone = labeled is not None and not (uses_bone and labeled.taken_from_echoes(result.method))
        labels = labeled.in_reference() if labeled and on_bone else None
        drawn = [*write_preview(result, arguments, labels, poses), *save_settings(result, arguments)]
        # What the sweep's own bone says of the CT's place
        lines = [*labeled.labels.notes, *labeled.lines(result.method)] if labeled is not None and uses_bone else []
    agreement = list(map(in_options, lines))
    tracking = tracking_of(job, result)
    if arguments.report and not is_page(arguments.report):
        said = {**report_of(result, tracking, outputs), "agreement": agreement, **_met(labeled, sequence, recipe)}
        write_text(arguments.report, json.dumps(said, indent=2) + "\n")
    if arguments.report and is_page(arguments.report):
        with ProgressBar() as progress:
            _write_page(arguments, job, result, tracking, labeled, progress)
    files = [path for path in (*outputs.values(), *drawn, arguments.report) if path]
    print(describe(result, len(sequence), time.perf_counter() - started, files, tracking, agreement))
    if labeled is not None and not on_bone and arguments.bone_transform is None:
        print(f"  The CT was taken to lie in Reference already. Place it first: {register_command(arguments)}")
    print(*(f"  {line}\n" for line in how_to_look(arguments)), sep="", end="")


def is_page(path: Path) -> bool:
    """Whether a report of this name is for reading, and not for programs."""
    return path.suffix.lower() in (".html", ".htm")


def _write_page(
    arguments: argparse.Namespace,
    job: ReconstructionJob,
    result: Reconstruction,
    tracking: dict[str, TrackingReport],
    labeled: LabeledBone | None,
    progress: Progress,
) -> None:
    """The page that the panel saves, with what was measured beside it where a method has raised bone."""
    from ..imaging.gray_window import gray_window
    from ..worker.page import PageAbout, Pictured, tell

    ct = read_ct(arguments.ct) if arguments.ct else None
    place = np.eye(4) if labeled is None or labeled.labels_to_reference is None else labeled.labels_to_reference
    weighs = method_named(result.method).needs_bone
    about = PageAbout(
        name=arguments.output.name,
        method=result.method,
        settings=json.dumps(settings_of(result.intensity)),
        spacing=tuple(map(float, result.grid.spacing)),
        tracking=tracking,
        sequence=job.sequence,
        recipe=job.recipe,
        labels=None if labeled is None else labeled.labels,
        labels_to_reference=place,
        names={} if labeled is None else labeled.labels.names,
        problem="No CT was given." if labeled is None else "",
        pictured=Pictured(
            result.intensity,
            gray_window(result.intensity.array, result.mask.array),
            plain_mean(job, result, part(progress, 0.0, 0.3)) if weighs else None,
            None if ct is None else ct.placed_by(place),
        ),
    )
    tell(about, arguments.report, as_option, part(progress, 0.3, 1.0))


def _met(labeled: LabeledBone | None, sequence: TrackedSequence, recipe: Recipe) -> dict[str, object]:
    """What the sweep met of the labeled bone, for the report; nothing without labels, or where the beams are not known."""
    from ..guidance.coverage import coverage

    if labeled is None:
        return {}
    try:
        found = coverage(sequence, labeled.labels, labeled.labels_to_reference, recipe=recipe)
    except (BeamGeometryError, GeometryError) as problem:
        return {"coverage": None, "coverage_problem": str(problem)}
    return {"coverage": found.to_dict()}


def report_of(result: Reconstruction, tracking: dict[str, TrackingReport], outputs: dict[str, Path | None]) -> dict[str, object]:
    """What was done, for JSON; of several sweeps a list of what each gave."""
    sweeps = [{"sequence": name, **report.to_dict()} for name, report in tracking.items()]
    return {
        "method": result.method,
        "grid": {
            "size": list(result.grid.size),
            "spacing_mm": [round(float(value), 6) for value in result.grid.spacing],
            "ijk_to_reference": result.grid.ijk_to_reference.tolist(),
        },
        "tracking": sweeps if len(sweeps) > 1 else next(iter(tracking.values())).to_dict(),
        "notes": list(map(in_options, result.said)),
        "files": {name: str(path) for name, path in outputs.items() if path},
    }


def describe(
    result: Reconstruction,
    frames: int,
    seconds: float,
    files: list[Path],
    tracking: dict[str, TrackingReport] | None = None,
    agreement: list[str] | None = None,
) -> str:
    """What was done, in a few lines; `tracking` by the names of the sweeps."""
    first, *others = summary_lines(result, frames, seconds, as_option)
    tracking = tracking or {}
    findings = [
        f"{name}: {line}" if len(tracking) > 1 else line for name, report in tracking.items() for line in report.findings_on_poses()
    ]
    lines = [first, *others, *(agreement or []), *findings, *(f"wrote {path}" for path in files)]
    return "\n  ".join(map(in_options, lines))
