"""What all engines are: they put frames into a `VoxelState`, the same voxels whichever of them does it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Integers, Matrix, Numbers, Reals, Singles
from ..bone.placed.on_grid import PlacedBone
from ..imaging.gray_levels import GrayLevels
from ..machine.threads import optional_module
from ..recipe.recipe import Recipe
from .batch import FrameBatch
from .evidence import ScanLines
from .layout import PixelLayout
from .methods.method import Factors
from .methods.table import method_named
from .state import VoxelState


@dataclass(frozen=True, eq=False)
class Job:
    """What an engine works on.

    Parameters
    ----------
    grid_size : (i, j, k)
    planes : (first, stop)
        The part of the grid that state and bone are of.
    maximum : float
        Brightest value an image can hold.
    importance : (rows, columns) float32 array, 0 to 1, or None
        Weight of each pixel of an image; those of 0 do not enter.
    threads : int or None
        How many a compiled engine uses; by default every core.
    """

    state: VoxelState
    grid_size: tuple[int, int, int]
    planes: tuple[int, int]
    settings: Recipe
    maximum: float
    bone: PlacedBone | None = None
    importance: Reals | None = None
    threads: int | None = None


class Engine:
    """Puts frames into a `VoxelState`, one by one on the caller's thread; others override `insert`."""

    name = "numpy"
    frames_at_once = 1

    def __init__(self, job: Job):
        self.job, self.state = job, job.state
        self.method = method_named(job.state.method)
        self.gray_levels = gray_levels_of(job)
        given = job.settings
        self.factors = Factors(*map(np.float32, (given.alpha, given.beta, given.weight_floor, given.bone_gain, job.maximum)))
        self._judging: Any = None if given.engine == "numpy" else optional_module("AIFReconLib.compounding.compiled.numba_evidence")

    def insert(self, batch: FrameBatch, layout: PixelLayout, scan_lines: ScanLines | None) -> list[int]:
        """Put frames into the volume; how many pixels entered of each. `scan_lines` is for methods that judge shadows."""
        return [self._insert(batch, place, layout, scan_lines) for place in range(len(batch))]

    def _insert(self, batch: FrameBatch, place: int, layout: PixelLayout, scan_lines: ScanLines | None) -> int:
        raise NotImplementedError

    def _entering(self, batch: FrameBatch, place: int, layout: PixelLayout) -> tuple[Integers, Integers]:
        """Numbers of the layout's pixels that enter of a frame, and their voxels."""
        pixels, voxels = layout.voxels(batch.image_to_ijk[place], self.job.grid_size, self.job.planes)
        if place not in batch.measured:
            return pixels, voxels
        measured = layout.values(batch.measured[place])[pixels] > 0
        return pixels[measured], voxels[measured]

    def _evidence(
        self, values: Numbers, image_to_ijk: Matrix, scan_lines: ScanLines | None, bone: PlacedBone | None, room: Singles | None = None
    ) -> Singles:
        """What the layout's pixels of a frame tell of shadows: reach and onset, (2, n) at least; `bone` has a word if there is any.

        `room` is where they are written, by default new memory.
        """
        if scan_lines is None:
            raise ValueError(f"Input scan_lines must be given for method {self.method.name}; got None.")
        room = np.empty((2, values.size), np.float32) if room is None else room
        probability = None if bone is None else bone.map_probability
        image_to_map = np.eye(4) if bone is None else bone.ijk_to_map @ image_to_ijk
        if self._judging is None:
            expected = None if probability is None else scan_lines.expected(probability, image_to_map)
            room[0], room[1] = scan_lines.evidence(values, self.gray_levels, expected)
        else:
            self._judging.judge_frame(scan_lines, self.gray_levels, values, (probability, image_to_map), (room[0], room[1]))
        return room


def gray_levels_of(job: Job) -> GrayLevels:
    """The gray levels that shadows are judged by: those of the settings, else the images' own."""
    given = job.settings.gray_levels
    brightest = min(job.maximum, float(np.finfo(np.float32).max))
    return GrayLevels.as_recorded(brightest) if given is None else GrayLevels(given)
