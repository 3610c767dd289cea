"""Candidate passes and what each would meet: looked at once, asked often."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Integers, Singles
from ..progress import Progress, Steps, carry_out, part
from .bone import GuidedBone
from .bone_coverage import MOST, FrameGeometry, expected_visibility, support_for, unseen
from .passes import Hand, Pass
from .probe import ProbeOnBack, ProbePlacement

OFF_TARGET = 0.01
"""What bone off the target counts: frames that can add nothing more to the target go there."""

OFF_TARGET_EVERY = 4
"""Of the points off the target one in so many is looked at, and stands for all."""

DRAWS = 3
"""How often each pass is looked at, as the hand happens to make it."""

FRAMES_AT_ONCE, PAIRS_AT_ONCE = 12, 100_000
"""Frames, and pairs of pass and point, that are computed in one step, some 3 ms: in a live scan frames come first."""

LEAST_GAIN = 0.001
"""Of the weighted area: a pass that adds less is not worth its frames."""


class Candidates:
    """Passes and what their frames meet, `Pass.least` at a time.

    A pass that a hand makes meets other bone each time: what it is expected to show is the mean over `DRAWS` of them.

    `target` as in `GuidedBone.target`; without a `hand` passes are made exactly. They are to be looked at before anything is asked: by
    `look`, or in steps by `look_again`.
    """

    def __init__(
        self,
        passes: Sequence[Pass],
        bone: GuidedBone,
        probe: ProbeOnBack,
        target: str,
        hand: Hand | None = None,
    ):
        self.passes, self._probe, self._hand = passes, probe, hand
        chosen = bone.target(target)
        others = np.flatnonzero(~chosen)[::OFF_TARGET_EVERY]
        self._looked = np.sort(np.concatenate([np.flatnonzero(chosen), others]))
        share = np.where(
            chosen, 1.0, OFF_TARGET * float(bone.surface.areas[~chosen].sum()) / max(float(bone.surface.areas[others].sum()), 1e-9)
        )
        self._weights = (share * bone.surface.areas)[self._looked]
        self._geometry = geometry_of(bone.only(self._looked), probe)
        self._rng = np.random.default_rng(0)
        self._made: list[list[list[ProbePlacement]]] = []
        self._seen: list[_Seen] = []
        self._draws = DRAWS if hand else 1

    @property
    def is_rough(self) -> bool:
        """Whether passes are still to be looked at."""
        return len(self._seen) < self._draws

    def look(self, progress: Progress | None = None) -> None:
        """Look at every pass as often as is needed, which takes some seconds."""
        while self.is_rough:
            done = len(self._seen)
            carry_out(self.look_again(), part(progress, done / self._draws, (done + 1) / self._draws))

    def look_again(self) -> Steps[None]:
        """Look at every pass once more, as the hand happens to make it; until that is done what is told stays as it was."""
        found: list[tuple[Integers, Singles, Integers]] = []
        first = 0
        while first < len(self.passes):
            yield first / len(self.passes), "Looking at candidate passes"
            ways: list[list[ProbePlacement]] = []
            while first + len(ways) < len(self.passes) and (not ways or sum(map(len, ways)) < FRAMES_AT_ONCE):
                ways.append(self._placements(first + len(ways))[len(self._seen)])
            found.append(self._support(ways, first))
            first += len(ways)
        points, support, owner = (np.concatenate(parts) for parts in zip(*found, strict=True))
        self._seen = [*self._seen, _Seen(points, support, owner)]

    def _support(self, ways: list[list[ProbePlacement]], first: int) -> tuple[Integers, Singles, Integers]:
        """What some passes meet, of which `first` is the first; see `_Seen`."""
        frame, point, support = self._geometry.support(self._probe.poses([placement for way in ways for placement in way]))
        way = np.repeat(np.arange(len(ways)), [len(way) for way in ways])[frame]
        together = np.bincount(way * len(self._weights) + point, support, len(ways) * len(self._weights))
        met = np.flatnonzero(together)
        owner, points = np.divmod(met, len(self._weights))
        # In single precision, for they are asked while a scan goes on
        return points, together[met].astype(np.float32), first + owner

    def _placements(self, number: int) -> list[list[ProbePlacement]]:
        """Those of the frames of a pass, each time that it is made."""
        if number == len(self._made):
            exact = self.passes[number].placements(self.passes[number].least)
            hand = self._hand
            self._made.append([exact] if hand is None else [hand.follow(exact, self._rng) for _ in range(DRAWS)])
        return self._made[number]

    @property
    def worth(self) -> float:
        """Gains below this are not worth the frames, mm^2."""
        return LEAST_GAIN * float(self._weights.sum())

    def looked(self, support: Floats) -> Floats:
        """Of the support of all points of the bone, that of those that are looked at."""
        looked: Floats = support[self._looked]
        return looked

    def gains(self, support: Floats, rounds: int = 1) -> Steps[Floats]:
        """What each pass adds to the weighted area that is expected to show, (n,) mm^2.

        `support` (points,) is what there is, as `looked` gives it; a pass has `rounds` times its `least` frames.
        """
        there = support.astype(np.float32)
        missing, gains = unseen(there), np.zeros(len(self.passes))
        for seen in self._seen:
            for first in range(0, len(seen.points), PAIRS_AT_ONCE):
                yield 0.0, "Comparing candidate passes"
                some = slice(first, first + PAIRS_AT_ONCE)
                points = seen.points[some]
                more = missing[points] - unseen(there[points] + np.float32(rounds) * seen.support[some])
                gains += np.bincount(seen.owner[some], self._weights[points] * more, len(gains))
        return MOST / len(self._seen) * gains

    def make(self, number: int, support: Floats) -> Floats:
        """Support after a pass, which a sure hand would need for what this hand is expected to show."""
        more = np.zeros(len(support))
        for seen in self._seen:
            mine = seen.owner == number
            before = support[seen.points[mine]]
            more[seen.points[mine]] += expected_visibility(before + seen.support[mine]) - expected_visibility(before)
        points, after = np.flatnonzero(more), support.copy()
        after[points] = support_for(expected_visibility(support[points]) + more[points] / len(self._seen))
        return after


@dataclass(frozen=True, eq=False)
class _Seen:
    """What all passes meet when each is made once: numbers of points (m,), their support (m,), and which pass each is of (m,)."""

    points: Integers
    support: Singles
    owner: Integers


def geometry_of(bone: GuidedBone, probe: ProbeOnBack) -> FrameGeometry:
    """What frames of this probe meet of the bone."""
    return FrameGeometry(bone, probe.images.frame_size, probe.images.geometry, probe.images.region)
