"""How well the bone of a placed CT and the bone echoes of a sweep agree, in numbers and in one sentence."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..arrays import Floats, Integers, Mask
from ..geometry.transforms import invert, transform_points
from ..message import listed
from .bone_field import BoneField
from .echoes import SweepEchoes

CLOSE = 2.0
"""mm from the surface within which an echo agrees with bone."""

TIGHT = 0.5
"""mm. Scale of the distances that tell the right place from one that only resembles it."""

NEAR = 10.0
"""mm from bone beyond which an echo says nothing about the registration: it is of bone that the labels lack, or of something else."""

ENOUGH, ENOUGH_OF_LABEL, LARGEST_MEDIAN = 0.7, 0.4, 0.45
"""A registration is believed from this share of agreeing echoes, of all and of each bone, and up to this median distance in mm.
docs/registration.md has right and wrong ones: the median is 0.2 to 0.4 mm in the right place, a real bone's included, and 0.5 mm or more
5 mm off, a level off, or with another patient's CT. A level off, a bone also stands where no sound came back from, and few of its echoes
agree."""

WIDTH_PER_MM, LEAST_WIDTH, LARGEST_WIDTH = 3.0, 1.5, 6.0
"""Width of the bone map for each mm within which three quarters of the echoes lie, and its limits, mm. Three widths of the Gaussian hold
nearly all of the bone that is that far off: 1.7 mm for the fibula where it is, 2.3 to 3.5 mm with it 1 mm off, 6 mm from 4 mm on."""

SURE_WIDTH = 2.0
"""mm. A bone map that has to be wider than this is believed the less: the CT's surface is one of many that bone may have."""

LABEL_ECHOES = 0.05
"""Share of all echoes near bone that must be a label's before it is judged alone."""

ENTERING = 0.1
"""Cosine between beam and surface below which sound would come out of bone, or graze it, and no echo comes back."""

COVER_FROM, COVER_TO, COVER_STEP, COVER_DEPTH = 3.0, 45.0, 1.5, 1.0
"""mm before an echo where bone is looked for, how finely, and how deep in bone counts: bone there would have stopped the beam."""


@dataclass(frozen=True, eq=False)
class EchoFit:
    """Echo by echo, how a placed CT explains them."""

    distances: Floats  #: (n,), mm. Signed distance to bone, positive before the surface or beside it.
    reachable: Mask  #: (n,). Whether the sound enters bone there and no bone lies before it.

    @property
    def near(self) -> Mask:
        """Echoes that say something about the registration, (n,) bool."""
        return self.distances <= NEAR

    @property
    def agreeing(self) -> Mask:
        """Echoes within `CLOSE` of bone that their beams could reach, (n,) bool."""
        agreeing: Mask = (np.abs(self.distances) <= CLOSE) & self.reachable
        return agreeing


@dataclass(frozen=True)
class LabelAgreement:
    """How one bone agrees: share of its echoes that do, their median distance in mm, and how many there are."""

    agreement: float
    median_distance: float
    echoes: int


@dataclass(frozen=True)
class Agreement:
    """How a placed CT and a sweep agree."""

    share: float
    """0 to 1. Of the echoes near labeled bone: how many lie within `CLOSE` of bone that their beams could reach."""
    median_distance: float  #: mm. Of the echoes near bone, without sign; NaN without echoes.
    echoes: int  #: Near labeled bone, within `NEAR`
    elsewhere: int  #: Farther away: of bone that the labels lack, or of none
    per_label: dict[int, LabelAgreement] = field(default_factory=dict)
    tightness: float = 0.0
    """0 to 1. Mean over all echoes, wherever they lie, of exp(-d^2 / 2 t^2) for those that their beams could reach, t = `TIGHT`: what
    decides between places that are far apart. A wrong place may explain more echoes than the right one of a CT that shows fewer bones than
    the sweep, but never so closely."""
    upper_quartile: float = float("nan")
    """mm. Three quarters of the echoes near bone whose beams enter it lie nearer, without sign; NaN without such."""

    @property
    def bone_width(self) -> float:
        """Width of the bone map that goes with such an agreement, mm: as narrow as the bone lies sure, in steps of 0.1 mm."""
        if not np.isfinite(self.upper_quartile):
            return LARGEST_WIDTH
        return round(float(np.clip(WIDTH_PER_MM * self.upper_quartile, LEAST_WIDTH, LARGEST_WIDTH)), 1)

    @property
    def bone_belief(self) -> float:
        """How far that map is to be believed, 0 to 1, in steps of 0.01: it goes on falling where the width has its limit."""
        if not np.isfinite(self.upper_quartile):
            return round(SURE_WIDTH / LARGEST_WIDTH, 2)
        return round(SURE_WIDTH / max(WIDTH_PER_MM * self.upper_quartile, SURE_WIDTH), 2)

    @property
    def explained(self) -> float:
        """Share of all echoes, wherever they lie, that agree."""
        return self.share * self.echoes / max(self.echoes + self.elsewhere, 1)

    @property
    def rank(self) -> tuple[bool, float]:
        """What places are compared by, the better the larger: whether they are to be believed, then how closely echoes lie on bone."""
        return self.enough, self.tightness

    @property
    def enough(self) -> bool:
        """Whether the registration is to be believed, as far as this tells."""
        return self.share >= ENOUGH and self.median_distance <= LARGEST_MEDIAN and not self.disagreeing_labels

    @property
    def disagreeing_labels(self) -> tuple[int, ...]:
        """Bones that do not lie where their echoes are: of another level, or moved since the CT was taken."""
        least = LABEL_ECHOES * self.echoes
        return tuple(label for label, one in self.per_label.items() if one.agreement < ENOUGH_OF_LABEL and one.echoes >= least)

    def sentence(self) -> str:
        """The agreement as users read it."""
        if not self.echoes:
            return f"CT and sweep do not agree: none of {self.elsewhere:,} bone echoes lies near the CT's bone."
        verdict = "agree" if self.enough else "do not agree"
        return (
            f"CT and sweep {verdict}: {self.share:.0%} of {self.echoes:,} bone echoes lie within {CLOSE:g} mm of the CT's bone, "
            f"{self.median_distance:.1f} mm off in the median."
        )

    def warning(self) -> str | None:
        """What is probably wrong, in one sentence; None where CT and sweep agree. What to do about it depends on who asks."""
        if self.enough:
            return None
        if self.share >= ENOUGH and self.median_distance <= LARGEST_MEDIAN:
            labels = listed(f"label {label}" for label in self.disagreeing_labels)
            return f"Not on its echoes: {labels}. The CT may lie one level off, or the spine may have bent since."
        return "The CT is probably not where the bone is, or of another patient."


