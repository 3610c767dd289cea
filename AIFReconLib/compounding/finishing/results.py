"""The volumes of a reconstruction on their way out: part by part they take the values of voxels, and in the end holes are filled."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ...arrays import Bytes, Mask, Matrix, Numbers, NumberType
from ...geometry.volume import Volume, VoxelGrid
from ...holes.automatic import with_limit
from ...holes.fill import asks_for_hits, copies_values, fill_as_asked
from ...holes.filling import HoleFilling
from ...progress import Progress
from ...recipe.recipe import Recipe
from ..state import BESIDE, VoxelState
from .parts import Planes
from .values import finish_values


class Results:
    """Volumes on the whole grid, filled by parts of it.

    Parameters
    ----------
    output_type : "uint8", "float32" or None
        Of the intensity; None before any image is known.
    beside : names of `BESIDE`
        Which volumes are wanted beside intensity and mask, and the cosine where the states have it.
    configured : tuple of HoleFilling
        As in `fill_as_asked`.
    """

    def __init__(
        self,
        grid: VoxelGrid,
        settings: Recipe,
        output_type: str | None,
        beside: Collection[str],
        configured: tuple[HoleFilling, ...] = (),
        threads: int | None = None,
    ):
        self.grid, self._settings, self._configured, self._threads = grid, settings, configured, threads
        self._type: NumberType = np.dtype(output_type or "float32")
        # What is made of several values must be made of values that are not rounded yet
        self._first_type: NumberType = self._type if copies_values(settings, configured) else np.dtype(np.float32)
        self._wanted = set(beside) | ({"score"} if asks_for_hits(settings, configured) else set())
        self._beside = frozenset(beside)
        self._mask: Bytes = np.zeros(grid.shape, np.uint8)
        self._made: dict[str, Numbers] = {"mask": self._mask}

    def put(self, state: VoxelState, planes: Planes, release: bool = False) -> None:
        """Take the values of some planes, (first, stop), of which the state is.

        With `release` no frame follows: the state hands over what it can and forgets what it held, which saves the memory of both.
        """
        first, stop = planes
        whole = release and stop - first == self.grid.size[2]
        if whole and state.value.dtype == self._first_type == np.float32 and not state.start:
            self._made["intensity"] = state.value.reshape(self.grid.shape)
        intensity = self._room("intensity", self._first_type)[first:stop]
        mask = self._mask[first:stop]
        finish_values(state, intensity.reshape(-1), mask.reshape(-1), self._threads)
        if release:
            state.value = np.empty(0, state.value.dtype)
        if "hits" in self._wanted:
            self._take("hits", state.hits, planes, whole)
        if "score" in self._wanted:
            score = state.hits if state.weight is None else state.weight
            self._take("score", score.astype(np.float32, copy=False), planes, whole and score.dtype == np.float32)
        if state.cosine is not None:
            self._take("cosine", state.cosine, planes, whole)

    def _take(self, name: str, values: Numbers, planes: Planes, own: bool) -> None:
        """Values (voxels,) of some planes; `own`: all of them, and nobody else's."""
        if own:
            self._made[name] = values.reshape(self.grid.shape)
            return
        room = self._room(name, values.dtype)[planes[0] : planes[1]].reshape(-1)
        # What was not visited is not written
        np.copyto(room, values, where=values != 0)

    def _room(self, name: str, dtype: NumberType) -> Numbers:
        if name not in self._made:
            self._made[name] = np.zeros(self.grid.shape, dtype)
        return self._made[name]

    def fill(self, poses: Matrix, shown: Mask, progress: Progress | None = None) -> tuple[float, tuple[str, ...]]:
        """Fill the holes and round where that has to come after; returns the limit (mm) and what a user should know of it.

        Parameters
        ----------
        poses, shown
            As in `automatic_limit`.
        """
        settings, messages = with_limit(self._settings, self._configured, poses, shown, self.grid)
        values = self._room("intensity", self._first_type)
        threads, score = self._threads, self._made.get("score")
        fill_as_asked(values, self._mask, self.grid.spacing, settings, self._configured, progress, threads=threads, score=score)
        if self._type != self._first_type:
            self._made["intensity"] = rounded(values, self._type)
        return float(settings.hole_limit), messages

    def volume(self, name: str) -> Volume | None:
        """Intensity, mask, score, hits or cosine as they are so far, `fill` ends them; None for what nobody asked for."""
        array = None if name in BESIDE and name not in self._beside else self._made.get(name)
        return None if array is None else Volume(array, self.grid.ijk_to_reference)


def rounded(values: Numbers, dtype: NumberType) -> Numbers:
    """Values [k, j, i] as gray levels of 8 bits, halves up, plane by plane."""
    result: Numbers = np.zeros(values.shape, dtype)
    for plane, gray in zip(values, result, strict=True):
        if plane.any():
            gray[:] = np.floor(np.clip(plane, 0.0, 255.0) + np.float32(0.5))
    return result


def bytes_of_results(settings: Recipe, configured: tuple[HoleFilling, ...], output_type: str, beside: Collection[str]) -> int:
    """What `Results` take per voxel."""
    output = np.dtype(output_type).itemsize
    # Rounded to another array where that has to wait for the holes
    intensity = output if copies_values(settings, configured) or output > 1 else 4 + output
    wanted = set(beside) | ({"score"} if asks_for_hits(settings, configured) else set())
    return intensity + 1 + 4 * len(wanted) + (4 if settings.best_cosine else 0)
