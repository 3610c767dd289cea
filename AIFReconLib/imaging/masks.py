"""Areas of an image: their gaps closed, thin lines dropped, the largest one without its holes.

What scipy's `binary_closing`, `binary_opening`, `label` and `binary_fill_holes` return, several times as fast: a step along rows and
columns is four passes over whole arrays, which processors take many pixels at a time, and areas are told from their runs along rows,
which are few.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Integers, Mask


def closed(mask: Mask, steps: int) -> Mask:
    """Grown by so many steps along rows and columns and shrunk again; beyond the image there is room to grow, (rows, columns)."""
    room = np.pad(mask, steps)
    _grow(room, steps)
    _shrink(room, steps)
    return room[steps:-steps, steps:-steps].copy()


def opened(mask: Mask, steps: int) -> Mask:
    """Shrunk by so many steps along rows and columns and grown again; beyond the image nothing is, (rows, columns)."""
    room = np.pad(mask, steps)
    _shrink(room, steps)
    _grow(room, steps)
    return room[steps:-steps, steps:-steps].copy()


def largest_area(mask: Mask) -> Mask:
    """The largest of the connected areas of a mask that is not empty, without its holes; of several the first, (rows, columns)."""
    runs, area, sizes = _areas(mask)
    largest = _painted(runs[area == sizes.argmax()], mask.shape)
    # What cannot be reached from beside the image is a hole; the first run is beside it
    outside = np.pad(~largest, 1, constant_values=True)
    runs, area, _ = _areas(outside)
    return ~_painted(runs[area == area[0]], outside.shape)[1:-1, 1:-1]


def large_areas(mask: Mask, part: float) -> Mask:
    """The connected areas of a mask that have at least this part of the largest one's pixels, (rows, columns)."""
    runs, area, sizes = _areas(mask)
    return _painted(runs[(sizes >= part * sizes.max(initial=0))[area]], mask.shape)


def _areas(mask: Mask) -> tuple[Integers, Integers, Integers]:
    """The runs of a mask along its rows, in their order, as flat [first, stop) (n, 2), the connected area of each, and the areas' sizes."""
    width = mask.shape[1]
    # One column more, so that no run goes on in the next row
    edges = np.flatnonzero(np.diff(np.pad(mask, ((0, 0), (0, 1))).reshape(-1), prepend=False))
    rows, columns = np.divmod(edges.reshape(-1, 2), width + 1)
    runs = rows * width + columns
    starts, stops = runs.T
    # Runs of the row below that share a column
    first, last = np.searchsorted(stops, starts + width, "right"), np.searchsorted(starts, stops + width, "left")
    below = np.maximum(last - first, 0)
    upper = np.repeat(np.arange(len(runs)), below)
    lower = np.arange(below.sum()) - np.repeat(np.cumsum(below) - below, below) + np.repeat(first, below)
    # The first run of an area is its number, and then these are counted through
    area = np.arange(len(runs))
    while (apart := area[upper] != area[lower]).any():
        one, other = area[upper[apart]], area[lower[apart]]
        np.minimum.at(area, np.maximum(one, other), np.minimum(one, other))
        while ((jump := area[area]) != area).any():
            area = jump
    _, area = np.unique(area, return_inverse=True)
    return runs, area, np.bincount(area, weights=stops - starts)


def _painted(runs: Integers, shape: tuple[int, ...]) -> Mask:
    """A mask of this shape that is True within the runs."""
    edges = np.concatenate([[0], runs.reshape(-1), [math.prod(shape)]])
    return np.repeat(np.arange(len(edges) - 1) % 2 == 1, np.diff(edges)).reshape(shape)


def _grow(room: Mask, steps: int) -> None:
    """Grow, in place, a mask around whose border so many steps are of no account: there, a row goes on in the next."""
    flat, width = room.reshape(-1), room.shape[1]
    for _ in range(steps):
        before = flat.copy()
        flat[1:] |= before[:-1]
        flat[:-1] |= before[1:]
        flat[width:] |= before[:-width]
        flat[:-width] |= before[width:]


def _shrink(room: Mask, steps: int) -> None:
    """The same for what is left out."""
    np.logical_not(room, out=room)
    _grow(room, steps)
    np.logical_not(room, out=room)