def fit_echoes(echoes: SweepEchoes, bone: BoneField, labels_to_reference: Floats) -> EchoFit:
    """How each echo lies to bone that stands where `labels_to_reference` puts it."""
    to_labels = invert(labels_to_reference)
    points, beams = transform_points(to_labels, echoes.points), echoes.beams @ to_labels[:3, :3].T
    distances, slopes = bone.sample(points)
    slopes /= np.maximum(np.linalg.norm(slopes, axis=1, keepdims=True), 1e-6)
    reachable = -(slopes * beams).sum(axis=1) >= ENTERING
    # Only what would agree otherwise needs to be followed back
    followed = np.flatnonzero(reachable & (np.abs(distances) <= CLOSE))
    before = points[followed, None] - np.arange(COVER_FROM, COVER_TO, COVER_STEP)[None, :, None] * beams[followed, None]
    reachable[followed] = (bone.distances(before) > -COVER_DEPTH).all(axis=1)
    return EchoFit(distances, reachable)


def check(echoes: SweepEchoes, bone: BoneField, labels_to_reference: Floats) -> Agreement:
    """How well bone that stands where `labels_to_reference` puts it agrees with the echoes.

    All `echoes` are wanted: counts are part of the answer. `labels_to_reference` is rigid, (4, 4) in mm.
    """
    return agreement_of(*judged(echoes, bone, labels_to_reference))


def judged(echoes: SweepEchoes, bone: BoneField, labels_to_reference: Floats) -> tuple[EchoFit, Integers]:
    """How each echo lies to bone that stands there, and the label that it belongs to, (n,); 0: to none."""
    fit = fit_echoes(echoes, bone, labels_to_reference)
    owners = np.zeros(len(echoes), dtype=np.int64)
    owners[fit.near] = bone.label_at(transform_points(invert(labels_to_reference), echoes.points[fit.near]))
    return fit, owners


def agreement_of(fit: EchoFit, owners: Integers) -> Agreement:
    """The agreement of echoes that are fitted and belong to the labels `owners` (n,); 0: to none in particular."""
    near = fit.near
    distances, agreeing, owners = np.abs(fit.distances[near]), fit.agreeing[near], owners[near]
    per_label = {
        int(label): LabelAgreement(*_share_and_median(agreeing[owners == label], distances[owners == label]), int((owners == label).sum()))
        for label in np.unique(owners[owners > 0])
    }
    tightness = float((np.exp(-0.5 * (np.minimum(np.abs(fit.distances), NEAR) / TIGHT) ** 2) * fit.reachable).mean()) if len(near) else 0.0
    entered = distances[fit.reachable[near]]
    quartile = float(np.percentile(entered, 75)) if len(entered) else float("nan")
    return Agreement(*_share_and_median(agreeing, distances), len(distances), len(near) - len(distances), per_label, tightness, quartile)


def _share_and_median(agreeing: Mask, distances: Floats) -> tuple[float, float]:
    """Share of True, and median in mm; 0 and NaN of none."""
    return (float(agreeing.mean()), float(np.median(distances))) if len(distances) else (0.0, float("nan"))
