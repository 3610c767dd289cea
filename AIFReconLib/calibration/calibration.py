"""A calibration from the scan itself, in one call: solved, judged on what it has not seen, and refused where it must not be used."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Floats, Mask
from ..bone.field import BoneField
from ..errors import require_kind
from ..geometry.transforms import as_matrix
from ..geometry.volume import Volume
from ..message import Sentence, listed
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..registration.agreement import Agreement
from ..registration.comparison import check
from ..registration.registration import LEAST_CLOSENESS
from ..registration.search import anywhere, search
from ..remedies import SCAN_AGAIN
from ..sweep.frames import TrackedSequence
from .certainty import HELD, Halves, compared_halves, deviations, placed_by, spread_of
from .echoes import Correction, ImagedEchoes, imaged_echoes
from .mending import FEWEST_ANGLES, ONE_ANGLE, Mending, advice_for, doubt_of
from .solve import ALL, COARSE, EXPECTED, FINE, FINE_ECHOES, PARAMETERS, Solved, as_correction, as_vector, descend, named, solve

PLACES = 3
"""Places of the CT from which is started where none is given."""

AS_GOOD, ELSEWHERE = 0.05, 1.5
"""Cost by which another solution may be worse, and mm by which it must place echoes elsewhere, to make the answer ambiguous."""


@dataclass(frozen=True, eq=False, repr=False)
class Calibration(Mending):
    """What a sweep and a CT say of the calibration that the sweep came with."""

    labels_to_reference: Floats  #: (4, 4), mm. Where the CT lies, by the new calibration.
    before: Agreement  #: Of the calibration as given, the CT's place refined
    after: Agreement
    uncertainty: float  #: mm. Echoes are placed on the bone within this in the median, 9 times in 10.
    given: Solved  #: The CT's place by the calibration as given

    def _facts(self) -> list[tuple[str, str]]:
        return [("accepted", str(self.accepted)), ("needed", str(self.needed)), ("determined", listed(named(self.held)) or "nothing")]

    @property
    def needed(self) -> bool:
        """Whether it moves echoes by more than it is sure of; else what was given needs no change."""
        return self.changed > self.uncertainty

    @property
    def echoes_on_bone(self) -> tuple[Floats, Floats]:
        """Where the echoes lie in the labels' frame by the calibration as given and by the new one, (n, 3) mm each."""
        return placed_by(self.given, self.echoes), placed_by(Solved(self.labels_to_reference, self.correction, 0.0), self.echoes)


def calibrate(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    labels: Volume,
    start: Floats | None = None,
    *,
    recipe: Recipe | None = None,
    progress: Progress | None = None,
) -> Calibration:
    """What is wrong with a sweep's calibration and delay, from the bone of a CT that the sweep shows from several angles.

    Parameters
    ----------
    sequences : TrackedSequence or several in one Reference, all of one calibration
    labels : Volume of integers
        Of any bone that the sweep shows: the patient's spine, a phantom, a dry bone in water.
    start : (4, 4) array or None, mm
        labels_to_reference, about right; None: where they lie if that is on the sweep, else the place is looked for, their axes being the
        patient's.
    recipe : Recipe or None
        As in `reconstruct`.

    Raises
    ------
    AIFReconError
        For input that cannot be used. A calibration that must not be used is no error: see `Calibration.refusal`.
    """
    require_kind("labels", labels, Volume, "Read it first: read_labels(path).")
    start = None if start is None else as_matrix(start, "start")
    bone = BoneField.from_labels(labels)
    echoes = imaged_echoes(sequences, recipe, part(progress, 0.0, 0.3))
    return calibrate_echoes(echoes, bone, start, part(progress, 0.3, 1.0))


