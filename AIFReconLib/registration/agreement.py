"""What is told of how the bone of a placed CT and the bone echoes of a sweep agree: numbers, and one sentence."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..bone.echoes.found import SweepEchoes
from ..message import listed

CLOSE = 2.0
"""mm from the surface within which an echo agrees with bone."""

TIGHT = 0.25
"""mm. Scale of the distances that tell the right place from one that only resembles it: half the echoes lie within 0.2 mm in the right
place, within 0.4 mm or more a level off or with another patient's CT."""

NEAR = 10.0
"""mm from bone beyond which an echo says nothing about the registration: it is of bone that the labels lack, or of something else."""

ENOUGH, ENOUGH_OF_LABEL, LARGEST_MEDIAN = 0.6, 0.4, 0.45
"""A registration is believed from this share of agreeing echoes, of all and of each bone, and up to this median distance in mm.
docs/registration.md has right and wrong ones: the median is 0.2 to 0.4 mm in the right place, a real bone's included, and 0.5 mm or more
5 mm off, a level off, or with another patient's CT. A level off, a bone also stands where no sound came back from, and few of its echoes
agree."""

WIDTH_PER_MM, LEAST_WIDTH, MISPLACED = 2.0, 1.0, 1.5
"""Width of the bone map for each mm within which three quarters of the echoes lie, and its least, mm: 1.3 mm for the fibula where it is,
2.4 to 2.7 mm with it 1 mm off. Where they lie farther off than the last, the sweep's own echoes tell more of bone than the CT does.
docs/decisions/0030 has what others gave."""

SURE = 0.7
"""mm within which three quarters of the echoes lie when bone is believed in full: the CT's surface is one of many that bone may have."""

BEYOND = 1.0
"""mm beyond nine tenths of the echoes near a misplaced CT, within which its bone may still be. Membranes lie farther off."""

LITTLE_OFF, ELSEWHERE = 5.0, 0.25
"""mm within which nine tenths of the echoes near a CT lie, and share of all echoes that lie elsewhere: up to these it is a little off. A
level off, one of them is more. The membranes about the fibula are a fifth of its echoes."""

LABEL_ECHOES = 0.05
"""Share of all echoes near bone that must be a label's before it is judged alone."""


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
    closeness: float = float("nan")
    """mm. Median distance of the echoes that agree, without sign; NaN without such. `median_distance` is also of echoes of bone beside that
    the labels lack."""
    upper_quartile: float = float("nan")
    """mm. Three quarters of the echoes near bone whose beams enter it lie nearer, without sign; NaN without such."""
    upper_tenth: float = float("nan")
    """mm. As `upper_quartile`, of nine in ten."""

    @property
    def misplaced(self) -> bool:
        """Whether the CT lies so far from the echoes that bone is better taken from those."""
        return not self.upper_quartile <= MISPLACED

    @property
    def reach(self) -> float:
        """mm from the CT's bone, misplaced as it is, beyond which an echo is of something else; infinite where it may lie a level off."""
        is_told = self.upper_tenth <= LITTLE_OFF and self.elsewhere <= ELSEWHERE * (self.echoes + self.elsewhere)
        return self.upper_tenth + BEYOND if is_told else math.inf

    @property
    def bone_width(self) -> float:
        """Width of the bone map that goes with such an agreement, mm: as narrow as the bone lies sure, in steps of 0.1 mm."""
        off = MISPLACED if self.misplaced else self.upper_quartile
        return round(max(WIDTH_PER_MM * off, LEAST_WIDTH), 1)

    @property
    def bone_belief(self) -> float:
        """How far that map is to be believed, 0 to 1, in steps of 0.01: it goes on falling where the width has its limit."""
        return round(SURE / max(self.upper_quartile, SURE), 2) if np.isfinite(self.upper_quartile) else 0.0

    @property
    def explained(self) -> float:
        """Share of all echoes, wherever they lie, that agree."""
        return self.share * self.echoes / max(self.echoes + self.elsewhere, 1)

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
        """The agreement as users read it: in shares, for how many echoes there are depends on how many frames were looked at."""
        if not self.echoes:
            return "CT and sweep do not agree: none of the sweep's bone echoes lies near the CT's bone."
        verdict = "agree" if self.enough else "do not agree"
        return (
            f"CT and sweep {verdict}: {self.share:.0%} of the bone echoes lie within {CLOSE:g} mm of the CT's bone, "
            f"{self.median_distance:.1f} mm off in the median."
        )

    def warning(self, names: Mapping[int, str] | None = None) -> str | None:
        """What is probably wrong, in one sentence; None where CT and sweep agree. `names` are those of the labels."""
        if self.enough:
            return None
        if self.share >= ENOUGH and self.median_distance <= LARGEST_MEDIAN:
            labels = listed((names or {}).get(label) or f"label {label}" for label in self.disagreeing_labels)
            return f"Not on its echoes: {labels}. The CT may lie one level off, or the spine may have bent since."
        return "The CT is probably not where the bone is, or of another patient."


@dataclass(frozen=True)
class Comparison:
    """How a sweep and placed labels agree, or why that cannot be told."""

    agreement: Agreement | None
    lines: tuple[str, ...]  #: The same in words, and what to do where they do not agree
    echoes: SweepEchoes | None = field(default=None, repr=False, compare=False)  #: That were compared
