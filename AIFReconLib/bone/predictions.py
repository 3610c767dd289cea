"""Predictions of bone in frames, and the points that they mean: one per scan line, like the echoes that a rule finds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Numbers, Singles
from .echoes.found import BoneEchoes
from .scan_line_reader import Rectangle, ScanLineReader

SURE = 0.5
"""Probability from which a scan line has bone."""

AS_SURE = 0.5
"""Part of its largest probability that the stretch has in whose middle its bone lies."""


def white_of(image: Numbers) -> float | None:
    """The largest gray level of an image of whole numbers; None of others."""
    return float(np.iinfo(image.dtype.name).max) if image.dtype.kind in "iu" else None


@dataclass(frozen=True, eq=False)
class Prediction:
    """Where bone is in one frame, as a network has it."""

    probability: Singles  #: (rows, columns), 0 to 1. Of any size.
    rectangle: Rectangle | None = None
    """(x, y, width, height). What it covers, in pixels of the frame; None: all of it."""


def points_of(prediction: Prediction, reader: ScanLineReader, whole: Rectangle) -> BoneEchoes:
    """Where each scan line is surest of bone, if it is by `SURE`: the middle of the stretch there, weighted by its probabilities.

    `whole` is the rectangle of all of the frame that the reader reads.
    """
    values = reader.read_rectangle(prediction.probability, prediction.rectangle or whole)
    lines = np.flatnonzero(values.max(axis=1) >= SURE)
    values, sample = values[lines], np.arange(values.shape[1])
    scores, top = values.max(axis=1), values.argmax(axis=1)[:, None]
    ends = values < AS_SURE * scores[:, None]
    first = np.where(ends & (sample < top), sample, -1).max(axis=1, keepdims=True)
    stop = np.where(ends & (sample > top), sample, len(sample)).min(axis=1, keepdims=True)
    stretch = np.where((sample > first) & (sample < stop), values, 0.0)
    return BoneEchoes(*reader.places(lines, stretch @ sample / stretch.sum(axis=1)), scores, np.ones(len(scores), dtype=bool))
