"""The recent samples of one transform of a stream, and what it was at the time of an image."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections import deque
from dataclasses import dataclass

import numpy as np

from ...arrays import Matrix
from ...geometry.pose_interpolation import interpolate_pose, pose_change
from ...geometry.transform_graph import MISSING, TransformSample, TransformStatus
from ...geometry.transforms import why_not_rigid

LONGEST_MEMORY = 4096
"""Samples kept of each transform: 10 s of the fastest trackers."""

LARGEST_SPEED = 500.0
"""mm/s, and"""

LARGEST_TURN = math.radians(360.0)
"""radians/s: two samples that lie farther apart are no motion of a hand but a jump, as at the end of a looped recording."""


@dataclass(frozen=True)
class Answer:
    """What a transform was at a time.

    Parameters
    ----------
    sample : TransformSample
        Not OK: there is no pose at that time.
    problem : str or None
        The reason where the status word does not tell it: ``"stale"`` (the neighbors in time are too far apart), ``"jumps"``.
    exact : bool
        It is a sample of that very time.
    """

    sample: TransformSample
    problem: str | None = None
    exact: bool = False


class PoseHistory:
    """Samples of one transform in order of arrival; a time that goes back starts over.

    Parameters
    ----------
    longest_gap : float, s
        Two samples may be this far apart for a pose between them.
    """

    def __init__(self, longest_gap: float):
        self._longest_gap = longest_gap
        self._times: deque[float] = deque(maxlen=LONGEST_MEMORY)
        self._samples: deque[TransformSample] = deque(maxlen=LONGEST_MEMORY)
        self._began = 0
        self._matches = 0
        self._strangers = 0

    @property
    def paired(self) -> bool:
        """Whether it comes with the very times of the images: then a missing sample means a tool that was not seen."""
        return self._matches > self._strangers

    def compare(self, before: float | None, time: float) -> None:
        """Learn whether its times are those of the images, from an image of `time` and the image `before` that."""
        first = bisect_right(self._times, before) if before is not None else len(self._times)
        index = bisect_left(self._times, time)
        self._strangers += max(index - first, 0)
        self._matches += index < len(self._times) and self._times[index] == time

    def add(self, time: float, sample: TransformSample, arrival: int) -> None:
        """Append a sample; `arrival` counts the messages of the stream."""
        if self._times and time < self._times[-1]:
            self.forget()
            self._began = arrival
        if self._times and time == self._times[-1]:
            # Sent again: the later statement holds
            self._times.pop(), self._samples.pop()
        self._times.append(time)
        self._samples.append(sample)

    def forget(self, since: int | None = None) -> None:
        """Drop all samples, unless its time went back after message number `since`: then they are of the new round."""
        if since is None or self._began <= since:
            self._times.clear()
            self._samples.clear()

    def exactly_at(self, time: float) -> Answer | None:
        """The sample of this very time, if it has come."""
        index = bisect_left(self._times, time)
        if index < len(self._times) and self._times[index] == time:
            return Answer(self._samples[index], exact=True)
        return None

    def has_passed(self, time: float) -> bool:
        """Whether a sample of a later time has come, after which none of this time will."""
        return bool(self._times) and self._times[-1] > time

    def between(self, time: float) -> Answer | None:
        """The pose at a time between samples; None while the sample behind that time has not come.

        Notes
        -----
        A sample that is not OK on either side, or none before, leaves the time without a pose.
        """
        index = bisect_left(self._times, time)
        if index == len(self._times):
            return None
        if self._times[index] == time:
            return Answer(self._samples[index], exact=True)
        if index == 0:
            return Answer(MISSING)
        before, after = self._samples[index - 1], self._samples[index]
        for sample in (before, after):
            if sample.status is not TransformStatus.OK:
                return Answer(TransformSample(MISSING.matrix, sample.status))
            if why_not_rigid(sample.matrix) and not _is_like(before.matrix, after.matrix):
                return Answer(TransformSample(sample.matrix, TransformStatus.INVALID), why_not_rigid(sample.matrix))
        span = self._times[index] - self._times[index - 1]
        if span > self._longest_gap:
            return Answer(MISSING, "stale")
        distance, angle = pose_change(before.matrix, after.matrix)
        if distance > LARGEST_SPEED * span or angle > LARGEST_TURN * span:
            return Answer(TransformSample(MISSING.matrix, TransformStatus.INVALID), "jumps")
        fraction = (time - self._times[index - 1]) / span
        return Answer(TransformSample(interpolate_pose(before.matrix, after.matrix, fraction)))

    def given_up(self) -> Answer:
        """The answer when nothing more is waited for."""
        return Answer(MISSING, "stale" if self._times else None)


def _is_like(first: Matrix, second: Matrix) -> bool:
    """Whether two matrices that are not rigid, as an image's with its pixel size, are finite and have the same axes' lengths."""
    if not (np.isfinite(first).all() and np.isfinite(second).all()):
        return False
    one, other = (np.linalg.norm(matrix[:3, :3], axis=0) for matrix in (first, second))
    return bool(one.min() > 0.0 and np.allclose(one, other, rtol=0.02))
