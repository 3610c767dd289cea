"""A recording is parted into passes: between two the scan stopped, the clock jumped, the probe turned back, or another file begins."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from ..arrays import Floats, Integers, Mask, Matrix
from ..recipe.recipe import LONGEST_GAP
from ..sweep.frames import TrackedSequence
from ..sweep.poses import SweepPoses, time_order

PAUSE = 4.0
"""Times the usual step between frames that a pause lasts, and at least `LONGEST_GAP`."""

SMOOTH, MOVES, TURNED = 5, 0.25, -0.3
"""Frames over which a way is smoothed, the share of the usual step from which the probe moves, and the cosine between two ways below which
it has turned back."""

FEWEST = 8
"""Frames of a pass; what would be shorter stays with the one before."""


@dataclass(frozen=True, eq=False)
class Passes:
    """Which frame belongs to which pass, and when it was taken; frames are counted over all sweeps."""

    numbers: Integers  #: (frames,). -1 for frames that cannot be placed.
    times: Floats  #: (frames,), s on one clock that goes on from sweep to sweep
    image_to_reference: Matrix  #: (frames, 4, 4), mm, as recorded; NaN where nothing places a frame

    def __len__(self) -> int:
        return int(self.numbers.max(initial=-1)) + 1


def passes_of(sweeps: list[TrackedSequence], poses: list[SweepPoses]) -> Passes:
    """The passes of sweeps with these poses."""
    numbers, times, count, before = [], [], 0, 0.0
    for sweep, placed in zip(sweeps, poses, strict=True):
        order = time_order(sweep)
        order = order[np.isin(order, placed.usable)]
        stamps = sweep.timestamps if np.isfinite(sweep.timestamps).all() else np.arange(len(sweep)) / 20.0
        stamps = stamps - stamps.min(initial=np.inf)
        number = np.full(len(sweep), -1)
        if len(order):
            number[order] = count + parted(stamps[order], placed.image_to_reference[order])
            count = int(number.max()) + 1
        numbers.append(number)
        times.append(before + stamps)
        before += float(stamps.max(initial=0.0)) + 2 * LONGEST_GAP
    return Passes(np.concatenate(numbers), np.concatenate(times), np.concatenate([each.image_to_reference for each in poses]))


def parted(stamps: Floats, matrices: Matrix) -> Integers:
    """The number of the pass of each frame (n,), in the order of time."""
    steps = np.diff(stamps)
    usual = float(np.median(steps)) if len(steps) else 0.0
    begins: Mask = np.concatenate([[True], steps > max(LONGEST_GAP, PAUSE * usual)])
    for first, last in pairwise([*np.flatnonzero(begins), len(begins)]):
        begins[first + _turns(matrices[first:last, :3, 3])] = True
    numbers, number, length = np.empty(len(begins), np.int64), 0, 0
    for n, begin in enumerate(begins):
        if begin and length >= FEWEST:
            number, length = number + 1, 0
        numbers[n], length = number, length + 1
    if length < FEWEST and number:
        numbers[-length:] -= 1
    return numbers


def _turns(places: Floats) -> Integers:
    """Where a way (n, 3) turns back, against the way that it took since the last turn."""
    if len(places) < 2 * FEWEST:
        return np.empty(0, np.int64)
    ways = np.gradient(scipy.ndimage.uniform_filter1d(places, SMOOTH, axis=0), axis=0)
    lengths = np.linalg.norm(ways, axis=1)
    turns, way = [], np.zeros(3)
    for n in np.flatnonzero(lengths > MOVES * np.median(lengths)):
        here = ways[n] / max(lengths[n], 1e-9)
        if here @ way < TURNED * np.linalg.norm(way):
            turns.append(n)
            way = np.zeros(3)
        way = 0.9 * way + 0.1 * here
    return np.array(turns, np.int64)
