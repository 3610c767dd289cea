"""The hole-filling step: empty voxels between measured ones take the nearest measured value.

All voxels within reach of a hole have a rank: the nearest comes first, of equally near ones that with the lowest [k, j, i]. They lie in
rows along i, and in each row only the voxel that is nearest along it can be the best. So a hole looks at one voxel of each row.
"""

from __future__ import annotations

import itertools

import numpy as np
import scipy

from ..arrays import Bytes, Floats, Integers, Numbers
from ..machine.threads import checked_threads, in_parts, optional_module
from ..progress import Progress, report
from .filling import EMPTY, FILLED, MEASURED

BLOCK = 64
"""Voxels along each side of what numpy fills in one go, to bound the memory that is needed beside the volume."""

PLANES_AT_ONCE = 16
"""Planes [k] that a thread fills in one go, compiled."""

NM_PER_MM = 1e6


def fill_holes(
    values: Numbers,
    mask: Bytes,
    spacing: Floats,
    limit: float,
    progress: Progress | None = None,
    *,
    engine: str = "auto",
    threads: int | None = None,
) -> int:
    """Fill holes in place.

    Parameters
    ----------
    values : [k, j, i] array
        Changed where a hole is filled.
    mask : [k, j, i] uint8 array
        MEASURED or EMPTY; filled voxels become FILLED.
    spacing : (3,) array, mm along i, j, k
    limit : float, mm
        Farthest measured voxel to take a value from; 0 fills nothing.
    engine : "auto", "numpy" or "numba"
        Who does it; the answer is the same.
    threads : int or None
        How many numba uses; by default every core.

    Returns
    -------
    filled : int
        How many voxels were filled.

    Notes
    -----
    Distances are between voxel centers; among equally near voxels the one with the lowest [k, j, i] gives its value. Only measured
    voxels are sources, so the order of filling does not matter.
    """
    rows, ranks, offsets = neighbors(spacing, limit, mask.shape)
    if len(offsets) < 2:
        return 0
    reach = offsets.max(axis=0)
    compiled = None if engine == "numpy" else optional_module("AIFReconLib.holes.numba_nearest")
    edge = np.maximum(BLOCK, 2 * reach) if compiled is None else np.array([PLANES_AT_ONCE, *mask.shape[1:]])
    blocks = list(itertools.product(*(range(0, n, e) for n, e in zip(mask.shape, edge, strict=True))))
    filled = np.zeros(len(blocks), np.int64)

    def fill(number: int) -> None:
        # The block with what is within reach around it
        low = np.maximum(blocks[number] - reach, 0)
        first, stop = blocks[number] - low, np.minimum(blocks[number] + edge, mask.shape) - low
        window = tuple(slice(*ends) for ends in zip(low, low + stop + reach, strict=True))
        part = values[window], mask[window]
        if compiled is None:
            filled[number] = _fill(*part, first, stop, rows, ranks, offsets)
        else:
            filled[number] = compiled.fill(*part, int(first[0]), int(stop[0]), rows, ranks, offsets)

    in_parts(fill, len(blocks), 1 if compiled is None else checked_threads(threads), progress, "Filling gaps")
    report(progress, 1.0, "Filled holes")
    return int(filled.sum())


def neighbors(spacing: Floats, limit: float, shape: tuple[int, ...]) -> tuple[Integers, Integers, Integers]:
    """The voxels within reach of another, itself among them.

    Parameters
    ----------
    spacing : (3,) array, mm along i, j, k
    limit : float, mm
    shape : [k, j, i]
        Of the volume, beyond which there is nothing to reach.

    Returns
    -------
    rows : (rows, 2) int64 array, [k, j]
        The rows along i that they lie in, nearest first.
    ranks : (rows, 2 reach + 2) int32 array
        Their ranks, from -reach to reach steps along each row; where none is within reach, and in the last column, how many there are.
    offsets : (n, 3) int64 array, [k, j, i]
        They themselves, by rank.
    """
    spacing_kji = np.asarray(spacing, dtype=np.float64)[::-1]
    reach = np.minimum(np.floor(limit / spacing_kji + 1e-9), np.array(shape) - 1).astype(int)
    grid = np.ogrid[tuple(slice(-r, r + 1) for r in reach)]
    squared = sum((along * pitch) ** 2 for along, pitch in zip(grid, spacing_kji, strict=True))
    # In whole nm, so that distances equal in mm are equal here whatever they were added up from
    distance = np.rint(np.sqrt(squared) * NM_PER_MM).astype(np.int64).reshape(-1)
    within = np.flatnonzero(distance <= round(limit * NM_PER_MM))
    # Flat numbers rise with [k, j, i]: a stable sort keeps that order among equals
    within = within[np.argsort(distance[within], kind="stable")]
    ranks = np.full(distance.size, len(within), np.int32)
    ranks[within] = np.arange(len(within))
    by_row = np.pad(ranks.reshape(-1, 2 * reach[2] + 1), ((0, 0), (0, 1)), constant_values=len(within))
    middle = by_row[:, reach[2]]
    order = np.argsort(middle)[: np.count_nonzero(middle < len(within))]
    rows = np.stack(np.divmod(order, 2 * reach[1] + 1), axis=1) - reach[:2]
    return rows, by_row[order], np.stack(np.unravel_index(within, 2 * reach + 1), axis=1) - reach


def _fill(values: Numbers, mask: Bytes, first: Integers, stop: Integers, rows: Integers, ranks: Integers, offsets: Integers) -> int:
    """`numba_nearest.fill` in numpy, of the block [first, stop) of these voxels [k, j, i]."""
    measured, reach = mask == MEASURED, offsets.max(axis=0)
    if not measured.any():
        return 0
    around = scipy.ndimage.maximum_filter(measured, 2 * reach + 1, mode="constant")
    inner = tuple(slice(*ends) for ends in zip(first, stop, strict=True))
    holes = np.argwhere((mask[inner] == EMPTY) & around[inner]) + first
    place, far = np.arange(mask.shape[2], dtype=np.int32), np.int32(2 * max(mask.shape))
    before = np.maximum.accumulate(np.where(measured, place, -far), axis=2) - place
    behind = np.minimum.accumulate(np.where(measured, place, 2 * far)[..., ::-1], axis=2)[..., ::-1] - place
    steps = np.where(-before <= behind, before, behind)
    steps[np.abs(steps) > reach[2]] = reach[2] + 1
    steps = np.pad(steps, [(r, r) for r in (*reach[:2], 0)], constant_values=reach[2] + 1)
    places = np.ravel_multi_index(tuple((holes + np.append(reach[:2], 0)).T), steps.shape)
    flat_steps, by_row = steps.reshape(-1), rows @ (steps.shape[1] * steps.shape[2], steps.shape[2])
    best, left = np.full(len(holes), len(offsets)), np.arange(len(holes))
    for row, rank in zip(by_row, ranks, strict=True):
        left = left[best[left] > rank[reach[2]]]
        best[left] = np.minimum(best[left], rank[reach[2] + flat_steps[places[left] + row]])
    found = best < len(offsets)
    holes, sources = holes[found], holes[found] + offsets[best[found]]
    values[tuple(holes.T)] = values[tuple(sources.T)]
    mask[tuple(holes.T)] = FILLED
    return len(holes)
