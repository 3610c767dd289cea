"""Where a CT lies on a sweep, asked for again and again: echoes and bone stay here, and what is to be shown goes back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Matrix
from ..bone.echoes.found import SweepEchoes
from ..geometry.volume import Volume
from ..progress import Progress
from ..recipe.recipe import Recipe
from ..registration.agreement import Agreement
from ..sweep.frames import TrackedSequence

MOST_DRAWN = 3000
"""Echoes that are drawn, evenly in space: slices are cut anew whenever they move."""


@dataclass(frozen=True, eq=False)
class PlacedCT:
    """How a place of the CT and the bone echoes agree."""

    labels_to_reference: Matrix  #: (4, 4), mm. The place.
    agreement: Agreement
    points: Floats  #: (n, 3), mm in Reference. Echoes to be drawn.
    distances: Floats  #: (n,), mm. From each of those to the CT's bone.


@dataclass(frozen=True, eq=False)
class _Offered:
    """Another place that the user may choose."""

    labels_to_reference: Matrix  #: (4, 4), mm
    agreement: Agreement
    levels: int | None  #: How many levels higher (+) or lower (-) the CT lies there; None: elsewhere


@dataclass(frozen=True, eq=False)
class Found:
    """Where the CT belongs; see `Registration`."""

    placed: PlacedCT
    reason: str | None  #: Why the answer must not be used unseen
    agreement: Agreement
    moved: float | None  #: mm
    uncertain: tuple[str, ...]  #: What the sweep does not hold, in words
    alternatives: tuple[_Offered, ...]  #: The best first
    apart: Volume | None  #: The labels in Reference, each where it came to lie on its own, where that was asked for


class Placing:
    """The echoes of a sweep or of a scan, and the bone of a CT that is to lie on them."""

    def __init__(self, echoes: SweepEchoes, labels: Volume):
        from ..bone.field import BoneField

        self._echoes, self._bone = echoes, BoneField.from_labels(labels)
        self._drawn = echoes.thinned(MOST_DRAWN)

    def at(self, place: Matrix) -> PlacedCT:
        """How well the CT agrees in a place, (4, 4) rigid."""
        from ..registration.comparison import check, fit_echoes

        distances = np.abs(fit_echoes(self._drawn, self._bone, place).distances)
        return PlacedCT(np.asarray(place), check(self._echoes, self._bone, place), self._drawn.points, distances)

    def find(self, start: Matrix | None, per_segment: bool = False, progress: Progress | None = None) -> Found:
        """Where it belongs, from a place or, without one, from anywhere; and, if asked for, each of its bones on its own."""
        from ..registration.registration import register_echoes
        from ..registration.segments import placed_labels

        found = register_echoes(self._echoes, self._bone, start, per_segment=per_segment, progress=progress)
        others = tuple(_Offered(other.transform, other.agreement, other.levels) for other in found.alternatives)
        apart = placed_labels(self._bone.labels, found.segments.transforms) if found.segments else None
        return Found(self.at(found.transform), found.reason, found.agreement, found.moved, tuple(found.uncertain), others, apart)


def echoes_in(sequence: TrackedSequence, recipe: Recipe, progress: Progress | None = None) -> SweepEchoes:
    """The bone echoes of a recorded sweep; arguments as of `sweep_echoes`."""
    from ..bone.echoes.search import sweep_echoes

    return sweep_echoes(sequence, recipe, progress=progress)
