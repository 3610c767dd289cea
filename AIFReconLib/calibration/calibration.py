"""A calibration from the scan itself, in one call: solved, judged on what it has not seen, and refused where it must not be used."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

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
from ..remedies import ADD_TIME_OFFSET, SCAN_AGAIN
from ..sweep.frames import TrackedSequence
from .certainty import HELD, Halves, compared_halves, deviations, placed_by, spread_of
from .echoes import Correction, ImagedEchoes, Mending, imaged_echoes
from .solve import ALL, COARSE, EXPECTED, FINE, FINE_ECHOES, PARAMETERS, UNITS, Solved, as_correction, as_vector, descend, in_words, solve

PLACES = 3
"""Places of the CT from which is started where none is given."""

FEWEST_ANGLES = 2

ONE_ANGLE = Sentence(
    "The sweep shows bone from one angle alone, and one angle says nothing of a calibration. Scan the same bone there and back with the "
    "probe tilted to all sides and turned by 90 degrees."
)

FARTHEST = 4.0
"""Times `EXPECTED`: a calibration that is more wrong than that is wrong in another way, see check.py."""

HALVES_APART = 0.8
"""mm. Farther apart the calibrations of two halves of a sweep do not tell the same."""

AS_GOOD, ELSEWHERE = 0.05, 1.5
"""Cost by which another solution may be worse, and mm by which it must place echoes elsewhere, to make the answer ambiguous."""

DEPTHS = 10.0
"""mm. Echoes are told of in steps of that depth."""

MOVEMENTS = {
    "there and back": ("delay",),
    "tilted within its image plane": ("shift across", "shift along"),
    "tilted out of its image plane": ("shift out of the image", "shift along"),
    "turned by 90 degrees": ("turn about across", "turn about along", "turn in the image"),
    "so that bone is seen at both sides of the image": ("size across",),
    "so that bone is seen near and deep": ("size along",),
}
"""How to move the probe over the same bone, and what that would tell."""


@dataclass(frozen=True, eq=False, repr=False)
class Calibration(Mending):
    """What a sweep and a CT say of the calibration that the sweep came with."""

    correction: Correction
    labels_to_reference: Floats  #: (4, 4), mm. Where the CT lies, by the new calibration.
    held: Mask  #: (9,). Which numbers of the correction the sweep holds, in the order of `solve.PARAMETERS`; the others stay as given.
    deviation: Floats  #: (9,). Standard deviation of each, in mm, radians, parts and s; NaN where it is not held.
    before: Agreement  #: Of the calibration as given, the CT's place refined
    after: Agreement
    halves: Halves
    uncertainty: float  #: mm. Echoes are placed on the bone within this in the median, 9 times in 10.
    changed: float  #: mm. How far the correction moves the echoes on the bone, in the median.
    said: str | None  #: Why it must not be used; None where it may be
    given: Solved  #: The CT's place by the calibration as given
    bone: BoneField = field(repr=False)
    echoes: ImagedEchoes = field(repr=False)

    def _facts(self) -> list[tuple[str, str]]:
        return [("accepted", str(self.accepted)), ("held", listed(self.names(self.held)) or "nothing")]

    @property
    def values(self) -> Floats:
        """(9,): the correction in the order of `solve.PARAMETERS`, mm, radians, parts, s."""
        return as_vector(self.correction)

    @property
    def echoes_on_bone(self) -> tuple[Floats, Floats]:
        """Where the echoes lie in the labels' frame by the calibration as given and by the new one, (n, 3) mm each."""
        return placed_by(self.given, self.echoes), placed_by(Solved(self.labels_to_reference, self.correction, 0.0), self.echoes)

    @staticmethod
    def names(chosen: Mask) -> list[str]:
        """Words for some of the nine numbers."""
        return [name for name, one in zip(PARAMETERS, chosen, strict=True) if one]

    @property
    def advice(self) -> str | None:
        """Which movement of the probe would tell what this sweep does not; None where it tells all."""
        return advice_for(self.names(~self.held))


def advice_for(missing: list[str]) -> str | None:
    """What is said of numbers, by their names, that a sweep does not hold; None of none."""
    moves = [move for move, tells in MOVEMENTS.items() if set(tells) & set(missing)]
    if not missing:
        return None
    return f"Not determined by this sweep, and left as given: {listed(missing)}. Scan the same bone with the probe also {listed(moves)}."


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
    given = min((_as_given(many, bone, place, none) for place in (best.labels_to_reference, *starts)), key=lambda one: one.cost)
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
    said = _refusal(echoes, best, solutions[1:], free, after, sides)
    report(progress, 1.0, "Calibrated")
    return Calibration(
        best.correction,
        best.labels_to_reference,
        free,
        deviation,
        before,
        after,
        sides,
        spread_of(many, bone, best, asked, sides.apart),
        changed,
        said,
        given,
        bone,
        echoes,
    )


def _only(free: Mask, correction: Correction) -> Correction:
    """The numbers of a correction that are free, (9,); the others stay as given."""
    return as_correction(np.where(free, as_vector(correction), 0.0), correction.center)


def _as_given(echoes: ImagedEchoes, bone: BoneField, place: Floats, none: Correction) -> Solved:
    return descend(echoes, bone, Solved(place, none, 1.0), (*COARSE, FINE[-1]), np.zeros(len(PARAMETERS), dtype=bool))


