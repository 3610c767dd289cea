"""Straight lines from the skin to a target: which of them true bone blocks, and how well something else tells these from the free ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Floats, Mask, Numbers, Singles
from ..geometry.transforms import transform_points
from ..geometry.volume import Volume

STEP = 0.5
"""mm between looks along a line."""

FREE, BLOCKED = 1.0, 0.0
"""mm: a line whose nearest bone is so far or farther is free, one that touches bone is blocked; those between are not asked."""

FOUND = 0.9
"""Share of the free lines that are to be found."""

FAR = 99.0
"""mm from bone of what lies beyond all distances that are known."""

LINES, FEWEST = 3000, 20
"""Lines that are drawn at random, and free ones and blocked ones of them without which nothing is told."""

UNDER_SKIN = 4.0
"""mm of each line that are not judged: there the probe's own echo is."""

ASIDE, STEEPEST_DEG = 5.0, 30.0
"""mm from the middle of the canal within which lines end, and the largest angle between a line and the shortest way from the skin."""


Roc = tuple[float, float]
"""How well a number tells free lines from blocked ones: the area under the curve of free found against blocked called free, which is how
often a free line is told from a blocked one (one half is chance); and the share of the blocked lines that look as free as nine in ten
free ones do. NaN where there are too few of either."""


def told_apart(free: Numbers, blocked: Numbers) -> Roc:
    """Of free lines and blocked ones by a number, (n,) and (m,), that is to be greater for free ones."""
    if min(len(free), len(blocked)) < FEWEST:
        return np.nan, np.nan
    order = np.sort(blocked)
    below = (np.searchsorted(order, free, "left") + np.searchsorted(order, free, "right")) / 2
    return float(below.mean() / len(blocked)), float((blocked >= np.quantile(free, 1 - FOUND)).mean())


@dataclass(frozen=True, eq=False)
class StraightLines:
    """Lines from the skin to a target in Reference, mm."""

    entries: Floats  #: (n, 3)
    ends: Floats  #: (n, 3)
    nearest_bone: Singles  #: (n,), mm. Signed distance to true bone where they come nearest to it.

    @classmethod
    def past(cls, distance: Volume, entries: Floats, ends: Floats) -> StraightLines:
        """Lines judged by the true signed distance to bone, mm."""
        return cls(entries, ends, values_at(distance, points_along(entries, ends), FAR).min(axis=1))

    @property
    def free(self) -> Mask:
        """Which ones pass, (n,) bool."""
        return self.nearest_bone >= FREE

    @property
    def blocked(self) -> Mask:
        """Which ones touch bone, (n,) bool."""
        return self.nearest_bone <= BLOCKED

    def brightest(self, volume: Volume) -> Singles:
        """The brightest gray level on each, (n,); what was not measured is as dark as it is in the volume."""
        found: Singles = values_at(volume, points_along(self.entries, self.ends)).max(axis=1)
        return found

    def told_by(self, number: Numbers) -> Roc:
        """How well a number of each line, (n,), tells the free ones, for which it is to be greater."""
        return told_apart(number[self.free], number[self.blocked])


def lines_to_canal(skin: Floats, canals: Floats, distance: Volume) -> StraightLines | None:
    """Random lines from points on the skin, (n, 3) mm, to the canal between neighboring vertebrae, (m, 2, 3) mm; None where there is none.

    `distance` is the true signed distance to bone, mm.
    """
    if not len(canals):
        return None
    rng = np.random.default_rng(0)
    lengths = np.linalg.norm(canals[:, 1] - canals[:, 0], axis=1)
    begin, end = canals[rng.choice(len(canals), LINES, p=lengths / lengths.sum())].transpose(1, 0, 2)
    return lines_near(skin, begin + rng.random((LINES, 1)) * (end - begin), distance, ASIDE, rng)


def lines_near(skin: Floats, targets: Floats, distance: Volume, aside: float, rng: np.random.Generator) -> StraightLines:
    """Random lines from points on the skin, (n, 3) mm, that end within `aside` mm of each target, (m, 3) mm; steep ones are left out.

    Notes
    -----
    They end on a disk across the shortest way from the skin to the target. They begin `UNDER_SKIN` below a point on the skin.
    """
    straight = targets - skin[scipy.spatial.cKDTree(skin).query(targets)[1]]
    straight /= np.linalg.norm(straight, axis=1)[:, None]
    across = rng.standard_normal(targets.shape)
    across -= (across * straight).sum(axis=1)[:, None] * straight
    ends = targets + aside * np.sqrt(rng.random((len(targets), 1))) * across / np.linalg.norm(across, axis=1)[:, None]
    entries = skin[rng.integers(len(skin), size=len(targets))]
    way = ends - entries
    length = np.linalg.norm(way, axis=1)
    kept = (length > 2 * UNDER_SKIN) & ((way * straight).sum(axis=1) > np.cos(np.radians(STEEPEST_DEG)) * length)
    entries, ends, way, length = entries[kept], ends[kept], way[kept], length[kept]
    return StraightLines.past(distance, entries + UNDER_SKIN * way / length[:, None], ends)


def points_along(entries: Floats, ends: Floats, step: float = STEP) -> Floats:
    """As many points of each line, (n, m, 3), from its entry to its end; `step` mm apart on the longest."""
    way = ends - entries
    along = np.linspace(0.0, 1.0, max(int(np.linalg.norm(way, axis=1).max(initial=0.0) / step), 2))
    points: Floats = entries[:, None] + along[None, :, None] * way[:, None]
    return points


def values_at(volume: Volume, points: Floats, outside: float = 0.0) -> Singles:
    """A volume at points (..., 3) in Reference, by linear interpolation; `outside` beyond it."""
    ijk = transform_points(volume.grid.reference_to_ijk, points.reshape(-1, 3))
    values = scipy.ndimage.map_coordinates(volume.array, ijk.T[::-1], output=np.float32, order=1, cval=outside)
    return np.asarray(values, dtype=np.float32).reshape(points.shape[:-1])
