"""The ways in which the Plus toolkit fills holes, and their parameters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Floats
from ..errors import SettingsError

CUBE, GAUSSIAN, STICK = "cube", "gaussian", "stick"
GAUSSIAN_BY_HITS, INVERSE_DISTANCE = "gaussian by hits", "inverse distance"
KINDS = (CUBE, GAUSSIAN, STICK, GAUSSIAN_BY_HITS, INVERSE_DISTANCE)

EMPTY, MEASURED, FILLED = 0, 1, 2
"""Values of the mask volume."""

LARGEST_SIZE = 201
"""Voxels. More than a reconstruction's gaps can be; it keeps a mistyped size from taking hours."""


@dataclass(frozen=True)
class HoleFilling:
    """One way to fill holes.

    Raises SettingsError, which names what is out of range.

    Parameters
    ----------
    kind : "cube", "gaussian", "gaussian by hits", "inverse distance" or "stick"
    size : int, voxels
        cube: the largest cube, with sides of 3, 5, ... voxels up to this many. stick: the longest one, its ends and the hole included
        (the longest gap it bridges has two voxels less). Others: side of the cube that is averaged.
    stdev : float, voxels
        gaussian, gaussian by hits: standard deviation.
    known_ratio : float, 0 to 1
        all but stick: a hole is filled where more than this part of size^3 voxels is measured.
    sticks : int
        stick: how many of the shortest are averaged; those of one length count together.
    """

    kind: str
    size: int
    stdev: float = 1.0
    known_ratio: float = 0.0
    sticks: int = 1

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise SettingsError(f"Input kind of hole filling must be one of {', '.join(KINDS)}; got {self.kind!r}.")
        if not 1 <= self.size <= LARGEST_SIZE:
            raise SettingsError(f"Input size of hole filling must be 1 to {LARGEST_SIZE} voxels; got {self.size!r}.")
        if self.kind in (GAUSSIAN, GAUSSIAN_BY_HITS) and not 0 < self.stdev < np.inf:
            raise SettingsError(f"Input standard deviation of hole filling must be above 0 voxels; got {self.stdev!r}.")
        if not 0 <= self.known_ratio <= 1:
            raise SettingsError(f"Input ratio of known voxels must be 0 to 1; got {self.known_ratio!r}.")
        if self.sticks < 1:
            raise SettingsError(f"Input number of sticks must be at least 1; got {self.sticks!r}.")

    def described(self) -> str:
        """The way and its size, in words."""
        return f"{self.kind} of up to {self.size} voxels"

    @property
    def reach(self) -> int:
        """How many voxels away a source may be, along an axis."""
        return max(self.size - 2, 0) if self.kind == STICK else (self.size - 1) // 2


def within(kind: str, limit: float, spacing: Floats) -> HoleFilling:
    """The way of this kind that reaches `limit` mm along the finest of these spacings (mm): cubes that far to each side, a Gaussian
    whose standard deviation is half of it, sticks that end that far on either side of a hole in the middle."""
    reach = min(int(np.floor(limit / np.min(spacing) + 1e-9)), (LARGEST_SIZE - 1) // 2)
    return HoleFilling(kind, 2 * reach + 1, stdev=max(reach / 2, 0.5))
