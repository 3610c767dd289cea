"""Hole filling as the Plus toolkit defines it: sticks, averages of a cube around the hole, and the mean of the nearest cube.

Sizes are in voxels, along the volume's axes. Only measured voxels are sources, so the order of filling does not matter.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Bytes, Floats, Integers, Mask, Numbers
from ..machine.threads import checked_threads, in_parts, optional_module
from ..progress import Progress, report
from .averages import gaussian, gaussian_by_hits, inverse_distance, nearest_cube
from .filling import CUBE, EMPTY, FILLED, GAUSSIAN, GAUSSIAN_BY_HITS, INVERSE_DISTANCE, MEASURED, STICK, HoleFilling

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
    threads: int | None = None,
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
    engine : "auto", "numpy" or "numba"
        Who does it; the answer is the same.
    threads : int or None
        For sticks with numba: how many to use, by default every core.
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
        holes = np.zeros_like(known)
        holes[start - low : stop - low] = mask[start:stop] == EMPTY
        for kind in kinds:
            if not holes.any() or not known.any():
                break
            found, found_values = _fill(values[low:high], known, holes, kind, hits, engine, threads)
            now = np.zeros_like(holes)
            now[holes] = found
            values[low:high][now] = found_values if values.dtype.kind == "f" else np.floor(found_values + 0.5)
            mask[low:high][now] = FILLED
            filled += len(found_values)
            holes[now] = False
    report(progress, 1.0, "Filled holes")
    return filled


def _fill(
    values: Numbers, known: Mask, holes: Mask, kind: HoleFilling, hits: Numbers | None, engine: str, threads: int | None
) -> tuple[Mask, Floats]:
    """Which of the `holes` (bool [k, j, i]), in their order, are filled in this way, and with what."""
    if kind.kind == STICK:
        return _fill_sticks(values, known, holes, kind, engine, threads)
    if kind.kind == GAUSSIAN_BY_HITS:
        return gaussian_by_hits(values, known, np.argwhere(holes), kind, hits)
    return _AVERAGES[kind.kind](values, known, np.argwhere(holes), kind)


def _fill_sticks(values: Numbers, known: Mask, holes: Mask, kind: HoleFilling, engine: str, threads: int | None) -> tuple[Mask, Floats]:
    """Linear interpolation between known voxels on both sides, along the shortest sticks.

    Notes
    -----
    With known voxels f steps ahead and r steps behind, f + r + 1 at most `size`, a stick has the value
    `((r + 1) v_ahead + f v_behind) / (f + r + 1)` and the score `1 / ((f + r + 1) |direction|)` in voxels. (The weights are IGSIO's; an
    interpolation proper would have r and f over f + r.) The best sticks are averaged by their scores; those of equal score enter
    together, until there are at least `sticks` of them.
    """
    longest = max(kind.size - 2, 0)
    # Around the volume lies so much that no stick gets out of it
    padded, flat_values = np.pad(known, longest), np.pad(values, longest).reshape(-1)
    strides = np.array([padded.shape[1] * padded.shape[2], padded.shape[2], 1])
    flat_known, places = padded.reshape(-1), np.flatnonzero(np.pad(holes, longest))
    compiled = None if engine == "numpy" else optional_module("AIFReconLib.holes.numba_sticks")
    averages = np.empty(len(places))
    starts = range(0, len(places), HOLES_AT_ONCE)

    def fill(number: int) -> None:
        part = slice(starts[number], starts[number] + HOLES_AT_ONCE)
        if compiled is None:
            averages[part] = _along_sticks(flat_values, flat_known, places[part], strides, kind)
        else:
            steps, lengths = np.dot(STICKS, strides), np.linalg.norm(STICKS, axis=1)
            compiled.fill_along_sticks(flat_values, flat_known, places[part], steps, lengths, kind.size, kind.sticks, averages[part])

    # In numpy one part at a time: each needs memory for all directions
    in_parts(fill, len(starts), 1 if compiled is None else checked_threads(threads))
    found = ~np.isnan(averages)
    return found, averages[found]


def _along_sticks(flat_values: Numbers, flat_known: Mask, places: Integers, strides: Integers, kind: HoleFilling) -> Floats:
    """The averages (holes,) at flat `places` of a padded volume with these strides [k, j, i]; NaN where no stick is found."""
    lengths = np.linalg.norm(STICKS, axis=1)
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
    # Those of one score enter together
    enters = (score > 0) & (score >= np.sort(score, axis=0)[-min(kind.sticks, len(STICKS))])
    weight = np.where(enters, score, 0.0)
    total = weight.sum(axis=0)
    averages: Floats = np.divide((weight * value).sum(axis=0), total, out=np.full(len(places), np.nan), where=total > 0)
    return averages


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


_AVERAGES = {CUBE: nearest_cube, GAUSSIAN: gaussian, INVERSE_DISTANCE: inverse_distance}
