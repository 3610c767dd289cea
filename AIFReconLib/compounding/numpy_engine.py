"""The distribution step in numpy: always there, and the same voxels as the plain loop over pixels."""

from __future__ import annotations

import numpy as np

from ..arrays import Integers, Matrix, Singles
from ..bone.placed.on_grid import PlacedBone, everywhere
from ..recipe.recipe import Recipe
from .batch import FrameBatch
from .evidence import ScanLines
from .layout import PixelLayout
from .methods.method import Factors, Pixels
from .methods.table import METHODS, built_in
from .state import HIT, VoxelState

NOTHING: Singles = np.empty(0, np.float32)


class NumpyEngine:
    """Puts frames into a `VoxelState`.

    Parameters
    ----------
    state : VoxelState
    grid_size : (i, j, k)
    settings : Recipe
    maximum : float
        Brightest value an image can hold.
    bone : PlacedBone or None
    threads : None
        For the sake of the other engine: this one works on the caller's thread.
    planes : (first, stop) or None
        The part of the grid that the state is of; by default all of it.
    """

    name = "numpy"
    methods = METHODS
    frames_at_once = 1

    def __init__(
        self,
        state: VoxelState,
        grid_size: tuple[int, int, int],
        settings: Recipe,
        maximum: float,
        bone: PlacedBone | None,
        threads: int | None = None,
        planes: tuple[int, int] | None = None,
    ):
        self.state = state
        self._grid_size, self._planes = grid_size, planes
        self._method = built_in(state.method)
        self._factors = Factors(
            *map(np.float32, (settings.alpha, settings.beta, settings.weight_floor, settings.bone_gain, maximum)),
        )
        self._bone = bone
        self._probability, self._directions = everywhere(bone)

    def insert(self, batch: FrameBatch, layout: PixelLayout, scan_lines: ScanLines | None) -> list[int]:
        """Put frames into the volume.

        Parameters
        ----------
        batch : FrameBatch
        layout : PixelLayout
        scan_lines : ScanLines or None
            Needed by `weighted` alone.

        Returns
        -------
        pixels : list of int
            How many entered of each frame.
        """
        return [self._insert(batch, place, layout, scan_lines) for place in range(len(batch))]

    def _insert(self, batch: FrameBatch, place: int, layout: PixelLayout, scan_lines: ScanLines | None) -> int:
        pixels, voxels = layout.voxels(batch.image_to_ijk[place], self._grid_size, self._planes)
        all_values = layout.values(batch.images[place])
        if place in batch.measured:
            measured = layout.values(batch.measured[place])[pixels] > 0
            pixels, voxels = pixels[measured], voxels[measured]
        entered = pixels.size
        if not entered:
            return 0
        # A view is enough where all enter
        chosen = slice(None) if entered == all_values.size else pixels
        values, beams = all_values[chosen], layout.beams(chosen, batch.axes[place])
        state = self.state
        if state.cosine is not None:
            np.maximum.at(state.cosine, voxels, beams.cosine(self._directions[voxels]))
        if state.packed:
            np.add.at(state.value, voxels, values.astype(np.uint32) + np.uint32(HIT))
            return entered
        if state.hits.size:
            np.add.at(state.hits, voxels, np.uint32(1))
        reach, onset = self._shadows(all_values, chosen, scan_lines, batch.image_to_ijk[place])
        bone_at = None if self._bone is None else self._bone.at
        entering = Pixels(values, voxels, self._factors, beams, self._probability, self._directions, bone_at, reach, onset)
        self._method.insert(state, entering)
        return entered

    def _shadows(
        self, all_values: Singles, chosen: Integers | slice, scan_lines: ScanLines | None, image_to_ijk: Matrix
    ) -> tuple[Singles, Singles]:
        """Reach and onset of the chosen pixels of a frame, (m,), for methods that judge shadows."""
        if not self._method.needs_shadows:
            return NOTHING, NOTHING
        if scan_lines is None or self._bone is None:
            raise ValueError(f"Input scan_lines and bone must be given for method {self._method.name}; got None.")
        expected = scan_lines.expected(self._bone.map_probability, self._bone.ijk_to_map @ image_to_ijk)
        evidence = scan_lines.evidence(all_values, float(self._factors.maximum), expected)
        return evidence.reach[chosen], evidence.onset[chosen]
