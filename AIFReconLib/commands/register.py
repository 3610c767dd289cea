"""`aifrecon register`: where a CT belongs on a sweep, from the bone that the sweep shows."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from ..evaluation.registration_figure import registration_figure
from ..geometry.transforms import invert, transform_points
from ..io.transform.files import write_transform
from ..io.volume.files import check_volume_path, write_volume
from ..io.volume.surfaces import check_surface_path, is_surface_path, write_labels_surface
from ..progress import part
from ..registration.registration import as_report
from ..terminal.arguments import Names, Output, Settings
from ..terminal.console import ProgressBar
from ..terminal.labels_options import PlacingOptions, place_from, required_labels
from ..terminal.outputs import tell, write_json
from ..terminal.remedies import in_options
from ..terminal.sequence_options import SequencesOptions, sequences_from
from ..workflows.register import RegistrationJob, RegistrationOutput, calibration_by, register_job
from .info import reconstruct_command


class _RegisterOptions(PlacingOptions, SequencesOptions):
    """Lay the bone of a CT's segmentation upon the bone that a sweep shows, and say how well they agree.

    Parameters
    ----------
    output : TRANSFORM
        where to write CT -> Reference as Slicer saves it (.tfm, .txt, .h5)
    bone_transform : START
        CT -> Reference to start from; default: look for it from behind
    labels_output : FILE
        also write the labels in Reference, where they came to lie; their surface if FILE ends in .vtp (give it twice for both)
    report : FILE.json
        also write numbers, alternatives and the motions that the sweep does not determine
    preview : FILE.png
        also draw the echoes on the bone (needs matplotlib)

    Examples
    --------
      aifrecon register sweep.igs.mha --config PlusDeviceSet.xml --bone-labels lumbar.nrrd --output CTToReference.tfm

    Exit code 1: the CT does not agree with the sweep, or fits as well elsewhere; then no transform is written (--report and --preview are).
    """

    output: Output
    bone_transform: Path | None = None
    labels_output: list[Output] = []
    report: Output | None = None
    preview: Output | None = None

    SETTINGS: ClassVar[Settings] = ("motion",)
    FIRST: ClassVar[Names] = ("bone_labels", "ct", "config", "bone_transform", "per_segment", "preview", "report", "quiet")


def run(asked: _RegisterOptions) -> None:
    """Read, register, write, and say how sure it is."""
    for path in asked.labels_output:
        (check_surface_path if is_surface_path(path) else check_volume_path)(path)
    with ProgressBar() as progress:
        labels = required_labels(asked, part(progress, 0.0, 0.05))
        sequences = sequences_from(asked, asked.sequences)
        start, recipe = place_from(asked), asked.recipe
        job = RegistrationJob(sequences, labels, start, recipe, asked.per_segment, asked.level, asked.accept)
        done = register_job(job, part(progress, 0.05, 0.8))
        calibration: list[str] = []
        if done.found.accepted:
            # What the bone where it came to lie says; nothing where the sweep cannot tell
            told = calibration_by(sequences, done.placed, None, recipe, part(progress, 0.8, 0.95), done.found.echoes)
            calibration = [] if told.agrees is None else list(map(in_options, told.lines))
        written = _write(asked, done, calibration)
    first, *others = done.lines
    tell(first, [*others, *calibration], written)
    done.require_taken()
    print(f"next: {reconstruct_command(asked, bone_transform=asked.output)}")


def _write(asked: _RegisterOptions, done: RegistrationOutput, calibration: list[str]) -> list[Path]:
    """Write what was asked for; the transform and the labels only when the answer is taken."""
    found, written = done.found, [asked.output, *asked.labels_output] if done.is_taken else []
    if done.is_taken:
        write_transform(found.transform, asked.output)
        for path in asked.labels_output:
            (write_labels_surface if is_surface_path(path) else write_volume)(done.placed, path)
    write_json(asked.report, {**as_report(found), "calibration": calibration, "written": list(map(str, written))})
    if asked.preview:
        # Bones that moved on their own are drawn where they came to lie, along the axes of the CT all the same
        to_labels = invert(found.transform)
        echoes = transform_points(to_labels, found.echoes.points)
        registration_figure(asked.preview, echoes, done.placed.placed_by(to_labels), found.agreement.sentence())
    return [*written, *(path for path in (asked.report, asked.preview) if path)]
