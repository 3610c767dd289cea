"""A bone map that is empty when a scan begins and grows while it goes on."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product
from typing import ClassVar

import numpy as np

from ..arrays import Integers, Matrix, Numbers
from ..geometry.box import corners_of
from ..geometry.transforms import CLOSEST, transform_points
from ..geometry.volume import Volume, VoxelGrid
from ..progress import Progress, part, report
from .echoes.found import SweepEchoes
from .echoes.surface import EchoSurface
from .map import BoneMap
from .placed.on_grid import BoneOnGrid

BLOCK = 48
"""Voxels along each edge of what is brought up to date in one go, where there is any bone; some 15 ms."""


@dataclass(frozen=True, eq=False, repr=False)
class GrowingBone(BoneMap):
    """Bone of which nothing is known at first, and then the surface that the echoes so far lie on.

    A reconstructor reads it on its own grid (`on_grid`), where `learn` and `spread` bring what frames say meanwhile. One that inserts at
    the same time sees some voxels as they were and others as they are: each is written as a whole, so its frame is weighted by what is
    known so far, and nothing waits.
    """

    grows: ClassVar[bool] = True
    probability: Volume = field(default_factory=lambda: Volume(np.zeros((1, 1, 1), np.float32), np.eye(4)))
    least_a_frame: float = 0.0  #: Echoes in a frame on the mean below which nothing is told of them
    _surface: EchoSurface = field(default_factory=EchoSurface)
    _learned: Integers = field(default_factory=lambda: np.zeros(2, np.int64))
    _on_grid: list[tuple[VoxelGrid, BoneOnGrid]] = field(default_factory=list)
    _told: list[BoneOnGrid] = field(default_factory=list)

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

    def learn(self, echoes: SweepEchoes) -> None:
        """Take what a frame shows."""
        self._learned[:] += 1, len(echoes)
        self._surface.add(echoes)

    def spread(self, progress: Progress | None = None) -> bool:
        """Bring what was learned since the last time to the voxels of the reconstructor; whether there was anything.

        `progress` hears of steps of some 15 ms. For one thread alone; another may `learn` meanwhile.
        """
        has_news, (frames, echoes) = self._surface.take_in(), self._learned
        if not self._on_grid or echoes < max(self.least_a_frame * frames, 1):
            return False
        grid, placed = self._on_grid[0]
        if self._told != [placed]:
            # A volume that begins anew is told all
            self._surface.renew()
            self._told[:] = [placed]
        elif not has_news:
            return False
        self._write(self._surface.news(part(progress, 0.0, 0.5)), grid, placed, part(progress, 0.5, 1.0))
        return True

    def _write(self, new: BoneMap, grid: VoxelGrid, placed: BoneOnGrid, progress: Progress | None) -> None:
        """Bring a part of the map to the voxels that lie in it."""
        last = np.array(new.probability.grid.size) - 1
        corners = transform_points(
            grid.reference_to_ijk @ new.probability.ijk_to_reference, corners_of(np.stack([np.zeros(3), last], axis=1))
        )
        first = np.maximum(np.ceil(corners.min(axis=0) - CLOSEST).astype(int), 0)
        stop = np.minimum(np.floor(corners.max(axis=0) + CLOSEST).astype(int) + 1, grid.size)
        to_new = new.probability.grid.reference_to_ijk @ grid.ijk_to_reference
        for k, j, i in product(*(range(int(a), int(b), BLOCK) for a, b in zip(first[::-1], stop[::-1], strict=True))):
            size = np.minimum(BLOCK, stop - (i, j, k))
            where = slice(k, k + size[2]), slice(j, j + size[1]), slice(i, i + size[0])
            # Where no frame has shown bone near by, there is none to write, nor was there
            if not (_around((i, j, k), size, to_new, new.probability.array).any() or placed.probability[where].any()):
                continue
            report(progress, 0.0, "Telling the volume of bone")
            block = new.on_grid(Volume(placed.probability, grid.ijk_to_reference)[where].grid)
            at = np.stack(np.meshgrid(*(np.arange(s.start, s.stop) for s in where), indexing="ij")[::-1], axis=-1)
            there = transform_points(to_new, at)
            held = np.all((there >= -CLOSEST) & (there <= last + CLOSEST), axis=-1)
            placed.directions_reference[where][held] = block.directions_reference[held]
            placed.probability[where][held] = block.probability[held]


def _around(first: tuple[int, int, int], size: Integers, to_map: Matrix, array: Numbers) -> Numbers:
    """The part of a map's array [k, j, i] that a block of voxels (i, j, k) is interpolated from."""
    corners = transform_points(to_map, corners_of(np.stack([first, first + size - 1], axis=1)))
    low, high = np.maximum(np.floor(corners.min(axis=0)).astype(int), 0), np.maximum(np.ceil(corners.max(axis=0)).astype(int) + 1, 0)
    return array[low[2] : high[2], low[1] : high[1], low[0] : high[0]]
