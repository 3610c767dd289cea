"""A bone map from what is told of bone in every frame of a sweep: by a network, another program, or the rule for echoes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import partial
from typing import Protocol

import numpy as np

from ..arrays import Numbers
from ..effective_settings import Imaging, resolve_imaging
from ..errors import GeometryError, require_kind
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..sweep.frames import TrackedFrame, TrackedSequence
from ..sweep.multi_sweep import joined
from ..sweep.poses import SweepPoses, still_images_of, sweep_poses, tracked_frames
from .echoes.finder import BoneEchoFinder
from .echoes.found import BoneEchoes, SweepEchoes
from .echoes.surface import LEAST_SCORE, surface_of
from .map import BoneMap
from .predictions import Prediction, points_of
from .recorded_predictions import RecordedPredictions, as_prediction
from .scan_line_reader import ForEachKind, ScanLineReader

MOST_BONE = 0.5
"""Share of the pixels that masks may call bone: its surface is thin."""

SAME_SHAPE = 0.02
"""By which the ratio of the sides of a mask may differ from its frame's."""


class BoneEstimator(Protocol):
    """What tells where bone is in a frame."""

    def estimate(self, frame: TrackedFrame) -> Prediction | BoneEchoes | Numbers | None:
        """The probability of bone in a frame that has an image and a pose, an array (rows, columns) will do, or points of it; None where
        nothing is known of it."""
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


class _Masks:
    """Masks in memory of frames of (columns, rows) pixels as an estimator; `full` is the value of certain bone."""

    def __init__(self, masks: Sequence[Numbers] | Numbers, full: float, frame_size: tuple[int, int]):
        self._masks, self._full, self._frame_size = masks, full, frame_size

    def estimate(self, frame: TrackedFrame) -> Prediction:
        return as_prediction(np.asarray(self._masks[frame.number]), f"mask {frame.number}", self._full)

    def notes(self) -> tuple[str, ...]:
        prediction = f"Bone is what {len(self._masks)} masks say."
        (high, wide), (columns, rows) = np.shape(self._masks[0]), self._frame_size
        if abs(high * columns / (wide * rows) - 1) <= SAME_SHAPE:
            return (prediction,)
        cut = f"WARNING: Masks of {high} x {wide} pixels are laid over whole frames of {rows} x {columns}, which have another shape."
        return (prediction, f"{cut} Were they cut out of them? Put them back into arrays as large as the frames.")


class PointsOfFrames:
    """What an estimator says of frames, as points in Reference; `imaging` must know region and probe."""

    def __init__(self, imaging: Imaging):
        self._readers = ForEachKind(ScanLineReader, imaging)

    def of(self, frame: TrackedFrame, prediction: Prediction | BoneEchoes | Numbers) -> SweepEchoes:
        """Of a frame that has an image and a pose; an InputTypeError where an estimator of one's own answers something else."""
        if isinstance(prediction, np.ndarray):
            prediction = as_prediction(prediction, f"frame {frame.number}")
        require_kind(
            "estimate", prediction, (Prediction, BoneEchoes), "An estimator answers with an array (rows, columns) of 0 to 1, or None."
        )
        image, pose = frame.placed()
        if isinstance(prediction, Prediction):
            prediction = points_of(prediction, self._readers.of(frame), (0.0, 0.0, float(image.shape[1]), float(image.shape[0])))
        return prediction.placed(pose, frame.number)


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
        prediction = estimator.estimate(frame)
        if prediction is None:
            silent += 1
        else:
            found.append(points.of(frame, prediction))
    echoes = SweepEchoes.joined(found)
    if not len(echoes):
        raise GeometryError(f"{sequence.name}: no frame shows bone by what it is looked for with.", "Give {bone_labels}, or no bone.")
    notes = list(estimator.notes())
    if silent:
        notes.append(f"Nothing is said of bone in {silent} of {len(usable)} frames.")
    made = estimator.made if isinstance(estimator, RecordedPredictions) else {}
    return replace(surface_of(echoes, part(progress, 0.9, 1.0)), notes=tuple(notes), made=made)


def bone_from_masks(
    sequence: TrackedSequence | Iterable[TrackedSequence],
    masks: Sequence[Numbers] | Numbers,
    recipe: Recipe | None = None,
    *,
    progress: Progress | None = None,
) -> BoneMap:
    """A bone map of what a network says of every frame.

    Raises GeometryError when there is not one mask for each frame, or no frame shows bone; BeamGeometryError when the probe is not known.

    Parameters
    ----------
    sequence : TrackedSequence or several in one Reference
    masks : (frames, rows, columns) or (frames, 1, rows, columns) array, or one array for each frame
        Where bone is: True, or from 0 to 1; 8 bit: 0 to 255. As large as the frames, or resized ones of all of them; a note warns of those
        of another shape.
    recipe : Recipe or None
        As in `reconstruct`.
    """
    sequence = joined(sequence, recipe or Recipe())
    if len(masks) != len(sequence):
        raise GeometryError(f"Input masks must be one for each of {len(sequence)} frames, (frames, rows, columns); got {np.shape(masks)}.")
    if np.shape(masks[0])[:-2] == (1,):
        masks = [mask[0] for mask in masks]
    share = np.mean([np.mean(np.asarray(mask) > np.max(mask, initial=0) / 2) for mask in masks])
    if share > MOST_BONE:
        raise GeometryError(f"Input masks must be set where bone is; {share:.0%} of all pixels are. Turn them round if bone is 0.")
    columns, rows = sequence.frame_size
    if np.shape(masks[0]) == (columns, rows) != (rows, columns):
        raise GeometryError(
            f"Input masks must be {rows} x {columns} like the frames; got {columns} x {rows}. Give masks.transpose(0, 2, 1)."
        )
    is_8_bit = any(np.asarray(mask).dtype == np.uint8 and np.max(mask, initial=0) > 1 for mask in masks)
    return bone_from_frames(sequence, _Masks(masks, 255.0 if is_8_bit else 1.0, sequence.frame_size), progress=progress, recipe=recipe)
