"""Sums over the points that lie in cubes of 1 mm: what is kept of a scan, however long it lasts."""

from __future__ import annotations

import numpy as np

from ...arrays import Floats, Integers

SPACING = 1.0
"""mm between the middles of cubes, which lie at whole multiples of it in Reference: all sums have the same cubes."""

HALF, ACROSS = 2**20, 2**21
"""Cubes on either side of the origin of Reference, and in all: how their numbers are made up."""


def cubes_of(points: Floats) -> Integers:
    """The cubes (n, 3) that points (n, 3), mm in Reference, lie in."""
    cubes: Integers = np.clip(np.rint(points / SPACING), -HALF, HALF - 1).astype(np.int64)
    return cubes


class CubeSums:
    """Sums of `many` values in each cube that has any; memory goes with these."""

    def __init__(self, many: int):
        self._numbers, self._sums = np.empty(0, np.int64), np.empty((many, 0))

    def add(self, cubes: Integers, values: Floats) -> None:
        """Add values (many, n) in cubes (n, 3)."""
        numbers, of = np.unique(_numbers(cubes), return_inverse=True)
        sums = np.stack([np.bincount(of.reshape(-1), each, len(numbers)) for each in values])
        at = np.searchsorted(self._numbers, numbers)
        known = np.append(self._numbers, -1)[at] == numbers
        self._sums[:, at[known]] += sums[:, known]
        self._numbers = np.insert(self._numbers, at[~known], numbers[~known])
        self._sums = np.insert(self._sums, at[~known], sums[:, ~known], axis=1)

    @property
    def cubes(self) -> Integers:
        """All that have sums, (n, 3)."""
        return _cubes(self._numbers)

    def within(self, low: Integers, high: Integers) -> tuple[Integers, Floats]:
        """The cubes (n, 3) from `low` to `high` that have sums, and these (many, n)."""
        first, last = np.searchsorted(self._numbers, _numbers(np.stack([low, high])))
        some = slice(first, last + 1)
        cubes = _cubes(self._numbers[some])
        inner = np.all((cubes >= low) & (cubes <= high), axis=1)
        return cubes[inner], self._sums[:, some][:, inner]


def _numbers(cubes: Integers) -> Integers:
    """One number for each cube (n, 3), in the order of arrays [k, j, i]."""
    i, j, k = cubes.T + HALF
    numbers: Integers = (k * ACROSS + j) * ACROSS + i
    return numbers


def _cubes(numbers: Integers) -> Integers:
    """The cubes (n, 3) with these numbers."""
    rest, i = np.divmod(numbers, ACROSS)
    cubes: Integers = np.stack([i, rest % ACROSS, rest // ACROSS], axis=1) - HALF
    return cubes
