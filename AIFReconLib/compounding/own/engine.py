"""The distribution step of a method of one's own: the arrays of a frame for its function, and the sums of what it answers."""

from __future__ import annotations

import numpy as np

from ...arrays import Integers, Singles
from ...bone.placed.on_grid import PlacedBone
from ..batch import FrameBatch
from ..evidence import FrameEvidence, ScanLines
from ..layout import PixelLayout
from ..state import VoxelState
from .method import Method


class OwnMethodEngine:
    """Puts frames into a `VoxelState` as a method of one's own says.

    Parameters
    ----------
    state : VoxelState
        One that keeps weights.
    grid_size : (i, j, k)
    method : Method
    maximum : float
        Brightest value an image can hold, which shadows are judged by.
    bone : PlacedBone or None
        Needed by a method that looks at bone, and where the state keeps the best cosine.
    planes : (first, stop) or None
        The part of the grid that the state is of, and the bone; by default all of it, which a method that looks at bone needs.
    """

    name = "numpy"
    frames_at_once = 1

    def __init__(
        self,
        state: VoxelState,
        grid_size: tuple[int, int, int],
        method: Method,
        maximum: float,
        bone: PlacedBone | None,
        planes: tuple[int, int] | None = None,
    ):
        self.state = state
        self.method = method
        self._grid_size, self._planes = grid_size, planes
        self._maximum = maximum
        self._bone = bone

    def insert(self, batch: FrameBatch, layout: PixelLayout, scan_lines: ScanLines | None) -> list[int]:
        """Put frames into the volume; returns how many pixels entered of each.

        Raises
        ------
        MethodError
            When the method fails, or answers what cannot be added up. Nothing of that frame has entered.
        """
        return [self._insert(batch, place, layout, scan_lines) for place in range(len(batch))]

    def _insert(self, batch: FrameBatch, place: int, layout: PixelLayout, scan_lines: ScanLines | None) -> int:
        pixels, voxels = layout.voxels(batch.image_to_ijk[place], self._grid_size, self._planes)
        if place in batch.measured:
            measured = layout.values(batch.measured[place])[pixels] > 0
            pixels, voxels = pixels[measured], voxels[measured]
        if not pixels.size:
            return 0
        # Bone that is there for the sake of the best cosine alone must change no voxel
        expected = self._bone if self.method.needs_bone else None
        frame = _Frame(batch, place, layout, scan_lines, self._maximum, pixels, voxels, self._bone, expected)
        number = batch.numbers[place]
        answer = self.method.weigh({name: frame.array(name) for name in self.method.arrays}, number)
        # A view is enough where all enter
        chosen = slice(None) if pixels.size == layout.mask.size else layout.inside[pixels]
        weight, value = (array.reshape(-1)[chosen] for array in answer)
        self.method.check(weight, value, number)
        state = self.state
        cosine = None if state.cosine is None else frame.cosine
        if not weight.all():
            counts = weight > 0
            weight, value, voxels = weight[counts], value[counts], voxels[counts]
            cosine = None if cosine is None else cosine[counts]
        np.add.at(state.hits, voxels, np.uint32(1))
        if state.cosine is not None and cosine is not None:
            np.maximum.at(state.cosine, voxels, cosine)
        # In doubles, in which the product of two singles is exact
        shares = weight.astype(np.float64)
        np.add.at(state.weights, voxels, shares)
        np.add.at(state.value, voxels, np.multiply(shares, value, out=shares))
        return voxels.size


class _Frame:
    """One frame as a method sees it; the pixels in the volume are `pixels` (m,), numbers of the layout's, in `voxels` (m,).

    `expected` is the bone whose word counts where onsets compete, if any.
    """

    def __init__(
        self,
        batch: FrameBatch,
        place: int,
        layout: PixelLayout,
        scan_lines: ScanLines | None,
        maximum: float,
        pixels: Integers,
        voxels: Integers,
        bone: PlacedBone | None,
        expected: PlacedBone | None,
    ):
        self._image, self._axes, self._layout = batch.images[place], batch.axes[place], layout
        self._scan_lines, self._maximum, self._image_to_ijk = scan_lines, maximum, batch.image_to_ijk[place]
        self._pixels, self._voxels, self._bone, self._expected = pixels, voxels, bone, expected
        self._evidence: FrameEvidence | None = None

    def array(self, name: str) -> Singles:
        """One of `ARRAYS`, (rows, columns) float32 of the window in which pixels count; the caller's to change."""
        if name == "intensity":
            return self._layout.within_window(self._image).astype(np.float32)
        if name == "cosine":
            return self._in_volume(self.cosine)
        if name == "probability":
            return self._in_volume(self._bone_map.at(self._voxels)[0])
        if self._evidence is None:
            if self._scan_lines is None:
                raise ValueError("Input scan_lines must be given for a method that looks at shadows; got None.")
            expected = None
            if self._expected is not None:
                expected = self._scan_lines.expected(self._expected.map_probability, self._expected.ijk_to_map @ self._image_to_ijk)
            self._evidence = self._scan_lines.evidence(self._layout.values(self._image), self._maximum, expected)
        return self._layout.filled(self._evidence.reach if name == "reach" else self._evidence.onset)

    @property
    def cosine(self) -> Singles:
        """Cosine of incidence of the pixels in the volume, (m,)."""
        directions = self._bone_map.at(self._voxels)[1]
        return self._layout.beams(self._pixels, self._axes).cosine(directions)

    @property
    def _bone_map(self) -> PlacedBone:
        if self._bone is None:
            raise ValueError("Input bone must be given for a method that looks at it; got None.")
        return self._bone

    def _in_volume(self, values: Singles) -> Singles:
        """Values of the pixels in the volume, (m,), in the window; 0 elsewhere."""
        if values.size == self._layout.inside.size:
            return self._layout.filled(values)
        whole = np.zeros(self._layout.inside.size, np.float32)
        whole[self._pixels] = values
        return self._layout.filled(whole)
