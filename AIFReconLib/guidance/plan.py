"""A plan of a scan: the passes that show most of a target, chosen one after the other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Integers, Matrix
from ..effective_settings import resolve_imaging
from ..errors import GeometryError, SettingsError
from ..geometry.transforms import as_matrix, invert, transform_points
from ..geometry.volume import Volume
from ..message import Described
from ..progress import Progress, carry_out, part, report
from ..recipe.recipe import Recipe
from ..registration.labeled_bone import LabeledBone
from ..remedies import PLACE_THE_CT
from ..sweep.frames import TrackedSequence
from ..sweep.poses import sweep_poses
from ..sweep.time_offset import as_asked
from .bone import GuidedBone, guided_bone
from .bone_coverage import CoverageAccumulator
from .candidates import Candidates, geometry_of
from .coverage import bone_before
from .passes import HAND, Hand, Pass, freehand_passes, wearable_passes, wearable_places
from .probe import ProbeImages, ProbeOnBack, Skin, images_like

FREEHAND, WEARABLE = "freehand", "wearable"
CANDIDATES = (FREEHAND, WEARABLE)

FOLLOWED = 8
"""How often a plan is followed, by hands that miss as they do, to say what it will show."""

NEW_PASS = 3
"""Frames that the beginning of another pass counts."""


@dataclass(frozen=True, eq=False)
class _PlannedPass:
    """A pass of a plan."""

    name: str
    image_to_reference: Matrix  #: (frames, 4, 4). In the order of scanning.
    adds_cm2: float  #: Area of the target that it is expected to show beyond what the passes before it show
    planned: Pass  #: From where to where it goes


@dataclass(frozen=True, eq=False, repr=False)
class ScanPlan(Described):
    """Passes, and what they are expected to show."""

    target: str
    passes: tuple[_PlannedPass, ...]
    predicted_visibility: float
    """0 to 1. Share that `weighted` is expected to show of the part of the target that the plan meets: what `aifrecon evaluate` measures of
    the reconstruction, whose coverage is of what the sweep could reach."""
    predicted_of_reachable: float
    """0 to 1. The same as a share of all of the target that any probe on the back can reach."""
    met: CoverageAccumulator  #: What a hand that follows the plan meets, point by point

    @property
    def frames(self) -> int:
        """Of all passes."""
        return sum(len(one.image_to_reference) for one in self.passes)

    def _facts(self) -> list[tuple[str, str]]:
        shown = f"{self.predicted_of_reachable:.0%} of what can be reached"
        return [("target", self.target), ("passes", str(len(self.passes))), ("frames", str(self.frames)), ("expected to show", shown)]

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


def plan(
    labels: Volume,
    labels_to_reference: Matrix | None = None,
    target: str = "interspinous",
    frames: int = 180,
    candidates: str = FREEHAND,
    *,
    like: TrackedSequence | None = None,
    recipe: Recipe | None = None,
    progress: Progress | None = None,
) -> ScanPlan:
    """The passes of a scan that show most of a target with so many frames, from a CT's bone.

    Parameters
    ----------
    labels : Labels, or Volume of integers
        One label for each vertebra.
    labels_to_reference : (4, 4) array, mm, or None
        The registration; None where the labels lie in Reference.
    target : str
        "interspinous" (the borders of the gaps), "posterior" (bone that faces the back), "all", or a label by name or number.
    frames : int
        Of all passes together.
    candidates : "freehand" or "wearable"
        What the probe can do.
    like : TrackedSequence or None
        A recording of the probe, on this patient best of all: its images, probe and skin. Else a phased array, and the skin 15 mm behind
        the spinous processes.
    recipe : Recipe or None
        How that recording is read.

    Raises
    ------
    AIFReconError
        When labels hold no bone, or the probe is not known.
    """
    bone, probe, _ = patient_and_probe(labels, labels_to_reference, like, recipe or Recipe(), part(progress, 0.0, 0.1))
    return plan_scan(bone, probe, target, frames, candidates, progress=part(progress, 0.1, 1.0))


def patient_and_probe(
    labels: Volume, labels_to_reference: Matrix | None, like: TrackedSequence | None, recipe: Recipe, progress: Progress | None = None
) -> tuple[GuidedBone, ProbeOnBack, tuple[str, ...]]:
    """The bone, the probe on its back, and what was assumed; arguments as of `plan`."""
    report(progress, 0.0, "Finding the bone surface")
    if like is None:
        bone = guided_bone(labels, labels_to_reference)
        assumed = ("the probe is taken for a phased array of 84 degrees and 88 mm, and the skin to lie 15 mm behind the spinous processes",)
        return bone, ProbeOnBack(ProbeImages.simulated(), Skin.over(bone), bone.patient_to_reference), assumed
    like = as_asked(like, recipe)
    poses = sweep_poses(like, recipe.image_to_reference, recipe.reference)
    usable = poses.image_to_reference[poses.require_usable(like.name)]
    imaging = resolve_imaging(like, poses, True, recipe)
    looks = usable[:, :3, 1] / np.linalg.norm(usable[:, :3, 1], axis=1)[:, None]
    labels = LabeledBone(labels, labels_to_reference, like, recipe).labels
    bone, notes = bone_before(labels, labels_to_reference, looks.mean(axis=0))
    images = images_like(usable[0], like.frame_size, imaging.known_probe(), imaging.region)
    skin, more = _skin(bone, transform_points(invert(bone.patient_to_reference), images.faces(usable)))
    return bone, ProbeOnBack(images, skin, bone.patient_to_reference), (*notes, *more)


FAR = 80.0
"""mm from the estimated skin beyond which a face was on something else."""


def _skin(bone: GuidedBone, faces_patient: Floats) -> tuple[Skin, tuple[str, ...]]:
    """The skin that faces were on, where that is this patient's."""
    estimate = Skin.over(bone)
    off = np.abs(estimate.at(faces_patient[:, 0], faces_patient[:, 2]) - faces_patient[:, 1])
    if np.median(off) > FAR or np.abs(np.median(faces_patient[:, [0, 2]], axis=0)).max() > 2 * FAR:
        return estimate, ("the recording is of another place: the skin is taken to lie 15 mm behind the spinous processes",)
    return Skin.through(faces_patient), ()


