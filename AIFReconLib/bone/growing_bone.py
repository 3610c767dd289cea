"""A bone map that is empty when a scan begins and grows while it goes on."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from ..arrays import Integers
from ..geometry.transforms import CLOSEST
from ..geometry.volume import Volume, VoxelGrid
from ..progress import Progress, Steps
from .echoes.found import LEAST_DARK, SweepEchoes
from .echoes.surface import EchoSurface
from .map import BoneMap
from .placed.on_grid import BoneOnGrid


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
    _learned: Integers = field(default_factory=lambda: np.zeros(3, np.int64))
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
        self._learned[:] += 1, len(echoes), len(echoes) if echoes.dark is None else echoes.dark.sum()
        self._surface.add(echoes)

    @property
    def _is_enough(self) -> bool:
        frames, echoes, dark = self._learned
        # Where nothing is asked of echoes, a network has told them
        shows_bone = not self.least_a_frame or dark >= LEAST_DARK * echoes
        return bool(shows_bone and echoes >= max(self.least_a_frame * frames, 1))

    def begin_anew(self, echoes: SweepEchoes) -> None:
        """Forget what frames showed and know these echoes instead: the patient moved, and frames lie elsewhere now."""
        object.__setattr__(self, "_surface", EchoSurface())
        self._surface.add(echoes)
        self._told.clear()

    @property
    def has_told(self) -> bool:
        """Whether the reconstructor was told all that was known when `spread` was asked last; nothing is told where too little is known."""
        return not self._is_enough or self._told == [placed for _, placed in self._on_grid]

    def so_far(self) -> Steps[BoneMap | None]:
        """The map as it is now, where enough is known; another thread may `learn` and a third may `spread` meanwhile."""
        return (yield from self._surface.whole()) if self._is_enough else None

    def spread(self) -> Steps[bool]:
        """Bring what was learned since the last time to the voxels of the reconstructor; whether there was anything.

        In steps of some 15 ms. For one thread alone; another may `learn` meanwhile.
        """
        has_news = self._surface.take_in()
        if not self._on_grid or not self._is_enough:
            return False
        grid, placed = self._on_grid[0]
        begins = self._told != [placed]
        if begins:
            # A volume that begins anew is told all
            self._surface.renew()
        elif not has_news:
            return False
        low, high = (end(grid.corners(), axis=0) for end in (np.min, np.max))
        news = yield from self._surface.news(within=(low, high))
        if news is not None:
            yield from _write(news, grid, placed)
        if begins:
            self._told[:] = [placed]
        return news is not None


def _write(new: BoneMap, grid: VoxelGrid, placed: BoneOnGrid) -> Steps[None]:
    """Bring a part of the map to the voxels that lie in it."""
    found = new.at_voxels(grid)
    near, last = found.coordinates, np.array(new.probability.shape)[:, None] - 1
    j, i = (numbers.ravel() for numbers in np.mgrid[slice(*near.rows), slice(*near.columns)])
    for k in range(*near.planes):
        yield k / grid.shape[0], "Telling the volume of bone"
        there = near.of_voxels(np.full_like(j, k), j, i)
        held = np.all((there > -CLOSEST) & (there < last + CLOSEST), axis=0)
        voxels = np.ravel_multi_index((np.full(held.sum(), k), j[held], i[held]), grid.shape)
        probability, directions = found.at(voxels, everywhere=True)
        placed.directions_reference.reshape(-1, 3)[voxels] = directions
        placed.probability.reshape(-1)[voxels] = probability
