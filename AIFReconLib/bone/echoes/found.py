"""Bone as points with a beam, whatever found them: in one frame, and in Reference, where a CT or a surface is laid upon them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Floats, Integers, Mask, Matrix, Singles

FEWEST = 150
"""Echoes below which no registration is attempted: six degrees of freedom from a few frames of a few scan lines."""


@dataclass(frozen=True, eq=False)
class BoneEchoes:
    """What one frame shows of bone: at most one echo per scan line."""

    pixels: Floats  #: (n, 2). Column and row of each.
    beams: Floats  #: (n, 2). One mm along the sound there, in pixels (column, row).
    scores: Singles  #: (n,). How surely each is bone, 0 to 1.

    def placed(self, image_to_reference: Matrix, frame: int) -> SweepEchoes:
        """The same in Reference, of the frame with this number."""
        beams = self.beams @ image_to_reference[:3, :2].T
        beams /= np.maximum(np.linalg.norm(beams, axis=1, keepdims=True), 1e-9)
        points = self.pixels @ image_to_reference[:3, :2].T + image_to_reference[:3, 3]
        return SweepEchoes(points, beams, self.scores, np.full(len(points), frame))


@dataclass(frozen=True, eq=False)
class SweepEchoes:
    """Bone echoes in Reference."""

    points: Floats  #: (n, 3), mm
    beams: Floats  #: (n, 3), unit vectors. Which way the sound went there.
    scores: Singles  #: (n,). How surely each is bone, 0 to 1.
    frames: Integers  #: (n,). Number of the frame that showed it, counted over all sweeps.

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, chosen: Mask | Integers) -> SweepEchoes:
        return SweepEchoes(self.points[chosen], self.beams[chosen], self.scores[chosen], self.frames[chosen])

    @classmethod
    def joined(cls, parts: Sequence[SweepEchoes]) -> SweepEchoes:
        """All of them, in their order; none of none."""
        parts = [cls(np.empty((0, 3)), np.empty((0, 3)), np.empty(0, np.float32), np.empty(0, np.int64)), *parts]
        return cls(*(np.concatenate([getattr(one, name) for one in parts]) for name in ("points", "beams", "scores", "frames")))

    def thinned(self, most: int) -> SweepEchoes:
        """At most so many, evenly in space: a place that many frames saw counts no more than one that a few saw.

        One echo, that of the highest score, is kept per cube; the cubes grow from 1 mm by a fifth until few enough are kept.
        """
        if len(self) <= most:
            return self
        cubes, edge = _numbered_cubes(self.points, 1.0), 1.0
        while len(np.unique(cubes)) > most:
            edge *= 1.2
            cubes = _numbered_cubes(self.points, edge)
        order = np.lexsort((-self.scores, cubes))
        first = np.ones(len(order), dtype=bool)
        first[1:] = np.diff(cubes[order]) != 0
        return self[np.sort(order[first])]


def _numbered_cubes(points: Floats, edge: float) -> Integers:
    """The number of the cube of this edge (mm) in which each point (n, 3) lies, (n,)."""
    cubes = np.floor(points / edge).astype(np.int64)
    cubes -= cubes.min(axis=0)
    across = cubes.max(axis=0) + 1
    numbers: Integers = (cubes[:, 0] * across[1] + cubes[:, 1]) * across[2] + cubes[:, 2]
    return numbers
