"""How a volume is cut for threads: slabs that share no voxel, so that no thread waits for another."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ...arrays import Integers, Mask, Matrix, Numbers
from ...machine.threads import AdaptiveBatch, checked_threads, in_parts
from ...progress import Progress
from ..batch import BATCH_FRAMES, FrameBatch
from ..engine import Engine, Job
from ..evidence import ScanLines
from ..layout import PixelLayout
from .groups import Slab

SLABS, SLABS_WITH_BONE = 8, 16
"""Slabs that a batch is cut into at most, and where the bone map is read in every voxel, which takes 16 bytes more of each: what frames
share of a slab fits into a core's cache."""

VOXELS_OF_SLAB = 8_000
"""Of one frame, that a core's cache holds beside the rest; smaller slabs only cut rows into more pieces, which are read out of turn."""

SLABS_OF_THREAD = 2
"""At least, so that threads end at about the same time."""


def slabs_for(matrices: Matrix, layout: PixelLayout, threads: int, most: int = SLABS) -> int:
    """How many slabs, at `most`, the cache and the threads ask for, by the voxels that the first of `matrices` (frames, 4, 4) meets."""
    left, right, top, bottom = layout.bounds
    pixel = float(np.linalg.norm(np.cross(matrices[0, :3, 0], matrices[0, :3, 1])))
    needed = pixel * (right - left) * (bottom - top) / VOXELS_OF_SLAB * (most / SLABS)
    return min(max(int(needed), SLABS_OF_THREAD * threads), most)


def cut_into_slabs(matrices: Matrix, layout: PixelLayout, bounds: Numbers, slabs: int = SLABS) -> tuple[int, Integers]:
    """The axis across which to cut, and the edges of the slabs along it, for frames at these places.

    Parameters
    ----------
    matrices : (frames, 4, 4) float64 array, image_to_ijk
    bounds : (2, 3) array, along i, j, k
        The first voxel of the part that counts, and the one after the last.
    slabs : int
        How many, at most.

    Returns
    -------
    axis : int
    edges : (slabs + 1,) int64 array
        First voxel of each slab, and the end of the last; together they hold every voxel that a pixel is in or, by less than one
        voxel, beside.

    Notes
    -----
    The axis is the one that image rows lie across and image columns lie along, so that rows are cut as little as can be.
    """
    left, right, top, bottom = layout.bounds
    down, along = np.abs(matrices[:, :3, 1]).mean(axis=0) * (bottom - top), np.abs(matrices[:, :3, 0]).mean(axis=0) * (right - left)
    axis = int(np.argmax(down - along))
    corners = np.array([(x, y, 0, 1) for x in (left, right) for y in (top, bottom)], dtype=np.float64)
    reached = corners @ matrices[:, axis, :].T + 0.5
    low, high = bounds[:, axis]
    first, last = (float(np.clip(np.floor(end), low, high - 1)) for end in (reached.min(), reached.max()))
    return axis, np.unique(np.floor(np.linspace(max(first - 1, low), min(last + 2, high), slabs + 1)).astype(np.int64))


class SlabEngine(Engine):
    """Puts a batch into a `VoxelState` slab by slab, on several threads.

    Slabs share no voxel, so threads need no locks and no order among them; within a slab frames follow each other in time, so that what
    they have in common is still in the cache when the next one comes.
    """

    name = "numba"
    frames_at_once = BATCH_FRAMES

    def __init__(self, job: Job):
        super().__init__(job)
        self.threads, self._pace = checked_threads(job.threads), AdaptiveBatch()

    def insert(self, batch: FrameBatch, layout: PixelLayout, scan_lines: ScanLines | None) -> list[int]:
        """As `Engine.insert`: frames of which the same pixels count go in together."""
        counting = self._counting(layout)
        if not batch.measured:
            return self._insert_alike(batch, slice(0, len(batch)), layout, scan_lines, counting)
        entered: list[int] = []
        for place in range(len(batch)):
            both = counting
            if place in batch.measured:
                kept = layout.within_window(batch.measured[place])
                both = kept if counting is None else kept & counting
            entered += self._insert_alike(batch, slice(place, place + 1), layout, scan_lines, both)
        return entered

    def _counting(self, layout: PixelLayout) -> Mask | None:
        """Which pixels of the window count in every frame, (rows, columns) bool; None: all of the layout's."""
        return None

    def _insert_alike(
        self, batch: FrameBatch, frames: slice, layout: PixelLayout, scan_lines: ScanLines | None, counting: Mask | None
    ) -> list[int]:
        raise NotImplementedError

    def _in_slabs(
        self, put: Callable[[Slab, Integers], Iterator[None]], axis: int, edges: Integers, frames: int, progress: Progress | None
    ) -> list[int]:
        """Call `put` for every slab, with the (frames,) counts that it raises; how many pixels entered of each frame."""
        entered = np.zeros((len(edges) - 1, frames), np.int64)

        def part(number: int) -> Iterator[None]:
            return put((axis, int(edges[number]), int(edges[number + 1])), entered[number])

        in_parts(part, len(edges) - 1, self.threads, progress, "Reconstructing")
        return [int(n) for n in entered.sum(axis=0)]