def plan_scan(
    bone: GuidedBone,
    probe: ProbeOnBack,
    target: str = "interspinous",
    frames: int = 180,
    candidates: str = FREEHAND,
    hand: Hand | None = HAND,
    progress: Progress | None = None,
) -> ScanPlan:
    """The passes that show most of a target with a number of frames.

    Bone and probe are given; each of the other parameters is one thing that a planner may want otherwise.
    Raises SettingsError when the frames are too few for one pass; GeometryError when there is no such target, or no pass shows more of
    it.

    Parameters
    ----------
    target : str
        `interspinous`, `posterior`, `all` or a label's name or number; see `GuidedBone.target`.
    frames : int
        Of all passes together.
    candidates : "freehand" or "wearable"
        What the probe can do: slide and tilt by hand, or tilt about two axes where it is strapped on.
    hand : Hand or None
        By how much passes are expected to miss; None: not at all, as a wearable device's motors in any case.

    Notes
    -----
    Greedy: of all candidates the one that adds most expected area per frame, again and again, until the frames are used or nothing is
    worth adding; a pass that is chosen again becomes denser. As what a pass adds only shrinks with what others have shown, this comes
    within a factor of 1 - 1/e of the best choice for equally long passes [1]_. A pass that was not chosen before counts `NEW_PASS` frames
    more, for people rather make few long passes than many short ones.

    References
    ----------
    .. [1] Nemhauser, Wolsey and Fisher (1978), An analysis of approximations for maximizing submodular set functions, Mathematical
       Programming 14:265-294, doi:10.1007/BF01588971.
    """
    chosen = bone.target(target)
    options: list[list[Pass]] = [freehand_passes(bone)]
    if candidates == WEARABLE:
        hand = None
        places = wearable_places(bone, bone.surface.points_reference[chosen])
        options = [wearable_passes(place, turn) for place in places for turn in (0.0, 90.0)]
    if frames < min(one.least for passes in options for one in passes):
        raise SettingsError(f"Input frames must be enough for one pass, some 6 to 25; got {frames!r}. Give more, or choose another target.")
    nothing = np.zeros(len(bone))
    best: tuple[float, list[tuple[Pass, int]]] = (0.0, [])
    for number, passes in enumerate(options):
        share = part(progress, 0.8 * number / len(options), 0.8 * (number + 1) / len(options))
        seen = Candidates(passes, bone, probe, target, hand)
        seen.look(share)
        best = max(best, _greedy(seen, seen.looked(nothing), frames), key=lambda option: option[0])
    if not best[1]:
        raise GeometryError(f"No pass of this probe would show more of {target}.", PLACE_THE_CT)
    return _planned(target, _filled(best[1], frames), probe, bone, np.flatnonzero(chosen), hand, part(progress, 0.8, 1.0))


