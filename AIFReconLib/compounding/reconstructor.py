"""Frames in, voxels out: the one class that turns tracked frames into a volume, whether they come from a file or a probe."""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from ..arrays import Reals
from ..bone.map import BoneMap
from ..bone.placed.on_grid import PlacedBone
from ..effective_settings import given_imaging
from ..errors import BeamGeometryError, OperationCanceled, require_kind
from ..geometry.volume import VoxelGrid
from ..holes.filling import HoleFilling
from ..imaging.beams import SECTOR, ProbeGeometry
from ..imaging.region import ImageRegion
from ..imaging.sound_speed import depth_factor
from ..machine.memory import require_memory
from ..message import Sentence
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..remedies import NAME_THE_PROBE, PLACE_THE_CT
from ..sweep.frames import TrackedFrame
from .batch import FrameBatch
from .engine import Engine, Job
from .engines import choose_engine
from .finishing.parts import Planes
from .finishing.results import Results
from .frame_placement import OUTSIDE, ImageKind, Intake, require_kinds, why_not
from .layout import MostHits
from .methods.table import method_named
from .needs import (
    bone_on_grid,
    needs_beams,
    needs_bone,
    refuse_reading,
    require_bone,
    require_grid_as_asked,
    require_map_as_asked,
    unused_settings,
)
from .numpy_engine import NumpyEngine
from .own.engine import OwnMethodEngine
from .own.method import Method
from .splat_engine import check_shares, splat_engine, uses_shares
from .state import BESIDE, Reconstruction, VoxelState, bytes_per_voxel, counts_hits, part_bytes

BESIDE_BONE = Sentence("Warning: the bone map does not overlap the volume, so incidence weights nothing.", PLACE_THE_CT)


@dataclass(eq=False)
class FrameCounts:
    """Which frames entered and which did not; in arrays, because a scan may take hours, and skip most of its frames."""

    inserted: int = 0
    skipped: dict[str, array[int]] = field(default_factory=dict)
    poses: array[float] = field(default_factory=lambda: array("d"))
    """The upper three rows of every pose, for the distance between frames."""
    reached: dict[int, Planes] = field(default_factory=dict)
    """The planes [k] that each frame may have pixels in, the lowest and the highest, where only a part of them is reconstructed."""

    def skip(self, reason: str, number: int) -> None:
        """Count frame `number` as skipped for `reason`."""
        self.skipped.setdefault(reason, array("q")).append(number)

    def copy(self) -> FrameCounts:
        """The counts as they are now."""
        return FrameCounts(self.inserted, {reason: numbers[:] for reason, numbers in self.skipped.items()}, self.poses[:])

    def merge(self, later: FrameCounts, given: Collection[int]) -> None:
        """Take in what became of the frames `given` to another part of the volume: one that entered any has entered."""
        why = {number: reason for reason, numbers in later.skipped.items() for number in numbers}
        before, self.skipped = self.skipped, {}
        for reason, numbers in before.items():
            for number in numbers:
                if number in given and number not in why:
                    self.inserted += 1
                else:
                    # That it lies beside one part says nothing of the whole
                    self.skip(why.get(number, reason) if reason == OUTSIDE else reason, number)


