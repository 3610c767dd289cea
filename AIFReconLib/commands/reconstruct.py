"""`aifrecon reconstruct`: the main job."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np

from ..compounding.methods.table import method_named
from ..compounding.state import BESIDE, Reconstruction
from ..errors import BeamGeometryError, GeometryError, SettingsError
from ..geometry.volume import Volume
from ..inspection.summary import summary_lines
from ..inspection.tracking_report import TrackingReport
from ..io.volume.dicom_series import read_ct
from ..io.volume.files import check_volume_path, write_volume
from ..progress import Progress, part
from ..provenance.record import settings_of
from ..provenance.settings_files import check_settings_path, write_settings
from ..recipe.recipe import Recipe
from ..registration.labeled_bone import LabeledBone
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import joined
from ..sweep.poses import SweepPoses, sweep_poses
from ..terminal.arguments import Names, Output, Settings
from ..terminal.console import ProgressBar
from ..terminal.outputs import write_json
from ..terminal.reconstruction_options import (
    SIDE_OUTPUTS,
    ReconstructionOptions,
    bone_inputs,
    bone_source_from,
    gigabytes,
    grid_from,
    with_provenance,
)
from ..terminal.remedies import as_option, in_options
from ..terminal.sequence_options import SequencesOptions, sequence_inputs, sequences_from
from ..workflows.job import ReconstructionJob, ReconstructionOutput
from ..workflows.reconstruct import plain_mean, reconstruct_job, tracking_of
from .info import register_command
from .preview import how_to_look, write_preview

FIRST_OPTIONS = (
    *("config", "bone_labels", "ct", "bone_transform", "bone_from_sweep"),
    *("method", "spacing", "grid_like", "hole_limit", "preview"),
)
"""What most need, here and in a live scan."""


TYPE_OF = {"score": "float32", "hits": "uint32", "mask": "uint8", "cosine": "float32"}
"""Types of the voxels of what is written beside the intensity."""


class _ReconstructOptions(ReconstructionOptions, SequencesOptions):
    """Reconstruct a volume from a tracked sequence recorded by Plus (.mha, .mhd, .nrrd).

    Parameters
    ----------
    output : VOLUME
        where to write (.nrrd, .mha, .mhd, .nii, .nii.gz, .dcm)
    memory : GB
        that volumes may take; larger ones are worked in parts, with the same voxels (default: three quarters of what is free)
    dicom_study : FILE
        a DICOM file or folder of the study that .dcm outputs join
    report : FILE.html
        also tell of the tracking and of what was done: .html, a page with pictures; .json, numbers

    Examples
    --------
      aifrecon reconstruct sweep.igs.mha --config PlusDeviceSet.xml --output volume.nrrd
      aifrecon reconstruct sweep.igs.mha --config PlusDeviceSet.xml --bone-labels lumbar.nrrd \\
          --bone-transform CTToReference.tfm --output volume.nrrd
      aifrecon reconstruct sweep.igs.mha --config PlusDeviceSet.xml --bone-from-sweep --method weighted --output volume.nrrd
    """

    output: Output
    memory: Annotated[int, gigabytes] | None = None
    dicom_study: Path | None = None
    report: Output | None = None

    SETTINGS: ClassVar[Settings] = ("motion",)
    FIRST: ClassVar[Names] = (*FIRST_OPTIONS, "report", "quiet")


def run(asked: _ReconstructOptions) -> None:
    """Read, reconstruct, write, and say what was done."""
    started = time.perf_counter()
    outputs = checked_outputs(asked, asked.output)
    inputs = [*sequence_inputs(asked, asked.sequences), *bone_inputs(asked), asked.importance_mask, asked.dicom_study]
    if asked.dicom_study and not any(path.suffix.lower() == ".dcm" for path in outputs.values()):
        raise SettingsError("--dicom-study is for an output that ends with .dcm, and there is none.")
    with ProgressBar() as progress:
        sequence, recipe = joined(sequences_from(asked, asked.sequences)), asked.recipe
        bone = bone_source_from(asked, part(progress, 0.0, 0.05))
        beside = [name for name in BESIDE if getattr(asked, name)]
        job = ReconstructionJob(sequence, recipe, bone, grid_from(asked), beside, asked.memory)
        output = reconstruct_job(job, part(progress, 0.05, 0.95))
        result, labeled = with_provenance(output.result, asked, inputs), output.labeled
        poses = sweep_poses(sequence, recipe.image_to_reference, recipe.reference) if asked.preview else None
        uses_bone = labeled is not None and method_named(result.method).needs_bone
        on_bone = labeled is not None and not (uses_bone and labeled.taken_from_echoes(result.method))
        labels = labeled.in_reference() if labeled and on_bone else None
        files = [*write_outputs(result, asked, outputs, labels, poses, asked.dicom_study), *([asked.report] if asked.report else [])]
        # What the sweep's own bone says of the CT's place
        lines = [*labeled.labels.notes, *labeled.lines(result.method)] if labeled is not None and uses_bone else []
    agreement = list(map(in_options, lines))
    tracking = tracking_of(job, result)
    if asked.report and asked.report.suffix.lower() not in (".html", ".htm"):
        write_json(asked.report, {**report_of(result, tracking, outputs), "agreement": agreement, **_met(labeled, sequence, recipe)})
    elif asked.report:
        with ProgressBar() as progress:
            _write_page(asked, replace(job, sequence=output.sequence or sequence), output, result, tracking, progress)
    print(describe(result, len(sequence), time.perf_counter() - started, files, tracking, agreement))
    if labeled is not None and not on_bone and asked.bone_transform is None:
        print(f"  The CT was taken to lie in Reference already. Place it first: {register_command(asked)}")
    print(*(f"  {line}\n" for line in how_to_look(asked, asked.output)), sep="", end="")


def checked_outputs(asked: ReconstructionOptions, output: Path) -> dict[str, Path]:
    """The volumes that are to be written, once they and what goes with them are found possible."""
    outputs = {"intensity": output, **{name: path for name in SIDE_OUTPUTS if (path := getattr(asked, name))}}
    for name, path in outputs.items():
        check_volume_path(path, TYPE_OF.get(name) or asked.output_type or "uint8")
    if asked.save_settings:
        check_settings_path(asked.save_settings)
    return outputs


def write_outputs(
    result: Reconstruction,
    asked: ReconstructionOptions,
    outputs: dict[str, Path],
    labels: Volume | None,
    poses: SweepPoses | None = None,
    study: Path | None = None,
) -> list[Path]:
    """Write volumes, preview and settings; the answer names the files."""
    for name, path in outputs.items():
        write_volume(getattr(result, name), path, study)
    files = [*outputs.values(), *write_preview(result, asked, outputs["intensity"].name, labels, poses)]
    if asked.save_settings:
        write_settings(settings_of(result.intensity), asked.save_settings)
        files.append(asked.save_settings)
    return files


def _write_page(
    asked: _ReconstructOptions,
    job: ReconstructionJob,
    output: ReconstructionOutput,
    result: Reconstruction,
    tracking: dict[str, TrackingReport],
    progress: Progress,
) -> None:
    """The page that the panel saves, with what was measured beside it where a method has raised bone."""
    from ..imaging.gray_window import gray_window
    from ..worker.page import PageAbout, tell

    labeled = output.labeled
    ct = read_ct(asked.ct) if asked.ct else None
    place = np.eye(4) if labeled is None or labeled.labels_to_reference is None else labeled.labels_to_reference
    weighs = method_named(result.method).needs_bone
    about = PageAbout(
        name=asked.output.name,
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
        motion=output.motion,
        shown=result.intensity,
        window=gray_window(result.intensity.array, result.mask.array),
        plain=plain_mean(job, result, part(progress, 0.0, 0.3)) if weighs else None,
        ct=None if ct is None else ct.placed_by(place),
    )
    tell(about, asked.report, as_option, part(progress, 0.3, 1.0))


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


def report_of(result: Reconstruction, tracking: dict[str, TrackingReport], outputs: dict[str, Path]) -> dict[str, object]:
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
        "notes": list(map(in_options, result.messages)),
        "files": {name: str(path) for name, path in outputs.items()},
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