def _greedy(candidates: Candidates, support: Floats, frames: int) -> tuple[float, list[tuple[Pass, int]]]:
    """The weighted area that they are expected to add, and the passes in the order of their choice, each with its frames."""
    least = np.array([one.least for one in candidates.passes])
    counts: dict[int, int] = {}
    new = np.full(len(least), NEW_PASS)
    left, added = frames, 0.0
    while True:
        gains = carry_out(candidates.gains(support))
        per_frame = np.where(least <= left, gains / (least + new), -1.0)
        best = int(np.argmax(per_frame))
        if per_frame[best] < 0 or gains[best] < candidates.worth:
            break
        count = int(least[best])
        added, left, new[best] = added + float(gains[best]), left - count, 0
        counts[best] = counts.get(best, 0) + count
        support = candidates.make(best, support)
    return added, [(candidates.passes[number], count) for number, count in counts.items()]


def _filled(passes: list[tuple[Pass, int]], frames: int) -> list[tuple[Pass, int]]:
    """The passes with all frames that there are, dealt out in proportion."""
    ends = np.cumsum([count for _, count in passes])
    counts = np.diff(np.round(ends / ends[-1] * frames).astype(int), prepend=0)
    return [(one, int(count)) for (one, _), count in zip(passes, counts, strict=True)]


def _planned(
    target: str,
    passes: list[tuple[Pass, int]],
    probe: ProbeOnBack,
    bone: GuidedBone,
    chosen: Integers,
    hand: Hand | None,
    progress: Progress | None,
) -> ScanPlan:
    """The plan, and what it meets and shows as hands happen to make it: in the middle one of `FOLLOWED` tries."""
    areas, geometry = bone.surface.areas[chosen], geometry_of(bone.only(chosen), probe)
    rng = np.random.default_rng(1)
    draws = 1 if hand is None else FOLLOWED
    tries: list[tuple[list[float], Matrix]] = []
    for draw in range(draws):
        met, shown, made = CoverageAccumulator(geometry), [0.0], []
        for number, (one, count) in enumerate(passes):
            report(progress, (draw + number / len(passes)) / (draws + 1), "Following the plan")
            placements = one.placements(count)
            made.append(probe.poses(placements if hand is None else hand.follow(placements, rng)))
            for pose in made[-1]:
                met.insert(pose)
            shown.append(float(areas @ met.expected))
        tries.append((shown, np.concatenate(made)))
    shown, poses = sorted(tries, key=lambda one: one[0][-1])[draws // 2]
    met = CoverageAccumulator(geometry_of(bone, probe))
    for pose in poses:
        met.insert(pose)
    planned = [
        _PlannedPass(one.name, one.poses(probe, count), float(added) / 100.0, one)
        for (one, count), added in zip(passes, np.diff(shown), strict=True)
    ]
    is_met = met.support[chosen] > 0
    of_met = shown[-1] / max(float(areas[is_met].sum()), 1e-9)
    return ScanPlan(target, tuple(planned), of_met, shown[-1] / float(areas.sum()), met)


def passes_of(document: object) -> list[tuple[str, Matrix]]:
    """Names and poses of the passes of a plan that was read from JSON.

    Raises SettingsError, GeometryError when it is no plan, or holds what is no pose.
    """
    passes = document.get("passes") if isinstance(document, dict) else None
    if not isinstance(passes, list) or not passes or not all(isinstance(one, dict) and one.get("image_to_reference") for one in passes):
        raise SettingsError("Input plan must have passes with image_to_reference. Make the plan again.")
    return [
        (str(one.get("name", "")), np.array([as_matrix(pose, "image_to_reference") for pose in one["image_to_reference"]]))
        for one in passes
    ]
