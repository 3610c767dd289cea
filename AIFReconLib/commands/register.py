"""`aifrecon register`: where a CT belongs on a sweep, from the bone that the sweep shows."""

from __future__ import annotations

import argparse
import json
from functools import partial
from pathlib import Path

import numpy as np

from ..errors import RegistrationRefused
from ..geometry.labels import Labels
from ..geometry.transforms import invert, transform_points
from ..geometry.volume import Volume
from ..io.disk.atomic import write_text
from ..io.transform.files import write_transform
from ..io.volume.files import check_volume_path, write_volume
from ..io.volume.surfaces import check_labels_surface_path, is_surface_path, write_labels_surface
from ..message import said
from ..progress import part
from ..registration.labeled_bone import LabeledBone
from ..registration.registration import Registration, as_report, register
from ..registration.segments import placed_labels
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
from .info import calibration_lines, reconstruct_command

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
        from ..evaluation.figures import require_matplotlib

        require_matplotlib()
    with ProgressBar() as progress:
        labels = required_labels(arguments, part(progress, 0.0, 0.05))
        start = place_from(arguments)
        sequences, recipe = [sequence_from(one) for one in each], recipe_from(arguments)
        given = labels
        if given.space_is_guessed:
            labels = LabeledBone(given, start, sequences, recipe).labels
        registered = partial(register, sequences, start=start, per_segment=arguments.per_segment, level=arguments.level or 0, recipe=recipe)
        found = registered(labels, progress=part(progress, 0.05, 0.8))
        if given.space_is_guessed and not found.accepted:
            is_lps = np.array_equal(labels.ijk_to_reference, given.ijk_to_reference)
            turned = given.taken_as("RAS" if is_lps else "LPS", "where the sweep fits better")
            other = registered(turned)
            if other.agreement.tightness > found.agreement.tightness:
                found, labels = other, turned
        calibration: list[str] = []
        if found.accepted:
            # What the bone where it came to lie says; nothing where the sweep cannot tell
            told, agrees = calibration_lines(sequences, _placed(found, labels), None, recipe, part(progress, 0.8, 0.95), found.echoes)
            calibration = [] if agrees is None else told
        written = _write(arguments, found, labels, calibration)
    moved = () if found.motion is None else found.motion.lines
    lines = [found.agreement.sentence(), *moved, *map(in_options, labels.notes), *_findings(found, labels), *calibration]
    print("\n  ".join([*lines, *(f"wrote {path}" for path in written)]))
    if not _is_taken(arguments, found):
        raise RegistrationRefused(f"No transform is written. {found.said}", said(found.said))
    print(f"next: {reconstruct_command(arguments, bone_transform=arguments.output)}")


def _is_taken(arguments: argparse.Namespace, found: Registration) -> bool:
    """Whether the answer is sure, or the user has chosen it."""
    return found.accepted or arguments.accept or arguments.level is not None


def _write(arguments: argparse.Namespace, found: Registration, labels: Volume, calibration: list[str]) -> list[Path]:
    """Write what was asked for; the transform and the labels only when the answer is taken."""
    written = []
    if _is_taken(arguments, found):
        write_transform(found.transform, arguments.output)
        written.append(arguments.output)
        for path in arguments.labels_output:
            (write_labels_surface if is_surface_path(path) else write_volume)(_placed(found, labels), path)
            written.append(path)
    if arguments.report:
        facts = {**as_report(found), "calibration": calibration, "written": [str(path) for path in written]}
        write_text(arguments.report, json.dumps(facts, indent=2) + "\n")
        written.append(arguments.report)
    if arguments.preview:
        from ..evaluation.registration_figure import registration_figure

        # Bones that moved on their own are drawn where they came to lie, along the axes of the CT all the same
        to_labels = invert(found.transform)
        shown = _placed(found, labels).placed_by(to_labels)
        registration_figure(arguments.preview, transform_points(to_labels, found.echoes.points), shown, found.agreement.sentence())
        written.append(arguments.preview)
    return written


def _placed(found: Registration, labels: Volume) -> Volume:
    """The labels in Reference, where they came to lie."""
    return placed_labels(labels, found.segments.transforms) if found.segments else labels.placed_by(found.transform)


def _findings(found: Registration, labels: Labels) -> list[str]:
    """What else a user should know, one line each."""
    lines, all_echoes = [], len(found.echoes)
    if found.moved is not None:
        lines.append(f"moved by {found.moved:.1f} mm from the start")
    lines += [
        f"{labels.called(label)}: {own.agreement:.0%} of its echoes agree; it has {own.echoes / all_echoes:.0%} of all"
        for label, own in sorted(found.agreement.per_label.items())
    ]
    if found.uncertain:
        lines.append("not determined by this sweep: " + "; ".join(found.uncertain))
    if found.agreement.elsewhere:
        far = found.agreement.elsewhere / all_echoes
        lines.append(f"{far:.1%} of all echoes lie far from labeled bone: of bone that the labels lack, or of none")
    if found.alternatives:
        best = found.alternatives[0]
        levels = "" if not best.levels else f" ({best.levels:+d} level{'s' if abs(best.levels) > 1 else ''})"
        lines.append(f"next best place{levels}: {best.agreement.explained:.0%} of all echoes agree, here {found.agreement.explained:.0%}")
    return lines