class Reconstructor:
    """Collects tracked frames into a volume.

    All but the grid may be left out. There are many parameters because they are what `reconstruct` finds in recipe, configuration, images
    and memory, one by one, and who inserts frames by hand need not have these.

    Parameters
    ----------
    grid : VoxelGrid
        The voxels to fill.
    settings : Recipe or None
        What of it says how a recording is read is refused, and so is what asks for other voxels or another bone map than those given.
    bone : BoneMap or None
        Needed by the methods that weight by incidence.
    probe : ProbeGeometry or None
        Where the beams go; needed where `bone` is used, and where a method looks for shadows. By default the settings'.
    region : ImageRegion or None
        Pixels outside it never enter. By default the settings'.
    threads : int or None
        How many the numba engine uses; by default every core.
    importance : (rows, columns) array, 0 to 1, or None
        Weight of each pixel of an image in an average; those of 0 do not enter.
    holes : tuple of HoleFilling
        How holes are filled, where the settings leave it open.
    fixed_point : bool
        Place pixels as Plus's Optimization=FULL does; see `in_fixed_point`.
    beside : names of `BESIDE`
        The volumes that are wanted beside intensity and mask (and the cosine, where the settings ask for it).
    planes : (first, stop) or None
        The part of the grid that is reconstructed, planes [k]; by default all of it. The results then come by `put_into`.

    Raises
    ------
    SettingsError
        When settings do not go with what is given, the method needs a bone map and there is none, the engine asked for is not there, or
        the method fits neither linear interpolation nor an importance mask.
    MethodError
        When the method is one of the user's own and is not registered.
    BeamGeometryError
        When it needs the beams' directions and there are none.
    InsufficientMemoryError
        When the grid does not fit into memory; nothing has been allocated then.

    Examples
    --------
    >>> grid = VoxelGrid.from_spacing((0.0, 0.0, 0.0), (8, 8, 8), 1.0)
    >>> reconstructor = Reconstructor(grid)
    >>> reconstructor.insert(TrackedFrame(np.full((4, 4), 7, np.uint8), np.eye(4)))
    >>> int(reconstructor.reconstruction().intensity.array.max())
    7
    """

    def __init__(
        self,
        grid: VoxelGrid,
        settings: Recipe | None = None,
        bone: BoneMap | None = None,
        *,
        probe: ProbeGeometry | None = None,
        region: ImageRegion | None = None,
        threads: int | None = None,
        importance: Reals | None = None,
        holes: tuple[HoleFilling, ...] = (),
        fixed_point: bool = False,
        beside: Collection[str] = BESIDE,
        planes: Planes | None = None,
        progress: Progress | None = None,
    ):
        require_kinds(recipe=settings, bone=bone, grid=grid, region=region, probe=probe)
        self.settings = settings or Recipe()
        refuse_reading(self.settings)
        require_grid_as_asked(self.settings, grid)
        require_map_as_asked(self.settings, bone)
        self.grid = grid
        self.method = self.settings.method_for(bone is not None)
        self.counts = FrameCounts()
        imaging, importance = given_imaging(self.settings, region, probe, importance)
        self._region, probe = imaging.region, imaging.probe
        self._made = bone.made if bone is not None and needs_bone(self.method, self.settings) else {}
        unused = unused_settings(self.method, self.settings, bone)
        self._unused = frozenset(unused)
        self.notes: list[str] = [f"{name} is not used: {unused[name]}." for name in self.settings.given(*unused)]
        method = method_named(self.method)
        uses_bone = require_bone(self.method, self.settings, bone is not None)
        uses_beams = needs_beams(self.method, self.settings)
        if uses_beams and probe is None:
            raise BeamGeometryError(f"Method {self.method} needs the direction of the beams.", NAME_THE_PROBE)
        self._moves_pixels = depth_factor(self.settings) != 1.0
        if self._moves_pixels and probe is None:
            raise BeamGeometryError("A speed of sound needs the direction of the beams.", NAME_THE_PROBE)
        check_shares(self.method, self.settings, importance)
        self._importance = None if importance is None else np.asarray(importance, dtype=np.float32)
        self._shares = uses_shares(self.settings, importance)
        self._holes, self._beside, self._threads = holes, beside, threads
        self._part, self._planes = planes, planes or (0, grid.size[2])
        shadows = method.needs_shadows
        self._intake = Intake(
            grid, self.settings, self._region, probe, needs_beams=uses_beams, judges_shadows=shadows, fixed_point=fixed_point
        )
        self._engine_class = self._chosen_engine(self._moves_pixels and probe is not None and probe.kind == SECTOR)
        # Of 8-bit images, which take the least: what others take is known when the first has come
        self._on_grid = bone_on_grid(self.method, self.settings, bone is not None and bone.grows)
        kind = self.method, self._on_grid, self.settings.best_cosine, self._shares, True
        size = (*grid.size[:2], self._planes[1] - self._planes[0])
        require_memory(size, grid.spacing, part_bytes(*kind, beside) if planes else bytes_per_voxel(*kind, beside, 1))
        self._bone = self._place_bone(bone, progress) if bone is not None and uses_bone else None
        self._state: VoxelState | None = self._empty_state(whole=True)
        self._hits = MostHits(grid.size)
        # The first image decides on these
        self._images: ImageKind | None = None
        self._engine: Engine | None = None
        self._batch: FrameBatch | None = None

    def insert(self, frames: TrackedFrame | Iterable[TrackedFrame], progress: Progress | None = None, count: int = 1) -> None:
        """Put a frame, or several in their order, into the volume.

        Frames whose status is not OK are counted with their reason and change nothing. When this returns, all have entered: a frame
        that is given alone is in its voxels at once, while several are computed together as fast as the machine can.

        Parameters
        ----------
        count : int
            How many frames come, for the fraction that `progress` hears.

        Raises
        ------
        OperationCanceled
            When `progress` returns False. The volume is of no use any more: frames may have entered in part.
        InputTypeError
            When something is no `TrackedFrame`.
        GeometryError
            When an image is not one of gray pixels, or its size or pixel type differs from that of the first. The frames before it have
            entered.
        """
        self._unfinished()
        if isinstance(frames, TrackedFrame):
            frames = (frames,)
        try:
            for done, frame in enumerate(frames):
                share = part(progress, min(done / count, 1.0), min((done + 1) / count, 1.0))
                report(share, 0.0, "Reconstructing")
                self._add(frame, share)
        except OperationCanceled:
            if self._batch is not None:
                self._batch.clear()
            raise
        finally:
            self._compute(part(progress, 1.0, 1.0))

    def lay_out_as(self, first: Reconstructor) -> None:
        """Lay frames out as the first part of the volume did, to which all of them were given; before any is inserted."""
        self._intake.laid_out = first._intake.laid_out

    @property
    def engine(self) -> str:
        """Name of the engine that does the arithmetic: "numpy" or "numba"."""
        return self._engine_class.name

    def reconstruction(self, progress: Progress | None = None) -> Reconstruction:
        """The volume as it is now, holes filled; more frames may follow."""
        return self.capture()(progress)

    def capture(self) -> Callable[[Progress | None], Reconstruction]:
        """Take the voxels as they are now; the answer makes a volume of them, once, while more frames may already enter."""
        results = self._results()
        results.put(self._unfinished(), self._planes)
        return partial(self.made, results, self.counts.copy(), tuple(self.notes))

    def finish(self, progress: Progress | None = None) -> Reconstruction:
        """The final volume. No frame can follow: the bone map is released and the state handed over, which saves the memory of both."""
        return self.made(self.put_into(None), self.counts.copy(), tuple(self.notes), progress)

    def put_into(self, results: Results | None) -> Results:
        """Hand the voxels over to the results of the whole grid, new ones where there are none yet. No frame can follow."""
        state = self._unfinished()
        self._state = self._bone = self._engine = self._batch = None
        results = results or self._results()
        results.put(state, self._planes, release=True)
        return results

    def made(self, results: Results, counts: FrameCounts, notes: tuple[str, ...], progress: Progress | None = None) -> Reconstruction:
        """The volume of results of the whole grid, its holes filled."""
        shown = self._region.mask(*self._images.shape[::-1]) if self._images else np.ones((1, 1), dtype=bool)
        hole_limit, messages = results.fill(np.reshape(counts.poses, (-1, 3, 4)), shown, progress)
        intensity, mask = results.volume("intensity"), results.volume("mask")
        if intensity is None or mask is None:
            raise ValueError("Input results must have been filled; got none.")
        return Reconstruction(
            intensity=intensity,
            score=results.volume("score"),
            hits=results.volume("hits"),
            mask=mask,
            cosine=results.volume("cosine"),
            method=self.method,
            frames_inserted=counts.inserted,
            skipped={reason: numbers.tolist() for reason, numbers in counts.skipped.items()},
            messages=(*notes, *messages),
            hole_limit=hole_limit,
            bone=self._made,
            unused=self._unused,
        )

    def _unfinished(self) -> VoxelState:
        if self._state is None:
            raise RuntimeError("finish() was called: this reconstructor has handed over its volume. Make a new one.")
        return self._state

    def _chosen_engine(self, curves_rows: bool) -> type[Engine]:
        chosen, note = choose_engine(self.settings.engine)
        if note is not None:
            self.notes.append(note)
        if isinstance(method_named(self.method), Method):
            return OwnMethodEngine
        if self._shares:
            return splat_engine(self.method, self.settings)
        if self.method not in chosen.methods:
            return NumpyEngine
        if curves_rows and chosen is not NumpyEngine:
            # The other engine wants rows of pixels to be straight lines
            self.notes.append("A sector's speed of sound is corrected for by the slower numpy engine. The voxels are the same.")
            return NumpyEngine
        return chosen

    def _empty_state(self, whole: bool) -> VoxelState:
        (i, j, _), (first, stop) = self.grid.size, self._planes
        counted = counts_hits(self.method, self._beside)
        return VoxelState.empty(i * j * (stop - first), self.method, self.settings.best_cosine, self._shares, whole, counted)

    def _results(self) -> Results:
        wanted = self._images.output_type(self.settings) if self._images else self.settings.output_type
        return Results(self.grid, self.settings, wanted, self._beside, self._holes, self._threads)

    def _place_bone(self, bone: BoneMap, progress: Progress | None) -> PlacedBone:
        place = bone.on_grid if self._on_grid else bone.at_voxels
        placed = place(self.grid, self.settings.bone_direction, progress, self._part)
        self.notes += bone.notes
        if not (placed.overlaps or bone.grows):
            self.notes.append(BESIDE_BONE)
        return placed

    def _add(self, frame: TrackedFrame, progress: Progress | None) -> None:
        """Put a frame into the batch; what waits there is computed when it is full or the frame does not fit to it."""
        require_kind("frames", frame, TrackedFrame, "Make one: TrackedFrame(image, image_to_reference).")
        problem = why_not(frame)
        if problem is not None:
            self.counts.skip(problem, frame.number)
            return
        image, pose = frame.placed()
        batch = self._start(ImageKind.of(image, frame.number)) if self._batch is None else self._batch
        if self._images is not None:
            self._images.check(image, frame.number)
        if not self._intake.fits(image, pose, frame.number):
            self._compute(progress)
            self._intake.lay_out(image, pose, frame.number)
        layout, kept = self._intake.layout, self._region.entering(image, self.settings.pixel_rejection)
        if kept is not None and layout is not None and not layout.has_any(kept):
            self.counts.skip("nothing bright enough in the image", frame.number)
            return
        self.counts.poses.extend(pose[:3].ravel())
        image_to_ijk = self._intake.image_to_ijk(pose)
        state = self._unfinished()
        if state.room < math.inf and layout is not None and self._hits.after(image_to_ijk, layout) > state.room:
            # What waits adds up as it would have one by one
            self._compute(progress)
            state.widen()
        if self._part is not None and layout is not None:
            self._intake.laid_out[frame.number] = layout.spacing
            low, high = self.counts.reached[frame.number] = layout.planes_reached(image_to_ijk)
            if high < self._part[0] or low >= self._part[1]:
                self.counts.skip(OUTSIDE, frame.number)
                return
        batch.add(image, pose, image_to_ijk, frame.number, kept)
        if batch.full:
            self._compute(progress)

    def _compute(self, progress: Progress | None) -> None:
        """Bring what waits into the volume."""
        batch, layout = self._batch, self._intake.layout
        if self._engine is None or layout is None or not batch:
            return
        batch.progress = progress
        try:
            entered = self._engine.insert(batch, layout, self._intake.scan_lines)
            for place, (number, pixels) in enumerate(zip(batch.numbers, entered, strict=True)):
                if pixels:
                    self.counts.inserted += 1
                else:
                    self.counts.skip(self._intake.why_nothing_entered(batch, place), number)
        finally:
            batch.clear()

    def _start(self, images: ImageKind) -> FrameBatch:
        self._images = images
        self.notes += images.warnings(self.method, self.settings)
        if not images.is_8_bit or self._moves_pixels:
            # The one that was made for 8-bit images goes first
            self._state = None
            self._state = self._empty_state(whole=False)
        settings, maximum = self.settings, images.maximum(self.settings)
        self._engine = self._engine_class(
            Job(self._unfinished(), self.grid.size, self._planes, settings, maximum, self._bone, self._importance, self._threads)
        )
        self._batch = FrameBatch(images.shape, images.dtype, self._engine.frames_at_once)
        return self._batch
