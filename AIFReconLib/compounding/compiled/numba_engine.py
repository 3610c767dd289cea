"""The distribution step on all processor cores: the same voxels as the numpy engine's, to the last bit."""

from __future__ import annotations

import numpy as np

from ...arrays import Floats, Integers, Singles
from ...bone.placed.on_grid import everywhere
from ...machine.threads import in_parts
from ..batch import FrameBatch
from ..engine import Job
from ..evidence import ScanLines
from ..layout import PixelLayout
from ..methods import aif, average, latest, maximum, rules, weighted
from .numba_kernels import AVERAGE, LATEST, MAXIMUM, insert_aif, insert_cosine, insert_plain, insert_weighted
from .slabs import Put, SlabEngine

NOTHING: Singles = np.empty(0, np.float32)

PLAIN_RULES = {average.AVERAGE.name: AVERAGE, latest.LATEST.name: LATEST, maximum.MAXIMUM.name: MAXIMUM}
PAPER_RULES = {aif.AIF.name: False, aif.AIF_COMPENSATED.name: True}
"""Whether oblique beams are compensated."""


class NumbaEngine(SlabEngine):
    """Puts frames into a `VoxelState` by the kernel of a method."""

    methods = (*PLAIN_RULES, *PAPER_RULES, weighted.WEIGHTED.name)
    """Those that have a kernel."""

    def __init__(self, job: Job):
        super().__init__(job)
        self._probability, self._directions = everywhere(job.bone)

    def _put(self, batch: FrameBatch, frames: slice, layout: PixelLayout, scan_lines: ScanLines | None) -> Put:
        images, matrices, axes = batch.images[frames], batch.image_to_ijk[frames], batch.axes[frames]
        state, name, factors = self.state, self.method.name, self.factors
        voxels = state.value, state.hits, NOTHING if state.weight is None else state.weight
        beam_x, beam_y = NOTHING if layout.beam_x is None else layout.beam_x, NOTHING if layout.beam_y is None else layout.beam_y
        bone = self._probability, self._directions, axes, beam_x, beam_y
        evident = self._judged(batch, frames, layout, scan_lines) if self.method.needs_shadows else None

        def put(pieces: Integers, box: Floats, spans: Integers) -> Integers:
            where = images, matrices, pieces, spans, self.part
            if state.cosine is not None:
                insert_cosine(where, state.cosine, bone)
            if evident is not None:
                insert_weighted(where, voxels, evident, (factors.floor, factors.gain, factors.maximum))
            elif name in PAPER_RULES:
                insert_aif(where, voxels, bone, (factors.alpha, factors.beta, factors.maximum, PAPER_RULES[name]))
            else:
                insert_plain(PLAIN_RULES[name], where, voxels)
            entered: Integers = (spans[:, :, 1] - spans[:, :, 0]).sum(axis=1)
            return entered

        return put

    def _judged(self, batch: FrameBatch, frames: slice, layout: PixelLayout, scan_lines: ScanLines | None) -> Singles:
        """Reach, gate and compensation of all pixels of the frames, (frames, 3, n); the last only where the gate is open."""
        job, images = self.job, batch.images[frames]
        evident = np.empty((len(images), 3, layout.inside.size), np.float32)

        def judge(frame: int) -> None:
            matrix, axes = batch.image_to_ijk[frames][frame], batch.axes[frames][frame]
            _, gate, compensation = evident[frame]
            self._evidence(layout.pixels(images[frame]), matrix, scan_lines, job.bone, evident[frame])
            begins = np.flatnonzero(gate > 0)
            entered, voxels = layout.voxels(matrix, job.grid_size, job.planes, begins)
            if job.bone is None or not entered.size:
                return
            begins = begins[entered]
            probability, directions = job.bone.at(voxels)
            gate[begins] = rules.weighted_gate(gate[begins], probability)
            compensation[begins] = rules.weighted_compensation(layout.beams(begins, axes).cosine(directions), self.factors.beta)

        in_parts(judge, len(images), self.threads, batch.progress, "Reconstructing")
        return evident