def _refusal(echoes: ImagedEchoes, best: Solved, others: list[Solved], free: Mask, after: Agreement, sides: Halves) -> Sentence | None:
    """Why a solution must not be used, in one sentence or two; None where it may."""
    angles = int(echoes.angles.max()) + 1
    if angles < FEWEST_ANGLES:
        return ONE_ANGLE
    if not free.any():
        return Sentence(advice_for(list(PARAMETERS)) or "")
    if not after.enough or after.closeness > LEAST_CLOSENESS:
        return Sentence(
            f"No calibration near this one lays the sweep on the CT's bone. {after.sentence()}",
            "Check that both are of one bone; leave out the CT first, and start from what that finds; or see {calibrate} "
            "with {check}, which looks for mirrored images and the like.",
        )
    rival = next((one for one in others if one.cost < best.cost + AS_GOOD and _apart(best, one, echoes) > ELSEWHERE), None)
    if rival is not None:
        return Sentence(f"Two calibrations fit as well and lie {_apart(best, rival, echoes):.1f} mm apart.", SCAN_AGAIN)
    return doubt_of_halves(sides.apart) or doubt_of_size(best.correction, free)


def doubt_of_halves(apart: float) -> Sentence | None:
    """Why a calibration must not be used whose halves of the sweep place echoes so many mm apart; None where they agree."""
    if apart <= HALVES_APART:
        return None
    return Sentence(f"The halves of this sweep give calibrations that lie {apart:.1f} mm apart.", SCAN_AGAIN)


def doubt_of_size(correction: Correction, free: Mask) -> Sentence | None:
    """Why a correction must not be used of which a number that is free, (9,), is larger than calibrations are wrong; None where none is."""
    far = (np.abs(as_vector(correction)) > FARTHEST * EXPECTED) & free
    if not far.any():
        return None
    name, value = PARAMETERS[int(far.argmax())], in_words(as_vector(correction))[int(far.argmax())]
    return Sentence(f"The calibration would have to change by more than calibrations are wrong by ({name} {value:+.1f}).")


def _apart(one: Solved, other: Solved, echoes: ImagedEchoes) -> float:
    return float(np.median(np.linalg.norm(placed_by(one, echoes) - placed_by(other, echoes), axis=1)))


def findings(found: Calibration) -> list[str]:
    """What a user should know, one line each."""
    values, deviations = in_words(found.values), in_words(found.deviation)
    lines = [
        f"as given: {found.before.median_distance:.2f} mm off the bone in the median, {found.before.share:.0%} of the echoes agree; "
        f"calibrated: {found.after.median_distance:.2f} mm, {found.after.share:.0%}",
        f"calibrated on one half of the sweep, the other half lies {found.halves.after:.2f} mm off instead of {found.halves.before:.2f} mm",
    ]
    if found.accepted:
        within = f"image points are placed within {found.uncertainty:.1f} mm of the CT's bone in the median"
        lines.append(f"{within}; the change is {found.changed:.1f} mm")
        if found.changed <= found.uncertainty:
            lines.append("the calibration as given agrees with this sweep: there is no need to change it")
    for name, value, deviation, unit, held in zip(PARAMETERS, values, deviations, UNITS, found.held, strict=True):
        if held:
            lines.append(f"{name}: {value:+.2f} {unit}, give or take {deviation:.2f}")
    if found.held[-1] and abs(found.values[-1]) > 2 * found.deviation[-1]:
        lines.append(Sentence("the delay is not part of a calibration.", ADD_TIME_OFFSET, offset=f"{found.values[-1]:.3f}"))
    if found.advice:
        lines.append(found.advice)
    return lines


def as_report(found: Calibration) -> dict[str, object]:
    """The calibration as JSON holds it: mm, degrees, percent, ms; matrices as nested lists, row by row."""
    values, deviations = in_words(found.values), in_words(found.deviation)
    numbers = {
        f"{name} ({unit})": {"change": round(float(value), 4), "deviation": round(float(deviation), 4), "held": bool(held)}
        for name, value, deviation, unit, held in zip(PARAMETERS, values, deviations, UNITS, found.held, strict=True)
        if np.isfinite(deviation)
    }
    residuals = {
        "by_depth_mm": _residuals(found, np.floor(found.echoes.points[:, 1] / DEPTHS) * DEPTHS),
        "by_angle": _residuals(found, found.echoes.angles[found.echoes.frames].astype(np.float64)),
    }
    return {
        "accepted": found.accepted,
        "refusal": found.refusal,
        "image_correction": found.image_correction.tolist(),
        "transform": found.labels_to_reference.tolist(),
        "numbers": numbers,
        "agreement": {"before": round(found.before.share, 4), "after": round(found.after.share, 4)},
        "median_distance_mm": {"before": round(found.before.median_distance, 4), "after": round(found.after.median_distance, 4)},
        "other_half_mm": {"before": round(found.halves.before, 4), "after": round(found.halves.after, 4)},
        "halves_apart_mm": round(found.halves.apart, 4),
        "uncertainty_mm": round(found.uncertainty, 4),
        "changed_mm": round(found.changed, 4),
        "residuals": residuals,
    }


def _residuals(found: Calibration, of: Floats) -> dict[str, list[float]]:
    """Median distances before and after, mm, of the echoes of each group; `of` (n,) says which."""
    result = {}
    sides = [np.abs(found.bone.sample(points)[0]) for points in found.echoes_on_bone]
    for group in np.unique(of):
        result[f"{group:g}"] = [round(float(np.median(side[of == group])), 3) for side in sides]
    return result
