"""The hole-filling step: empty voxels between measured ones take the nearest measured value."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import cast

import numpy as np
import scipy

from ..arrays import Bytes, Floats, Integers, Mask, Numbers
from ..machine.threads import in_parts, optional_module, usable_cores
from ..progress import Progress, report
from .filling import EMPTY, FILLED, MEASURED

BLOCK = 64
"""Voxels along each side of what is searched in one go, to bound the memory that is needed beside the volume."""

HOLES_AT_ONCE = 500_000
"""How many holes are looked up together, to bound the memory that is needed beside the volume."""

MOST_ASKED = 130
"""Neighbors (a reach of 3 voxels) up to which holes ask them one after the other; beyond, a distance transform is faster."""

LONGEST_REACH = 24
"""Voxels up to which the compiled search asks rows; beyond, a distance transform is faster."""

PLANES_AT_ONCE = 16
"""Planes [k] that a thread fills before it takes the next ones; it looks at those within reach beside them too."""

NM_PER_MM = 1e6

Box = tuple[slice, ...]


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
    offsets, distances = neighbor_offsets(spacing, limit, mask.shape)
    if not len(offsets):
        return 0
    reach = np.abs(offsets).max(axis=0)
    compiled = None if engine == "numpy" or reach.max() > LONGEST_REACH else optional_module("AIFReconLib.holes.numba_nearest")
    if compiled is not None and values.flags.c_contiguous and mask.flags.c_contiguous:
        fill_plane = partial(compiled.fill_plane, values.reshape(-1), mask.reshape(-1), mask, offsets, *_by_rows(offsets, distances))
        return _fill_compiled(fill_plane, mask, reach, threads, progress)
    edge = np.maximum(BLOCK, 2 * reach)
    blocks = list(itertools.product(*(range(0, n, e) for n, e in zip(mask.shape, edge, strict=True))))
    filled = 0
    for number, first in enumerate(blocks):
        report(progress, number / len(blocks), "Filling gaps")
        # The block with what the limit can reach around it
        low = np.maximum(first - reach, 0)
        window = tuple(slice(a, b) for a, b in zip(low, first + edge + reach, strict=True))
        block = tuple(slice(a, b) for a, b in zip(first - low, first - low + edge, strict=True))
        if len(offsets) <= MOST_ASKED:
            filled += _fill_near(values[window], mask[window], block, offsets)
        else:
            filled += _fill_block(values[window], mask[window], block, np.asarray(spacing)[::-1], offsets, distances)
    report(progress, 1.0, "Filled holes")
    return filled


def neighbor_offsets(spacing: Floats, limit: float, shape: tuple[int, ...]) -> tuple[Integers, Integers]:
    """Every voxel within reach of another.

    Parameters
    ----------
    spacing : (3,) array, mm along i, j, k
    limit : float, mm
    shape : [k, j, i]
        Of the volume, beyond which there is nothing to reach.

    Returns
    -------
    offsets : (n, 3) int64 array, [k, j, i]
        Nearest first, equally near ones by rising [k, j, i].
    distances : (n,) int64 array, nm
    """
    spacing_kji = np.asarray(spacing, dtype=np.float64)[::-1]
    reach = np.minimum(np.floor(limit / spacing_kji + 1e-9), np.array(shape) - 1).astype(int)
    grid = np.ogrid[tuple(slice(-r, r + 1) for r in reach)]
    distance = _nanometers([along.astype(np.float64) for along in grid], spacing_kji)
    within = np.flatnonzero((distance > 0) & (distance <= round(limit * NM_PER_MM)))
    # Flat numbers rise with [k, j, i]: a stable sort keeps that order among equals
    within = within[np.argsort(distance.reshape(-1)[within], kind="stable")]
    return np.stack(np.unravel_index(within, distance.shape), axis=1) - reach, distance.reshape(-1)[within]


def _nanometers(offset_kji: Sequence[Numbers], spacing_kji: Floats) -> Integers:
    """Lengths of offsets (in voxels) in whole nm, so that distances equal in mm are equal here whatever they were added up from."""
    squared = sum((along * pitch) ** 2 for along, pitch in zip(offset_kji, spacing_kji, strict=True))
    lengths: Floats = np.rint(np.sqrt(squared) * NM_PER_MM)
    return lengths.astype(np.int64)


def _fill_compiled(
    fill_plane: Callable[[int, tuple[int, int, int, int], int, Bytes, Mask, Integers], int],
    mask: Bytes,
    reach: Integers,
    threads: int | None,
    progress: Progress | None,
) -> int:
    """Fill the whole volume plane by plane with a compiled search that is told where to look, and keeps notes for a few planes."""
    planes = mask.shape[0]
    starts = range(0, planes, PLANES_AT_ONCE)
    filled = np.zeros(len(starts), dtype=np.int64)
    boxes = [_box_of(plane) for plane in mask.view(bool)]

    def fill(part: int) -> Iterator[None]:
        stop = min(starts[part] + PLANES_AT_ONCE, planes)
        low, high = max(starts[part] - int(reach[0]), 0), min(stop + int(reach[0]), planes)
        near = [box for box in boxes[low:high] if box is not None]
        if near:
            (j, i), (last_j, last_i) = np.min(near, axis=0)[[0, 2]] - reach[1:], np.max(near, axis=0)[[1, 3]] + reach[1:]
            box = max(int(j), 0), min(int(last_j), mask.shape[1]), max(int(i), 0), min(int(last_i), mask.shape[2])
            # Empty pages cost nothing where no notes are taken
            size = high - low, *mask.shape[1:]
            notes = np.empty(size, np.uint8), np.empty(size, bool), np.zeros(1, np.int64)
            for k in range(starts[part], stop):
                filled[part] += fill_plane(k, box, low, *notes)
                yield

    in_parts(fill, len(starts), threads or usable_cores(), progress, "Filling gaps")
    report(progress, 1.0, "Filled holes")
    return int(filled.sum())


def _box_of(plane: Mask) -> tuple[int, int, int, int] | None:
    """The rows and the columns of what was measured in a plane, the first and the one after the last of each; None where nothing was."""
    rows = np.flatnonzero(plane.any(axis=1))
    if not rows.size:
        return None
    columns = np.flatnonzero(plane[rows[0] : rows[-1] + 1].any(axis=0))
    return int(rows[0]), int(rows[-1]) + 1, int(columns[0]), int(columns[-1]) + 1


def _by_rows(offsets: Integers, distances: Integers) -> tuple[Integers, Integers]:
    """What is within reach by rows along i: offsets [k, j] of the rows, and how far each step along them leads; see `fill_slab`."""
    rows, row = np.unique(np.concatenate([[[0, 0]], offsets[:, :2]]), axis=0, return_inverse=True)
    lengths = np.full((len(rows), int(np.abs(offsets[:, 2]).max()) + 2), distances[-1] + 1)
    lengths[row.reshape(-1)[1:], np.abs(offsets[:, 2])] = distances
    lengths[(rows == 0).all(axis=1), 0] = 0
    order = np.argsort(lengths[:, 0], kind="stable")
    return rows[order], lengths[order]


def _fill_near(values: Numbers, mask: Bytes, block: Box, offsets: Integers) -> int:
    """Fill the holes in `block`, a part [k, j, i] of these voxels, that have one of few neighbors; returns how many.

    Notes
    -----
    All holes ask their nearest neighbor, those left over the next, and so on. Holes with nothing measured in the box around them are
    not asked at all.
    """
    reach = np.abs(offsets).max(axis=0)
    around = [(r, r) for r in reach]
    measured = np.pad(mask == MEASURED, around)
    holes = np.zeros_like(measured)
    inner = tuple(slice(part.start + r, part.stop + r) for part, r in zip(block, reach, strict=True))
    holes[inner][tuple(slice(0, n) for n in mask[block].shape)] = mask[block] == EMPTY
    holes &= _dilated(measured, reach)
    left = np.flatnonzero(holes)
    if not left.size:
        return 0
    flat_measured, flat_values = measured.reshape(-1), np.pad(values, around).reshape(-1)
    asked = left.size
    for step in offsets @ (measured.shape[1] * measured.shape[2], measured.shape[2], 1):
        found = flat_measured[left + step]
        places = left[found]
        if places.size:
            at = np.unravel_index(places, measured.shape)
            at = tuple(along - r for along, r in zip(at, reach, strict=True))
            values[at] = flat_values[places + step]
            mask[at] = FILLED
            left = left[~found]
            if not left.size:
                break
    return asked - left.size


def _dilated(mask: Mask, reach: Integers) -> Mask:
    """`mask` [k, j, i] grown to boxes of `reach` voxels to each side."""
    for axis, r in enumerate(reach):
        grown = mask.copy()
        for step in range(1, int(r) + 1):
            near, far = [slice(None)] * 3, [slice(None)] * 3
            near[axis], far[axis] = slice(step, None), slice(None, -step)
            grown[tuple(near)] |= mask[tuple(far)]
            grown[tuple(far)] |= mask[tuple(near)]
        mask = grown
    return mask


def _fill_block(values: Numbers, mask: Bytes, block: Box, spacing_kji: Floats, offsets: Integers, distances: Integers) -> int:
    """Fill the holes in `block`, a part [k, j, i] of these voxels, from all of them; returns how many had a value within reach.

    Notes
    -----
    The distance transform tells how far each hole's nearest measured voxel is; which one it is, is then looked up among the offsets
    of that very length, in their order, because the transform breaks ties as it likes. Holes of one length are looked up together.
    """
    measured = mask == MEASURED
    holes = np.argwhere(mask[block] == EMPTY) + [part.start for part in block]
    if not len(holes) or not measured.any():
        return 0
    transform = scipy.ndimage.distance_transform_edt(~measured, sampling=spacing_kji, return_distances=False, return_indices=True)
    nearest = cast("Integers", transform)
    reach = np.abs(offsets).max(axis=0)
    padded = np.pad(measured, [(r, r) for r in reach])
    strides = np.array([padded.shape[1] * padded.shape[2], padded.shape[2], 1])
    lengths, starts = np.unique(distances, return_index=True)
    asked = list(itertools.pairwise([*starts, len(distances)]))
    filled = 0
    for first in range(0, len(holes), HOLES_AT_ONCE):
        some = holes[first : first + HOLES_AT_ONCE]
        k, j, i = some.T
        nanometers = _nanometers([nearest[axis, k, j, i] - some[:, axis] for axis in range(3)], spacing_kji)
        within = nanometers <= lengths[-1]
        some, kind = some[within], np.searchsorted(lengths, nanometers[within])
        order = np.argsort(kind, kind="stable")
        some, ends = some[order], np.searchsorted(kind[order], np.arange(len(lengths) + 1))
        here = some + offsets[_first_measured(padded.reshape(-1), (some + reach) @ strides, offsets @ strides, ends, asked)]
        values[tuple(some.T)] = values[tuple(here.T)]
        mask[tuple(some.T)] = FILLED
        filled += len(some)
    return filled


def _first_measured(measured: Mask, places: Integers, steps: Integers, ends: Integers, asked: list[tuple[int, int]]) -> Integers:
    """Which step leads from each place to a measured voxel first.

    Parameters
    ----------
    measured : (voxels,) bool array
    places : (holes,) int64 array
        Sorted by how far they have to ask: those of length n are between `ends` n and n + 1.
    steps : (neighbors,) int64 array
    ends : (lengths + 1,) int64 array
    asked : list of (first, last), one for each length
        The steps that are that long, one of which leads there.
    """
    which = np.empty(len(places), dtype=np.int64)
    for (begin, end), (first, last) in zip(itertools.pairwise(ends), asked, strict=True):
        left = np.arange(begin, end)
        for number in range(first, last):
            if not left.size:
                break
            found = measured[places[left] + steps[number]]
            which[left[found]] = number
            left = left[~found]
    return which
