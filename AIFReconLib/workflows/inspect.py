"""What a recording holds and lacks, and what a reconstruction would make of it, before one is made."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..arrays import Matrix
from ..bone.echoes.surface import default_bone
from ..compounding.methods.table import method_named
from ..effective_settings import takes_out_motion
from ..errors import AIFReconError
from ..geometry.labels import Labels
from ..imaging.beams import LINEAR, SECTOR
from ..inspection.diagnosis import SequenceReport, diagnose
from ..message import Sentence
from ..progress import Progress
from ..recipe.recipe import AUTOMATIC, Recipe
from ..registration.labeled_bone import LabeledBone
from ..sweep.frames import TrackedSequence
from .job import ReconstructionJob
from .reconstruct import ReconstructionPlan, plan, without_motion
from .register import calibration_by


@dataclass(frozen=True, eq=False)
class _InspectionOutput:
    """What was found."""

    diagnosis: SequenceReport
    planned: ReconstructionPlan | None = None  #: None where nothing can be made of it
    problem: AIFReconError | None = None  #: Why, where the recording itself is ready
    notes: tuple[str, ...] = ()
    bone: tuple[str, ...] = ()  #: What is to be said of the CT's bone, and of the calibration by it
    is_placed: bool = True  #: The CT lies on the sweep, as far as that can be told


def inspected(
    sequence: TrackedSequence, recipe: Recipe, labels: Labels | None, placed: Matrix | None, progress: Progress | None = None
) -> _InspectionOutput:
    """Look at a recording, and at the bone of a CT where there are labels, which a (4, 4) rigid transform places."""
    probe = recipe.probe if recipe.probe == LINEAR else SECTOR if recipe.apex_px else None
    given = probe and f"{probe} (as given)"
    diagnosis = diagnose(sequence, recipe.image_to_reference, recipe.reference, progress, given, labels is not None)
    if not diagnosis.ready:
        return _InspectionOutput(diagnosis)
    has_bone = labels is not None
    unasked: tuple[str, ...] = ()
    labeled = None if labels is None else LabeledBone(labels, placed, sequence, recipe)
    job, motion = without_motion(ReconstructionJob(sequence, replace(recipe, motion=AUTOMATIC), labeled), progress)
    is_mended = takes_out_motion(recipe, None if has_bone else sequence.configuration.method)
    # As the reconstruction will see it
    mended = job.sequence if is_mended else sequence
    moved: tuple[str, ...] = () if motion is None else motion.lines
    if motion is not None and motion.applied and not is_mended:
        moved = (Sentence(f"WARNING: {motion.moved} That stays in the volume.", "Give {motion:auto} to take it out."),)
    try:
        if labels is None:
            recipe, shown, unasked = default_bone(mended, recipe, progress)
            has_bone, unasked = shown is not None, unasked if shown is None else shown.notes
        planned = plan(mended, recipe, has_bone=has_bone)
    except AIFReconError as error:
        return _InspectionOutput(diagnosis, problem=error)
    notes = (*moved, *planned.notes, *unasked)
    if labeled is None:
        return _InspectionOutput(diagnosis, planned, notes=notes)
    labeled = labeled.seen_by(mended)
    comparison = labeled.comparison()
    is_placed = comparison is None or comparison.agreement is None or comparison.agreement.enough
    lines = labeled.lines(planned.method) if method_named(planned.method).needs_bone else []
    told = calibration_by([sequence], labeled.labels, placed, recipe, motion=motion).lines if is_placed else []
    return _InspectionOutput(diagnosis, planned, None, notes, (*labeled.labels.notes, *lines, *told), is_placed)
