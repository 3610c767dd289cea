"""A bone map that is empty when a scan begins and grows while it goes on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import product
from typing import ClassVar

import numpy as np

from ..arrays import Integers, Matrix, Numbers
from ..geometry.box import Box
from ..geometry.volume import Volume, VoxelGrid
from ..progress import Progress
from .map import BoneMap
from .placed.on_grid import BoneOnGrid
from .predictions import BoneAccumulator, BoneSamples, cubes_over

MOST_PENDING, AT_A_TIME = 500, 8
"""Frames that wait until there is a volume (of more, every other is let go), and how many it then takes with each new one."""

BLOCK = 48
"""Voxels along each edge of what is brought up to date in one go, where there is any bone; some 15 ms."""


@dataclass(frozen=True, eq=False, repr=False)
class GrowingBone(BoneMap):
    """Bone of which nothing is known at first.

    A reconstructor reads it on its own grid (`on_grid`), where `learn` and `spread` bring what frames say meanwhile. One that inserts at
    the same time sees some voxels as they were and others as they are: each is written as a whole, so its frame is weighted by what is
    known so far, and nothing waits.
    """

    grows: ClassVar[bool] = True
    probability: Volume = field(default_factory=lambda: Volume(np.zeros((1, 1, 1), np.float32), np.eye(4)))
    _on_grid: list[tuple[VoxelGrid, BoneOnGrid]] = field(default_factory=list)
    _known: list[tuple[VoxelGrid, BoneAccumulator]] = field(default_factory=list)
    _pending: list[tuple[BoneSamples, Matrix]] = field(default_factory=list)

    def on_grid(
        self, grid: VoxelGrid, direction: str = "gradient", progress: Progress | None = None, planes: tuple[int, int] | None = None
    ) -> BoneOnGrid:
        """Arrays of nothing, which `spread` fills; those of an earlier grid are let go. A scan is never made in parts."""
        if planes is not None:
            raise ValueError("A map that grows has one volume to grow in; got a part of one.")
        # Compiled now: frames must not wait for it
        super().on_grid(VoxelGrid.from_spacing((0.0, 0.0, 0.0), (2, 2, 2), 0.5))
        nowhere = np.zeros(grid.shape, np.float32)
        empty = BoneOnGrid(nowhere, np.zeros((*grid.shape, 3), np.float32), nowhere, np.eye(4))
        self._on_grid[:] = [(grid, empty)]
        return empty

    def learn(self, samples: BoneSamples, image_to_reference: Matrix, grid: VoxelGrid | None) -> None:
        """Take a frame, for a volume on `grid`; another grid than before begins anew. Without one it waits for the first."""
        if grid is None:
            self._pending.append((samples, image_to_reference))
            if len(self._pending) > MOST_PENDING:
                del self._pending[::2]
            return
        if not self._known or self._known[0][0] is not grid:
            self._known[:] = [(grid, BoneAccumulator(cubes_over(grid)))]
        earlier = self._pending[:AT_A_TIME]
        del self._pending[:AT_A_TIME]
        for each, pose in (*earlier, (samples, image_to_reference)):
            self._known[0][1].add(each, pose)

    def spread(self, pause: Callable[[], object] = lambda: None) -> bool:
        """Bring what was learned since the last time to the voxels of the reconstructor; whether there was anything.

        `pause` is called between steps of some 15 ms. For one thread alone; another may `learn` meanwhile.
        """
        if not self._on_grid or not self._known or self._on_grid[0][0] is not self._known[0][0]:
            return False
        (grid, placed), known = self._on_grid[0], self._known[0][1]
        if not placed.probability.any():
            # A volume that begins anew is told all
            known.renew()
        news = known.news(pause)
        if news is None:
            return False
        self._write(*news, known.grid, grid, placed, pause)
        return True

    def _write(self, new: BoneMap, box: Box, cubes: VoxelGrid, grid: VoxelGrid, placed: BoneOnGrid, pause: Callable[[], object]) -> None:
        low, high = (np.array([getattr(side, end) for side in box[::-1]]) for end in ("start", "stop"))
        ends = np.stack(np.meshgrid(*zip(low - 0.5, high - 0.5, strict=True), indexing="ij"), axis=-1).reshape(-1, 3)
        to_grid = grid.reference_to_ijk @ cubes.ijk_to_reference
        corners = ends @ to_grid[:3, :3].T + to_grid[:3, 3]
        first = np.maximum(np.ceil(corners.min(axis=0)).astype(int), 0)
        stop = np.minimum(np.floor(corners.max(axis=0)).astype(int) + 1, grid.size)
        if (first >= stop).any():
            return
        to_new = new.probability.grid.reference_to_ijk @ grid.ijk_to_reference
        for k, j, i in product(*(range(int(a), int(b), BLOCK) for a, b in zip(first[::-1], stop[::-1], strict=True))):
            size = np.minimum(BLOCK, stop - (i, j, k))
            matrix = grid.ijk_to_reference.copy()
            matrix[:3, 3] += matrix[:3, :3] @ (i, j, k)
            # Where no frame has shown bone near by, there is none to write, nor was there
            if not _around((i, j, k), size, to_new, new.probability.array).any():
                continue
            pause()
            block = new.on_grid(VoxelGrid((int(size[0]), int(size[1]), int(size[2])), matrix))
            where = slice(k, k + size[2]), slice(j, j + size[1]), slice(i, i + size[0])
            placed.directions_reference[where] = block.directions_reference
            placed.probability[where] = block.probability


def _around(first: tuple[int, int, int], size: Integers, to_map: Matrix, array: Numbers) -> Numbers:
    """The part of a map's array [k, j, i] that a block of voxels (i, j, k) is interpolated from."""
    corners = first + (size - 1) * np.stack(np.meshgrid(*[(0, 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    there = corners @ to_map[:3, :3].T + to_map[:3, 3]
    low, high = np.maximum(np.floor(there.min(axis=0)).astype(int), 0), np.maximum(np.ceil(there.max(axis=0)).astype(int) + 1, 0)
    return array[low[2] : high[2], low[1] : high[1], low[0] : high[0]]
