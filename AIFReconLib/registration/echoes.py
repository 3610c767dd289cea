"""The bone echoes of a sweep as points in Reference: what a CT is laid upon.

How an echo is told from tissue is the business of `BoneEchoFinder`, which the bone map of a sweep without CT uses too.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Integers, Mask, Singles
from ..bone.echo_bone import BoneEchoFinder
from ..errors import GeometryError
from ..geometry.transforms import pixel_spacing
from ..machine.threads import in_parts, usable_cores
from ..message import listed
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..remedies import Remedy
from ..resolve import resolve_imaging
from ..sweep.frames import TrackedFrame, TrackedSequence
from ..sweep.joined import sweeps_of
from ..sweep.poses import poses_of_each, time_order, tracked_frames

MOST_FRAMES = 240
"""Frames of all sweeps together that are looked at, evenly among them: time and memory do not grow with a recording's length."""

AT_ONCE = 16
"""Frames that are held in memory at a time, for all threads to look at."""

FEWEST = 150
"""Echoes below which no registration is attempted: six degrees of freedom from a few frames of a few scan lines."""


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


def echoes_of(frame: TrackedFrame, finder: BoneEchoFinder, number: int | None = None) -> SweepEchoes:
    """The echoes of a frame that has an image and a pose, in Reference; `number` stands for the frame's own."""
    image, matrix = frame.placed()
    echoes = finder.find(image)
    beams = echoes.beams @ matrix[:3, :2].T
    beams /= np.maximum(np.linalg.norm(beams, axis=1, keepdims=True), 1e-9)
    frames = np.full(len(echoes.scores), frame.number if number is None else number)
    return SweepEchoes(echoes.pixels @ matrix[:3, :2].T + matrix[:3, 3], beams, echoes.scores, frames)


def sweep_echoes(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    recipe: Recipe | None = None,
    *,
    most_frames: int = MOST_FRAMES,
    progress: Progress | None = None,
) -> SweepEchoes:
    """The bone echoes of one or more recorded sweeps in one Reference.

    Raises AIFReconError when frames cannot be placed or beams not be told, as in `reconstruct`; GeometryError when fewer than `FEWEST`
    echoes are found.

    Parameters
    ----------
    sequences : TrackedSequence or several
    recipe : Recipe or None
        As in `reconstruct`.
    most_frames : int
        Of all sweeps together; chosen evenly.
    """
    sweeps, recipe = sweeps_of(sequences), recipe or Recipe()
    placed = []
    for sequence, poses in zip(sweeps, poses_of_each(sweeps, recipe.image_to_reference, recipe.reference), strict=True):
        usable = poses.usable
        order = time_order(sequence)
        placed.append((sequence, poses, order[np.isin(order, usable)]))
    every = max(sum(len(order) for *_, order in placed) / most_frames, 1.0)
    found: list[SweepEchoes] = []
    before = 0
    for done, (sequence, poses, order) in enumerate(placed):
        chosen = order[np.unique((np.arange(max(int(len(order) / every), 1)) * every).astype(np.int64))]
        imaging = resolve_imaging(sequence, poses, True, recipe)
        finder = BoneEchoFinder(sequence.frame_size, pixel_spacing(poses.image_to_reference[chosen[0]]), imaging)
        share = part(progress, done / len(placed), (done + 1) / len(placed))
        for number in range(0, len(chosen), AT_ONCE):
            report(share, number / len(chosen), "Looking for bone in the sweep")
            found += _read_at_once(finder, list(tracked_frames(sequence, poses, chosen[number : number + AT_ONCE])), before)
        before += len(sequence)
    echoes = SweepEchoes.joined(found)
    if len(echoes) < FEWEST:
        raise GeometryError(
            f"{listed([sequence.name for sequence in sweeps])}: {len(echoes)} bone echoes, bright with darkness behind them, are too "
            f"few to place a CT by; {FEWEST} are needed.",
            Remedy.CHECK_PROBE_AND_CLIP,
        )
    return echoes


def _read_at_once(finder: BoneEchoFinder, frames: list[TrackedFrame], before: int) -> list[SweepEchoes]:
    """The echoes of each of these frames, found by all cores; frames are counted on from `before`."""
    found = [SweepEchoes.joined(())] * len(frames)

    def read(index: int) -> None:
        found[index] = echoes_of(frames[index], finder, before + frames[index].number)

    in_parts(read, len(frames), usable_cores())
    return found


def _numbered_cubes(points: Floats, edge: float) -> Integers:
    """The number of the cube of this edge (mm) in which each point (n, 3) lies, (n,)."""
    cubes = np.floor(points / edge).astype(np.int64)
    cubes -= cubes.min(axis=0)
    across = cubes.max(axis=0) + 1
    numbers: Integers = (cubes[:, 0] * across[1] + cubes[:, 1]) * across[2] + cubes[:, 2]
    return numbers
