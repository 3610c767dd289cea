"""Predictions of bone that another program made and recorded: a sequence of probabilities beside the sequence of images."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import scipy

from ..arrays import Integers, Numbers, Singles
from ..errors import GeometryError, SequenceFormatError
from ..geometry.transform_graph import TransformStatus
from ..sweep.frames import TrackedFrame, TrackedSequence
from ..sweep.multi_sweep import sweeps_of
from .predictions import Prediction
from .scan_line_reader import Rectangle

COVERS = "BoneFramePx"
"""The field of a prediction that says which rectangle of its frame it covers, as X Y W H."""

SAME_TIME = 1e-3
"""s. Time stamps this near to each other are of one frame: programs write them with different numbers of digits."""

ROUNDING = 1e-3
"""By how much a probability may lie outside 0 to 1: what a network's last layer rounds."""


class RecordedPredictions:
    """Probability images of a sweep's frames, as an estimator.

    A prediction belongs to the frame of its time stamp (to 1 ms). Where one of the files has no time stamps, or none of them is that of a
    frame, it belongs to the frame of its number, if there are as many. Frames without one say nothing, and are counted.

    Raises GeometryError when sizes or counts do not fit; SequenceFormatError when pixels are neither 8 bit nor floating point.

    Parameters
    ----------
    sequence : TrackedSequence or several in one Reference
        The sweep.
    predictions : TrackedSequence, or one for each sweep
        As `read_sequence` returns them; 8 bit (0 to 255, or 0 and 1) or floating point (0 to 1). Their transforms are not looked at.
    rectangle : (x, y, width, height) or None
        What a prediction covers, in pixels of a frame, where it has not the size of one and does not say itself, as those recorded live do.
    """

    def __init__(
        self,
        sequence: TrackedSequence | Iterable[TrackedSequence],
        predictions: TrackedSequence | Iterable[TrackedSequence],
        rectangle: Rectangle | None = None,
    ):
        sweeps, of_each = sweeps_of(sequence), sweeps_of(predictions)
        if len(sweeps) != len(of_each):
            raise GeometryError(
                f"Predictions must be one sequence for each sweep; got {len(of_each)} for {len(sweeps)}.",
                "Give one for each, in their order.",
            )
        self._rectangle = checked_rectangle(rectangle)
        self.made: dict[str, object] = {} if self._rectangle is None else {"bone_frames_px": self._rectangle}
        self._notes: list[str] = []
        self._of_frame: list[tuple[TrackedSequence, int] | None] = []
        for sweep, predicted in zip(sweeps, of_each, strict=True):
            self._check(sweep, predicted)
            self._of_frame += [None if number < 0 else (predicted, number) for number in self._matched(sweep, predicted).tolist()]
        self._full = {id(predicted): full_value(predicted) for predicted in of_each}

    def estimate(self, frame: TrackedFrame) -> Prediction | None:
        """What was recorded for a frame; None where nothing was; raises SequenceFormatError when it holds what is no probability."""
        found = self._of_frame[frame.number] if 0 <= frame.number < len(self._of_frame) else None
        if found is None or found[0].records[found[1]].image_status is not TransformStatus.OK:
            return None
        predicted, number = found
        return Prediction(
            probability_of(predicted.images[number], self._full[id(predicted)], f"{predicted.name}, frame {number}"),
            self._rectangle,
        )

    def notes(self) -> tuple[str, ...]:
        """How predictions and frames were matched."""
        return tuple(self._notes)

    def _check(self, sweep: TrackedSequence, predicted: TrackedSequence) -> None:
        kind = np.dtype(predicted.images.dtype)
        if kind.kind != "f" and kind.name not in ("uint8", "bool"):
            raise SequenceFormatError(
                f"{predicted.name}: predictions must be 8 bit, 0 to 255, or floating point, 0 to 1; got {kind.name}. Save them "
                "as one of these."
            )
        self._rectangle = self._rectangle or _own_rectangle(predicted)
        if self._rectangle is None and predicted.frame_size != sweep.frame_size:
            raise GeometryError(
                f"{predicted.name}: predictions of {_size(predicted)} pixels do not fit frames of {_size(sweep)}.",
                "Say with {bone_frames_px:X Y W H} which rectangle of the frame they cover.",
            )

    def _matched(self, sweep: TrackedSequence, predicted: TrackedSequence) -> Integers:
        """The number of each frame's prediction, (frames,); -1 for those without."""
        frames, times = sweep.timestamps, predicted.timestamps
        matched, by = np.full(len(sweep), -1), "time"
        if frames.size and times.size and np.isfinite(frames).all() and np.isfinite(times).all():
            away, nearest = scipy.spatial.cKDTree(times[:, None]).query(frames[:, None], distance_upper_bound=SAME_TIME + 1e-9)
            matched = np.where(np.isfinite(away), nearest, -1)
        if not (matched >= 0).any():
            if len(sweep) != len(predicted):
                raise GeometryError(
                    f"{predicted.name}: {len(predicted)} predictions for {len(sweep)} frames, and their time stamps are not those of the "
                    "frames. Save them with the time stamps of their frames, or one for each frame."
                )
            matched, by = np.arange(len(sweep)), "number"
        count = int((matched >= 0).sum())
        self._notes.append(f"{predicted.name}: bone is predicted for {count} of {len(sweep)} frames, matched by {by}.")
        return matched


