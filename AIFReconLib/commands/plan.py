"""`aifrecon plan`: the passes that will show a target."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np

from ..arrays import Floats
from ..errors import AIFReconError, FileFormatError, SettingsError
from ..evaluation.plan_figure import plan_figure
from ..geometry.transforms import invert, transform_points
from ..guidance.bone import GuidedBone
from ..guidance.coverage import covered
from ..guidance.plan import CANDIDATES, FREEHAND, ScanPlan, patient_and_probe, plan_scan
from ..guidance.probe import ProbeOnBack
from ..guidance.window import NOT_SEEN, unseen_of, window
from ..io.disk.atomic import write_text
from ..io.disk.tables import read_table
from ..message import columns
from ..progress import part
from ..terminal.console import ProgressBar
from ..terminal.options import Commands, check_files, place_from, refuse_to_overwrite, required_labels
from ..terminal.recipe_options import recipe_from
from ..terminal.remedies import in_options
from ..terminal.sequence_options import add_sweep_options, sequence_from
from .coverage import add_placed_labels_options
from .preview import check_preview

EXAMPLE = """examples:
  aifrecon plan --bone-labels lumbar.nrrd --bone-transform CTToReference.tfm --output plan.json
  aifrecon plan --bone-labels lumbar.nrrd --bone-transform CTToReference.tfm --unseen paths.json --frames 60 --output plan.json"""

FRAMES = 180


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "plan",
        description="Choose the passes of a scan that show most of a target with a number of frames, from a registered CT's segmentation, "
        "and say how much of it a reconstruction will show.",
        examples=EXAMPLE,
    )
    add_placed_labels_options(parser)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="PLAN.json", help="where to write the passes and their poses")
    aim = parser.add_mutually_exclusive_group()
    aim.add_argument(
        "--target",
        default="interspinous",
        metavar="NAME",
        help="interspinous (borders of the gaps), posterior (bone that faces the back), all, or a label, by name or number "
        "(default: %(default)s)",
    )
    aim.add_argument(
        "--unseen",
        type=Path,
        metavar="PATHS.json",
        help="in place of bone, the windows that the report of aifrecon paths tells as not seen",
    )
    parser.add_argument("--frames", type=int, default=FRAMES, metavar="N", help="of all passes together (default: %(default)s)")
    parser.add_argument(
        "--candidates",
        choices=CANDIDATES,
        default=FREEHAND,
        help="what the probe can do: freehand slides and tilts; a wearable device tilts by 35 degrees where it is strapped on "
        "(default: %(default)s)",
    )
    parser.add_argument("--preview", type=Path, metavar="FILE.png", help="also draw the passes over the bone (needs matplotlib)")
    like = parser.add_argument_group("probe", "what the images will be like")
    like.add_argument(
        "--probe-like",
        type=Path,
        metavar="SEQUENCE",
        help="a recording of the probe, best of this patient, whose skin it tells",
    )
    add_sweep_options(parser, several=False)
    parser.show_first("bone_labels", "ct", "bone_transform", "target", "frames", "probe_like", "config", "preview", "quiet")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Read, plan, write, and say what each pass adds."""
    arguments.sequence = arguments.probe_like
    refuse_to_overwrite(arguments, "output", "preview")
    if arguments.frames < 1:
        raise SettingsError(f"Input frames must be 1 or more; got {arguments.frames!r}. Give --frames N.")
    check_files(arguments.output)
    check_preview(arguments.preview)
    with ProgressBar() as progress:
        labels = required_labels(arguments, part(progress, 0.0, 0.05))
        placed = place_from(arguments)
        like = sequence_from(arguments) if arguments.probe_like else None
        bone, probe, assumed = patient_and_probe(labels, placed, like, recipe_from(arguments), part(progress, 0.05, 0.1))
        notes = (*labels.notes, *assumed)
        if arguments.unseen:
            bone, arguments.target = window(bone, _unseen(arguments.unseen)), NOT_SEEN
        plan = plan_scan(bone, probe, arguments.target, arguments.frames, arguments.candidates, progress=part(progress, 0.1, 0.95))
        write_text(arguments.output, json.dumps(plan.to_dict()) + "\n")
        written = [arguments.output]
        if arguments.preview:
            _draw(arguments.preview, plan, bone, probe)
            written.append(arguments.preview)
    print(
        "\n".join(
            [
                *_lines(plan),
                *covered(plan.met).lines(),
                *(f"  {in_options(note)}" for note in [*notes, *(f"wrote {path}" for path in written)]),
            ]
        )
    )


def _unseen(path: Path) -> Floats:
    """The places of a report of paths; FileFormatError when the file is none."""
    table = read_table(path, FileFormatError)
    try:
        return unseen_of(table)
    except (ValueError, AIFReconError) as error:
        raise FileFormatError(f"{path}: it is no report of paths ({error}). Make one with aifrecon paths --report.") from None


def _lines(plan: ScanPlan) -> list[str]:
    rows = [("pass", "frames", "adds", "")]
    rows += [(str(n), str(len(one.image_to_reference)), f"{one.adds_cm2:.2f} cm2", one.name) for n, one in enumerate(plan.passes, start=1)]
    head = (
        f"{plan.frames} frames in {len(plan.passes)} passes are expected to show {plan.predicted_visibility:.0%} of {plan.target} where "
        f"they meet it, {plan.predicted_of_reachable:.0%} of what can be reached"
    )
    return [head, *columns(rows).split("\n")]


def _draw(path: Path, plan: ScanPlan, bone: GuidedBone, probe: ProbeOnBack) -> None:
    to_patient = invert(bone.patient_to_reference)
    poses = to_patient @ np.concatenate([one.image_to_reference for one in plan.passes])
    surface = transform_points(to_patient, bone.surface.points_reference)
    title = f"{plan.frames} frames for {plan.target}: {plan.predicted_of_reachable:.0%} of what can be reached is expected to show"
    frames = [len(one.image_to_reference) for one in plan.passes]
    plan_figure(path, surface, plan.met.best_cosine, probe.images.faces(poses), poses[:, :3, 1], frames, title)
