"""Which frame lies where: named transforms, their statuses, and the chains between frames.

The rules are those of the Plus toolkit: a transform `ProbeToTracker` maps Probe to Tracker, inverses and chains are implied. Servers
compute whatever transform they are asked for, so several ways may lead from one frame to another: ways that agree are one, and ways that
do not are an error. What is on no way between the two is not asked, and a transform from a frame to itself says nothing. A way that leads
over a tool that is not seen is none, and where that tool is on another way too, neither is that.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import chain

import numpy as np

from ..arrays import Matrix
from ..errors import GeometryError, TransformError, require_kind
from .transforms import invert

AGREE = 0.1
"""mm within which two ways are one: files and messages round their numbers, and poses between samples are interpolated."""


class TransformStatus(Enum):
    """What the tracker said of a pose. Only OK is usable."""

    OK = "OK"
    MISSING = "MISSING"
    OUT_OF_VIEW = "OUT_OF_VIEW"
    OUT_OF_VOLUME = "OUT_OF_VOLUME"
    SWITCH1_IS_ON = "SWITCH1_IS_ON"
    SWITCH2_IS_ON = "SWITCH2_IS_ON"
    SWITCH3_IS_ON = "SWITCH3_IS_ON"
    REQ_TIMEOUT = "REQ_TIMEOUT"
    INVALID = "INVALID"
    PATH_NOT_FOUND = "PATH_NOT_FOUND"
    UNKNOWN = "UNKNOWN"

    @classmethod
    def parse(cls, text: str) -> TransformStatus:
        """The status that `text` names, in any case; UNKNOWN for a word that is none."""
        return cls.__members__.get(text.strip().upper(), cls.UNKNOWN)


def capital(text: str) -> str:
    """`text` with a capital first letter, as Plus spells the names of coordinate frames."""
    return text[:1].upper() + text[1:]


@dataclass(frozen=True)
class TransformName:
    """`From` and `To` of a transform; its text is ``FromToTo``."""

    source: str
    target: str

    @classmethod
    def parse(cls, text: str) -> TransformName:
        """Split a name such as ``ProbeToTracker`` (a trailing ``Transform`` is allowed); frames get a capital first letter, as in Plus.

        Raises TransformError when the name has no "To" before an upper-case letter or a digit between two frames, or more than one.
        """
        require_kind("transform name", text, str, "Poses go into the sequence: TrackedSequence.from_arrays(images, image_to_reference).")
        bare = text.removesuffix("Transform")
        # As IGSIO splits: whatever is no lower-case letter begins a frame's name
        cuts = [m.start() for m in re.finditer(r"To(?=[^a-z\s])", bare)]
        if len(cuts) != 1 or cuts[0] == 0:
            raise TransformError(
                "Input transform name must be FromToTo, with one 'To' before an upper-case letter or a digit (as in ProbeToTracker); "
                f"got {text!r}."
            )
        return cls(capital(bare[: cuts[0]]), capital(bare[cuts[0] + 2 :]))

    @property
    def inverse(self) -> TransformName:
        """The name of the transform the other way: ``TrackerToProbe`` for ``ProbeToTracker``."""
        return TransformName(self.target, self.source)

    def __str__(self) -> str:
        return f"{self.source}To{self.target}"


@dataclass(frozen=True)
class TransformSample:
    """One transform at one moment: matrix (4, 4) and what the tracker said of it."""

    matrix: Matrix
    status: TransformStatus = TransformStatus.OK


MISSING = TransformSample(np.full((4, 4), np.nan), TransformStatus.MISSING)


@dataclass(frozen=True)
class _Link:
    """One step of a way: a stored transform, followed forward or as its inverse."""

    stored: TransformName
    forward: bool

    @cached_property
    def name(self) -> TransformName:
        """Its transform in the direction of travel."""
        return self.stored if self.forward else self.stored.inverse


Way = tuple[_Link, ...]


@dataclass(frozen=True)
class Ways:
    """Every way from one frame to another."""

    path: Way  #: The one with the fewest links
    loops: tuple[tuple[Way, Way], ...]
    """Two ways to one frame, for each link by which there is more than one."""

    @cached_property
    def names(self) -> tuple[TransformName, ...]:
        """The stored transforms as a trouble is told of the first: a tool of the path says more than what was computed of it."""
        frames = {frame for link in self.path for frame in (link.stored.source, link.stored.target)}
        links = dict.fromkeys(link for way in (self.path, *chain(*self.loops)) for link in way)

        def doubt(link: _Link) -> int:
            return 1 if link in self.path else 0 if link.stored.source in frames else 2

        return tuple(link.stored for link in sorted(links, key=doubt))

    def without(self, broken: Collection[TransformName]) -> Ways | None:
        """The ways that are left where these transforms are not valid; None where none is, or it leads over a tool of theirs."""
        if not broken:
            return self
        try:
            left = find_ways([name for name in self.names if name not in broken], self.path[0].name.source, self.path[-1].name.target)
        except TransformError:
            return None
        frames = {frame for name in left.names for frame in (name.source, name.target)}
        return None if any(name.source in frames for name in broken) else left

    def follow(self, matrices: Mapping[TransformName, Matrix]) -> tuple[Matrix, list[Matrix]]:
        """The product along `path`, (4, 4), and those along the two ways of each of `loops`, (2, 4, 4).

        Raises GeometryError when a matrix would have to be inverted that is singular.
        """
        return _product(self.path, matrices), [np.stack([_product(way, matrices) for way in loop]) for loop in self.loops]

    def describe(self, number: int) -> str:
        """The two ways of a loop, in words."""
        one, other = self.loops[number]
        source = one[0].name.source
        # The path, led round by the other side of the loop, where it meets the loop
        stored = [{link.stored for link in way} for way in (self.path, one, other)]
        around = find_ways(stored[0] ^ stored[1] ^ stored[2], source, self.path[-1].name.target).path
        if set(around) != set(self.path):
            one, other = self.path, around
        return f"Two paths lead from {source} to {one[-1].name.target}: {self._spell(one)}; and {self._spell(other)}"

    def _spell(self, way: Way) -> str:
        return " > ".join(f"inverse of {link.stored}" if not link.forward and link.name in self.names else str(link.name) for link in way)


def _product(way: Way, matrices: Mapping[TransformName, Matrix]) -> Matrix:
    matrix = np.eye(4)
    for link in way:
        try:
            matrix = (matrices[link.stored] if link.forward else invert(matrices[link.stored])) @ matrix
        except GeometryError:
            raise GeometryError(f"{link.stored} singular") from None
    return matrix


def find_ways(names: Iterable[TransformName], source: str, target: str) -> Ways:
    """The ways from `source` to `target` over transforms of these names and their inverses.

    Raises TransformError when there is none (names what is connected to either end).
    """
    names = tuple(names)
    leaving = _links_by_source(names)
    on_way = _reached(leaving, {source})
    if target not in on_way:
        known, near = ", ".join(map(str, names)) or "none", _list_frames(on_way - {source})
        raise TransformError(
            f"Nothing says where {source} lies in {target}. Known transforms: {known}. {source} is connected to {near}, {target} to "
            f"{_list_frames(_reached(leaving, {target}) - {target})}."
        )
    # A frame that a single other frame cuts off from both ends is on no way between them
    for cut in sorted(on_way):
        on_way &= _reached(leaving, {source, target} - {cut}, without=cut) | {cut}
    ways: dict[str, Way] = {source: ()}
    loops: list[tuple[Way, Way]] = []
    used: set[TransformName] = set()
    for here in (nearest_first := [source]):
        for link in leaving.get(here, ()):
            there = link.name.target
            if there not in on_way or link.stored in used:
                continue
            used.add(link.stored)
            way = (*ways[here], link)
            if there in ways:
                loops.append((ways[there], way))
            else:
                ways[there] = way
                nearest_first.append(there)
    return Ways(ways[target], tuple(loops))


def connected(names: Iterable[TransformName], frame: str) -> set[str]:
    """Every frame that some chain of these transforms joins to `frame`, itself included."""
    return _reached(_links_by_source(names), {frame})


def _links_by_source(names: Iterable[TransformName]) -> dict[str, list[_Link]]:
    leaving: dict[str, list[_Link]] = {}
    for name in names:
        if name.source != name.target:
            leaving.setdefault(name.source, []).append(_Link(name, True))
            leaving.setdefault(name.target, []).append(_Link(name, False))
    return leaving


def _reached(leaving: Mapping[str, list[_Link]], starts: set[str], without: str | None = None) -> set[str]:
    """Every frame that a chain from one of `starts` leads to, but not over `without`; those themselves included."""
    found, edge = set(starts), list(starts)
    while edge:
        for link in leaving.get(edge.pop(), ()):
            there = link.name.target
            if there not in found and there != without:
                found.add(there)
                edge.append(there)
    return found


def capitalized(name: TransformName) -> TransformName:
    """The transform with its frames as Plus spells them: with a capital first letter."""
    return TransformName(capital(name.source), capital(name.target))


def _list_frames(frames: Iterable[str]) -> str:
    return ", ".join(sorted(frames)) or "nothing"
