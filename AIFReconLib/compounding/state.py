"""What is remembered of every voxel while frames come in, what that costs in memory, and the volumes that come of it."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Reals, Singles
from ..geometry.volume import Volume, VoxelGrid
from ..message import Described, in_python_words, translated
from ..settings import BONE_METHODS, is_own_method

if TYPE_CHECKING:
    from ..sweep.joined import SweepShare

MAP_BYTES = 4 + 3 * 4
"""Probability and direction of the bone map, per voxel."""

OUTPUT_BYTES = 4 + 4 + 1 + 1
"""What the results of a finished reconstruction take beside its state, at most: a float32 mean, the score of a method
without weights, the mask, and the 8-bit intensity. Everything else is handed over without a copy."""


@dataclass(eq=False)
class VoxelState:
    """Running values of one reconstruction; flat arrays over [k, j, i] in C order.

    Parameters
    ----------
    method : str
    hits : (voxels,) uint32 array
        Pixels that entered.
    value : (voxels,) array
        float32: the running average (aif), the last (latest) or the largest (maximum) value; the sum of w v (weighted).
        float64: the sum (average), so that its mean is exact; the sum of w v (a method of one's own).
    weight : (voxels,) array or None
        float32: the paper's V_count (aif), the sum of w (weighted). float64: the sum of shares (average of pixels that count unequally),
        the sum of w (a method of one's own).
    cosine : (voxels,) float32 array or None
        Best cosine of incidence so far.
    """

    method: str
    hits: NDArray[np.uint32]
    value: Reals
    weight: Reals | None
    cosine: Singles | None

    @classmethod
    def empty(cls, grid: VoxelGrid, method: str, best_cosine: bool, shares: bool = False) -> VoxelState:
        """State before the first frame. With `shares`, an average keeps the sum of what pixels count."""
        value: Reals = np.zeros(grid.voxels, dtype=np.float64 if _sums_in_double(method) else np.float32)
        if method == "maximum":
            value.fill(-np.inf)
        return cls(
            method=method,
            hits=np.zeros(grid.voxels, dtype=np.uint32),
            value=value,
            weight=_no_weights(grid.voxels, method, shares),
            cosine=np.zeros(grid.voxels, dtype=np.float32) if best_cosine else None,
        )

    @property
    def weights(self) -> Reals:
        """`weight`, for methods that keep one.

        Raises
        ------
        ValueError
            When this one does not.
        """
        if self.weight is None:
            raise ValueError(f"Input state must be one that keeps weights; method {self.method} has none here.")
        return self.weight

    def intensity(self) -> Singles:
        """The reconstructed values, (voxels,) float32; 0 where nothing was measured.

        It may be the state's own array, so no frame may follow; take a `copy` first where one will.
        """
        if self.method == "weighted" or _sums_in_double(self.method):
            divisor = self.hits if self.weight is None else self.weight
            result = np.zeros(self.value.shape, dtype=np.float32)
            np.divide(self.value, divisor, out=result, where=self.hits > 0, casting="same_kind")
            return result
        if self.method == "maximum":
            np.copyto(self.value, 0, where=self.hits == 0)
        return self.value.astype(np.float32, copy=False)

    def score(self) -> Singles:
        """How much good evidence each voxel has, (voxels,) float32: the sum of weights; methods without weights count each pixel as 1.

        May be the state's own array.
        """
        return self.hits.astype(np.float32) if self.weight is None else self.weight.astype(np.float32, copy=False)

    def copy(self) -> VoxelState:
        """A snapshot that later frames do not change."""
        return replace(self, **{name: getattr(self, name).copy() for name in self._arrays()})

    def _arrays(self) -> list[str]:
        return [spec.name for spec in fields(self) if isinstance(getattr(self, spec.name), np.ndarray)]


def _sums_in_double(method: str) -> bool:
    return method == "average" or is_own_method(method)


def _weighs_in_double(method: str, shares: bool) -> bool:
    return (shares and method == "average") or is_own_method(method)


def _no_weights(voxels: int, method: str, shares: bool) -> Reals | None:
    if method in BONE_METHODS:
        return np.zeros(voxels, dtype=np.float32)
    return np.zeros(voxels, dtype=np.float64) if _weighs_in_double(method, shares) else None


def bytes_per_voxel(method: str, has_bone: bool, best_cosine: bool, shares: bool = False) -> int:
    """Memory that a reconstruction takes, per voxel, its results included, and its bone map where it reads one; `shares` as in
    `VoxelState.empty`.

    Notes
    -----
    The bone map is released before the results are made when a whole sequence is reconstructed at once. A snapshot of a live
    reconstruction needs the results, a copy of the state and the map at the same time.
    """
    state = 4 + (8 if _sums_in_double(method) else 4) + (4 if method in BONE_METHODS else 0) + (4 if best_cosine else 0)
    state += 8 if _weighs_in_double(method, shares) else 0
    return state + max(MAP_BYTES if has_bone else 0, OUTPUT_BYTES)


@dataclass(frozen=True, eq=False, repr=False)
class Reconstruction(Described):
    """The result of a reconstruction, all volumes on one grid.

    Parameters
    ----------
    intensity : Volume of uint8 or float32
        The reconstructed ultrasound.
    score : Volume of float32
        Sum of the weights of all pixels that entered (the paper's V_count); the number of pixels for methods without weights.
    hits : Volume of uint32
        Pixels that entered.
    mask : Volume of uint8
        0 empty, 1 measured, 2 filled from a neighbor.
    cosine : Volume of float32 or None
        Best cosine of incidence, when it was asked for.
    method : str
    frames_inserted : int
    skipped : dict of str to list of int
        Numbers of the frames that were not inserted, by reason; of several sweeps numbered through.
    said : tuple of str
        What a user should know about how this result came about, with options named as on the command line; see `notes`.
    hole_limit : float, mm
        Up to which holes were filled, as given or as chosen; 0 where they were not, or in the configuration's own way.
    sweeps : tuple of SweepShare
        What each recorded sweep gave; none where frames came one by one.
    """

    intensity: Volume
    score: Volume
    hits: Volume
    mask: Volume
    cosine: Volume | None
    method: str
    frames_inserted: int
    skipped: dict[str, list[int]]
    said: tuple[str, ...] = ()
    hole_limit: float = 0.0
    sweeps: tuple[SweepShare, ...] = ()

    def _facts(self) -> list[tuple[str, str]]:
        skipped = sum(map(len, self.skipped.values()))
        return [("method", self.method), ("frames", f"{self.frames_inserted} inserted, {skipped} skipped"), *self.grid.facts()]

    @property
    def notes(self) -> tuple[str, ...]:
        """What a user should know about how this result came about, in Python's words."""
        return tuple(str(translated(note, in_python_words)) for note in self.said)

    @property
    def grid(self) -> VoxelGrid:
        """The voxels that all its volumes share."""
        return self.intensity.grid
