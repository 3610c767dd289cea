"""Several sweeps of one patient as one: frame after frame in the order given, each sweep with its own transforms."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from ..arrays import Integers, Numbers
from ..errors import GeometryError, require_kind
from ..imaging.images import ImagesOnDemand, ImageStack
from ..recipe.recipe import ReadingSettings
from .frames import TrackedSequence
from .time_offset import as_asked


class JoinedImages(ImagesOnDemand):
    """The images of several stacks, one after the other."""

    def __init__(self, stacks: Sequence[ImageStack]):
        self._stacks = stacks
        self._ends = list(accumulate(map(len, stacks)))
        self.shape, self.dtype = (self._ends[-1], *stacks[0].shape[1:]), stacks[0].dtype

    def _image(self, index: int) -> Numbers:
        stack = bisect_right(self._ends, index)
        return self._stacks[stack][index - self._ends[stack] + len(self._stacks[stack])]


@dataclass(frozen=True, eq=False, repr=False)
class JoinedSequence(TrackedSequence):
    """What `joined` makes of several: their frames, numbered through; the first one's configuration says how the volume is made."""

    of: tuple[TrackedSequence, ...] = ()
    """The sweeps, each with its own transforms and configuration, by which its frames are placed."""

    @property
    def sweeps(self) -> tuple[TrackedSequence, ...]:
        """The sweeps."""
        return self.of

    @property
    def name(self) -> str:
        """The names of all."""
        return ", ".join(names_of(self.of))


def names_of(sequences: Iterable[TrackedSequence]) -> list[str]:
    """Names that tell sweeps apart: the files', with their folders where two have one name, and a number where that is not enough."""
    sequences = list(sequences)
    names = [sequence.name for sequence in sequences]
    long = [str(each.path) if names.count(name) > 1 and each.path else name for name, each in zip(names, sequences, strict=True)]
    return [f"{name} ({long[:n].count(name) + 1})" if name in long[:n] else name for n, name in enumerate(long)]


def sweeps_of(sequences: TrackedSequence | Iterable[TrackedSequence], asked: ReadingSettings | None = None) -> list[TrackedSequence]:
    """One or more sequences as the sweeps that they are made of, each read as `asked`.

    Raises InputTypeError when one is something else, such as the path of a file; SettingsError as `as_asked`.
    """
    advice = "Read it first: read_sequence(path); of arrays make one: TrackedSequence.from_arrays(images, image_to_reference)."
    if isinstance(sequences, str) or hasattr(sequences, "shape") or not isinstance(sequences, Iterable):
        require_kind("sequence", sequences, TrackedSequence, advice)
    sequences = [sequences] if isinstance(sequences, TrackedSequence) else list(sequences)
    for sequence in sequences:
        require_kind("sequence", sequence, TrackedSequence, advice)
    sweeps = [sweep for sequence in sequences for sweep in sequence.sweeps]
    return sweeps if asked is None else [as_asked(sweep, asked) for sweep in sweeps]


def joined(sequences: TrackedSequence | Iterable[TrackedSequence], asked: ReadingSettings | None = None) -> TrackedSequence:
    """One or more sweeps as one, in the order given, each read as `asked`.

    Raises GeometryError when there is none, or their images differ in size or type; InputTypeError when one is something else, such as
    the path of a file; SettingsError as `as_asked`.
    """
    sweeps = tuple(sweeps_of(sequences, asked))
    if isinstance(sequences, TrackedSequence) and sweeps == sequences.sweeps:
        return sequences
    if not sweeps:
        raise GeometryError("Input sequence must be one or more sweeps; got none.")
    if len(sweeps) == 1:
        return sweeps[0]
    first, names = sweeps[0], names_of(sweeps)
    for other, name in zip(sweeps[1:], names[1:], strict=True):
        if (first.frame_size, np.dtype(first.images.dtype)) != (other.frame_size, np.dtype(other.images.dtype)):
            raise GeometryError(
                f"{names[0]} and {name} cannot enter one volume: images of {_kind(first)} and of {_kind(other)}. Reconstruct them one "
                "by one."
            )
    return JoinedSequence(
        JoinedImages([sweep.images for sweep in sweeps]),
        [record for sweep in sweeps for record in sweep.records],
        configuration=first.configuration,
        of=sweeps,
    )


def _kind(sequence: TrackedSequence) -> str:
    columns, rows = sequence.frame_size
    return f"{columns} x {rows} pixels, {np.dtype(sequence.images.dtype).name}"


@dataclass(frozen=True)
class SweepShare:
    """What one of several sweeps gave to a volume."""

    name: str
    frames: int
    inserted: int
    """How many it has, and how many of them entered."""
    skipped: dict[str, list[int]]
    """The sweep's own numbers of those that did not, by reason."""


def shares(sequence: TrackedSequence, taken: Integers, skipped: Mapping[str, Sequence[int]]) -> tuple[SweepShare, ...]:
    """What each sweep gave, of the frames `taken` in turn and those of them that were `skipped`, both numbered through."""
    found, start = [], 0
    for sweep, name in zip(sequence.sweeps, names_of(sequence.sweeps), strict=True):
        end = start + len(sweep)
        skipped_here = {reason: [int(n) - start for n in numbers if start <= n < end] for reason, numbers in skipped.items()}
        skipped_here = {reason: numbers for reason, numbers in skipped_here.items() if numbers}
        entered = int(((taken >= start) & (taken < end)).sum()) - sum(map(len, skipped_here.values()))
        found.append(SweepShare(name, len(sweep), entered, skipped_here))
        start = end
    return tuple(found)
