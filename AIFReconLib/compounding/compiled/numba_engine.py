"""The distribution step on all processor cores: the same voxels as the numpy engine, to the last bit.

A batch of frames is put into the volume slab by slab. Slabs share no voxel, so threads need no locks and no order among them; within
a slab the frames follow each other in time, so that what they have in common is still in the cache when the next one comes.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...arrays import Floats, Integers, Numbers, Singles
from ...bone.placed.on_grid import PlacedBone, everywhere
from ...machine.threads import Pace, checked_threads, in_parts
from ...progress import Progress
from ...recipe.recipe import Recipe
from ..batch import BATCH_FRAMES, FrameBatch
from ..evidence import ScanLines
from ..layout import PixelLayout
from ..methods import aif, average, latest, maximum, weighted
from ..methods.table import method_named
from ..state import VoxelState
from .groups import Evidence, evidence_of
from .numba_evidence import FrameJudge
from .numba_kernels import AVERAGE, LATEST, MAXIMUM, PACKED, clip_to_volume, insert_aif, insert_cosine, insert_plain, insert_weighted
from .slabs import SLABS, SLABS_WITH_BONE, cut_into_slabs, slabs_for

NOTHING: Singles = np.empty(0, np.float32)

PLAIN_RULES = {average.AVERAGE.name: AVERAGE, latest.LATEST.name: LATEST, maximum.MAXIMUM.name: MAXIMUM}
PAPER_RULES = {aif.AIF.name: False, aif.AIF_COMPENSATED.name: True}
"""Whether oblique beams are compensated."""


class NumbaEngine:
    """Puts frames into a `VoxelState`.

    Parameters
    ----------
    state : VoxelState
    grid_size : (i, j, k)
    settings : Recipe
    maximum : float
        Brightest value an image can hold.
    bone : PlacedBone or None
    threads : int or None
        How many to use; by default NUMBA_NUM_THREADS of the environment, else every core.
    planes : (first, stop) or None
        The part of the grid that the state is of, and the bone; by default all of it.

    Raises
    ------
    SettingsError
        When the number of threads is not at least 1.
    """

    name = "numba"
    methods = (*PLAIN_RULES, *PAPER_RULES, weighted.WEIGHTED.name)
    """Those that have a kernel."""
    frames_at_once = BATCH_FRAMES

    def __init__(
        self,
        state: VoxelState,
        grid_size: tuple[int, int, int],
        settings: Recipe,
        maximum: float,
        bone: PlacedBone | None,
        threads: int | None = None,
        planes: tuple[int, int] | None = None,
    ):
        self.state = state
        self.threads = checked_threads(threads)
        self._pace = Pace()
        first, stop = (0, grid_size[2]) if planes is None else planes
        self._ends = (0, 0, first), (*grid_size[:2], stop)
        self._bounds = np.array([(0, 0, first), (*grid_size[:2], stop)], dtype=np.float64)
        self._maximum = float(maximum)
        self._method = method_named(state.method)
        compensated = PAPER_RULES.get(state.method, False)
        self._aif_factors = (np.float32(settings.alpha), np.float32(settings.beta), np.float32(maximum), compensated)
        floor, gain = np.float32(settings.weight_floor), np.float32(settings.bone_gain)
        self._weighted_factors = (floor, gain, np.float32(settings.beta), np.float32(maximum))
        self._judge: FrameJudge | None = None
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
        if not batch.measured:
            return self._insert(batch, slice(0, len(batch)), layout.pieces, layout, scan_lines)
        entered: list[int] = []
        for place in range(len(batch)):
            pieces = layout.pieces
            if place in batch.measured:
                pieces = layout.pieces_within(layout.mask & layout.within_window(batch.measured[place]))
            entered += self._insert(batch, slice(place, place + 1), pieces, layout, scan_lines)
        return entered

    def _insert(self, batch: FrameBatch, frames: slice, pieces: Integers, layout: PixelLayout, scan_lines: ScanLines | None) -> list[int]:
        images, matrices, axes = batch.images[frames], batch.image_to_ijk[frames], batch.axes[frames]
        slabs = slabs_for(matrices, layout, self.threads, SLABS_WITH_BONE if self._probability.size else SLABS)
        axis, edges = cut_into_slabs(matrices, layout, self._bounds, slabs)
        spans = np.empty((len(images), len(pieces), 4), np.int32)
        clip_to_volume(matrices, pieces, self._bounds, axis, spans)
        entered = np.zeros((len(edges) - 1, len(images)), np.int64)
        state, method = self.state, self._method
        voxels = state.value, state.hits, NOTHING if state.weight is None else state.weight
        beam_x, beam_y = NOTHING if layout.beam_x is None else layout.beam_x, NOTHING if layout.beam_y is None else layout.beam_y
        evidence = self._judged(scan_lines, images, matrices, axes, layout, batch.progress) if method.needs_shadows else None

        def put(part: int) -> Iterator[None]:
            slab = axis, int(edges[part]), int(edges[part + 1])
            for some in self._pace.steps(len(images)):
                where, pixels = (images[some], matrices[some], pieces, spans[some], self._bounds), entered[part, some]
                bone = self._probability, self._directions, axes[some], beam_x, beam_y
                if state.cosine is not None:
                    insert_cosine(where, slab, state.cosine, bone)
                if evidence is not None:
                    insert_weighted(where, slab, voxels, self._weighted_factors, evidence_of(evidence, some), pixels)
                elif method.name in PLAIN_RULES:
                    insert_plain(PACKED if state.packed else PLAIN_RULES[method.name], where, slab, voxels, pixels)
                else:
                    insert_aif(where, slab, voxels, bone, self._aif_factors, pixels)
                yield

        in_parts(put, len(edges) - 1, self.threads, batch.progress, "Reconstructing")
        return [int(n) for n in entered.sum(axis=0)]

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
        bone = self._bone
        if scan_lines is None or bone is None:
            raise ValueError("Input scan_lines and bone must be given for method weighted; got None.")
        judge = self._frame_judge(scan_lines, images)

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

    def _frame_judge(self, scan_lines: ScanLines, images: Numbers) -> FrameJudge:
        if self._judge is None or self._judge.scan_lines is not scan_lines:
            self._judge = FrameJudge(scan_lines, images.dtype, self._maximum, BATCH_FRAMES)
        return self._judge
