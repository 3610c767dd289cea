"""The distribution step in numpy: always there, and the same voxels as the plain loop over pixels.

The paper's running average depends on the order in which pixels meet a voxel. So the pixels of a frame are sorted by voxel, in
row-major order within each, and then one pixel of every voxel is taken at a time: as many vector operations as the fullest voxel
has pixels, instead of as many scalar ones as the image has.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Integers, Singles
from ..bone.placed.on_grid import PlacedBone, everywhere
from ..settings import ReconstructionSettings
from . import rules
from .batch import FrameBatch
from .evidence import ScanLines
from .layout import PixelLayout
from .state import HIT, VoxelState

NOTHING: Singles = np.empty(0, np.float32)

LONG_RUN = 64
"""Pixels in the order of their voxels, on average, from which on the sort that merges such runs is the faster one."""


@dataclass(frozen=True, eq=False)
class VoxelGroups:
    """Pixels of a frame grouped by the voxel they fall into.

    Parameters
    ----------
    order : (m,) int64 array
        Positions in the frame's pixel list, voxel by voxel, rising within each.
    voxels : (g,) int64 array
        The voxels, fullest first.
    starts, counts : (g,) int64 arrays
        Where each voxel's pixels begin in `order`, and how many there are.
    """

    order: Integers
    voxels: Integers
    starts: Integers
    counts: Integers

    @classmethod
    def of(cls, voxels_of_pixels: Integers) -> VoxelGroups:
        """Group the pixels of `voxels_of_pixels` (m,) int64."""
        bits = max(int(voxels_of_pixels.size - 1).bit_length(), 1)
        keys = (voxels_of_pixels << bits) | np.arange(voxels_of_pixels.size)
        # Where rows run along the grid, hardly a pixel is out of order: merging what is in order is then the fastest way to sort
        falls = np.count_nonzero(voxels_of_pixels[1:] < voxels_of_pixels[:-1])
        keys.sort(kind="stable" if falls * LONG_RUN < keys.size else "quicksort")
        order = keys & ((1 << bits) - 1)
        keys >>= bits
        starts = np.concatenate([[0], np.flatnonzero(keys[1:] != keys[:-1]) + 1])
        counts = np.diff(starts, append=keys.size)
        most = counts.max()
        # Small numbers are sorted by their digits, which is faster
        fullest_first = np.argsort((most - counts).astype(np.min_scalar_type(most)), kind="stable")
        return cls(order, keys[starts][fullest_first], starts[fullest_first], counts[fullest_first])

    def rounds(self) -> Iterator[tuple[int, Integers]]:
        """Yield (n, positions) per round: the first n voxels take the pixels at `positions`."""
        for turn in range(int(self.counts[0])):
            active = int(np.searchsorted(-self.counts, -turn, side="left"))
            yield active, self.order[self.starts[:active] + turn]


class FrameBeams(NamedTuple):
    """The beams through pixels of a frame: their components along its axes, (m,), and these axes, (3,) in Reference."""

    x: Singles
    y: Singles
    x_axis: Singles
    y_axis: Singles

    @classmethod
    def of(cls, layout: PixelLayout, pixels: Integers | slice, axes: Singles) -> FrameBeams:
        """Those through `pixels` of a layout; none where it has no beams."""
        if layout.beam_x is None or layout.beam_y is None:
            return cls(NOTHING, NOTHING, axes[:3], axes[3:])
        return cls(layout.beam_x[pixels], layout.beam_y[pixels], axes[:3], axes[3:])

    def of_pixels(self, pixels: Integers) -> FrameBeams:
        """Some of them."""
        return FrameBeams(self.x[pixels], self.y[pixels], self.x_axis, self.y_axis)


def cosine_of(directions: Singles, beams: FrameBeams) -> Singles:
    """Cosine of incidence of pixels in voxels with these `directions` (m, 3) of bone, (m,)."""
    x, y, z = directions.T
    return rules.cosine_of_incidence(beams.x, beams.y, rules.facing(x, y, z, beams.x_axis), rules.facing(x, y, z, beams.y_axis))


class NumpyEngine:
    """Puts frames into a `VoxelState`.

    Parameters
    ----------
    state : VoxelState
    grid_size : (i, j, k)
    settings : ReconstructionSettings
    maximum : float
        Brightest value an image can hold.
    bone : PlacedBone or None
    threads : None
        For the sake of the other engine: this one works on the caller's thread.
    planes : (first, stop) or None
        The part of the grid that the state is of; by default all of it.
    """

    name = "numpy"
    frames_at_once = 1

    def __init__(
        self,
        state: VoxelState,
        grid_size: tuple[int, int, int],
        settings: ReconstructionSettings,
        maximum: float,
        bone: PlacedBone | None,
        threads: int | None = None,
        planes: tuple[int, int] | None = None,
    ):
        self.state = state
        self._grid_size, self._planes = grid_size, planes
        self._maximum = np.float32(maximum)
        self._alpha, self._beta = np.float32(settings.alpha), np.float32(settings.beta)
        self._floor, self._gain = np.float32(settings.weight_floor), np.float32(settings.bone_gain)
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
        values, beams = all_values[chosen], FrameBeams.of(layout, chosen, batch.axes[place])
        state, method = self.state, self.state.method
        if state.cosine is not None:
            np.maximum.at(state.cosine, voxels, cosine_of(self._directions[voxels], beams))
        if state.packed:
            np.add.at(state.value, voxels, values.astype(np.uint32) + np.uint32(HIT))
            return entered
        if state.hits.size:
            np.add.at(state.hits, voxels, np.uint32(1))
        if method in ("aif", "aif-compensated"):
            self._insert_aif(values, voxels, beams)
        elif method == "weighted":
            if scan_lines is None or self._bone is None:
                raise ValueError("Input scan_lines and bone must be given for method weighted; got None.")
            expected = scan_lines.expected(self._bone.map_probability, self._bone.ijk_to_map @ batch.image_to_ijk[place])
            evidence = scan_lines.evidence(all_values, float(self._maximum), expected)
            self._insert_weighted(values, voxels, beams, evidence.reach[chosen], evidence.onset[chosen], self._bone)
        elif method == "average":
            np.add.at(state.value, voxels, values.astype(np.float64))
        elif method == "latest":
            state.value[voxels] = values
        else:
            np.maximum.at(state.value, voxels, values.astype(state.value.dtype, copy=False))
        return entered

    def _insert_weighted(
        self, values: Singles, voxels: Integers, beams: FrameBeams, reach: Singles, onset: Singles, bone: PlacedBone
    ) -> None:
        """The weighted sum. Where no shadow begins, as nearly everywhere, its gate is closed: the bone map is not looked at."""
        weight, value = self._floor * reach, np.minimum(values, self._maximum)
        begins = np.flatnonzero(onset > 0)
        probability, directions = bone.at(voxels[begins])
        gate = rules.weighted_gate(onset[begins], probability)
        cosine = cosine_of(directions, beams.of_pixels(begins))
        weight[begins] = rules.weighted_weight(gate, reach[begins], self._floor)
        value[begins] = rules.weighted_value(values[begins], gate, cosine, self._gain, self._beta, self._maximum)
        value *= weight
        np.add.at(self.state.value, voxels, value)
        np.add.at(self.state.weights, voxels, weight)

    def _insert_aif(self, values: Singles, voxels: Integers, beams: FrameBeams) -> None:
        """The paper's rule. The bone map is read once per voxel, not once per pixel."""
        state = self.state
        bone = np.flatnonzero(self._probability[voxels] != 0)
        limited: Singles = np.minimum(values, self._maximum)
        if not bone.size:
            state.value[voxels] = limited
            return
        groups = VoxelGroups.of(voxels[bone])
        at = groups.voxels
        value, count = state.value[at].astype(np.float32, copy=False), state.weights[at].astype(np.float32, copy=False)
        # Where no bone is expected the weight stays 0, and the rule comes down to the last pixel; elsewhere this is overwritten below
        state.value[voxels] = limited
        x, y, z = self._directions[at].T
        facing_x, facing_y = rules.facing(x, y, z, beams.x_axis), rules.facing(x, y, z, beams.y_axis)
        probability = self._probability[at]
        compensated = state.method == "aif-compensated"
        for active, positions in groups.rounds():
            now, taken = slice(0, active), bone[positions]
            cosine = rules.cosine_of_incidence(beams.x[taken], beams.y[taken], facing_x[now], facing_y[now])
            weight = rules.paper_angle_weight(cosine, self._beta, compensated) * probability[now]
            new = rules.paper_value(values[taken], weight, self._alpha, self._maximum)
            value[now] = rules.paper_update(value[now], count[now], new)
            count[now] += weight
        state.value[at], state.weights[at] = value, count
