"""Lines that are neighbors make a window: one answer for each, not ten beside each other."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy

from ..arrays import Bytes, Floats, Integers
from .states import NOT_SEEN, TIGHT, MetLine
from .surroundings import Surroundings

ENTRY_PITCH, END_PITCH = 2.0, 1.5
"""mm between the points on the skin from which lines begin, and between those at which they end."""

UNSEEN_PITCH = 3.0
"""mm between places that were not seen: a beam is as thick."""

NEIGHBORS = 1.8
"""Times that distance within which points are neighbors: the diagonal one still is."""

FEWEST, MOST = 4, 3
"""Lines that make a window, and windows that were not seen that are told at most."""


@dataclass(frozen=True, eq=False)
class Window(MetLine):
    """Lines that are neighbors and all free, or all not seen: the best of them, and what they are together."""

    name: str
    is_free: bool  #: Seen, and not blocked; else part of every line was not seen
    width: tuple[float, float]  #: mm across all its lines where the best one is nearest to bone: the narrow and the wide way
    lines: int
    unseen: Floats = field(repr=False)  #: (n, 3). Places of its lines that were not seen, one in each cube of `UNSEEN_PITCH`.

    @property
    def direction(self) -> Floats:
        """Unit vector of the line, (3,)."""
        way: Floats = (self.end - self.entry) / self.depth
        return way

    def to_dict(self) -> dict[str, object]:
        """All numbers by name, rounded to what they can mean."""
        return {
            "name": self.name,
            "free": self.is_free,
            "entry": np.round(self.entry, 2).tolist(),
            "end": np.round(self.end, 2).tolist(),
            "direction": np.round(self.direction, 5).tolist(),
            "depth_mm": round(self.depth, 2),
            "clearance_mm": round(self.clearance, 2) if self.is_free else None,
            "seen": round(self.seen, 4),
            "width_mm": [round(side, 1) for side in self.width],
            "lines": self.lines,
            "unseen": np.round(self.unseen, 2).tolist(),
        }


def windows_of(
    surroundings: Surroundings,
    points: tuple[Floats, Floats],
    joined: tuple[Integers, Integers],
    clearance: Floats,
    seen: Floats,
    states: Bytes,
) -> tuple[Window, ...]:
    """The windows among lines that join entries and ends: free ones by their clearance, then the largest not seen."""
    (entries, ends), (number, last) = points, joined
    found: list[Window] = []
    for is_free, chosen in ((True, np.flatnonzero(states >= TIGHT)), (False, np.flatnonzero(states == NOT_SEEN))):
        groups = _joined(entries, ends, number[chosen], last[chosen])
        sizes = np.bincount(groups)
        of_kind: list[tuple[int, Integers]] = []
        for group in np.flatnonzero(sizes >= FEWEST):
            lines = chosen[groups == group]
            of_kind.append((int(lines[clearance[lines].argmax()]), lines))
        of_kind.sort(key=lambda one: -clearance[one[0]] if is_free else -len(one[1]))
        for best, lines in of_kind if is_free else of_kind[:MOST]:
            entry, end, begins, finishes = entries[number[best]], ends[last[best]], entries[number[lines]], ends[last[lines]]
            width, unseen = _width(surroundings, begins, finishes, entry, end), surroundings.unseen(begins, finishes, UNSEEN_PITCH)
            name, clear, share = f"Path {len(found) + 1}", float(clearance[best]), float(seen[best])
            found.append(Window(entry, end, clear, share, name, is_free, width, len(lines), unseen))
    return tuple(found)


def _joined(entries: Floats, ends: Floats, number: Integers, last: Integers) -> Integers:
    """Which lines belong together, (n,) numbers of groups: neighbors begin in one place or side by side, and end so."""
    place = np.full((len(entries), len(ends)), -1)
    place[number, last] = np.arange(len(number))
    begin, finish = _side_by_side(entries, ENTRY_PITCH), _side_by_side(ends, END_PITCH)
    pairs = np.concatenate(
        [np.stack([place[begin[0]][:, one], place[begin[1]][:, other]], axis=-1).reshape(-1, 2) for one, other in finish.T]
    )
    pairs = pairs[(pairs >= 0).all(axis=1)]
    graph = scipy.sparse.coo_matrix((np.ones(len(pairs), bool), pairs.T), (len(number), len(number)))
    groups: Integers = scipy.sparse.csgraph.connected_components(graph, directed=False)[1]
    return groups


def _side_by_side(points: Floats, pitch: float) -> Integers:
    """Pairs of points in one place or side by side, in both orders, (2, n)."""
    pairs = scipy.spatial.cKDTree(points).query_pairs(NEIGHBORS * pitch, output_type="ndarray")
    each = np.arange(len(points))
    return np.concatenate([pairs.T, pairs.T[::-1], np.stack([each, each])], axis=1)


def _width(surroundings: Surroundings, entries: Floats, ends: Floats, entry: Floats, end: Floats) -> tuple[float, float]:
    """How far lines lie apart where the line from `entry` to `end` is nearest to bone, mm: the narrow and the wide way."""
    distance, _looks = surroundings.profile(entry[None], end[None])
    narrow = (int(distance.argmin()) + 1) / distance.shape[1]
    way = (end - entry) / np.linalg.norm(end - entry)
    places = entries + narrow * (ends - entries)
    places = places - places.mean(axis=0)
    places = places - np.outer(places @ way, way)
    across = np.linalg.svd(places, full_matrices=False)[2]
    extents = sorted(float(np.ptp(places @ axis)) for axis in across[:2])
    return extents[0], extents[1]
