"""Hole filling as the Plus toolkit defines it: sticks, averages of a cube around the hole, and the mean of the nearest cube.

Sizes are in voxels, along the volume's axes. Only measured voxels are sources, so the order of filling does not matter.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Bytes, Floats, Integers, Mask, Numbers
from ..machine.threads import optional_module
from ..progress import Progress, report
from .averages import gaussian, gaussian_by_hits, inverse_distance, nearest_cube
from .filling import CUBE, GAUSSIAN, GAUSSIAN_BY_HITS, INVERSE_DISTANCE, STICK, HoleFilling
from .nearest import EMPTY, FILLED, MEASURED

STICKS = (
    *((0, 0, 1), (0, 1, 0), (1, 0, 0)),
    *((0, 1, 1), (1, 0, 1), (1, 1, 0), (0, -1, 1), (-1, 0, 1), (-1, 1, 0)),
    *((1, 1, 1), (1, 1, -1), (1, -1, 1), (1, -1, -1)),
)
"""The 13 directions [k, j, i] in which sticks lie: along edges, face diagonals and space diagonals of a voxel."""


VOXELS_AT_ONCE = 4_000_000
"""How many voxels (halo not included) are filled together, to bound the memory that is needed beside the volume."""

HOLES_AT_ONCE = 200_000
"""How many holes are bridged by sticks together, to bound the memory that is needed beside the volume."""


def fill_holes_by_kind(
    values: Numbers,
    mask: Bytes,
    kinds: tuple[HoleFilling, ...],
    progress: Progress | None = None,
    *,
    engine: str = "auto",
    score: Numbers | None = None,
) -> int:
    """Fill holes in place; returns how many were filled.

    Parameters
    ----------
    values : [k, j, i] array
        Changed where a hole is filled; rounded where it holds whole numbers.
    mask : [k, j, i] uint8 array
        MEASURED or EMPTY; filled voxels become FILLED.
    kinds : tuple of HoleFilling
        Tried in this order: a hole that one leaves empty is the next one's.
    progress : Progress or None
    engine : "auto", "numpy" or "numba"
        Who does it; the answer is the same.
    score : [k, j, i] array or None
        How many pixels, or how much of them, entered each voxel, for "gaussian by hits"; by default the same everywhere.

    Notes
    -----
    After IGSIO, whose rules these are, except that values are not cut to whole numbers on the way.
    """
    reach = max((kind.reach for kind in kinds), default=0)
    if reach < 1:
        return 0
    planes = max(VOXELS_AT_ONCE // (mask.shape[1] * mask.shape[2]), 1)
    starts = range(0, mask.shape[0], planes)
    filled = 0
    for number, start in enumerate(starts):
        report(progress, number / len(starts), "Filling gaps")
        stop = min(start + planes, mask.shape[0])
        low, high = max(start - reach, 0), min(stop + reach, mask.shape[0])
        # Filled voxels of the slab before are holes still to this one, and no sources
        known = mask[low:high] == MEASURED
        hits = None if score is None else score[low:high]
        holes = np.argwhere(mask[start:stop] == EMPTY) + np.array([start - low, 0, 0])
        for kind in kinds:
            if not len(holes) or not known.any():
                break
            found, found_values = _fill(values[low:high], known, holes, kind, engine, hits)
            at = tuple((holes[found] + np.array([low, 0, 0])).T)
            values[at] = found_values if values.dtype.kind == "f" else np.floor(found_values + 0.5)
            mask[at] = FILLED
            filled += int(found.sum())
            holes = holes[~found]
    report(progress, 1.0, "Filled holes")
    return filled


def _fill(values: Numbers, known: Mask, holes: Integers, kind: HoleFilling, engine: str, hits: Numbers | None) -> tuple[Mask, Floats]:
    """Which holes are filled in this way, and with what."""
    if kind.kind == STICK:
        return _fill_sticks(values, known, holes, kind, engine)
    if kind.kind == GAUSSIAN_BY_HITS:
        return gaussian_by_hits(values, known, holes, kind, hits)
    return _AVERAGES[kind.kind](values, known, holes, kind)


def _fill_sticks(values: Numbers, known: Mask, holes: Integers, kind: HoleFilling, engine: str) -> tuple[Mask, Floats]:
    """Linear interpolation between known voxels on both sides, along the shortest sticks.

    Notes
    -----
    With known voxels f steps ahead and r steps behind, f + r + 1 at most `size`, a stick has the value
    `((r + 1) v_ahead + f v_behind) / (f + r + 1)` and the score `1 / ((f + r + 1) |direction|)` in voxels. (The weights are IGSIO's; an
    interpolation proper would have r and f over f + r.) The best sticks are averaged by their scores; those of equal score enter
    together, until there are at least `sticks` of them.
    """
    longest = max(kind.size - 2, 0)
    padded = np.pad(known, longest)
    flat_values = np.pad(values, longest).reshape(-1)
    strides = np.array([padded.shape[1] * padded.shape[2], padded.shape[2], 1])
    places = (holes + longest) @ strides
    parts = [slice(start, start + HOLES_AT_ONCE) for start in range(0, len(places), HOLES_AT_ONCE)]
    filled = [_fill_along_sticks(flat_values, padded.reshape(-1), places[part], strides, kind, engine) for part in parts]
    return np.concatenate([found for found, _ in filled]), np.concatenate([averages for _, averages in filled])


def _fill_along_sticks(
    flat_values: Numbers, flat_known: Mask, places: Integers, strides: Integers, kind: HoleFilling, engine: str
) -> tuple[Mask, Floats]:
    """The same for holes at flat `places` of a padded volume with these strides [k, j, i]."""
    lengths = np.linalg.norm(STICKS, axis=1)
    compiled = None if engine == "numpy" else optional_module("AIFReconLib.holes.numba_sticks")
    if compiled is not None:
        averages = np.empty(len(places))
        compiled.fill_along_sticks(flat_values, flat_known, places, np.dot(STICKS, strides), lengths, kind.size, kind.sticks, averages)
        found = ~np.isnan(averages)
        return found, averages[found]
    longest = max(kind.size - 2, 0)
    score, value = np.zeros((2, len(STICKS), len(places)))
    for number, direction in enumerate(STICKS):
        step = int(np.dot(direction, strides))
        ahead = _steps(flat_known, places, step, np.full(len(places), longest))
        some = np.flatnonzero(ahead)
        behind = _steps(flat_known, places[some], -step, kind.size - 1 - ahead[some])
        some, behind = some[behind > 0], behind[behind > 0]
        f, here = ahead[some], places[some]
        length = f + behind + 1.0
        toward = (behind + 1) / length
        value[number, some] = (1 - toward) * flat_values[here - step * behind] + toward * flat_values[here + step * f]
        score[number, some] = 1.0 / (length * lengths[number])
    found = score.max(axis=0) > 0
    return found, _best_sticks(score[:, found], value[:, found], kind.sticks)


def _steps(known: Mask, places: Integers, step: int, limits: Integers) -> Integers:
    """How many steps it takes from each place to a known voxel, at most `limits`; 0 for none. `known` is flat."""
    steps = np.zeros(len(places), dtype=np.int64)
    left = np.arange(len(places))
    for taken in range(1, int(limits.max(initial=0)) + 1):
        left = left[limits[left] >= taken]
        found = known[places[left] + taken * step]
        steps[left[found]] = taken
        left = left[~found]
        if not left.size:
            break
    return steps


def _best_sticks(score: Floats, value: Floats, wanted: int) -> Floats:
    """The average of the values (sticks, holes) with the best scores, weighted by these."""
    weighted, weights = np.zeros((2, score.shape[1]))
    used = np.zeros(score.shape[1], dtype=np.int64)
    score = score.copy()
    while True:
        best = score.max(axis=0, initial=0.0)
        chosen = (score == best) & (best > 0) & (used < wanted)
        if not chosen.any():
            return weighted / weights
        scores = np.where(chosen, score, 0.0)
        weighted += (scores * value).sum(axis=0)
        weights += scores.sum(axis=0)
        used += chosen.sum(axis=0)
        score[chosen] = 0.0


_AVERAGES = {CUBE: nearest_cube, GAUSSIAN: gaussian, INVERSE_DISTANCE: inverse_distance}
