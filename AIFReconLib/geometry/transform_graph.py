"""Which frame lies where: named transforms, their statuses, and the chains between frames.

The rules are those of the Plus toolkit: a transform `ProbeToTracker` maps Probe to Tracker, inverses and chains are
implied, and a second way from one frame to another is an error, because the two would sooner or later disagree.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Matrix
from ..errors import TransformError, require_kind
from ..message import Message
from .transforms import as_matrix, invert, why_not_affine


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

        Raises
        ------
        TransformError
            When the name has no "To" before an upper-case letter or a digit between two frames, or more than one.
        """
        require_kind("transform name", text, str, "Poses go into the sequence: TrackedSequence.from_arrays(images, image_to_reference).")
        bare = text.removesuffix("Transform")
        # As IGSIO splits: whatever is no lower-case letter begins a frame's name
        cuts = [m.start() for m in re.finditer(r"To(?=[^a-z\s])", bare)]
        if len(cuts) != 1 or cuts[0] == 0:
            raise TransformError(
                "Input transform name must be FromToTo, with one 'To' before an upper-case letter or a digit (as in ProbeToTracker); "
                "got {text!r}.",
                text=text,
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


@dataclass(frozen=True)
class FoundTransform:
    """The answer of a look-up: the matrix, the status of the chain, and the transforms it is made of."""

    matrix: Matrix
    status: TransformStatus
    path: tuple[TransformName, ...]

    def describe_path(self) -> str:
        """The chain in words: ``ImageToProbe, ProbeToTracker, TrackerToReference``."""
        return ", ".join(str(name) for name in self.path)


class TransformGraph:
    """Named transforms with implied inverses and chains.

    Examples
    --------
    >>> graph = TransformGraph()
    >>> graph.put("ImageToProbe", np.diag([0.2, 0.2, 0.2, 1.0]))
    >>> graph.put("ProbeToReference", np.eye(4))
    >>> graph.lookup("Image", "Reference").describe_path()
    'ImageToProbe, ProbeToReference'
    """

    def __init__(self, transforms: dict[TransformName, TransformSample] | None = None):
        require_kind("transforms", transforms, (dict, type(None)), "Poses of a sweep go into TrackedSequence.from_arrays.")
        self._transforms: dict[TransformName, TransformSample] = {}
        for name, sample in (transforms or {}).items():
            self._put(name, sample)

    def __len__(self) -> int:
        return len(self._transforms)

    @property
    def names(self) -> tuple[TransformName, ...]:
        """The transforms that were put in, in that order."""
        return tuple(self._transforms)

    def put(self, name: str | TransformName, matrix: ArrayLike, status: TransformStatus = TransformStatus.OK) -> None:
        """Add a transform, or replace the one of the same name.

        Raises
        ------
        TransformError
            When its inverse is there already: two statements of one relation. When it leads from a frame to itself.
        GeometryError
            When the matrix is not a finite, invertible 4x4 matrix.
        """
        name = TransformName.parse(name) if isinstance(name, str) else name
        self._put(name, TransformSample(as_matrix(matrix, Message("transform {name}", name=name)), status))

    def updated(self, transforms: dict[TransformName, TransformSample]) -> TransformGraph:
        """A new graph with `transforms` (those of one tracked frame) put on top of this one."""
        graph = TransformGraph(self._transforms)
        for name, sample in transforms.items():
            graph._put(name, sample)
        return graph

    def lookup(self, source: str, target: str) -> FoundTransform:
        """The transform from `source` to `target`, as a chain of what was put in.

        Returns
        -------
        FoundTransform
            Its status is OK only when every link is OK; else it is the first other status on the way (INVALID for a link that is
            no finite affine matrix), and the matrix is NaN, so that nobody uses it by mistake.

        Raises
        ------
        TransformError
            When no path exists (names what is connected to either end), or more than one (names two).
        GeometryError
            When a singular matrix would have to be inverted.
        """
        path = self._shortest_path(source, target)
        if path is None:
            raise self._no_path(source, target)
        for link, _ in path:
            other = self._shortest_path(source, target, without=link)
            if other is not None:
                raise TransformError(
                    "Two paths lead from {source} to {target}: {one}; and {other}. "
                    "Remove one of them, or take the recorded one with --image-to-reference {source}To{target}.",
                    source=source,
                    target=target,
                    one=_spell(path),
                    other=_spell(other),
                )
        names = tuple(name if forward else name.inverse for name, forward in path)
        matrix = np.eye(4)
        for name, forward in path:
            sample = self._transforms[name]
            status = sample.status
            if status is TransformStatus.OK and why_not_affine(sample.matrix):
                status = TransformStatus.INVALID
            if status is not TransformStatus.OK:
                return FoundTransform(np.full((4, 4), np.nan), status, names)
            matrix = (sample.matrix if forward else invert(sample.matrix)) @ matrix
        return FoundTransform(matrix, TransformStatus.OK, names)

    def connected(self, frame: str) -> set[str]:
        """Every frame that some chain joins to `frame`, itself included."""
        found, edge = {frame}, [frame]
        while edge:
            here = edge.pop()
            for name in self._transforms:
                for a, b in ((name.source, name.target), (name.target, name.source)):
                    if a == here and b not in found:
                        found.add(b)
                        edge.append(b)
        return found

    def _put(self, name: TransformName, sample: TransformSample) -> None:
        if name.source == name.target:
            raise TransformError("Transform {name} cannot be set: it leads from a frame to itself. Remove it.", name=name)
        if name.inverse in self._transforms:
            raise TransformError(
                "Transform {name} cannot be set: its inverse {inverse} is given already. Remove one of the two.",
                name=name,
                inverse=name.inverse,
            )
        self._transforms[name] = sample

    def _shortest_path(self, source: str, target: str, without: TransformName | None = None) -> list[tuple[TransformName, bool]] | None:
        """The way with the fewest links that avoids `without`, as (stored name, used forward); None where there is none."""
        ways: dict[str, list[tuple[TransformName, bool]]] = {source: []}
        nearest_first = [source]
        for here in nearest_first:
            for name in self._transforms:
                if name == without or here not in (name.source, name.target):
                    continue
                forward = name.source == here
                there = name.target if forward else name.source
                if there not in ways:
                    ways[there] = [*ways[here], (name, forward)]
                    nearest_first.append(there)
        return ways.get(target)

    def _no_path(self, source: str, target: str) -> TransformError:
        return TransformError(
            "No transform leads from {source} to {target}. Known transforms: {known}. "
            "{source} is connected to {near_source}, {target} to {near_target}.",
            source=source,
            target=target,
            known=", ".join(str(name) for name in self._transforms) or Message("none"),
            near_source=_list_frames(self.connected(source) - {source}),
            near_target=_list_frames(self.connected(target) - {target}),
        )


def _list_frames(frames: Iterable[str]) -> str:
    return ", ".join(sorted(frames)) or Message("nothing")


def _spell(path: list[tuple[TransformName, bool]]) -> str:
    return " > ".join(str(name if forward else name.inverse) for name, forward in path)


def capitalized(name: TransformName) -> TransformName:
    """The transform with its frames as Plus spells them: with a capital first letter."""
    return TransformName(capital(name.source), capital(name.target))
