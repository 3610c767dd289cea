"""Hole filling as the Plus toolkit defines it: sticks, averages of a cube around the hole, and the mean of the nearest cube.

Sizes are in voxels, along the volume's axes. Only measured voxels are sources, so the order of filling does not matter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import SettingsError
from ..machine.threads import optional_module
from ..progress import Progress, report
from ..settings import ReconstructionSettings
from . import averages as hole_averages
from .nearest import EMPTY, FILLED, MEASURED, fill_holes

CUBE, GAUSSIAN, STICK = "cube", "gaussian", "stick"
GAUSSIAN_BY_HITS, INVERSE_DISTANCE = "gaussian by hits", "inverse distance"
KINDS = (CUBE, GAUSSIAN, STICK, GAUSSIAN_BY_HITS, INVERSE_DISTANCE)
STICKS = (
    *((0, 0, 1), (0, 1, 0), (1, 0, 0)),
    *((0, 1, 1), (1, 0, 1), (1, 1, 0), (0, -1, 1), (-1, 0, 1), (-1, 1, 0)),
    *((1, 1, 1), (1, 1, -1), (1, -1, 1), (1, -1, -1)),
)
"""The 13 directions [k, j, i] in which sticks lie: along edges, face diagonals and space diagonals of a voxel."""

LARGEST_SIZE = 201
"""Voxels. More than a reconstruction's gaps can be; it keeps a mistyped size from taking hours."""

VOXELS_AT_ONCE = 4_000_000
"""How many voxels (halo not included) are filled together, and"""

HOLES_AT_ONCE = 200_000
"""how many holes are bridged by sticks together: both bound the memory that is needed beside the volume."""


@dataclass(frozen=True)
class HoleFilling:
    """One way to fill holes.

    Parameters
    ----------
    kind : "cube", "gaussian", "gaussian by hits", "inverse distance" or "stick"
    size : int, voxels
        cube: the largest cube, with sides of 3, 5, ... voxels up to this many. stick: the longest one, its ends and the hole included
        (the longest gap it bridges has two voxels less). Others: side of the cube that is averaged.
    stdev : float, voxels
        gaussian, gaussian by hits: standard deviation.
    known_ratio : float, 0 to 1
        all but stick: a hole is filled where more than this share of size^3 voxels is measured.
    sticks : int
        stick: how many of the shortest are averaged; those of one length count together.

    Raises
    ------
    SettingsError
        Names what is out of range.
    """

    kind: str
    size: int
    stdev: float = 1.0
    known_ratio: float = 0.0
    sticks: int = 1

    def __post_init__(self):
        if self.kind not in KINDS:
            raise SettingsError("Input kind of hole filling must be one of {kinds}; got {kind!r}.", kinds=", ".join(KINDS), kind=self.kind)
        if not 1 <= self.size <= LARGEST_SIZE:
            raise SettingsError(
                "Input size of hole filling must be 1 to {largest} voxels; got {size!r}.", largest=LARGEST_SIZE, size=self.size
            )
        if self.kind in (GAUSSIAN, GAUSSIAN_BY_HITS) and not 0 < self.stdev < np.inf:
            raise SettingsError("Input standard deviation of hole filling must be above 0 voxels; got {stdev!r}.", stdev=self.stdev)
        if not 0 <= self.known_ratio <= 1:
            raise SettingsError("Input ratio of known voxels must be 0 to 1; got {known_ratio!r}.", known_ratio=self.known_ratio)
        if self.sticks < 1:
            raise SettingsError("Input number of sticks must be at least 1; got {sticks!r}.", sticks=self.sticks)

    @property
    def reach(self) -> int:
        """How many voxels away a source may be, along an axis."""
        return max(self.size - 2, 0) if self.kind == STICK else (self.size - 1) // 2


