"""Bone as points with a beam, whatever found them: in one frame, and in Reference, where a CT or a surface is laid upon them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Floats, Integers, Mask, Matrix, Singles

FEWEST = 150
"""Echoes below which no registration is attempted: six degrees of freedom from a few frames of a few scan lines."""

NAMES = ("points", "beams", "scores", "frames")

LEAST_DARK = 0.65
"""Part of the echoes behind which scan lines are dark to their end, in images of bone. In simulated tissue without bone it is
0.1 to 0.55, whatever gain and gray curve are; of two patients 0.73 to 0.95, of the fibula 0.88 to 1."""


@dataclass(frozen=True, eq=False)
class BoneEchoes:
    """What one frame shows of bone: at most one echo per scan line."""

    pixels: Floats  #: (n, 2). Column and row of each.
    beams: Floats  #: (n, 2). One mm along the sound there, in pixels (column, row).
    scores: Singles  #: (n,). How surely each is bone, 0 to 1.
    dark: Mask  #: (n,). Whether the scan line is dark behind it to its end, as it is behind bone.

    def placed(self, image_to_reference: Matrix, frame: int) -> SweepEchoes:
        """The same in Reference, of the frame with this number."""
        beams = self.beams @ image_to_reference[:3, :2].T
        beams /= np.maximum(np.linalg.norm(beams, axis=1, keepdims=True), 1e-9)
        points = self.pixels @ image_to_reference[:3, :2].T + image_to_reference[:3, 3]
        return SweepEchoes(points, beams, self.scores, np.full(len(points), frame), self.dark)


@dataclass(frozen=True, eq=False)
class SweepEchoes:
    """Bone echoes in Reference."""

    points: Floats  #: (n, 3), mm
    beams: Floats  #: (n, 3), unit vectors. Which way the sound went there.
    scores: Singles  #: (n,). How surely each is bone, 0 to 1.
    frames: Integers  #: (n,). Number of the frame that showed it, counted over all sweeps.
    dark: Mask | None = None  #: (n,). Whether the scan line is dark behind it to its end; None where nobody looked.

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, chosen: Mask | Integers) -> SweepEchoes:
        dark = None if self.dark is None else self.dark[chosen]
        return SweepEchoes(self.points[chosen], self.beams[chosen], self.scores[chosen], self.frames[chosen], dark)

    @property
    def show_bone(self) -> bool:
        """Whether so many lines are dark behind their echoes that these are of bone: tissue has echoes, too, and is lit behind them."""
        return self.dark is None or bool(self.dark.sum() >= LEAST_DARK * len(self))

    @classmethod
    def joined(cls, parts: Sequence[SweepEchoes]) -> SweepEchoes:
        """All of them, in their order; none of none."""
        parts = [cls(np.empty((0, 3)), np.empty((0, 3)), np.empty(0, np.float32), np.empty(0, np.int64)), *parts]
        known = [one.dark for one in parts if one.dark is not None]
        dark = np.concatenate(known) if sum(map(len, known)) == sum(map(len, parts)) and known else None
        points, beams, scores, frames = (np.concatenate([getattr(one, name) for one in parts]) for name in NAMES)
        return cls(points, beams, scores, frames, dark)

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
