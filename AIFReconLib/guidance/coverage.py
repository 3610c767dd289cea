"""What a recorded sweep met of the bone: per label, at the interspinous borders, and in all."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Mask, Matrix
from ..bone.echoes.surface import bone_from_sweep
from ..effective_settings import resolve_imaging
from ..evaluation.visibility import BEAM_THICKNESS
from ..geometry.volume import Volume
from ..message import Described, columns, one_line
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import joined
from ..sweep.poses import still_images_of, sweep_poses, time_order, tracked_frames
from .bone import GuidedBone, bone_of_echoes, guided_bone
from .bone_coverage import CoverageAccumulator, FrameGeometry
from .snapshot import Share

BELOW_60, BELOW_45 = np.cos(np.radians((60.0, 45.0)))

AWRY_DEG = 60.0
"""A sweep whose middle beams run farther than this from the front of the labels, on the mean, says itself where the front is."""


@dataclass(frozen=True, eq=False, repr=False)
class Coverage(Described):
    """What a scan met."""

    met: CoverageAccumulator  #: Point by point
    all: Share
    interspinous: Share
    by_label: dict[str, Share]  #: By the name of the label, or its number where it has none; nothing where there is no CT
    notes: tuple[str, ...] = ()  #: What was assumed

    def _facts(self) -> list[tuple[str, str]]:
        return [
            (name, f"{share.met:.0%} met of {share.reachable_cm2:.1f} cm2") for name, share in (*self.by_label.items(), ("all", self.all))
        ]

    def to_dict(self) -> dict[str, object]:
        """The report, for JSON."""
        labels = {name: share.to_dict() for name, share in self.by_label.items()}
        return {"all": self.all.to_dict(), "interspinous": self.interspinous.to_dict(), "labels": labels}

    def lines(self) -> list[str]:
        """A table for a terminal, a line each."""
        rows: list[tuple[str, ...]] = [("bone", "reachable", "hit", "below 60 deg", "below 45 deg", "expected to show")]
        named = [*((f"label {name}" if name.isdecimal() else name, share) for name, share in self.by_label.items())]
        if self.met.bone.is_of_ct:
            named.append(("interspinous borders", self.interspinous))
        rows += [(one_line(name), *_cells(share)) for name, share in [*named, ("all", self.all)]]
        return columns(rows).split("\n")


def _cells(share: Share) -> list[str]:
    shares = (share.met, share.below_60_deg, share.below_45_deg, share.expected_visibility)
    return [f"{share.reachable_cm2:.1f} cm2", *("-" if value != value else f"{value:.0%}" for value in shares)]


def coverage(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    labels: Volume | None = None,
    labels_to_reference: Matrix | None = None,
    recipe: Recipe | None = None,
    *,
    thickness: float = BEAM_THICKNESS,
    names: Mapping[int, str] | None = None,
    progress: Progress | None = None,
) -> Coverage:
    """How much of each bone the frames of one or more sweeps met, and how squarely.

    Raises AIFReconError when frames cannot be placed, beams not be told, labels hold no bone, or, without labels, images show hardly any.

    Parameters
    ----------
    sequences : TrackedSequence or several in one Reference
    labels : Volume of integers or None
        Segmentation of the CT, one label per vertebra. None: the surface that the sweeps' own echoes lie on, and where bone may go on
        beyond it; see `bone_of_echoes`.
    labels_to_reference : (4, 4) array, mm, or None
        The registration, as `register` finds it; None where the labels lie in Reference.
    recipe : Recipe or None
        As in `reconstruct`.
    thickness : float, mm
        Full width of the beam across the image plane.
    names : mapping of int to str or None
        What the labels are called; by default what `Labels` know themselves.
    """
    recipe = recipe or Recipe()
    sequence = joined(sequences, recipe)
    poses = sweep_poses(sequence, recipe.image_to_reference, recipe.reference)
    usable = poses.require_usable(sequence.name)
    if labels is None:
        known = bone_from_sweep(sequence, recipe, part(progress, 0.0, 0.8))
        bone = bone_of_echoes(known, poses.image_to_reference[usable])
        return covered(unrefuted(followed(bone, sequence, recipe, thickness, part(progress, 0.8, 1.0))), known.notes)
    report(progress, 0.0, "Finding the bone surface")
    looks = poses.image_to_reference[usable][:, :3, 1]
    mean = (looks / np.linalg.norm(looks, axis=1)[:, None]).mean(axis=0)
    bone, notes = bone_before(labels, labels_to_reference, mean, names)
    met = followed(bone, sequence, recipe, thickness, part(progress, 0.1, 1.0))
    return covered(met, notes)


def followed(
    bone: GuidedBone, sequence: TrackedSequence, recipe: Recipe, thickness: float = BEAM_THICKNESS, progress: Progress | None = None
) -> CoverageAccumulator:
    """What the frames of a sweep met of this bone, in the order of time; arguments and errors are those of `coverage`."""
    poses = sweep_poses(sequence, recipe.image_to_reference, recipe.reference)
    usable = poses.require_usable(sequence.name)
    imaging = resolve_imaging(sequence, poses, True, recipe)
    met = CoverageAccumulator(FrameGeometry(bone, sequence.frame_size, imaging.known_probe(), imaging.region, thickness))
    order = time_order(sequence)
    order = order[np.isin(order, usable)]
    for done, frame in enumerate(tracked_frames(sequence, poses, order, still_images_of(sequence, poses, order))):
        report(progress, done / len(order), "Following the beams")
        if frame.status == "OK" and frame.image_to_reference is not None:
            met.insert(frame.image_to_reference, None if frame.image is None else imaging.gray_levels.of(frame.image))
    report(progress, 1.0, "Followed the beams")
    return met


def unrefuted(met: CoverageAccumulator) -> CoverageAccumulator:
    """What was met of `bone_of_echoes`, but for the places beyond its surface that beams met below 60 degrees: no echo came from there."""
    with np.errstate(invalid="ignore"):
        refuted = (met.bone.surface.labels == 0) & (met.best_cosine > BELOW_60)
    return met.only(np.flatnonzero(~refuted))


def bone_before(
    labels: Volume, labels_to_reference: Matrix | None, looks: Floats, names: Mapping[int, str] | None = None
) -> tuple[GuidedBone, tuple[str, ...]]:
    """The bone that can be reached by a probe that looks that way, (3,) in Reference on the mean; and what was assumed."""
    front = (np.eye(4) if labels_to_reference is None else np.asarray(labels_to_reference, dtype=np.float64))[:3, 1]
    if not is_awry(front, looks):
        return guided_bone(labels, labels_to_reference, names=names), ()
    note = "The labels' axes are not the patient's: the frames do not look toward their front. What can be reached is told from the frames."
    return guided_bone(labels, labels_to_reference, looks / np.linalg.norm(looks), names), (note,)


def is_awry(front: Floats, looks: Floats) -> bool:
    """Whether a probe that looks that way, (3,) on the mean, does not look toward the front (3,); looks of all sorts tell nothing."""
    length = float(np.linalg.norm(looks))
    return length >= 0.5 and bool(front @ looks < np.cos(np.radians(AWRY_DEG)) * length * np.linalg.norm(front))


def covered(met: CoverageAccumulator, notes: tuple[str, ...] = ()) -> Coverage:
    """What was met until now, in shares."""
    everything = np.ones(len(met.bone), dtype=bool)
    return Coverage(met, share_of(met, everything), share_of(met, met.bone.border), _of_labels(met, everything), notes)


def back_of_labels(met: CoverageAccumulator) -> dict[str, Share]:
    """By the name of each label, how much of its bone that faces the back was met: what a scan from there is to show."""
    return _of_labels(met, met.bone.posterior)


def _of_labels(met: CoverageAccumulator, chosen: Mask) -> dict[str, Share]:
    labels = met.bone.surface.labels
    if not met.bone.is_of_ct:
        return {}
    return {met.bone.name_of(int(label)): share_of(met, chosen & (labels == label)) for label in np.unique(labels)}


def share_of(met: CoverageAccumulator, chosen: Mask) -> Share:
    """How much of the chosen points was met, (n,) bool."""
    areas, best = met.bone.surface.areas[chosen], met.best_cosine[chosen]
    total = float(areas.sum())
    if total == 0:
        return Share(0.0, *[float("nan")] * 4)
    with np.errstate(invalid="ignore"):
        any_angle, below_60, below_45 = (float(areas @ of_it) / total for of_it in (np.isfinite(best), best > BELOW_60, best > BELOW_45))
    return Share(total / 100.0, any_angle, below_60, below_45, float(areas @ met.expected[chosen]) / total)
