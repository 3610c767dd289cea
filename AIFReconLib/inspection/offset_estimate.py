"""How far images and poses are out of step, told from a sweep that goes back over the same place.

On the way there and on the way back the probe sees the same anatomy at the same place. Where poses are late, images that claim one place
show two different ones, apart by twice the speed times the delay. So the offset is sought at which images of one place, taken while moving
in opposite directions, are most alike. A sweep that never turns back says nothing about it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Integers, Matrix, Reals
from ..geometry.box import block_sums
from ..message import Sentence
from ..progress import Progress, report
from ..recipe.recipe import LONGEST_GAP
from ..remedies import SAME_MOVEMENT
from ..sweep.frames import TrackedSequence
from ..sweep.poses import SweepPoses
from ..sweep.time_offset import BEGUN_MM, first_change

LARGEST = 0.5
"""s. Offsets are sought from minus to plus this."""

STEP = 0.01
"""s. Between offsets that are tried; the minimum is then refined by a parabola."""

MOST_FRAMES = 400
"""Images that are looked at, spread evenly over the sweep."""

FEWEST_FRAMES = 20
SHORTEST_RETURN = 0.3
"""s. Images closer in time are alike whatever the offset."""

FEWEST_RETURNS = 10
"""Frames that must have a partner on the way back."""

SMALLEST_NEIGHBORHOOD = 0.5
"""mm. Two images nearer than about this show the same place."""

LARGEST_COST = 0.85
"""Of the mean cost of all offsets: above it, no offset makes the images agree much better than any other."""

STOOD = 0.5
"""s that a tool must have stood still at first, and that it must begin apart from the images."""

LEAST_SURE = 0.1
"""s. An estimate that is less sure than this is none."""

JUMP, SHORTEST_JUMP = 4.0, 3.0
"""A step this many times as fast as nine of ten, and longer than so many mm, is no motion: a recording that begins anew, a lost marker."""

_BLOCKS = 10
_NEGLIGIBLE = -7.0
"""Exponent of a weight that counts for nothing."""
_PATCHES = 24
"""Patches along the longer side of an image, whose mean gray levels are compared: speckle is gone, anatomy is left."""


@dataclass(frozen=True)
class OffsetEstimate:
    """What a sweep says of its time offset."""

    time_offset: float | None = None  #: s. As `with_time_offset` takes it; None when it cannot be told.
    uncertainty: float | None = None
    """s. Twice the standard error (jackknife over ten parts of the sweep), and not below half a step."""
    reason: str = ""  #: Why it cannot be told; "" otherwise
    begins_late: float | None = None
    """s by which a tool that stood still begins to move after the images change; None: not seen, or near."""

    @property
    def out_of_step(self) -> bool:
        """Whether there is an offset beyond doubt."""
        return self.time_offset is not None and abs(self.time_offset) > max(self.uncertainty or 0.0, STEP)

    def to_text(self) -> str:
        """One sentence for a user."""
        if self.time_offset is None:
            told = f"Whether images and poses are in step cannot be told: {self.reason}."
            if self.begins_late is None:
                return told
            told += f" The tool begins to move {self.begins_late:+.2f} s after the images begin to change."
            return Sentence(told, SAME_MOVEMENT, offset=f"{self.begins_late:.2f}")
        if self.out_of_step:
            return Sentence(
                f"Images and poses are likely out of step by {self.time_offset:+.3f} s (give or take {self.uncertainty:.3f} s). "
                f"A time offset of {self.time_offset:.3f} would put them in step.",
                "Apply it with {time_offset:auto} in the same run.",
            )
        return f"Images and poses are in step: offset {self.time_offset:+.3f} s, give or take {self.uncertainty:.3f} s."


def estimate_time_offset(sequence: TrackedSequence, poses: SweepPoses, progress: Progress | None = None) -> OffsetEstimate:
    """Estimate the time offset between images and poses.

    Parameters
    ----------
    sequence : TrackedSequence
        Images are read one at a time, `MOST_FRAMES` at most, and only when the sweep turns back on itself
        or first stands still.
    poses : SweepPoses
        As `sweep_poses` finds them.
    """
    usable = poses.usable
    stamps = sequence.timestamps[usable]
    if not np.isfinite(stamps).all():
        return OffsetEstimate(reason="not every frame has a time stamp")
    times, first = np.unique(stamps, return_index=True)
    if len(times) < FEWEST_FRAMES:
        return OffsetEstimate(reason=f"there are only {len(times)} frames with a pose and a time of their own")
    track = _Track(times, corner_track(poses.image_to_reference[usable[first]], sequence.frame_size))
    chosen = np.unique(np.linspace(0, len(times) - 1, min(len(times), MOST_FRAMES)).round().astype(int))
    near = max(SMALLEST_NEIGHBORHOOD, track.typical_step / 2)
    returns = track.weights(chosen, 0.0, 2 * near).any(axis=1).sum()
    if returns < FEWEST_RETURNS:
        reason = "the sweep does not go back over the same place in the opposite direction"
        return OffsetEstimate(reason=reason, begins_late=_begins_late(sequence, usable[first], track))
    dissimilarity = _dissimilarity(sequence, usable[first][chosen], progress)
    offsets = STEP * np.arange(-round(LARGEST / STEP), round(LARGEST / STEP) + 1)
    starts = np.arange(_BLOCKS) * len(chosen) // _BLOCKS
    sums: Floats = np.array([_block_sums(track.weights(chosen, offset, near), dissimilarity, starts) for offset in offsets])
    best = _minimum(offsets, sums.sum(axis=(2, 3)))
    if best is None:
        reason = "the images agree best at no offset within half a second, or at none much better than at others"
        return OffsetEstimate(reason=reason, begins_late=_begins_late(sequence, usable[first], track))
    without = (np.delete(np.delete(sums, b, axis=2), b, axis=3) for b in range(_BLOCKS))
    each = [_minimum(offsets, rest.sum(axis=(2, 3))) for rest in without]
    left_out = np.array([offset for offset in each if offset is not None])
    spread = np.sqrt((_BLOCKS - 1) / _BLOCKS * np.sum((left_out - np.mean(left_out)) ** 2)) if len(left_out) == _BLOCKS else np.inf
    middle = _BLOCKS // 2
    halves = [_minimum(offsets, sums[:, :, half, half].sum(axis=(2, 3))) for half in (slice(middle), slice(middle, None))]
    apart = abs(halves[0] - halves[1]) if halves[0] is not None and halves[1] is not None else 0.0
    if 2 * spread > LEAST_SURE or apart > LEAST_SURE:
        return OffsetEstimate(reason="parts of the sweep contradict each other")
    return OffsetEstimate(float(best), float(max(2 * spread, STEP / 2)))


def _begins_late(sequence: TrackedSequence, numbers: Integers, track: _Track) -> float | None:
    """As `OffsetEstimate` has it, by the images of these numbers, one for each place of the track."""
    moved = np.flatnonzero(np.linalg.norm(track.points - track.points[0], axis=1) > BEGUN_MM)
    if not len(moved) or track.times[moved[0]] - track.times[0] < STOOD:
        return None
    changes = first_change(sequence.images, numbers.tolist(), track.times)
    late = None if changes is None else float(track.times[moved[0]] - changes)
    return late if late is not None and abs(late) > STOOD else None


def corner_track(image_to_reference: Matrix, frame_size: tuple[int, int]) -> Floats:
    """The four corners of every image as one point of a 12-dimensional space, (frames, 12).

    Divided by two, so that the distance of two such points is the root mean square distance of the corners, in mm: rotations count by
    how far they move the image.
    """
    columns, rows = frame_size
    corners = np.array([(c, r, 0.0, 1.0) for c in (0, columns - 1) for r in (0, rows - 1)])
    track: Floats = np.einsum("nij,kj->nki", image_to_reference[:, :3], corners).reshape(len(image_to_reference), 12) / 2.0
    return track


class _Track:
    """Where the image is over time: in stretches, which end where frames are missing or the image jumps."""

    def __init__(self, times: Floats, points: Floats):
        self.times = times
        self.points = points
        steps, seconds = np.linalg.norm(np.diff(points, axis=0), axis=1), np.diff(times)
        missing = seconds > LONGEST_GAP
        speeds = steps / seconds
        usual = np.percentile(speeds[~missing], 90) if not missing.all() else 0.0
        jumps = (speeds > JUMP * usual) & (steps > SHORTEST_JUMP)
        self._stretch = np.concatenate([[0], np.cumsum(missing | jumps)])
        self.velocities = np.zeros_like(points)
        for number in range(int(self._stretch[-1]) + 1):
            stretch = self._stretch == number
            if stretch.sum() > 1:
                self.velocities[stretch] = np.gradient(points[stretch], times[stretch], axis=0)
        steady = steps[~(missing | jumps)]
        self.typical_step = float(np.median(steady)) if len(steady) else 0.0

    def weights(self, images: Integers, offset: float, near: float) -> Floats:
        """How much each pair of images counts whose poses are `offset` (s) off: same place, opposite ways, not one right after the other.

        `images` (n,) are their numbers on this track; (n, n) comes back. Within `near` (mm) is the same place.
        """
        at = self.times[images] + offset
        points = np.stack([np.interp(at, self.times, column) for column in self.points.T], axis=1)
        velocities = np.stack([np.interp(at, self.times, column) for column in self.velocities.T], axis=1)
        speeds = np.linalg.norm(velocities, axis=1)
        after = np.clip(np.searchsorted(self.times, at), 1, len(self.times) - 1)
        # Between two frames of the stretch that the image itself is of; a moment that is a frame's own belongs to it alone
        stretch = self._stretch[images]
        before = np.where(at == self.times[after], after, after - 1)
        after = np.where(at == self.times[after - 1], after - 1, after)
        known = (at >= self.times[0]) & (at <= self.times[-1]) & (self._stretch[before] == stretch) & (self._stretch[after] == stretch)
        moving = known & (speeds > 0.2 * np.percentile(speeds, 75)) & (speeds > 0)
        squares = (points**2).sum(axis=1)
        exponents = (_products(points) - 0.5 * (squares[:, None] + squares[None])) / near**2
        counts = exponents > _NEGLIGIBLE
        counts &= _products(velocities) < -0.5 * speeds[:, None] * speeds[None]
        counts &= np.abs(at[:, None] - at[None]) > SHORTEST_RETURN
        counts &= moving[:, None] & moving[None]
        weights = np.zeros(counts.shape)
        weights[counts] = np.exp(np.minimum(exponents[counts], 0.0))
        return weights


def _dissimilarity(sequence: TrackedSequence, numbers: Integers, progress: Progress | None) -> Floats:
    """Mean squared difference of every two images, in patches; (n, n)."""
    columns, rows = sequence.frame_size
    size = max(1, max(columns, rows) // _PATCHES)
    patches = []
    for done, number in enumerate(numbers):
        report(progress, done / len(numbers), "Comparing images and poses")
        patches.append(block_sums(sequence.images[number], (size, size), np.float64).ravel() / size**2)
    report(progress, 1.0, "Comparing images and poses")
    values = np.array(patches)
    values -= values.mean(axis=0)
    squares = (values**2).sum(axis=1)
    dissimilarity: Floats = np.maximum(squares[:, None] + squares[None] - 2 * _products(values), 0)
    return dissimilarity


def _products(vectors: Floats) -> Floats:
    """Every vector times every other. (The matrix product would wake all cores for so small a task.)"""
    products: Floats = np.einsum("ik,jk->ij", vectors, vectors)
    return products


def _block_sums(weights: Floats, dissimilarity: Floats, starts: Integers) -> Floats:
    """Weighted dissimilarity and weight, summed over every two blocks of frames; (2, blocks, blocks)."""
    values = np.stack([weights * dissimilarity, weights])
    return np.add.reduceat(np.add.reduceat(values, starts, axis=1), starts, axis=2)


def _minimum(offsets: Reals, sums: Reals) -> float | None:
    """Where the mean dissimilarity is least, refined by a parabola; None where that is at an end or hardly a minimum."""
    with np.errstate(invalid="ignore", divide="ignore"):
        cost = np.where(sums[:, 1] > 0, sums[:, 0] / sums[:, 1], np.inf)
    lowest = int(np.argmin(cost))
    around = cost[max(lowest - 1, 0) : lowest + 2]
    if len(around) < 3 or not np.isfinite(around).all() or cost[lowest] > LARGEST_COST * cost[np.isfinite(cost)].mean():
        return None
    left, middle, right = around
    bend = left - 2 * middle + right
    return float(offsets[lowest] + (STEP * 0.5 * (left - right) / bend if bend > 0 else 0.0))
