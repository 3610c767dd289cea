"""`aifrecon register`: where a CT belongs on a sweep, from the bone that the sweep shows."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from ..evaluation.figures import require_matplotlib
from ..evaluation.registration_figure import registration_figure
from ..geometry.transforms import invert, transform_points
from ..io.disk.atomic import write_text
from ..io.transform.files import write_transform
from ..io.volume.files import check_volume_path, write_volume
from ..io.volume.surfaces import check_labels_surface_path, is_surface_path, write_labels_surface
from ..progress import part
from ..registration.registration import as_report
from ..terminal.console import ProgressBar
from ..terminal.options import (
    Commands,
    add_labels_options,
    add_placing_options,
    check_files,
    place_from,
    refuse_to_overwrite,
    required_labels,
)
from ..terminal.recipe_options import add_setting, recipe_from
from ..terminal.remedies import in_options
from ..terminal.sequence_options import add_sweep_options, of_each, sequence_from
from ..workflows.register import RegistrationJob, RegistrationOutput, calibration_by, register_job
from .info import reconstruct_command

EXAMPLE = """example:
  aifrecon register sweep.igs.mha --config PlusDeviceSet.xml --bone-labels lumbar.nrrd --output CTToReference.tfm

Exit code 1: the CT does not agree with the sweep, or fits as well elsewhere; then no transform is written (--report and --preview are)."""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "register",
        description="Lay the bone of a CT's segmentation upon the bone that a sweep shows, and say how well they agree.",
        examples=EXAMPLE,
    )
    parser.add_argument("sequences", type=Path, nargs="+", metavar="SEQUENCE", help="tracked frames, one or more sweeps in one Reference")
    add_labels_options(parser)
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        required=True,
        metavar="TRANSFORM",
        help="where to write CT -> Reference as Slicer saves it (.tfm, .txt, .h5)",
    )
    parser.add_argument(
        "--bone-transform",
        type=Path,
        metavar="START",
        help="CT -> Reference to start from; default: look for it from behind",
    )
    result = parser.add_argument_group("result")
    add_placing_options(result)
    result.add_argument(
        "--labels-output",
        type=Path,
        action="append",
        default=[],
        metavar="FILE",
        help="also write the labels in Reference, where they came to lie; their surface if FILE ends in .vtp (give it twice for both)",
    )
    result.add_argument(
        "--report",
        type=Path,
        metavar="FILE.json",
        help="also write numbers, alternatives and the motions that the sweep does not determine",
    )
    result.add_argument("--preview", type=Path, metavar="FILE.png", help="also draw the echoes on the bone (needs matplotlib)")
    add_sweep_options(parser)
    add_setting(parser, "motion")
    parser.show_first("bone_labels", "ct", "config", "bone_transform", "per_segment", "preview", "report", "quiet")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read, register, write, and say how sure it is."""
    each = of_each(arguments, arguments.sequences)
    refuse_to_overwrite(arguments, "output", "labels_output", "report", "preview")
    check_files(arguments.output, arguments.report, arguments.preview)
    for path in arguments.labels_output:
        (check_labels_surface_path if is_surface_path(path) else check_volume_path)(path)
    if arguments.preview:
        require_matplotlib()
    with ProgressBar() as progress:
        labels = required_labels(arguments, part(progress, 0.0, 0.05))
        start, recipe = place_from(arguments), recipe_from(arguments)
        sequences = [sequence_from(one) for one in each]
        job = RegistrationJob(sequences, labels, start, recipe, arguments.per_segment, arguments.level, arguments.accept)
        done = register_job(job, part(progress, 0.05, 0.8))
        calibration: list[str] = []
        if done.found.accepted:
            # What the bone where it came to lie says; nothing where the sweep cannot tell
            told = calibration_by(sequences, done.placed, None, recipe, part(progress, 0.8, 0.95), done.found.echoes)
            calibration = [] if told.agrees is None else list(map(in_options, told.lines))
        written = _write(arguments, done, calibration)
    print("\n  ".join([*map(in_options, done.lines), *calibration, *(f"wrote {path}" for path in written)]))
    done.require_taken()
    print(f"next: {reconstruct_command(arguments, bone_transform=arguments.output)}")


def _write(arguments: argparse.Namespace, done: RegistrationOutput, calibration: list[str]) -> list[Path]:
    """Write what was asked for; the transform and the labels only when the answer is taken."""
    written, found = [], done.found
    if done.is_taken:
        write_transform(found.transform, arguments.output)
        written.append(arguments.output)
        for path in arguments.labels_output:
            (write_labels_surface if is_surface_path(path) else write_volume)(done.placed, path)
            written.append(path)
    if arguments.report:
        facts = {**as_report(found), "calibration": calibration, "written": [str(path) for path in written]}
        write_text(arguments.report, json.dumps(facts, indent=2) + "\n")
        written.append(arguments.report)
    if arguments.preview:
        # Bones that moved on their own are drawn where they came to lie, along the axes of the CT all the same
        to_labels = invert(found.transform)
        echoes = transform_points(to_labels, found.echoes.points)
        registration_figure(arguments.preview, echoes, done.placed.placed_by(to_labels), found.agreement.sentence())
        written.append(arguments.preview)
    return written
