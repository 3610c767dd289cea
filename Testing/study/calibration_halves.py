"""A real bone, calibrated on one half of its frames and measured on the other: the fibula of shared/data."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from measured import table

from AIFReconLib.bone.field import BoneField
from AIFReconLib.calibration.calibration import calibrate
from AIFReconLib.calibration.certainty import BLOCKS, median_distance
from AIFReconLib.calibration.crossing import calibrate_by_crossing
from AIFReconLib.calibration.echoes import Correction, ImagedEchoes, imaged_echoes
from AIFReconLib.calibration.solve import COARSE, FINE, FINE_ECHOES, PARAMETERS, Solved, descend
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.evaluation.visibility import SweepBeams, bone_truth
from AIFReconLib.imaging.beams import LINEAR
from AIFReconLib.recipe.recipe import Recipe, ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.sweep.edits import corrected
from AIFReconLib.sweep.frames import TrackedSequence

from .real_bone_cases import HOLE_LIMIT, PASS_GAP, SPACING, RealBone

PLACE_ALONE = np.zeros(len(PARAMETERS), dtype=bool)
METHOD = "weighted"


def halves_on_bone(bone: RealBone) -> str:
    """A line for each half: what it makes of the other, and what the other makes of itself."""
    recipe, field = Recipe(probe=LINEAR), BoneField.from_labels(bone.labels)
    lines = []
    for name, one, other in _halves(bone):
        echoes = imaged_echoes(other, recipe)
        found, itself = (calibrate(half, bone.labels, np.eye(4), recipe=recipe) for half in (one, other))
        crossed = calibrate_by_crossing(one, recipe=recipe)
        given = _rest(echoes, field, Correction.none(echoes.center))
        rests = [_rest(echoes, field, each.correction) for each in (found, itself, crossed)]
        off = [median_distance(echoes, field, rest) for rest in (given, *rests)]
        before = _measured(bone, other, given, recipe)
        mended = corrected(other, found.image_correction)
        after = _measured(bone, mended, rests[0], replace(recipe, time_offset=found.correction.delay))
        cells = [f"{off[0]:.3f}", *(f"{each:.3f} ({each / off[0] - 1:+.0%})" for each in off[1:])]
        lines.append([name, *cells, *(f"{there / here:.2f}" for here, there in zip(before, after, strict=True))])
    of_half = ("calibrated on", "the other half, as given", "calibrated", "calibrated on itself", "without the CT")
    return table((*of_half, "CNR, times", "coverage, times"), lines) + "\n"


def _halves(bone: RealBone) -> Iterator[tuple[str, TrackedSequence, TrackedSequence]]:
    """Both ways round: every other ten frames, every other quarter of each pass, and the first and second half of all frames."""
    whole = bone.sequence
    frames = np.arange(len(whole.records))
    passes = np.concatenate([[0], np.cumsum(np.diff(whole.timestamps) > PASS_GAP)])
    first, count = np.searchsorted(passes, passes), np.bincount(passes)[passes]
    for names, chosen in (
        (("every other ten frames", "the others"), frames // 10 % 2 == 0),
        (("quarters 1 and 3 of each pass", "quarters 2 and 4"), (frames - first) * BLOCKS // count % 2 == 0),
        (("the first half in time", "the second"), frames < len(frames) // 2),
    ):
        one, other = _chosen(whole, chosen), _chosen(whole, ~chosen)
        yield names[0], one, other
        yield names[1], other, one


def _chosen(sequence: TrackedSequence, frames: np.ndarray) -> TrackedSequence:
    records = [record for record, kept in zip(sequence.records, frames, strict=True) if kept]
    return replace(sequence, images=np.asarray(sequence.images)[frames], records=records)


def _rest(echoes: ImagedEchoes, bone: BoneField, correction: Correction) -> Solved:
    """Where the CT comes to lie by this calibration."""
    start = Solved(np.eye(4), correction, math.nan)
    return descend(echoes.spread(FINE_ECHOES), bone, start, (COARSE[1], *FINE), PLACE_ALONE)


def _measured(bone: RealBone, sequence: TrackedSequence, rest: Solved, recipe: Recipe) -> tuple[float, float]:
    """CNR and coverage of the volume."""
    place = rest.labels_to_reference
    settings = ReconstructionSettings(method=METHOD, spacing=SPACING, hole_limit=HOLE_LIMIT)
    settings = replace(settings, probe=LINEAR, time_offset=recipe.time_offset)
    result = reconstruct(sequence, settings, LabeledBone(bone.labels, place, sequence, recipe).map(METHOD))
    truth = bone_truth(bone.labels.placed_by(place), SweepBeams.of_sequence(sequence, recipe))
    numbers = evaluate(result.intensity, truth, result.mask)
    return numbers.bone.cnr, numbers.bone.coverage
