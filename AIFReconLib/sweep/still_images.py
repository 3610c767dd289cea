"""Images that stand still while the probe moves: of a frame grabber that is slower than the tracker, of a scanner that was frozen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from ..arrays import Matrix, Numbers
from .frames import TrackedFrame

STILL = "image stands still while the probe moves"

MOVED = 0.3
"""mm by which a corner of the image must have moved: more than a tracker trembles at rest."""

_LOOK_EVERY = 16
"""Pixels from one to the next by which most images are told apart."""

Frame = TypeVar("Frame", bound=TrackedFrame)


class StillImages:
    """Finds the frames of a sweep, given in the order of time, whose image is an older one, taken at another place.

    Of equal images in a row the first shows what its pose says. The others count while they are where the first one was, as those of a
    probe at rest. An image of one gray level says nothing and stands still nowhere: one without contact, a pattern for a test.

    Parameters
    ----------
    all_equal : callable or None
        Whether all images of a recording are equal, asked before the first is left out: then each is taken for what its pose says, and
        `notes` say so. None: of a stream, where nobody knows.
    """

    def __init__(self, all_equal: Callable[[], bool] | None = None) -> None:
        self._ask, self._all_equal = all_equal, False
        self._first: tuple[Numbers, Matrix] | None = None

    @property
    def notes(self) -> tuple[str, ...]:
        """What is to be said of the sweep."""
        told = "All images are equal although the probe moved: a pattern for a test, or was the scanner frozen? All of them are taken."
        return (told,) if self._all_equal else ()

    def judged(self, frame: Frame) -> Frame:
        """The same frame, its status `STILL` where its image is of another place."""
        if self._all_equal or frame.status != "OK":
            return frame
        image, pose = frame.placed()
        if self._first is None or not are_equal(image, self._first[0]):
            self._first = image, pose
            return frame
        if _farthest(pose, self._first[1], image.shape) <= MOVED or image.min() == image.max():
            return frame
        if self._ask is not None:
            self._all_equal, self._ask = self._ask(), None
        return frame if self._all_equal else replace(frame, status=STILL)


def are_equal(image: Numbers, other: Numbers) -> bool:
    """Whether two images are the same, pixel by pixel."""
    few = slice(None, None, _LOOK_EVERY)
    return np.array_equal(image[few, few], other[few, few], equal_nan=True) and np.array_equal(image, other, equal_nan=True)


def _farthest(pose: Matrix, other: Matrix, shape: tuple[int, ...]) -> float:
    """How far the corner of an image of this shape lies that moves most between two poses, mm."""
    rows, columns = shape
    corners = np.array([(c, r, 0.0, 1.0) for c in (0, columns - 1) for r in (0, rows - 1)])
    return float(np.linalg.norm(corners @ (pose - other)[:3].T, axis=1).max())
