"""The distribution step in numpy: always there, and the same voxels as the plain loop over pixels."""

from __future__ import annotations

import numpy as np

from ..arrays import Singles
from ..bone.placed.on_grid import everywhere
from .batch import FrameBatch
from .engine import Engine, Job
from .evidence import ScanLines
from .layout import PixelLayout
from .methods.method import BuiltInMethod, Pixels
from .methods.table import METHODS

NOTHING: Singles = np.empty(0, np.float32)


class NumpyEngine(Engine):
    """Puts frames into a `VoxelState` by the numpy rule of a method of the library."""

    methods: tuple[str, ...] = METHODS

    def __init__(self, job: Job):
        super().__init__(job)
        if not isinstance(self.method, BuiltInMethod):
            raise ValueError(f"Input state must be of a method of the library; got {self.method.name}.")
        self._rule = self.method.insert
        self._probability, self._directions = everywhere(job.bone)

    def _insert(self, batch: FrameBatch, place: int, layout: PixelLayout, scan_lines: ScanLines | None) -> int:
        pixels, voxels = self._entering(batch, place, layout)
        if not pixels.size:
            return 0
        all_pixels = layout.pixels(batch.images[place])
        all_values = all_pixels.astype(np.float32)
        # A view is enough where all enter
        chosen = slice(None) if pixels.size == all_values.size else pixels
        values, beams = all_values[chosen], layout.beams(chosen, batch.axes[place])
        state, bone = self.state, self.job.bone
        if state.cosine is not None:
            np.maximum.at(state.cosine, voxels, beams.cosine(self._directions[voxels]))
        if state.hits.size:
            np.add.at(state.hits, voxels, np.uint32(1))
        reach = onset = NOTHING
        if self.method.needs_shadows:
            reach, onset = self._evidence(all_pixels, batch.image_to_ijk[place], scan_lines, bone)[:, chosen]
        bone_at = None if bone is None else bone.at
        self._rule(state, Pixels(values, voxels, self.factors, beams, self._probability, self._directions, bone_at, reach, onset))
        return int(pixels.size)
