"""A bone map from predictions in every frame of a sweep: by the sweep's own echoes, a network, or another program."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Protocol

import numpy as np

from ..arrays import Matrix
from ..errors import GeometryError
from ..geometry.volume import VoxelGrid
from ..holes.automatic import SHARE, distances_between_frames
from ..imaging.extent import grid_around_sweep
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..remedies import Remedy
from ..resolve import Imaging, resolve_imaging
from ..sweep.frames import TrackedFrame, TrackedSequence
from ..sweep.joined import joined
from ..sweep.poses import SweepPoses, sweep_poses, tracked_frames
from .echoes.finder import BoneEchoFinder
from .map import BoneMap
from .predictions import LARGEST_SIGMA, SIGMA, SPACING, BoneAccumulator, Prediction, PredictionSampler, cubes_over
from .scan_line_reader import ForEachKind


class BoneEstimator(Protocol):
    """What tells where bone is in a frame."""

    def estimate(self, frame: TrackedFrame) -> Prediction | None:
        """The probability of bone in a frame that has an image and a pose; None where nothing is known of it."""
        ...

    def notes(self) -> tuple[str, ...]:
        """What a user should know of it, one sentence each."""
        ...


class EchoEstimator:
    """The rule of `BoneEchoFinder` as an estimator: no network, no CT.

    A scan line that found bone says its score from `HALF_THICKNESS` mm before the echo to as much behind it, and 0 elsewhere.

    `imaging` must know region and probe.
    """

    def __init__(self, imaging: Imaging):
        self._finders = ForEachKind(BoneEchoFinder, imaging)

    def estimate(self, frame: TrackedFrame) -> Prediction | None:
        """See `BoneEstimator`."""
        return Prediction(self._finders.of(frame).drawn(frame.placed()[0]))

    def notes(self) -> tuple[str, ...]:
        """Nothing."""
        return ()


def bone_from_frames(
    sequence: TrackedSequence | Iterable[TrackedSequence],
    estimator: BoneEstimator,
    poses: SweepPoses | None = None,
    imaging: Imaging | None = None,
    progress: Progress | None = None,
    recipe: Recipe | None = None,
) -> BoneMap:
    """A bone map of what an estimator predicts in every frame.

    Raises BeamGeometryError when the probe is not known; GeometryError when no frame shows bone.

    Parameters
    ----------
    sequence : TrackedSequence or several in one Reference
    estimator : BoneEstimator
        `RecordedPredictions` of files, an `OnnxModel`, an `EchoEstimator`, or one of your own.
    poses, imaging : SweepPoses, Imaging or None
        Where they are known already, as `sweep_poses` and `resolve_imaging` return them.
    recipe : Recipe or None
        As in `reconstruct`; what `poses` or `imaging` tell comes before it.
    """
    sequence, recipe = joined(sequence), recipe or Recipe()
    poses = sweep_poses(sequence, recipe.image_to_reference, recipe.reference) if poses is None else poses
    usable = poses.require_usable(sequence.name)
    imaging = resolve_imaging(sequence, poses, True, recipe) if imaging is None else imaging
    matrices = poses.image_to_reference[usable]
    box = grid_around_sweep(matrices, sequence.frame_size, imaging.region, (SPACING,) * 3, 40)
    sigma = sigma_for(matrices, imaging, sequence.frame_size, box)
    known = BoneAccumulator(cubes_over(box, margin=3 * sigma), sigma)
    samplers, silent = ForEachKind(PredictionSampler, imaging), 0
    looking = part(progress, 0.0, 0.9)
    for done, frame in enumerate(tracked_frames(sequence, poses, usable)):
        report(looking, done / len(usable), "Looking for bone in the sweep")
        prediction = estimator.estimate(frame)
        if prediction is None:
            silent += 1
        else:
            image, pose = frame.placed()
            known.add(samplers.of(frame).sample(image, prediction), pose)
    if not known.shows_bone:
        raise GeometryError(f"{sequence.name}: no frame shows bone by what it is looked for with.", Remedy.BONE_OF_CT)
    found = known.map(part(progress, 0.9, 1.0))
    notes = list(estimator.notes())
    if silent:
        notes.append(f"Nothing is said of bone in {silent} of {len(usable)} frames.")
    return replace(found, notes=tuple(notes))


def sigma_for(image_to_reference: Matrix, imaging: Imaging, size: tuple[int, int], box: VoxelGrid) -> float:
    """The smoothing, mm, that joins frames as far apart as these: half of what all but `SHARE` of the space between them is within."""
    if len(image_to_reference) < 2:
        return SIGMA
    distances = distances_between_frames(image_to_reference[:, :3], imaging.region.mask(*size), box)
    apart = 2.0 * float(np.quantile(distances, SHARE)) if distances.size else 0.0
    return float(np.clip(0.5 * apart, SIGMA, LARGEST_SIGMA))
