"""What is remembered of every voxel while frames come in, what that costs in memory, and the volumes that come of it."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Numbers, Reals, Singles
from ..geometry.volume import Volume, VoxelGrid
from ..message import Described, advised
from .methods.table import method_named

if TYPE_CHECKING:
    from ..sweep.multi_sweep import SweepShare

MAP_BYTES = 4 + 3 * 4
"""Probability and direction of the bone map, per voxel."""

BESIDE = ("score", "hits")
"""Volumes that are made beside the intensity and the mask, unless others are asked for."""

MOST_IN_SINGLE, MOST_IN_WHOLE = 2.0**16, 2.0**24
"""Pixels of a voxel whose weights and values add up in float32, where the mean is then off by a third of a gray level at worst; and whose
gray levels of 8 bits add up in 32."""

AT_ONCE = 2**20
"""Voxels that are looked through at a time: little memory beside them."""

NO_HITS: NDArray[np.uint32] = np.empty(0, np.uint32)


@dataclass(eq=False)
class VoxelState:
    """Running values of one reconstruction, or of a part of it; flat arrays over [k, j, i] in C order.

    Nothing is written where no pixel enters: the system gives memory to what was visited alone.

    Parameters
    ----------
    hits : (voxels,) uint32 array
        Pixels that entered; none where they are not counted.
    value : (voxels,) array
        uint32: the sum (average of 8-bit images).
        uint8: the last (latest) or the largest (maximum) value of 8-bit images; float32: of others, and the running average (aif), the sum
        of w v (weighted).
        float64: the sum (average), so that its mean is exact; the sum of w v (a method of one's own, and weighted after `widen`).
    weight : (voxels,) array or None
        float32: the paper's V_count (aif), the sum of w (weighted). float64: the sum of shares (average of pixels that count unequally),
        the sum of w where that of w v is float64.
    cosine : (voxels,) float32 array or None
        Best cosine of incidence so far.
    start : float
        The value before the first pixel.
    """

    method: str
    hits: NDArray[np.uint32]
    value: Numbers
    weight: Reals | None
    cosine: Singles | None
    start: float = 0.0

    @classmethod
    def empty(
        cls, voxels: int, method: str, best_cosine: bool, shares: bool = False, whole: bool = False, counted: bool = True
    ) -> VoxelState:
        """State before the first frame.

        Parameters
        ----------
        shares : bool
            An average keeps the sum of what pixels count.
        whole : bool
            Pixels are of 8 bits, and enter one voxel each.
        counted : bool
            Whether somebody asks how many entered a voxel; where weights say that any did, hits are kept for nothing else.
        """
        kinds = method_named(method).kept(whole, shares)
        value: Numbers = np.zeros(voxels, kinds.value)
        if kinds.start:
            value.fill(kinds.start)
        return cls(
            method=method,
            hits=np.zeros(voxels, dtype=np.uint32) if counted else NO_HITS,
            value=value,
            weight=None if kinds.weight is None else np.zeros(voxels, kinds.weight),
            cosine=np.zeros(voxels, dtype=np.float32) if best_cosine else None,
            start=kinds.start,
        )

    @property
    def nbytes(self) -> int:
        """Memory that it takes."""
        return sum(array.nbytes for array in (self.value, self.hits, self.weight, self.cosine) if array is not None)

    @property
    def met(self) -> NDArray[np.unsignedinteger]:
        """(voxels,), 0 where no pixel entered and nowhere else: hits, or the bits of weights, which are above 0 then."""
        return self.hits if self.hits.size or self.weight is None else self.weight.view(f"u{self.weight.itemsize}")

    @property
    def weights(self) -> Reals:
        """`weight`, for methods that keep one; a ValueError when this one does not."""
        if self.weight is None:
            raise ValueError(f"Input state must be one that keeps weights; method {self.method} has none here.")
        return self.weight

    @property
    def room(self) -> float:
        """How many pixels of one voxel its sums have room for."""
        if self.value.dtype == np.uint32:
            return MOST_IN_WHOLE
        return MOST_IN_SINGLE if method_named(self.method).widens and self.value.dtype == np.float32 else math.inf

    def widen(self) -> None:
        """Go on in float64: sums would run over, or stop growing, where a probe rests. Memory that is empty stays so."""
        self.value = _copied(self.value)
        self.weight = None if self.weight is None else _copied(self.weight)


def _copied(values: Numbers) -> Reals:
    """The values in float64; where they are 0 nothing is written."""
    copy = np.zeros(values.size)
    for start in range(0, values.size, AT_ONCE):
        some = values[start : start + AT_ONCE]
        np.copyto(copy[start : start + AT_ONCE], some, where=some != 0)
    return copy


def counts_hits(method: str, beside: Collection[str]) -> bool:
    """Whether a method's state counts pixels, for one who wants these volumes beside the intensity."""
    return not method_named(method).always_weighs or "hits" in beside


def part_bytes(
    method: str, map_on_grid: bool, best_cosine: bool, shares: bool = False, whole: bool = False, beside: Collection[str] = BESIDE
) -> int:
    """Bytes per voxel of a part that is worked: its state, and a bone map on its voxels. Arguments as in `bytes_per_voxel`."""
    one = VoxelState.empty(1, method, best_cosine, shares, whole, counts_hits(method, beside))
    return one.nbytes + (MAP_BYTES if map_on_grid else 0)


def bytes_per_voxel(
    method: str,
    map_on_grid: bool,
    best_cosine: bool,
    shares: bool = False,
    whole: bool = False,
    beside: Collection[str] = BESIDE,
    output: int = 4,
) -> int:
    """Memory that a reconstruction takes at its peak, per voxel, its results included, and its bone map where that lies on the grid.

    `beside` are the results that are wanted, `output` the bytes of an intensity; the others are those of `VoxelState.empty`.

    Notes
    -----
    The bone map is released before the results are made when a whole sequence is reconstructed at once. A snapshot of a live
    reconstruction has results, state and map at the same time, and copies of those results that are the state's own.
    """
    one = VoxelState.empty(1, method, best_cosine, shares, whole, counts_hits(method, beside))
    results = output + 1
    # A weight of 4 bytes is handed over as the score
    score = 4 if "score" in beside and (one.weight is None or one.weight.nbytes != 4) else 0
    part = one.nbytes + (MAP_BYTES if map_on_grid else 0)
    return max(part, one.nbytes + results, one.nbytes - one.value.nbytes + results + score)


@dataclass(frozen=True, eq=False, repr=False)
class Reconstruction(Described):
    """The result of a reconstruction, all volumes on one grid.

    Parameters
    ----------
    intensity : Volume of uint8 or float32
        The reconstructed ultrasound.
    score : Volume of float32, or None
        Sum of the weights of all pixels that entered (the paper's V_count); the number of pixels for methods without weights.
    hits : Volume of uint32, or None
        Pixels that entered. It and the score are left out where only others were asked for.
    mask : Volume of uint8
        0 empty, 1 measured, 2 filled from a neighbor.
    cosine : Volume of float32 or None
        Best cosine of incidence, when it was asked for.
    skipped : dict of str to list of int
        Numbers of the frames that were not inserted, by reason; of several sweeps numbered through.
    messages : tuple of str
        What a user should know about how this result came about, with options named as on the command line; see `notes`.
    hole_limit : float, mm
        Up to which holes were filled, as given or as chosen; 0 where they were not, or in the configuration's own way.
    sweeps : tuple of SweepShare
        What each recorded sweep gave; none where frames came one by one.
    bone : mapping
        Settings by which the bone map was made, by name; nothing where none was read.
    unused : frozenset of str
        Settings that were of no concern to it.
    """

    intensity: Volume
    score: Volume | None
    hits: Volume | None
    mask: Volume
    cosine: Volume | None
    method: str
    frames_inserted: int
    skipped: dict[str, list[int]]
    messages: tuple[str, ...] = ()
    hole_limit: float = 0.0
    sweeps: tuple[SweepShare, ...] = ()
    bone: Mapping[str, object] = field(default_factory=dict)
    unused: frozenset[str] = frozenset()

    def _facts(self) -> list[tuple[str, str]]:
        skipped = sum(map(len, self.skipped.values()))
        return [("method", self.method), ("frames", f"{self.frames_inserted} inserted, {skipped} skipped"), *self.grid.facts()]

    @property
    def notes(self) -> tuple[str, ...]:
        """What a user should know about how this result came about, in Python's words."""
        return tuple(map(advised, self.messages))

    @property
    def grid(self) -> VoxelGrid:
        """The voxels that all its volumes share."""
        return self.intensity.grid
