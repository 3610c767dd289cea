"""The bone echoes of a sweep are looked for in its frames.

How an echo is told from tissue is the business of `BoneEchoFinder`, which the bone map of a sweep without CT uses too.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice

import numpy as np

from ...effective_settings import resolve_imaging
from ...errors import GeometryError
from ...geometry.transforms import pixel_spacing
from ...machine.threads import in_parts, usable_cores
from ...message import listed
from ...progress import Progress, part, report
from ...recipe.recipe import Recipe
from ...remedies import CHECK_PROBE_AND_CLIP
from ...sweep.frames import TrackedFrame, TrackedSequence
from ...sweep.multi_sweep import sweeps_of
from ...sweep.poses import poses_of_each, still_images_of, time_order, tracked_frames
from .finder import LEAST_SCORE, BoneEchoFinder
from .found import FEWEST, SweepEchoes

MOST_FRAMES = 240
"""Frames of all sweeps together that are looked at, evenly among them: time and memory do not grow with a recording's length."""

AT_ONCE = 16
"""Frames that are held in memory at a time, for all threads to look at."""


def echoes_of(frame: TrackedFrame, finder: BoneEchoFinder, number: int | None = None) -> SweepEchoes:
    """The echoes of a frame that has an image and a pose, in Reference; `number` stands for the frame's own."""
    image, matrix = frame.placed()
    return finder.find(image).placed(matrix, frame.number if number is None else number)


def sweep_echoes(
    sequences: TrackedSequence | Iterable[TrackedSequence],
    recipe: Recipe | None = None,
    *,
    most_frames: int | None = MOST_FRAMES,
    least_score: float = LEAST_SCORE,
    progress: Progress | None = None,
) -> SweepEchoes:
    """The bone echoes of one or more recorded sweeps in one Reference.

    Raises AIFReconError when frames cannot be placed or beams not be told, as in `reconstruct`; GeometryError when fewer than `FEWEST`
    echoes are found.

    Parameters
    ----------
    recipe : Recipe or None
        As in `reconstruct`.
    most_frames : int or None
        Of all sweeps together; chosen evenly. None: all.
    least_score : float, 0 to 1
        From which an echo counts.
    """
    recipe = recipe or Recipe()
    sweeps = sweeps_of(sequences, recipe)
    placed = []
    for sequence, poses in zip(sweeps, poses_of_each(sweeps, recipe.image_to_reference, recipe.reference), strict=True):
        usable = poses.usable
        order = time_order(sequence)
        placed.append((sequence, poses, order[np.isin(order, usable)]))
    every = 1.0 if most_frames is None else max(sum(len(order) for *_, order in placed) / most_frames, 1.0)
    found: list[SweepEchoes] = []
    before = 0
    for done, (sequence, poses, order) in enumerate(placed):
        chosen = order[np.unique((np.arange(max(int(len(order) / every), 1)) * every).astype(np.int64))]
        imaging = resolve_imaging(sequence, poses, True, recipe)
        spacing = pixel_spacing(poses.image_to_reference[chosen[0]])
        finder = BoneEchoFinder(sequence.frame_size, spacing, imaging, least_score)
        share = part(progress, done / len(placed), (done + 1) / len(placed))
        frames = tracked_frames(sequence, poses, chosen, still_images_of(sequence, poses, chosen))
        for number in range(0, len(chosen), AT_ONCE):
            report(share, number / len(chosen), "Looking for bone in the sweep")
            found += _read_at_once(finder, [frame for frame in islice(frames, AT_ONCE) if frame.status == "OK"], before)
        before += len(sequence)
    echoes = SweepEchoes.joined(found)
    if len(echoes) < FEWEST:
        raise GeometryError(
            f"{listed([sequence.name for sequence in sweeps])}: {len(echoes)} bone echoes, bright with darkness behind them, are too "
            f"few to tell bone by; {FEWEST} are needed.",
            CHECK_PROBE_AND_CLIP,
        )
    return echoes


def _read_at_once(finder: BoneEchoFinder, frames: list[TrackedFrame], before: int) -> list[SweepEchoes]:
    """The echoes of each of these frames, found by all cores; frames are counted on from `before`."""
    found = [SweepEchoes.joined(())] * len(frames)

    def read(index: int) -> None:
        found[index] = echoes_of(frames[index], finder, before + frames[index].number)

    in_parts(read, len(frames), usable_cores())
    return found
