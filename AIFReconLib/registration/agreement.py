"""What is told of how the bone of a placed CT and the bone echoes of a sweep agree: numbers, and one sentence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..message import listed

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
