"""The distribution step in numpy: always there, and the same voxels as the plain loop over pixels.

The paper's running average depends on the order in which pixels meet a voxel. So the pixels of a frame are sorted by voxel, in
row-major order within each, and then one pixel of every voxel is taken at a time: as many vector operations as the fullest voxel
has pixels, instead of as many scalar ones as the image has.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..bone import BoneOnGrid
from ..settings import ReconstructionSettings
from . import rules
from .batch import FrameBatch
from .evidence import ScanLines
from .layout import PixelLayout
from .state import VoxelState


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

    order: np.ndarray
    voxels: np.ndarray
    starts: np.ndarray
    counts: np.ndarray

    @classmethod
    def of(cls, voxels_of_pixels: np.ndarray) -> VoxelGroups:
        """Group the pixels of `voxels_of_pixels` (m,) int64."""
        bits = max(int(voxels_of_pixels.size - 1).bit_length(), 1)
        keys = (voxels_of_pixels << bits) | np.arange(voxels_of_pixels.size)
        keys.sort()
        order = keys & ((1 << bits) - 1)
        keys >>= bits
        starts = np.concatenate([[0], np.flatnonzero(keys[1:] != keys[:-1]) + 1])
        counts = np.diff(starts, append=keys.size)
        fullest_first = np.argsort(-counts.astype(np.int32), kind="stable")
        return cls(order, keys[starts][fullest_first], starts[fullest_first], counts[fullest_first])

    def rounds(self):
        """Yield (n, positions) per round: the first n voxels take the pixels at `order[positions]`."""
        for turn in range(int(self.counts[0])):
            active = int(np.searchsorted(-self.counts, -turn, side="left"))
            yield active, self.starts[:active] + turn


class NumpyEngine:
    """Puts frames into a `VoxelState`.

    Parameters
    ----------
    state : VoxelState
    grid_size : (i, j, k)
    settings : ReconstructionSettings
    maximum : float
        Brightest value an image can hold.
    bone : BoneOnGrid or None
    threads : None
        For the sake of the other engine: this one works on the caller's thread.
    """

    name = "numpy"
    frames_at_once = 1

    def __init__(
        self,
        state: VoxelState,
        grid_size: tuple[int, int, int],
        settings: ReconstructionSettings,
        maximum: float,
        bone: BoneOnGrid | None,
        threads: int | None = None,
    ):
        self.state = state
        self._grid_size = grid_size
        self._maximum = np.float32(maximum)
        self._alpha, self._beta = np.float32(settings.alpha), np.float32(settings.beta)
        self._floor, self._gain = np.float32(settings.weight_floor), np.float32(settings.bone_gain)
        self._probability = None if bone is None else bone.probability.reshape(-1)
        self._directions = None if bone is None else bone.directions_reference.reshape(-1, 3)

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
        pixels, voxels = layout.voxels(batch.image_to_ijk[place], self._grid_size)
        image_axes = batch.axes[place].reshape(2, 3)
        all_values = layout.values(batch.images[place])
        values = all_values[pixels]
        if place in batch.measured:
            measured = layout.values(batch.measured[place])[pixels] > 0
            values, pixels, voxels = values[measured], pixels[measured], voxels[measured]
        if not pixels.size:
            return 0
        method = self.state.method
        if method in ("aif", "aif-compensated"):
            self._insert_aif(values, pixels, voxels, image_axes, layout)
            return pixels.size
        np.add.at(self.state.hits, voxels, np.uint32(1))
        cosine = None
        if self._directions is not None and (method == "weighted" or self.state.cosine is not None):
            cosine = self._cosine(self._directions[voxels], layout.beam_x[pixels], layout.beam_y[pixels], image_axes)
        if self.state.cosine is not None:
            np.maximum.at(self.state.cosine, voxels, cosine)
        if method == "average":
            np.add.at(self.state.value, voxels, values.astype(np.float64))
        elif method == "latest":
            self.state.value[voxels] = values
        elif method == "maximum":
            np.maximum.at(self.state.value, voxels, values)
        else:
            evidence = scan_lines.evidence(all_values, float(self._maximum))
            gate = rules.weighted_gate(evidence.onset[pixels], self._probability[voxels])
            weight = rules.weighted_weight(gate, evidence.reach[pixels], self._floor)
            value = rules.weighted_value(values, gate, cosine, self._gain, self._beta, self._maximum)
            np.add.at(self.state.value, voxels, weight * value)
            np.add.at(self.state.weight, voxels, weight)
        return pixels.size

    def _cosine(self, directions: np.ndarray, beam_x, beam_y, image_axes) -> np.ndarray:
        x, y, z = directions[:, 0], directions[:, 1], directions[:, 2]
        return rules.cosine_of_incidence(beam_x, beam_y, rules.facing(x, y, z, image_axes[0]), rules.facing(x, y, z, image_axes[1]))

    def _insert_aif(self, values, pixels, voxels, image_axes, layout: PixelLayout) -> None:
        """The paper's rule. The bone map is read once per voxel, not once per pixel."""
        state = self.state
        if state.cosine is None:
            expected = self._probability[voxels] != 0
            if not expected.all():
                # Where no bone is expected the weight stays 0, and the rule comes down to the last pixel
                elsewhere = ~expected
                state.value[voxels[elsewhere]] = np.minimum(values[elsewhere], self._maximum)
                np.add.at(state.hits, voxels[elsewhere], np.uint32(1))
                values, pixels, voxels = values[expected], pixels[expected], voxels[expected]
                if not voxels.size:
                    return
        groups = VoxelGroups.of(voxels)
        at = groups.voxels
        x, y, z = self._directions[at].T
        facing_x, facing_y = rules.facing(x, y, z, image_axes[0]), rules.facing(x, y, z, image_axes[1])
        probability = self._probability[at]
        value, count = state.value[at], state.weight[at]
        best = np.zeros(at.size, dtype=np.float32) if state.cosine is not None else None
        compensated = state.method == "aif-compensated"
        beam = pixels[groups.order]
        beam_x, beam_y, values = layout.beam_x[beam], layout.beam_y[beam], values[groups.order]
        for active, positions in groups.rounds():
            now = slice(0, active)
            cosine = rules.cosine_of_incidence(beam_x[positions], beam_y[positions], facing_x[now], facing_y[now])
            weight = rules.paper_angle_weight(cosine, self._beta, compensated) * probability[now]
            new = rules.paper_value(values[positions], weight, self._alpha, self._maximum)
            value[now] = rules.paper_update(value[now], count[now], new)
            count[now] += weight
            if best is not None:
                np.maximum(best[now], cosine, out=best[now])
        state.value[at], state.weight[at] = value, count
        state.hits[at] += groups.counts.astype(np.uint32)
        if best is not None:
            state.cosine[at] = np.maximum(state.cosine[at], best)
