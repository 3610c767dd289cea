"""`aifrecon plan`: the passes that will show a target."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, ClassVar

import numpy as np

from ..arrays import Floats
from ..errors import AIFReconError, FileFormatError
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
from ..terminal.arguments import Names, Output, Rivals, count
from ..terminal.console import ProgressBar
from ..terminal.labels_options import PlacedLabelsOptions, place_from, required_labels
from ..terminal.outputs import tell
from ..terminal.sequence_options import SweepOptions, sequences_from


class _PlanOptions(PlacedLabelsOptions, SweepOptions):
    """Choose the passes of a scan that show most of a target with a number of frames, from a registered CT's segmentation, and say how
    much of it a reconstruction will show.

    Parameters
    ----------
    output : PLAN.json
        where to write the passes and their poses
    target : NAME
        interspinous (borders of the gaps), posterior (bone that faces the back), all, or a label, by name or number
    unseen : PATHS.json
        in place of bone, the windows that the report of aifrecon paths tells as not seen
    frames : N
        of all passes together
    candidates
        what the probe can do: freehand slides and tilts; a wearable device tilts by 35 degrees where it is strapped on
    preview : FILE.png
        also draw the passes over the bone (needs matplotlib)
    probe_like : SEQUENCE
        a recording of the probe, best of this patient, whose skin it tells

    Examples
    --------
      aifrecon plan --bone-labels lumbar.nrrd --bone-transform CTToReference.tfm --output plan.json
      aifrecon plan --bone-labels lumbar.nrrd --bone-transform CTToReference.tfm --unseen paths.json --frames 60 --output plan.json
    """

    output: Output
    target: str = "interspinous"
    unseen: Path | None = None
    frames: Annotated[int, count] = 180
    candidates: Annotated[str, CANDIDATES] = FREEHAND
    preview: Output | None = None
    probe_like: Path | None = None

    RIVALS: ClassVar[Rivals] = (("target", "unseen"),)
    FIRST: ClassVar[Names] = ("bone_labels", "ct", "bone_transform", "target", "frames", "probe_like", "config", "preview", "quiet")


def run(asked: _PlanOptions) -> None:
    """Read, plan, write, and say what each pass adds."""
    with ProgressBar() as progress:
        labels = required_labels(asked, part(progress, 0.0, 0.05))
        placed = place_from(asked)
        like = sequences_from(asked, [asked.probe_like])[0] if asked.probe_like else None
        bone, probe, assumed = patient_and_probe(labels, placed, like, asked.recipe, part(progress, 0.05, 0.1))
        notes = (*labels.notes, *assumed)
        if asked.unseen:
            bone, asked.target = window(bone, _unseen(asked.unseen)), NOT_SEEN
        plan = plan_scan(bone, probe, asked.target, asked.frames, asked.candidates, progress=part(progress, 0.1, 0.95))
        write_text(asked.output, json.dumps(plan.to_dict()) + "\n")
        if asked.preview:
            _draw(asked.preview, plan, bone, probe)
    tell("\n".join([*_lines(plan), *covered(plan.met).lines()]), notes, [asked.output, asked.preview])


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