def full_value(predicted: TrackedSequence) -> float:
    """The value that means certain bone: 255 of 8 bit, unless there are only 0 and 1; 1 of floating point."""
    if np.dtype(predicted.images.dtype) != np.dtype(np.uint8):
        return 1.0
    return 255.0 if any(int(predicted.images[number].max(initial=0)) > 1 for number in range(len(predicted))) else 1.0


def as_prediction(image: Numbers, what: str, full: float = 1.0) -> Prediction:
    """An array as a prediction of all of its frame; a GeometryError where it is no image of numbers from 0 to `full`."""
    if image.ndim != 2 or image.dtype.kind not in "biuf":
        raise GeometryError(f"{what}: bone must be (rows, columns) of 0 to 1, or True and False; got {image.shape} of {image.dtype}.")
    return Prediction(probability_of(image, full, what))


def probability_of(image: Numbers, full: float, what: str) -> Singles:
    """Values as probabilities, (rows, columns) float32.

    Raises SequenceFormatError when one is not finite, or none. `what` names it.
    """
    probability: Singles = image.astype(np.float32)
    if not np.isfinite(probability).all():
        raise SequenceFormatError(f"{what}: a probability of bone must be a number; got NaN or infinity. Repair the predictions.")
    low, high = float(probability.min(initial=0.0)), float(probability.max(initial=0.0))
    if low < -ROUNDING * full or high > (1 + ROUNDING) * full:
        raise SequenceFormatError(
            f"{what}: a probability of bone must be 0 to 1; got {low:g} to {high:g}. Pass logits through a sigmoid, or divide by their "
            "largest value."
        )
    clipped: Singles = np.clip(probability / np.float32(full), 0.0, 1.0)
    return clipped


def checked_rectangle(rectangle: Rectangle | None) -> Rectangle | None:
    """The rectangle, if it is one."""
    if rectangle is None:
        return None
    if len(rectangle) != 4 or not all(math.isfinite(value) for value in rectangle) or min(rectangle[2:]) <= 0:
        raise GeometryError(f"Input rectangle must be X Y W H in pixels, with W and H above 0; got {tuple(rectangle)}.")
    x, y, width, height = (float(value) for value in rectangle)
    return x, y, width, height


def _own_rectangle(predicted: TrackedSequence) -> Rectangle | None:
    """What predictions say that they cover, in their first frame."""
    words = predicted.records[0].fields.get(COVERS, "").split() if predicted.records else []
    try:
        x, y, width, height = (float(word) for word in words)
    except ValueError:
        return None
    return checked_rectangle((x, y, width, height))


def _size(sequence: TrackedSequence) -> str:
    columns, rows = sequence.frame_size
    return f"{columns} x {rows}"
