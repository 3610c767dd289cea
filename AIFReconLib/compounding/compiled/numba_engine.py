"""The distribution step on all processor cores: the same voxels as the numpy engine's, to the last bit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...arrays import Floats, Integers, Mask, Numbers, Singles
from ...bone.placed.on_grid import everywhere
from ...machine.threads import in_parts
from ...progress import Progress
from ..batch import BATCH_FRAMES, FrameBatch
from ..engine import Job
from ..evidence import ScanLines
from ..layout import PixelLayout
from ..methods import aif, average, latest, maximum, weighted
from .groups import Evidence, Slab, evidence_of
from .numba_evidence import FrameJudge
from .numba_kernels import AVERAGE, LATEST, MAXIMUM, PACKED, clip_to_volume, insert_aif, insert_cosine, insert_plain, insert_weighted
from .slabs import SLABS, SLABS_WITH_BONE, SlabEngine, cut_into_slabs, slabs_for

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
        i, j, _ = job.grid_size
        self._ends = (0, 0, job.planes[0]), (i, j, job.planes[1])
        self._bounds = np.array(self._ends, dtype=np.float64)
        settings, brightest = job.settings, np.float32(job.maximum)
        alpha, beta, floor, gain = map(np.float32, (settings.alpha, settings.beta, settings.weight_floor, settings.bone_gain))
        self._aif_factors = alpha, beta, brightest, PAPER_RULES.get(self.method.name, False)
        self._weighted_factors = floor, gain, beta, brightest
        self._judge: FrameJudge | None = None
        self._probability, self._directions = everywhere(job.bone)

    def _insert_alike(
        self, batch: FrameBatch, frames: slice, layout: PixelLayout, scan_lines: ScanLines | None, counting: Mask | None
    ) -> list[int]:
        images, matrices, axes = batch.images[frames], batch.image_to_ijk[frames], batch.axes[frames]
        pieces = layout.pieces if counting is None else layout.pieces_within(layout.mask & counting)
        slabs = slabs_for(matrices, layout, self.threads, SLABS_WITH_BONE if self._probability.size else SLABS)
        axis, edges = cut_into_slabs(matrices, layout, self._bounds, slabs)
        spans = np.empty((len(images), len(pieces), 4), np.int32)
        clip_to_volume(matrices, pieces, self._bounds, axis, spans)
        state, name = self.state, self.method.name
        voxels = state.value, state.hits, NOTHING if state.weight is None else state.weight
        beam_x, beam_y = NOTHING if layout.beam_x is None else layout.beam_x, NOTHING if layout.beam_y is None else layout.beam_y
        evidence = self._judged(scan_lines, images, matrices, axes, layout, batch.progress) if self.method.needs_shadows else None

        def put(slab: Slab, entered: Integers) -> Iterator[None]:
            for some in self._pace.steps(len(images)):
                where = images[some], matrices[some], pieces, spans[some], self._bounds
                bone = self._probability, self._directions, axes[some], beam_x, beam_y
                if state.cosine is not None:
                    insert_cosine(where, slab, state.cosine, bone)
                if evidence is not None:
                    insert_weighted(where, slab, voxels, self._weighted_factors, evidence_of(evidence, some), entered[some])
                elif name in PAPER_RULES:
                    insert_aif(where, slab, voxels, bone, self._aif_factors, entered[some])
                else:
                    insert_plain(PACKED if state.packed else PLAIN_RULES[name], where, slab, voxels, entered[some])
                yield

        return self._in_slabs(put, axis, edges, len(images), batch.progress)

    def _judged(
        self,
        scan_lines: ScanLines | None,
        images: Numbers,
        matrices: Floats,
        axes: Singles,
        layout: PixelLayout,
        progress: Progress | None,
    ) -> Evidence:
        """What the frames themselves tell, of what the CT expects in them, and the CT where they show bone."""
        bone = self.job.bone
        if scan_lines is None or bone is None:
            raise ValueError(f"Input scan_lines and bone must be given for method {self.method.name}; got None.")
        if self._judge is None or self._judge.scan_lines is not scan_lines:
            self._judge = FrameJudge(scan_lines, self.gray_levels, BATCH_FRAMES)
        judge = self._judge

        def judge_frame(frame: int) -> None:
            matrix = matrices[frame]
            begins = judge.judge(images[frame], frame, bone.map_probability, bone.ijk_to_map @ matrix)
            if not begins.size:
                return
            entered, voxels = judge.voxels_of(begins, matrix, *self._ends)
            probability, directions = bone.at(voxels)
            judge.keep(frame, entered, probability, layout.beams(begins[entered], axes[frame]).cosine(directions))

        in_parts(judge_frame, len(images), self.threads, progress, "Reconstructing")
        return judge.evidence(len(images))