def calibrate_echoes(echoes: ImagedEchoes, bone: BoneField, start: Floats | None = None, progress: Progress | None = None) -> Calibration:
    """`calibrate`, for echoes and a field that are there already."""
    asked = ALL if echoes.timed else np.arange(len(PARAMETERS)) < len(PARAMETERS) - 1
    none = Correction.none(echoes.center)
    placed = echoes.placed(none)
    if start is None and check(placed, bone, np.eye(4)).enough:
        # The CT lies on the sweep as it is
        start = np.eye(4)
    places = [start]
    if start is None:
        found = search(placed, bone, anywhere(placed, bone), part(progress, 0.0, 0.3))
        places = [place.labels_to_reference for place in found[:PLACES]]
    starts = [place for place in places if place is not None]
    solutions = solve(echoes, bone, starts, asked, part(progress, 0.3, 0.8))
    many = echoes.spread(FINE_ECHOES)
    best = solutions[0]
    report(progress, 0.8, "Judging the calibration")
    nothing = np.zeros(len(PARAMETERS), dtype=bool)
    near = (best.labels_to_reference, *starts)
    as_given = [descend(many, bone, Solved(place, none, 1.0), (*COARSE, FINE[-1]), nothing) for place in near]
    given = min(as_given, key=lambda one: one.cost)
    deviation = np.full(len(PARAMETERS), np.nan)
    deviation[asked] = deviations(many, bone, best, asked)
    free = np.nan_to_num(deviation, nan=np.inf) <= HELD
    deviation *= EXPECTED
    if (free != asked).any():
        # Along what is not held, any answer would do
        best = descend(many, bone, replace(given, correction=_only(free, best.correction)), (*COARSE, *FINE), free)
        # Turns about two axes are a little of one about the third
        best = replace(best, correction=_only(free, best.correction))
    sides = compared_halves(echoes, bone, given, best, free)
    before, after = (check(echoes.placed(one.correction), bone, one.labels_to_reference) for one in (given, best))
    changed = float(np.median(np.linalg.norm(placed_by(best, echoes) - placed_by(given, echoes), axis=1)))
    reason = _refusal(echoes, best, solutions[1:], free, after, sides)
    report(progress, 1.0, "Calibrated")
    uncertainty = spread_of(many, bone, best, asked, sides.apart)
    place = best.labels_to_reference
    return Calibration(best.correction, free, deviation, sides, changed, reason, echoes, place, before, after, uncertainty, given)


def _only(free: Mask, correction: Correction) -> Correction:
    """The numbers of a correction that are free, (9,); the others stay as given."""
    return as_correction(np.where(free, as_vector(correction), 0.0), correction.center)


def _refusal(echoes: ImagedEchoes, best: Solved, others: list[Solved], free: Mask, after: Agreement, sides: Halves) -> Sentence | None:
    """Why a solution must not be used, in one sentence or two; None where it may."""
    angles = int(echoes.angles.max()) + 1
    if angles < FEWEST_ANGLES:
        return ONE_ANGLE
    if not free.any():
        return Sentence(advice_for(ALL) or "")
    if not after.enough or after.closeness > LEAST_CLOSENESS:
        return Sentence(
            f"No calibration near this one lays the sweep on the CT's bone. {after.sentence()}",
            "Check that both are of one bone; leave out the CT first, and start from what that finds; or see {calibrate} "
            "with {check}, which looks for mirrored images and the like.",
        )
    rival = next((one for one in others if one.cost < best.cost + AS_GOOD and _apart(best, one, echoes) > ELSEWHERE), None)
    if rival is not None:
        return Sentence(f"Two calibrations fit as well and lie {_apart(best, rival, echoes):.1f} mm apart.", SCAN_AGAIN)
    return doubt_of(sides.apart, best.correction, free)


def _apart(one: Solved, other: Solved, echoes: ImagedEchoes) -> float:
    return float(np.median(np.linalg.norm(placed_by(one, echoes) - placed_by(other, echoes), axis=1)))


def findings(found: Calibration) -> list[str]:
    """What a user should know, one line each."""
    lines = [
        f"as given: {found.before.median_distance:.2f} mm off the bone in the median, {found.before.share:.0%} of the echoes agree; "
        f"calibrated: {found.after.median_distance:.2f} mm, {found.after.share:.0%}",
        found.by_halves,
    ]
    if found.accepted:
        within = f"image points are placed within {found.uncertainty:.1f} mm of the CT's bone in the median"
        lines.append(f"{within}; the change is {found.changed:.1f} mm")
        if not found.needed:
            lines.append("the calibration as given agrees with this sweep: there is no need to change it")
    return [*lines, *found.lines()]


def as_report(found: Calibration) -> dict[str, object]:
    """The calibration as JSON holds it, see `Mending.report`."""
    sides = {"before": found.before, "after": found.after}
    return {
        **found.report(),
        "transform": found.labels_to_reference.tolist(),
        "agreement": {name: round(side.share, 4) for name, side in sides.items()},
        "median_distance_mm": {name: round(side.median_distance, 4) for name, side in sides.items()},
        "uncertainty_mm": round(found.uncertainty, 4),
    }
