"""CT to Reference in one call: refined from a start or found without one, judged against its alternatives, bone by bone if asked for."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from ..arrays import Floats
from ..bone.echoes.found import SweepEchoes
from ..bone.echoes.search import sweep_echoes
from ..bone.field import BoneField
from ..effective_settings import takes_out_motion
from ..errors import GeometryError, SettingsError, require_kind
from ..geometry.transforms import as_matrix, transform_points, why_not_rigid
from ..geometry.volume import Volume
from ..message import Judged, Sentence
from ..motion.motion import PatientMotion, find_motion
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..remedies import START_NEARER
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import sweeps_of
from .agreement import Agreement
from .certainty import HELD_MM, UnconstrainedMotion, as_given, not_held, restart_spread
from .comparison import check
from .search import Place, anywhere, around, beside, distinct, finished, level_shifts, mirrored, motion_between, search, shifted
from .segments import Segments, fields_of_labels, fit_segments

AS_GOOD = 0.8
"""A second place whose echoes lie this share as closely on bone as the best one's makes the answer ambiguous; right places have 0.7 at
most."""

OUTNUMBERED = 1.8
"""A place that is believed for the few echoes near it is not, where another explains so many times as many of all."""

LEAST_CLOSENESS = 0.33
"""mm. Closeness beyond which a place that was refined is not the right one: a level off or with another patient's CT it is 0.36 mm or
more, in the right place 0.3 mm or less, a real bone's included. What is only checked need not be refined, so it is judged less
strictly."""

BENT, NEARLY_AS_GOOD = 3, 0.8
"""Most places in which the bones are let loose, and the share of what the best one explains that makes it worth trying."""

WORTH_JUDGING = 0.3
"""Agreement below which it is no use to ask what holds a place."""


@dataclass(frozen=True, eq=False)
class _Alternative:
    """Another place: labels_to_reference (4, 4), how well it agrees, and how many levels higher (+) or lower (-) the CT lies there, or
    None.
    """

    transform: Floats
    agreement: Agreement
    levels: int | None


@dataclass(frozen=True, eq=False, repr=False)
class Registration(Judged):
    """Where the CT belongs, and how sure that is."""

    transform: Floats  #: (4, 4), mm. labels_to_reference, RAS.
    agreement: Agreement  #: Of that place, or, where each bone moved on its own, of the bones where they came to lie
    reason: str | None
    """Sentence. Why the answer must not be used unseen, with options named as on the command line; see `refusal`."""
    loose: tuple[UnconstrainedMotion, ...]  #: Motions that the sweep does not hold
    restarts: float  #: mm. How far apart refinements from nearby starts ended.
    alternatives: tuple[_Alternative, ...]  #: Other places, best first; of which some may be as good
    moved: float | None  #: mm. How far the bone has moved from the start; None without one.
    segments: Segments | None  #: Each bone's own motion
    echoes: SweepEchoes = field(repr=False)
    motion: PatientMotion | None = None  #: That was taken out of the echoes before

    def _facts(self) -> list[tuple[str, str]]:
        return [("accepted", str(self.accepted)), ("agreement", self.agreement.sentence())]

    @property
    def uncertain(self) -> list[str]:
        """What the data do not hold, in words."""
        words = [loose.sentence for loose in self.loose]
        if not words and self.restarts > HELD_MM:
            words = [f"tries that began nearby end {self.restarts:.1f} mm apart"]
        return words


def register(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    labels: Volume,
    start: Floats | None = None,
    *,
    per_segment: bool = False,
    level: int = 0,
    recipe: Recipe | None = None,
    progress: Progress | None = None,
) -> Registration:
    """Lay a CT's bone upon the bone that a sweep shows.

    Parameters
    ----------
    sequences : TrackedSequence or several in one Reference
    labels : Volume of integers
        The CT's segmentation; any label above 0 is bone, one label per vertebra tells levels apart.
    start : (4, 4) array or None, mm
        labels_to_reference, rigid, from which to go; None: the place is looked for.
    per_segment : bool
        Let each label move on its own in the end.
    level : int
        Take the place so many levels higher (lower where negative) than the best one.
    recipe : Recipe or None
        As in `reconstruct`.

    Raises
    ------
    AIFReconError
        For input that cannot be registered. An answer that is ambiguous or does not agree is no error: see `Registration.refusal`.
    """
    # What is wrong with the CT is said before the sweep is read
    require_kind("labels", labels, Volume, "Read it first: read_labels(path).")
    start = None if start is None else _rigid(start)
    bone = BoneField.from_labels(labels)
    sweeps, motion = sweeps_of(sequences, recipe), None
    echoes = sweep_echoes(sweeps, recipe, progress=part(progress, 0.0, 0.4))
    if takes_out_motion(recipe or Recipe()):
        motion = find_motion(sweeps, None, recipe, part(progress, 0.4, 0.5), echoes)
        echoes = echoes if motion is None or not motion.applied else motion.curve.moved(echoes)
    found = register_echoes(echoes, bone, start, per_segment=per_segment, level=level, progress=part(progress, 0.5, 1.0))
    return replace(found, motion=motion)


def register_echoes(
    echoes: SweepEchoes,
    bone: BoneField,
    start: Floats | None = None,
    *,
    per_segment: bool = False,
    level: int = 0,
    progress: Progress | None = None,
) -> Registration:
    """`register`, for echoes and a field that are there already: of the last seconds of a live scan, say.

    Raises SettingsError when a level is asked for of a single bone.
    """
    shifts = level_shifts(bone)
    if level and not shifts:
        raise SettingsError(f"Input level must be 0 for labels of a single bone; got {level}. Give one label per vertebra.")
    given = start
    if start is None and check(echoes, bone, np.eye(4)).enough:
        # The CT lies on the sweep as it is
        start = np.eye(4)
    places = _places(echoes, bone, start, part(progress, 0.0, 0.6))
    places = distinct([*places, *beside(echoes, bone, places[0].labels_to_reference)], echoes)
    fields = fields_of_labels(bone.labels) if per_segment else {}
    segments_of: dict[int, Segments] = {}
    if per_segment:
        # A bent spine fits rigidly a level off nearly as well: the bones decide
        rivals = [place for place in places[:BENT] if place.agreement.explained >= NEARLY_AS_GOOD * places[0].agreement.explained]
        segments_of = {id(place): fit_segments(echoes, fields, place.labels_to_reference) for place in rivals}
        places[: len(rivals)] = sorted(rivals, key=lambda place: segments_of[id(place)].agreement.tightness, reverse=True)
    chosen = places[0]
    if level:
        unit = shifts[1] * np.sign(shifts[1][2] or 1.0)
        chosen = finished(echoes, bone, places[0].labels_to_reference @ shifted(level * unit))
        if per_segment:
            segments_of[id(chosen)] = fit_segments(echoes, fields, chosen.labels_to_reference)

    def judged(place: Place) -> Agreement:
        return segments_of[id(place)].agreement if id(place) in segments_of else place.agreement

    report(progress, 0.7, "Judging the CT's place")
    segments, agreement = segments_of.get(id(chosen)), judged(chosen)
    alternatives = tuple(
        _Alternative(other.labels_to_reference, judged(other), _levels(other, chosen, bone, shifts))
        for other in places
        if other is not chosen
    )
    loose, restarts = [], 0.0
    if chosen.agreement.share >= WORTH_JUDGING:
        place = chosen.labels_to_reference
        loose, restarts = not_held(echoes, bone, place), restart_spread(echoes, bone, place)
    if loose and start is not None and not level and segments is None:
        place = as_given(echoes, bone, chosen.labels_to_reference, start, loose)
        chosen = Place(place, check(echoes, bone, place))
        agreement = chosen.agreement
    moved = None if given is None else motion_between(given, chosen.labels_to_reference, echoes.thinned(200).points)
    refusal = _disagreement(agreement) or (None if level else _ambiguity(agreement, alternatives))
    if refusal is None and mirrored(echoes, bone, chosen.labels_to_reference).agreement.tightness > chosen.agreement.tightness:
        words = "The CT fits more closely mirrored: its left and right, or those of the images, may be swapped."
        refusal = Sentence(words, START_NEARER)
    report(progress, 1.0, "Registered")
    return Registration(chosen.labels_to_reference, agreement, refusal, tuple(loose), restarts, alternatives, moved, segments, echoes)


def _places(echoes: SweepEchoes, bone: BoneField, start: Floats | None, progress: Progress | None) -> list[Place]:
    if start is None:
        return search(echoes, bone, anywhere(echoes, bone), progress)
    report(progress, 0.0, "Refining the CT's place")
    place = finished(echoes, bone, start)
    if place.agreement.enough:
        return [place]
    # The way down led nowhere good: look around
    middle = transform_points(start, bone.middle)
    return distinct([place, *search(echoes, bone, around(start, middle), progress)], echoes)


def _rigid(start: Floats) -> Floats:
    matrix = as_matrix(start, "start")
    problem = why_not_rigid(matrix)
    if problem:
        raise GeometryError(
            f"Input start must be a rigid transform, a turn and a shift; got one that is {problem}. Save it without scaling."
        )
    return matrix


def _levels(place: Place, best: Place, bone: BoneField, shifts: dict[int, Floats]) -> int | None:
    """How many levels higher the CT lies at a place than at the best one."""
    if not shifts:
        return None
    unit = shifts[1] * np.sign(shifts[1][2] or 1.0)
    moved = transform_points(np.linalg.inv(best.labels_to_reference) @ place.labels_to_reference, bone.middle) - bone.middle
    return round(float(moved @ unit / (unit @ unit)))


def _disagreement(agreement: Agreement) -> Sentence | None:
    warning = agreement.warning()
    if warning is None and agreement.closeness > LEAST_CLOSENESS:
        warning = (
            "It fits only roughly even after fine adjustment: the CT may be a level off or of another patient, the spine may have "
            "bent, or the tracking was unsteady."
        )
    if warning is None:
        return None
    return Sentence(
        f"{agreement.sentence()} {warning}",
        ("Start nearer with {bone_transform}, give {per_segment} if the spine has bent, or take it as it is with {accept}."),
    )


def _ambiguity(best: Agreement, others: Iterable[_Alternative]) -> Sentence | None:
    others = list(others)
    most = max((other.agreement.explained for other in others), default=0.0)
    if most > OUTNUMBERED * best.explained:
        return Sentence(
            f"Only {best.explained:.0%} of all echoes agree in the place that fits most closely, and {most:.0%} in one that fits too "
            "roughly.",
            START_NEARER,
        )
    rival = max(others, key=lambda other: other.agreement.tightness, default=None)
    if rival is None or rival.agreement.tightness < AS_GOOD * best.tightness:
        return None
    there = f"{rival.agreement.explained:.0%} of all echoes agree there, {best.explained:.0%} here"
    if rival.levels is None:
        return Sentence(f"The CT's one bone fits nearly as well elsewhere: {there}. More bones would tell.", START_NEARER)
    where = "elsewhere" if not rival.levels else f"{rival.levels:+d} level(s) away (+: toward the head)"
    return Sentence(
        f"The CT fits nearly as well {where}: {there}.",
        "Compare the alternatives, then choose one with {level:N}, or take the best with {accept}.",
    )


def as_report(found: Registration) -> dict[str, object]:
    """The registration as JSON holds it: matrices as nested lists, row by row, labels -> Reference in RAS."""
    by_label = {
        str(label): {"agreement": round(one.agreement, 4), "median_distance_mm": _rounded(one.median_distance), "echoes": one.echoes}
        for label, one in found.agreement.per_label.items()
    }
    for label, place in (found.segments.transforms if found.segments else {}).items():
        by_label.setdefault(str(label), {"agreement": 0.0, "median_distance_mm": None, "echoes": 0})["transform"] = place.tolist()
    return {
        "accepted": found.accepted,
        "refusal": found.refusal,
        "agreement": round(found.agreement.share, 4),
        "median_distance_mm": _rounded(found.agreement.median_distance),
        "echoes": found.agreement.echoes,
        "echoes_elsewhere": found.agreement.elsewhere,
        "transform": found.transform.tolist(),
        "moved_mm": None if found.moved is None else round(found.moved, 3),
        "uncertain": [str(words) for words in found.uncertain],
        "loose": [
            {"kind": one.kind, "axis": [round(float(v), 4) for v in one.axis], "mm" if one.kind == "slide" else "deg": round(one.amount, 2)}
            for one in found.loose
        ],
        "restarts_mm": round(found.restarts, 3),
        "motion": [] if found.motion is None else list(found.motion.lines),
        "alternatives": [
            {
                "transform": other.transform.tolist(),
                "agreement": round(other.agreement.share, 4),
                "explained": round(other.agreement.explained, 4),
                "levels": other.levels,
            }
            for other in found.alternatives
        ],
        "per_label": by_label,
    }


def _rounded(value: float) -> float | None:
    return round(value, 4) if np.isfinite(value) else None