def within(kind: str, limit: float, spacing: np.ndarray) -> HoleFilling:
    """The way of this kind that reaches `limit` mm along the finest of these spacings (mm): cubes that far to each side, a Gaussian
    whose standard deviation is half of it, sticks that end that far on either side of a hole in the middle."""
    reach = min(int(np.floor(limit / np.min(spacing) + 1e-9)), (LARGEST_SIZE - 1) // 2)
    return HoleFilling(kind, 2 * reach + 1, stdev=max(reach / 2, 0.5))


def fill_as_asked(
    values: np.ndarray,
    mask: np.ndarray,
    spacing: np.ndarray,
    settings: ReconstructionSettings,
    configured: tuple[HoleFilling, ...] = (),
    progress: Progress | None = None,
    *,
    threads: int | None = None,
    score: np.ndarray | None = None,
) -> int:
    """Fill holes in place as the settings ask for, else as a configuration does; returns how many were filled.

    Parameters
    ----------
    values, mask : [k, j, i] arrays
        See `fill_holes_by_kind`.
    spacing : (3,) array, mm along i, j, k
    settings : ReconstructionSettings
        Of which `holes`, `hole_limit` and `engine` count.
    configured : tuple of HoleFilling
        What is done where the settings have neither a way nor a limit.
    progress : Progress or None
    threads : int or None
    score : [k, j, i] array or None
        See `fill_holes_by_kind`.
    """
    if settings.holes == "off":
        return 0
    if settings.holes is None and settings.hole_limit == 0:
        return fill_holes_by_kind(values, mask, configured, progress, engine=settings.engine, score=score)
    if settings.holes in (None, "nearest"):
        return fill_holes(values, mask, spacing, settings.hole_limit, progress, engine=settings.engine, threads=threads)
    return fill_holes_by_kind(values, mask, (within(settings.holes, settings.hole_limit, spacing),), progress, engine=settings.engine)


def fill_holes_by_kind(
    values: np.ndarray,
    mask: np.ndarray,
    kinds: tuple[HoleFilling, ...],
    progress: Progress | None = None,
    *,
    engine: str = "auto",
    score: np.ndarray | None = None,
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
        report(progress, number / len(starts), "Filling holes")
        stop = min(start + planes, mask.shape[0])
        low, high = max(start - reach, 0), min(stop + reach, mask.shape[0])
        # Filled voxels of the slab before are holes still to this one, and no sources
        known = mask[low:high] == MEASURED
        hits = None if score is None else score[low:high]
        holes = np.argwhere(mask[start:stop] == EMPTY) + np.array([start - low, 0, 0])
        for kind in kinds:
            if not len(holes) or not known.any():
                break
            found, found_values = _FILLERS[kind.kind](values[low:high], known, holes, kind, engine=engine, hits=hits)
            at = tuple((holes[found] + np.array([low, 0, 0])).T)
            values[at] = found_values if values.dtype.kind == "f" else np.floor(found_values + 0.5)
            mask[at] = FILLED
            filled += int(found.sum())
            holes = holes[~found]
    report(progress, 1.0, "Filled holes")
    return filled


def _fill_sticks(values, known, holes, kind: HoleFilling, *, engine: str, **_) -> tuple[np.ndarray, np.ndarray]:
    """Linear interpolation between known voxels on both sides, along the shortest sticks.

    Notes
    -----
    With known voxels f steps ahead and r steps behind, f + r + 1 at most `size`, a stick has the value
    ((r + 1) v_ahead + f v_behind) / (f + r + 1) and the score 1 / ((f + r + 1) |direction|) in voxels. (The weights are IGSIO's; an
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
    return tuple(np.concatenate(arrays) for arrays in zip(*filled, strict=True))


def _fill_along_sticks(flat_values, flat_known, places, strides, kind: HoleFilling, engine: str) -> tuple[np.ndarray, np.ndarray]:
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


def _steps(known: np.ndarray, places: np.ndarray, step: int, limits: np.ndarray) -> np.ndarray:
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


def _best_sticks(score: np.ndarray, value: np.ndarray, wanted: int) -> np.ndarray:
    """The average of the values (sticks, holes) with the best scores, weighted by these."""
    weighted, weights = np.zeros((2, score.shape[1]))
    used = np.zeros(score.shape[1], dtype=np.int64)
    score = score.copy()
    while True:
        best = score.max(axis=0, initial=0.0)
        chosen = (score == best) & (best > 0) & (used < wanted)
        if not chosen.any():
            return weighted / weights
        share = np.where(chosen, score, 0.0)
        weighted += (share * value).sum(axis=0)
        weights += share.sum(axis=0)
        used += chosen.sum(axis=0)
        score[chosen] = 0.0


_FILLERS = {
    CUBE: hole_averages.nearest_cube,
    GAUSSIAN: hole_averages.gaussian,
    STICK: _fill_sticks,
    GAUSSIAN_BY_HITS: hole_averages.gaussian_by_hits,
    INVERSE_DISTANCE: hole_averages.inverse_distance,
}
