"""A bone map from what is told of bone in every frame of a sweep: by a network, another program, or the rule for echoes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from typing import Protocol

from ..effective_settings import Imaging, resolve_imaging
from ..errors import GeometryError
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..sweep.frames import TrackedFrame, TrackedSequence
from ..sweep.multi_sweep import joined
from ..sweep.poses import SweepPoses, still_images_of, sweep_poses, tracked_frames
from .echoes.finder import BoneEchoFinder
from .echoes.found import BoneEchoes, SweepEchoes
from .echoes.surface import LEAST_SCORE, surface_of
from .map import BoneMap
from .predictions import Prediction, PredictionReader
from .recorded_predictions import RecordedPredictions
from .scan_line_reader import ForEachKind


class BoneEstimator(Protocol):
    """What tells where bone is in a frame."""

    def estimate(self, frame: TrackedFrame) -> Prediction | BoneEchoes | None:
        """The probability of bone in a frame that has an image and a pose, or points of it; None where nothing is known of it."""
        ...

    def notes(self) -> tuple[str, ...]:
        """What a user should know of it, one sentence each."""
        ...


class EchoEstimator:
    """The rule of `BoneEchoFinder` as an estimator, as `bone_from_sweep` has it: no network, no CT.

    `imaging` must know region and probe.
    """

    def __init__(self, imaging: Imaging):
        self._finders = ForEachKind(partial(BoneEchoFinder, least=LEAST_SCORE), imaging)

    def estimate(self, frame: TrackedFrame) -> BoneEchoes:
        """See `BoneEstimator`."""
        return self._finders.of(frame).find(frame.placed()[0])

    def notes(self) -> tuple[str, ...]:
        """Nothing."""
        return ()


class PointsOfFrames:
    """What an estimator says of frames, as points in Reference; `imaging` must know region and probe."""

    def __init__(self, imaging: Imaging):
        self._readers = ForEachKind(PredictionReader, imaging)

    def of(self, frame: TrackedFrame, said: Prediction | BoneEchoes) -> SweepEchoes:
        """Of a frame that has an image and a pose."""
        found = self._readers.of(frame).find(said) if isinstance(said, Prediction) else said
        return found.placed(frame.placed()[1], frame.number)


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
    recipe = recipe or Recipe()
    sequence = joined(sequence, recipe)
    poses = sweep_poses(sequence, recipe.image_to_reference, recipe.reference) if poses is None else poses
    usable = poses.require_usable(sequence.name)
    imaging = resolve_imaging(sequence, poses, True, recipe) if imaging is None else imaging
    points, found, silent = PointsOfFrames(imaging), [], 0
    looking = part(progress, 0.0, 0.9)
    for done, frame in enumerate(tracked_frames(sequence, poses, usable, still_images_of(sequence, poses, usable))):
        report(looking, done / len(usable), "Looking for bone in the sweep")
        if frame.status != "OK":
            continue
        said = estimator.estimate(frame)
        if said is None:
            silent += 1
        else:
            found.append(points.of(frame, said))
    echoes = SweepEchoes.joined(found)
    if not len(echoes):
        raise GeometryError(f"{sequence.name}: no frame shows bone by what it is looked for with.", "Give {bone_labels}, or no bone.")
    notes = list(estimator.notes())
    if silent:
        notes.append(f"Nothing is said of bone in {silent} of {len(usable)} frames.")
    made = estimator.made if isinstance(estimator, RecordedPredictions) else {}
    return replace(surface_of(echoes, part(progress, 0.9, 1.0)), notes=tuple(notes), made=made)
