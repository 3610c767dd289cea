"""How a volume is cut for threads: slabs that share no voxel, so that no thread waits for another."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...arrays import Floats, Integers, Mask, Matrix, Numbers
from ...machine.threads import checked_threads, in_parts
from ..batch import BATCH_FRAMES, FrameBatch
from ..engine import Engine, Job
from ..evidence import ScanLines
from ..layout import PixelLayout
from .numba_kernels import clip

SLABS = 8
"""Slabs that a batch is cut into: what frames share of one fits into a core's cache, and threads end at about the same time."""

Put = Callable[[Integers, Floats, Integers], Integers]
"""Inserts pieces of rows (n, 4) into a box (2, 3), of which `spans` (frames, n, 2) tell the columns that may matter to it; answers how many
pixels entered of each frame, (frames,)."""


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
    """Puts a batch into a `VoxelState` slab by slab, on several threads; within a slab frames follow each other in time."""

    name = "numba"
    frames_at_once = BATCH_FRAMES
    margin = 0.0
    """Voxels beside a slab from which pixels give to it."""

    def __init__(self, job: Job):
        super().__init__(job)
        self.threads = checked_threads(job.threads)
        (i, j, _), (first, stop) = job.grid_size, job.planes
        self.part = np.array([i, j, first], dtype=np.float64)
        self._bounds = np.array([(0, 0, first), (i, j, stop)], dtype=np.float64)

    def insert(self, batch: FrameBatch, layout: PixelLayout, scan_lines: ScanLines | None) -> list[int]:
        """As `Engine.insert`: frames of which the same pixels count go in together."""
        counting = layout.mask & self._counting(layout)
        if not batch.measured:
            return self._insert_alike(batch, slice(0, len(batch)), layout, scan_lines, counting)
        entered: list[int] = []
        for place in range(len(batch)):
            kept = layout.within_window(batch.measured[place]) if place in batch.measured else True
            entered += self._insert_alike(batch, slice(place, place + 1), layout, scan_lines, counting & kept)
        return entered

    def _insert_alike(
        self, batch: FrameBatch, frames: slice, layout: PixelLayout, scan_lines: ScanLines | None, counting: Mask
    ) -> list[int]:
        matrices, pieces = batch.image_to_ijk[frames], layout.pieces_within(counting)
        put = self._put(batch, frames, layout, scan_lines)
        axis, edges = cut_into_slabs(matrices, layout, self._bounds)
        entered = np.zeros((len(edges) - 1, len(matrices)), np.int64)

        def part(number: int) -> None:
            box, spans = self._bounds.copy(), np.empty((len(matrices), len(pieces), 2), np.int32)
            box[:, axis] = edges[number : number + 2]
            around = box + self.margin * np.array([[-1.0], [1.0]])
            clip(matrices, pieces, around, axis, spans)
            entered[number] = put(pieces, box, spans)

        in_parts(part, len(edges) - 1, self.threads, batch.progress, "Reconstructing")
        return [int(n) for n in entered.sum(axis=0)]

    def _counting(self, layout: PixelLayout) -> Mask | bool:
        """Which pixels of the window count in every frame, (rows, columns) bool; True: all of the layout's."""
        return True

    def _put(self, batch: FrameBatch, frames: slice, layout: PixelLayout, scan_lines: ScanLines | None) -> Put:
        """What inserts these frames."""
        raise NotImplementedError
