"""Candidate passes and what each would meet: looked at once, asked often."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Floats, Integers, Matrix
from ..progress import Progress, report
from .bone import GuidedBone
from .expectation import evidence_for, evidence_of, expected_visibility
from .hand import Hand
from .met import MET, FrameGeometry
from .passes import Pass
from .probe import ProbeOnBack

BESIDE_TARGET = 0.01
"""What bone beside the target counts: frames that can add nothing more to the target go there."""

BESIDE_EVERY = 4
"""Of the points beside the target one in so many is looked at, and stands for all."""

DRAWS = 3
"""How often each pass is looked at, as the hand happens to make it."""

LEAST_GAIN = 0.001
"""Of the weighted area: a pass that adds less is not worth its frames."""


class Candidates:
    """Passes and what their frames meet, `Pass.least` at a time.

    Parameters
    ----------
    passes : sequence of Pass
    bone : GuidedBone
    probe : ProbeOnBack
    target : str
        See `GuidedBone.part`.
    hand : Hand or None
        How the passes are made; None: exactly.
    progress : Progress or None

    Notes
    -----
    A pass that a hand makes meets other bone each time: what it is expected to show is the mean over `DRAWS` of them.
    """

    def __init__(
        self,
        passes: Sequence[Pass],
        bone: GuidedBone,
        probe: ProbeOnBack,
        target: str,
        hand: Hand | None = None,
        progress: Progress | None = None,
    ):
        self.passes = passes
        chosen = bone.part(target)
        beside = np.flatnonzero(~chosen)[::BESIDE_EVERY]
        self._looked = np.sort(np.concatenate([np.flatnonzero(chosen), beside]))
        share = np.where(
            chosen, 1.0, BESIDE_TARGET * float(bone.surface.areas[~chosen].sum()) / max(float(bone.surface.areas[beside].sum()), 1e-9)
        )
        self._weights = (share * bone.surface.areas)[self._looked]
        geometry = geometry_of(bone.only(self._looked), probe)
        rng = np.random.default_rng(0)
        points, found = [], []
        for number, one in enumerate(passes):
            placements, draws = one.placements(one.least), []
            for draw in range(DRAWS if hand else 1):
                # So often, because who looks while a scan goes on makes way to frames meanwhile
                report(progress, (number + draw / DRAWS) / len(passes), "Looking at candidate passes")
                draws.append(_evidence(geometry, probe.poses(hand.follow(placements, rng) if hand else placements)))
            evidence = np.array(draws)
            met = np.flatnonzero(evidence.any(axis=0))
            points.append(met)
            found.append(evidence[:, met])
        self._points: Integers = np.concatenate(points)
        self._met = np.concatenate(found, axis=1)
        self._owner = np.repeat(np.arange(len(passes)), [len(each) for each in points])

    @property
    def worth(self) -> float:
        """Gains below this are not worth the frames, mm^2."""
        return LEAST_GAIN * float(self._weights.sum())

    def looked(self, evidence: Floats) -> Floats:
        """Of the evidence of all points of the bone, that of those that are looked at."""
        looked: Floats = evidence[self._looked]
        return looked

    def gains(self, evidence: Floats, rounds: int = 1) -> Floats:
        """What each pass adds to the weighted area that is expected to show, (n,) mm^2.

        Parameters
        ----------
        evidence : (points,) array
            What there is; see `looked`.
        rounds : int
            How many times `least` frames the pass has.
        """
        before = expected_visibility(evidence)
        more = expected_visibility(evidence[self._points] + rounds * self._met).mean(axis=0) - before[self._points]
        return np.asarray(np.bincount(self._owner, self._weights[self._points] * more, len(self.passes)), dtype=np.float64)

    def make(self, number: int, evidence: Floats) -> Floats:
        """Evidence after a pass, which a sure hand would need for what this hand is expected to show."""
        part = self._owner == number
        points, after = self._points[part], evidence.copy()
        after[points] = evidence_for(expected_visibility(evidence[points] + self._met[:, part]).mean(axis=0))
        return after


def _evidence(geometry: FrameGeometry, image_to_reference: Matrix) -> Floats:
    """Of some frames together, (n,)."""
    evidence = np.zeros(len(geometry.bone))
    for pose in image_to_reference:
        view = geometry.view(pose)
        met = view.status == MET
        evidence[view.points[met]] += evidence_of(view.cosines[met])
    return evidence


def geometry_of(bone: GuidedBone, probe: ProbeOnBack) -> FrameGeometry:
    """What frames of this probe meet of the bone."""
    return FrameGeometry(bone, probe.images.frame_size, probe.images.geometry, probe.images.region)
