"""The distribution step of a method of one's own: the arrays of a frame for its function, and the sums of what it answers."""

from __future__ import annotations

import numpy as np

from ...arrays import Singles
from ..batch import FrameBatch
from ..engine import Engine, Job
from ..evidence import ScanLines
from ..layout import PixelLayout
from .method import Method


class OwnMethodEngine(Engine):
    """Puts frames into a `VoxelState` that keeps weights as a method of one's own says.

    Of a frame for which the method fails, or answers what cannot be added up (a MethodError), nothing enters.
    """

    def __init__(self, job: Job):
        super().__init__(job)
        if not isinstance(self.method, Method):
            raise ValueError(f"Input state must be of a method of one's own; got {self.method.name}.")
        self._own = self.method

    def _insert(self, batch: FrameBatch, place: int, layout: PixelLayout, scan_lines: ScanLines | None) -> int:
        pixels, voxels = self._entering(batch, place, layout)
        if not pixels.size:
            return 0
        number, method, state, bone = batch.numbers[place], self._own, self.state, self.job.bone

        def in_volume(values: Singles) -> Singles:
            """Values of the pixels in the volume, (m,), in the window; 0 elsewhere."""
            if values.size == layout.inside.size:
                return layout.filled(values)
            whole = np.zeros(layout.inside.size, np.float32)
            whole[pixels] = values
            return layout.filled(whole)

        given: dict[str, Singles] = {}
        cosine: Singles | None = None
        if bone is not None and (state.cosine is not None or method.needs_bone):
            probability, directions = bone.at(voxels)
            cosine = layout.beams(pixels, batch.axes[place]).cosine(directions)
            given |= {"cosine": cosine, "probability": probability}
        # Each is the method's to change
        arrays = {name: in_volume(given[name]) for name in method.arrays if name in given}
        if "intensity" in method.arrays:
            arrays["intensity"] = layout.within_window(batch.images[place]).astype(np.float32)
        if method.needs_shadows:
            # Bone that is there for the sake of the best cosine alone must change no voxel
            expected = bone if method.needs_bone else None
            reach, onset = self._evidence(layout.pixels(batch.images[place]), batch.image_to_ijk[place], scan_lines, expected)
            arrays |= {"reach": layout.filled(reach), "onset": layout.filled(onset)}
        answer = method.weigh({name: arrays[name] for name in method.arrays}, number)
        # A view is enough where all enter
        chosen = slice(None) if pixels.size == layout.mask.size else layout.inside[pixels]
        weight, value = (array.reshape(-1)[chosen] for array in answer)
        method.check(weight, value, number)
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
