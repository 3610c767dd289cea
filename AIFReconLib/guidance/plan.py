"""A plan of a scan: the passes that show most of a target, chosen one after the other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Matrix
from ..errors import GeometryError, SettingsError
from ..geometry.transforms import as_matrix
from ..progress import Progress, part, report
from .bone import GuidedBone
from .candidates import LEAST_GAIN, Candidate, candidates_of, geometry_of, target_weights
from .expectation import expected_visibility
from .met import BoneMet, FrameGeometry
from .passes import Pass, freehand_passes, wearable_passes, wearable_places
from .probe import ProbeOnBack

FREEHAND, WEARABLE = "freehand", "wearable"
CANDIDATES = (FREEHAND, WEARABLE)


@dataclass(frozen=True, eq=False)
class PlannedPass:
    """A pass of a plan.

    Parameters
    ----------
    name : str
    image_to_reference : (frames, 4, 4) float64 array
        In the order of scanning.
    adds_cm2 : float
        Area of the target that it is expected to show beyond what the passes before it show.
    """

    name: str
    image_to_reference: Matrix
    adds_cm2: float


@dataclass(frozen=True, eq=False)
class ScanPlan:
    """Passes, and what they are expected to show.

    Parameters
    ----------
    target : str
    passes : tuple of PlannedPass
    predicted_visibility : float, 0 to 1
        Share that `weighted` is expected to show of the part of the target that the plan meets: what `aifrecon evaluate` measures of the
        reconstruction, whose coverage is of what the sweep could reach.
    predicted_of_reachable : float, 0 to 1
        The same as a share of all of the target that any probe on the back can reach.
    met : BoneMet
        What the whole plan meets, point by point.
    """

    target: str
    passes: tuple[PlannedPass, ...]
    predicted_visibility: float
    predicted_of_reachable: float
    met: BoneMet

    @property
    def frames(self) -> int:
        """Of all passes."""
        return sum(len(one.image_to_reference) for one in self.passes)

    def to_dict(self) -> dict[str, object]:
        """The plan, for JSON."""
        passes = [
            {"name": one.name, "adds_cm2": round(one.adds_cm2, 2), "image_to_reference": one.image_to_reference.tolist()}
            for one in self.passes
        ]
        return {
            "target": self.target,
            "frames": self.frames,
            "predicted_visibility": round(self.predicted_visibility, 4),
            "predicted_of_reachable": round(self.predicted_of_reachable, 4),
            "passes": passes,
        }


def plan_scan(
    bone: GuidedBone,
    probe: ProbeOnBack,
    target: str = "interspinous",
    frames: int = 180,
    candidates: str = FREEHAND,
    before: BoneMet | None = None,
    progress: Progress | None = None,
) -> ScanPlan:
    """The passes that show most of a target with a number of frames.

    Parameters
    ----------
    bone : GuidedBone
    probe : ProbeOnBack
    target : str
        `interspinous`, `posterior`, `all` or a label's name or number; see `GuidedBone.part`.
    frames : int
        Of all passes together.
    candidates : "freehand" or "wearable"
        What the probe can do: slide and tilt by hand, or tilt about two axes where it is strapped on.
    before : BoneMet or None
        What was met already.
    progress : Progress or None

    Raises
    ------
    SettingsError
        When the frames are too few for one pass.
    GeometryError
        When there is no such target, or no pass shows more of it.

    Notes
    -----
    Greedy: of all candidates the one that adds most expected area per frame, again and again, until the frames are used or nothing is
    worth adding; as what a pass adds only shrinks with what others have shown, this comes within a factor of 1 - 1/e of the best choice
    for equally long passes [1]_. Frames that are left over make the chosen passes denser.

    References
    ----------
    .. [1] Nemhauser, Wolsey and Fisher (1978), An analysis of approximations for maximizing submodular set functions, Mathematical
       Programming 14:265-294, doi:10.1007/BF01588971.
    """
    chosen_points = bone.part(target)
    areas = bone.surface.areas
    weights = target_weights(bone, target)
    geometry = geometry_of(bone, probe)
    options: list[list[Pass]] = [freehand_passes(bone)]
    if candidates == WEARABLE:
        places = wearable_places(bone, bone.surface.points_reference[chosen_points])
        options = [wearable_passes(bone, place, turn) for place in places for turn in (0.0, 90.0)]
    if frames < min(one.least for passes in options for one in passes):
        raise SettingsError(
            "Input frames must be enough for one pass, some 6 to 25; got {frames!r}. Give more, or choose another target.", frames=frames
        )
    shown = np.zeros(len(bone)) if before is None else expected_visibility(before.best_cosine)
    best: tuple[float, list[Candidate]] = (-1.0, [])
    for number, passes in enumerate(options):
        share = part(progress, 0.9 * number / len(options), 0.9 * (number + 1) / len(options))
        looked = candidates_of(passes, probe, geometry, share)
        chosen, value = _greedy(looked, weights, shown.copy(), frames)
        if value > best[0]:
            best = (value, chosen)
    if not best[1]:
        raise GeometryError(
            "No pass of this probe would show more of {target}. Check that --bone-transform places the labels where the patient was.",
            target=target,
        )
    report(progress, 0.95, "Following the plan")
    return _planned(target, best[1], frames, probe, geometry, np.where(chosen_points, areas, 0.0), shown)


def _greedy(candidates: list[Candidate], weights: Floats, shown: Floats, frames: int) -> tuple[list[Candidate], float]:
    """The passes in the order of their choice, and the weighted area that they are expected to add."""
    left, chosen, added = frames, [], 0.0
    open_ = list(candidates)
    while open_:
        open_ = [one for one in open_ if one.planned.least <= left]
        gains = [one.gain(weights, shown) for one in open_]
        per_frame = [gain / one.planned.least for gain, one in zip(gains, open_, strict=True)]
        if not open_ or max(gains) < LEAST_GAIN * float(weights.sum()):
            break
        best = int(np.argmax(per_frame))
        one = open_.pop(best)
        chosen.append(one)
        added += gains[best]
        left -= one.planned.least
        shown[one.points] = np.maximum(shown[one.points], one.shown)
    return chosen, added


def _planned(
    target: str, chosen: list[Candidate], frames: int, probe: ProbeOnBack, geometry: FrameGeometry, areas: Floats, shown: Floats
) -> ScanPlan:
    """The chosen passes with all their frames, looked at again as they will be scanned."""
    least = np.array([one.planned.least for one in chosen])
    ends = np.round(np.cumsum(least) / least.sum() * max(frames, least.sum())).astype(int)
    counts = np.diff(ends, prepend=0)
    met, passes, before = BoneMet(geometry), [], float(areas @ shown)
    for one, count in zip(chosen, counts, strict=True):
        poses = one.planned.poses(probe, int(count))
        for pose in poses:
            met.insert(pose)
        after = float(areas @ np.maximum(expected_visibility(met.best_cosine), shown))
        passes.append(PlannedPass(one.planned.name, poses, (after - before) / 100.0))
        before = after
    reached = float(areas[np.isfinite(met.best_cosine) | (shown > 0)].sum())
    return ScanPlan(target, tuple(passes), before / reached if reached else 0.0, before / float(areas.sum()), met)


def passes_of(document: object) -> list[tuple[str, Matrix]]:
    """Names and poses of the passes of a plan that was read from JSON.

    Raises
    ------
    SettingsError, GeometryError
        When it is no plan, or holds what is no pose.
    """
    passes = document.get("passes") if isinstance(document, dict) else None
    if not isinstance(passes, list) or not passes or not all(isinstance(one, dict) and one.get("image_to_reference") for one in passes):
        raise SettingsError("Input plan must have passes with image_to_reference. Make the plan again.")
    return [
        (str(one.get("name", "")), np.array([as_matrix(pose, "image_to_reference") for pose in one["image_to_reference"]]))
        for one in passes
    ]
