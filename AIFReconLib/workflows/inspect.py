"""What a recording holds and lacks, and what a reconstruction would make of it, before one is made."""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import Matrix
from ..bone.echoes.surface import default_bone
from ..compounding.methods.table import method_named
from ..errors import AIFReconError
from ..geometry.labels import Labels
from ..imaging.beams import LINEAR, SECTOR
from ..inspection.diagnosis import SequenceReport, diagnose
from ..progress import Progress
from ..recipe.recipe import Recipe
from ..registration.labeled_bone import LabeledBone
from ..sweep.frames import TrackedSequence
from .reconstruct import ReconstructionPlan, plan
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
    try:
        if labels is None:
            # As the reconstruction will decide
            recipe, shown, unasked = default_bone(sequence, recipe, progress)
            has_bone, unasked = shown is not None, unasked if shown is None else shown.notes
        planned = plan(sequence, recipe, has_bone=has_bone, poses=diagnosis.poses)
    except AIFReconError as error:
        return _InspectionOutput(diagnosis, problem=error)
    notes = (*planned.notes, *unasked)
    if labels is None:
        return _InspectionOutput(diagnosis, planned, notes=notes)
    labeled = LabeledBone(labels, placed, sequence, recipe)
    comparison = labeled.comparison()
    is_placed = comparison is None or comparison.agreement is None or comparison.agreement.enough
    lines = labeled.lines(planned.method) if method_named(planned.method).needs_bone else []
    told = calibration_by([sequence], labels, placed, recipe).lines if is_placed else []
    return _InspectionOutput(diagnosis, planned, None, notes, (*labeled.labels.notes, *lines, *told), is_placed)
