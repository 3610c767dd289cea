"""Candidate passes and what each would meet: looked at once, asked often."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Integers, Matrix
from ..progress import Progress, report
from .bone import GuidedBone
from .expectation import expected_visibility
from .met import MET, FrameGeometry
from .passes import Pass
from .probe import ProbeOnBack

BESIDE_TARGET = 0.05
"""What bone beside the target counts: frames that can add nothing more to the target go there."""

LEAST_GAIN = 0.001
"""Of the weighted area: a pass that adds less is not worth its frames."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A pass with the points that it meets, and the chance that each shows by it alone."""

    planned: Pass
    points: Integers
    shown: Floats

    def gain(self, weights: Floats, shown: Floats) -> float:
        """The weighted area that it is expected to show beyond what is `shown` already, (n,) chances."""
        return float(weights[self.points] @ np.maximum(self.shown - shown[self.points], 0.0))


def candidates_of(passes: list[Pass], probe: ProbeOnBack, geometry: FrameGeometry, progress: Progress | None = None) -> list[Candidate]:
    """Each pass with what it meets."""
    looked = []
    for number, one in enumerate(passes):
        report(progress, number / len(passes), "Looking at candidate passes")
        best = _best_cosine(geometry, one.poses(probe))
        points = np.flatnonzero(np.isfinite(best))
        looked.append(Candidate(one, points, expected_visibility(best[points])))
    return looked


def _best_cosine(geometry: FrameGeometry, image_to_reference: Matrix) -> Floats:
    """Of the smallest angle at which any of some frames meets each point, (n,); NaN where none does."""
    best = np.full(len(geometry.bone), np.nan)
    for pose in image_to_reference:
        view = geometry.view(pose)
        met = view.status == MET
        best[view.points[met]] = np.fmax(best[view.points[met]], view.cosines[met])
    return best


def target_weights(bone: GuidedBone, target: str) -> Floats:
    """What each point's area counts for a target, (n,) mm^2: all of it, or `BESIDE_TARGET`; see `GuidedBone.part`."""
    return np.where(bone.part(target), 1.0, BESIDE_TARGET) * bone.surface.areas


def geometry_of(bone: GuidedBone, probe: ProbeOnBack) -> FrameGeometry:
    """What frames of this probe meet of the bone."""
    return FrameGeometry(bone, probe.images.frame_size, probe.images.geometry, probe.images.region)
