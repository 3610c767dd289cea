"""A sweep, a recipe and a source of bone become one plan, in which all is decided, and that a volume."""

from __future__ import annotations

import logging
from array import array
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..arrays import Integers, NumberType
from ..bone.echoes.surface import bone_from_sweep, default_bone
from ..bone.map import BoneMap
from ..bone.network.model import OnnxModel
from ..bone.predicted_bone import bone_from_frames
from ..bone.recorded_predictions import RecordedPredictions
from ..calibration.check import known_without_ct
from ..compounding.finishing.parts import Costs, Planes, cut_into_parts, frames_of, memory_to_use
from ..compounding.finishing.results import Results, bytes_of_results
from ..compounding.frame_placement import ImageKind, require_kinds
from ..compounding.methods.average import AVERAGE
from ..compounding.methods.table import method_named
from ..compounding.needs import (
    bone_on_grid,
    needs_beams,
    needs_bone,
    require_grid_as_asked,
    require_map_as_asked,
)
from ..compounding.reconstructor import BESIDE_BONE, FrameCounts, Reconstructor
from ..compounding.splat_engine import uses_shares
from ..compounding.state import BESIDE, Reconstruction, bytes_per_voxel, part_bytes
from ..effective_settings import (
    BEFORE_FRAMES,
    RECOGNIZED,
    Imaging,
    ReconstructorParts,
    reconstructor_parts,
    resolve_imaging,
    resolve_settings,
    takes_out_motion,
)
from ..errors import GeometryError, NoUsableFramesError
from ..geometry.transforms import pixel_spacing
from ..geometry.volume import Volume, VoxelGrid
from ..holes.automatic import with_limit
from ..imaging.extent import grid_around_sweep
from ..imaging.region import ImageRegion
from ..imaging.sound_speed import depth_factor, depth_scale
from ..inspection.tracking_report import TrackingReport, tracking_report
from ..machine.read_ahead import read_ahead
from ..machine.threads import usable_cores
from ..motion.motion import CANNOT_TELL, PatientMotion, find_motion, taken_out, with_notes
from ..motion.solve import BoneInPlace
from ..progress import Progress, part, report
from ..provenance.record import input_files, with_origin
from ..recipe.recipe import AUTOMATIC, Recipe
from ..registration.labeled_bone import LabeledBone
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import joined, shares
from ..sweep.poses import (
    SweepPoses,
    describe_skipped,
    still_images_of,
    sweep_poses,
    time_order,
    tracked_frames,
)
from ..sweep.still_images import STILL
from .job import BoneSource, ReconstructionJob, ReconstructionOutput

logger = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class ReconstructionPlan:
    """All that is decided before the first frame enters; nothing further down asks anybody.

    Parameters
    ----------
    sequence : TrackedSequence
    asked, settings : Recipe
        As asked for, and with what that leaves open.
    method : str
    parts : ReconstructorParts
    poses : SweepPoses
    order, chosen : arrays of frame numbers
        The frames that are looked at, in the order of time; those of them that have a pose.
    imaging : Imaging
    grid : VoxelGrid
    bone : BoneMap or None
    source : BoneMap, LabeledBone or None
        What was found where bone was asked for: of the same job by another method it is the source.
    messages : tuple of str
        Of the bone that nobody has asked for.
    """

    sequence: TrackedSequence
    asked: Recipe
    settings: Recipe
    method: str
    parts: ReconstructorParts
    poses: SweepPoses
    order: Integers
    chosen: Integers
    imaging: Imaging
    grid: VoxelGrid
    bone: BoneMap | None = None
    source: BoneMap | LabeledBone | None = None
    messages: tuple[str, ...] = ()
    motion: PatientMotion | None = None  #: That is taken out of the sequence

    def costs(self, beside: Collection[str] = BESIDE) -> Costs:
        """What this takes per voxel, in one part and in several."""
        return _costs(self.settings, self.method, self.parts, self.sequence.images.dtype, beside)

    @property
    def memory(self) -> int:
        """Bytes that it takes in one part."""
        return self.grid.voxels * self.costs().whole

    @property
    def region(self) -> ImageRegion:
        """The pixels that enter."""
        return self.imaging.region

    @property
    def hole_limit(self) -> float:
        """How far from a measured voxel holes are filled, mm."""
        return float(self._filling[0].hole_limit)

    @property
    def notes(self) -> tuple[str, ...]:
        """What of the configuration and the scanner's knobs does not go with the images; how holes are filled, and why."""
        imaging = [note for note in self.imaging.notes if not note.startswith(RECOGNIZED)]
        return (*imaging, *self.imaging.gray_levels.notes, *self._filling[1])

    def rows(self) -> list[tuple[str, str]]:
        """The volume in words."""
        grid = self.grid
        extent = " x ".join(f"{n * mm:.0f}" for n, mm in zip(grid.size, grid.spacing, strict=True))
        size, spacing = (" x ".join(f"{n:.4g}" for n in three) for three in (grid.size, grid.spacing))
        corner = ", ".join(f"{mm:.1f}" for mm in np.asarray(grid.origin))
        return [
            ("box", f"{extent} mm, first voxel at {corner} in Reference"),
            ("voxels", f"{size} of {spacing} mm, {grid.voxels / 1e6:.1f} million"),
            ("memory", f"{self.memory / 2**20:.0f} MiB"),
            ("method", self.method),
        ]

    def to_dict(self) -> dict[str, object]:
        """The volume, for JSON."""
        return {
            "method": self.method,
            "size": list(self.grid.size),
            "spacing_mm": [round(float(mm), 6) for mm in self.grid.spacing],
            "ijk_to_reference": self.grid.ijk_to_reference.tolist(),
            "memory_bytes": self.memory,
            "hole_limit_mm": self.hole_limit,
        }

    @cached_property
    def _filling(self) -> tuple[Recipe, tuple[str, ...]]:
        shown = self.region.mask(*self.sequence.frame_size)
        placed = self.poses.image_to_reference[self.chosen][:, :3]
        return with_limit(self.settings, self.parts.holes, placed, shown, self.grid)


# ---- what is decided


def plan(
    sequence: TrackedSequence | Iterable[TrackedSequence],
    recipe: Recipe | None = None,
    *,
    has_bone: bool = False,
    poses: SweepPoses | None = None,
) -> ReconstructionPlan:
    """What `reconstruct` would choose, without looking for bone; it raises the same errors.

    `poses` are those that `sweep_poses` finds, where they are known already.
    """
    recipe = recipe or Recipe()
    return _decided(ReconstructionJob(joined(sequence, recipe), recipe), has_bone, poses)


def planned(job: ReconstructionJob, progress: Progress | None = None) -> ReconstructionPlan:
    """Everything that a job leaves open, decided: where bone is, first of all."""
    report(progress, 0.0, "Looking at the sweep")
    job, motion = without_motion(replace(job, sequence=joined(job.sequence, job.recipe)), progress)
    sequence, asked = job.sequence, job.recipe
    messages: tuple[str, ...] = ()
    with _about(job.bone.name if isinstance(job.bone, BoneSource) else ""):
        bone = source = found_bone(job, progress)
        if isinstance(bone, LabeledBone):
            bone = bone.map(asked.method_for(True), progress)
    if bone is None:
        asked, bone, messages = default_bone(sequence, asked, progress)
    require_kinds(bone=bone)
    require_map_as_asked(asked, bone)
    if bone is not None and "bone_from_sweep" in bone.made:
        messages = known_without_ct(sequence, asked, None if motion is None else motion.echoes)
    if motion is not None and not motion.applied and asked.motion and not any(line.startswith("WARNING") for line in messages):
        messages = (*messages, *motion.lines)
    if motion is None and asked.motion == AUTOMATIC:
        messages = (*messages, f"{CANNOT_TELL[:1].upper()}{CANNOT_TELL[1:]}.")
    found = _decided(replace(job, recipe=asked), bone is not None)
    taken = motion if motion is not None and motion.applied else None
    return replace(found, bone=bone, source=source, messages=messages, motion=taken)


def without_motion(job: ReconstructionJob, progress: Progress | None = None) -> tuple[ReconstructionJob, PatientMotion | None]:
    """The job with the motion of the patient taken out of its sweep, where that is to be done and there is any; and that motion."""
    recipe, source, sequence = job.recipe, job.bone, job.sequence
    has_labels = isinstance(source, Volume | LabeledBone) or (isinstance(source, BoneSource) and source.labels is not None)
    if not takes_out_motion(recipe, sequence.configuration.method if source is None else None):
        return job, None
    labeled = found_bone(job) if has_labels else None
    bone = known = None
    if isinstance(labeled, LabeledBone):
        job, comparison = replace(job, bone=labeled), labeled.comparison(progress)
        bone, known = BoneInPlace(labeled.field, labeled.place), None if comparison is None else comparison.echoes
    motion = find_motion(sequence, bone, recipe, progress, known)
    if motion is None or not motion.applied:
        return job, motion
    mended = taken_out(sequence, motion, recipe)
    source = labeled.seen_by(mended) if isinstance(labeled, LabeledBone) else job.bone
    # The header says it, so that it is done again
    return replace(job, sequence=mended, bone=source, recipe=replace(recipe, motion=AUTOMATIC)), motion


def mended(
    sequence: TrackedSequence | Iterable[TrackedSequence],
    bone: LabeledBone | Volume | None = None,
    recipe: Recipe | None = None,
    progress: Progress | None = None,
) -> TrackedSequence:
    """A recording with the motion of the patient taken out of its poses, by the echoes of bone that its passes show.

    Its notes say what was found. What the passes do not show closely enough is left as it was: see `find_motion`.

    Parameters
    ----------
    sequence : TrackedSequence or several in one Reference
    bone : LabeledBone, Volume of labels in Reference, or None
        A CT's bone, on which all is laid.
    recipe : Recipe or None
        As in `reconstruct`.
    """
    recipe = replace(recipe or Recipe(), motion=AUTOMATIC)
    job, motion = without_motion(ReconstructionJob(joined(sequence, recipe), recipe, bone), progress)
    if motion is None or motion.applied or not motion.lines:
        return job.sequence
    return with_notes(job.sequence, motion.lines)


def found_bone(job: ReconstructionJob, progress: Progress | None = None) -> BoneMap | LabeledBone | None:
    """The bone of a job's source; None where it has none. Of labels a map is made for each method."""
    source = BoneSource() if job.bone is None else job.bone
    sequence, recipe = job.sequence, job.recipe
    if isinstance(source, Volume | LabeledBone):
        labeled = LabeledBone(source) if isinstance(source, Volume) else source
        return labeled.of_sweep(sequence, recipe)
    if not isinstance(source, BoneSource):
        return source
    if source.labels is not None:
        return LabeledBone(source.labels, source.to_reference, sequence, recipe)
    if source.probability is not None:
        return BoneMap.from_probability(source.probability, source.to_reference)
    if source.predictions is not None:
        predicted = RecordedPredictions(sequence, source.predictions, recipe.bone_frames_px)
        return bone_from_frames(sequence, predicted, recipe=recipe, progress=progress)
    if source.model is not None:
        network = OnnxModel(source.model, usable_cores())
        return bone_from_frames(sequence, network, recipe=recipe, progress=progress)
    if recipe.bone_from_sweep and needs_bone(recipe.method_for(True), recipe):
        return bone_from_sweep(sequence, recipe, progress)
    return None


@contextmanager
def _about(name: str) -> Iterator[None]:
    """Errors of geometry say what they are about."""
    try:
        yield
    except GeometryError as error:
        if not name:
            raise
        raise GeometryError(f"{name}: {error}") from error


def _decided(job: ReconstructionJob, has_bone: bool, poses: SweepPoses | None = None) -> ReconstructionPlan:
    sequence, asked = job.sequence, job.recipe
    settings = resolve_settings(asked, sequence.configuration, has_bone)
    parts = reconstructor_parts(asked, settings, sequence.configuration)
    method = settings.method_for(has_bone)
    poses = sweep_poses(sequence, asked.image_to_reference, asked.reference) if poses is None else poses
    poses.require_usable(sequence.name)
    order = time_order(sequence)[:: settings.skip]
    chosen = order[[poses.problems[number] is None for number in order]]
    if not chosen.size:
        what = f"{sequence.name}: none of every {settings.skip}th frames can be placed."
        raise NoUsableFramesError(what, "Use a smaller {skip}.")
    needs_probe = needs_beams(method, settings) or depth_factor(settings) != 1.0
    imaging = resolve_imaging(sequence, poses, needs_probe, asked)
    if method_named(method).needs_shadows:
        settings = replace(settings, gray_levels=imaging.gray_levels.landmarks)
    grid = job.grid or asked.grid
    if grid is None and asked.image_to_reference is None and asked.reference is None:
        grid = parts.grid
    if grid is None:
        costs = _costs(settings, method, parts, sequence.images.dtype, job.beside)
        # Which images stand still is only known once they are read
        placed = poses.image_to_reference[[number for number in order if poses.problems[number] in (None, STILL)]]
        mask = imaging.region.mask(*sequence.frame_size)
        scale = depth_scale(settings, mask, imaging.probe, pixel_spacing(placed[0]))
        box = placed, sequence.frame_size, imaging.region, settings.spacing_xyz()
        grid = grid_around_sweep(*box, costs.results, scale, parts.fits_spacing)
    require_grid_as_asked(asked, grid)
    return ReconstructionPlan(sequence, asked, settings, method, parts, poses, order, chosen, imaging, grid)


def _costs(
    settings: Recipe,
    method: str,
    parts: ReconstructorParts,
    pixels: NumberType,
    beside: Collection[str],
) -> Costs:
    kind = ImageKind((1, 1), pixels)
    whole = kind.is_8_bit and depth_factor(settings) == 1.0
    on_grid, has_shares = bone_on_grid(method, settings), uses_shares(settings, parts.importance)
    asked = method, on_grid, settings.best_cosine, has_shares, whole
    results = bytes_of_results(settings, parts.holes, kind.output_type(settings), beside)
    output = results - 1 - 4 * len({*beside} & {*BESIDE})
    works_in_parts = method_named(method).works_in_parts
    return Costs(bytes_per_voxel(*asked, beside, output), results, part_bytes(*asked, beside), works_in_parts)


# ---- what is done


def reconstruct_job(job: ReconstructionJob, progress: Progress | None = None) -> ReconstructionOutput:
    """Carry out a job.

    Raises AIFReconError, one of its kinds, with a message that says what is wrong, where, and what to do.
    """
    decided = planned(job, part(progress, 0.0, 0.1))
    return execute(decided, job.beside, job.memory, part(progress, 0.1, 1.0))


def execute(
    decided: ReconstructionPlan,
    beside: Collection[str] = BESIDE,
    memory: int | None = None,
    progress: Progress | None = None,
) -> ReconstructionOutput:
    """Make the volume of a plan; `beside` and `memory` as in `reconstruct`."""
    sequence, imaging, settings = decided.sequence, decided.imaging, decided.settings
    costs, memory = decided.costs(beside), memory_to_use(memory)
    cut = cut_into_parts(decided.grid, costs, memory)
    if len(cut) > 1:
        logger.info("%s: %s voxels are worked in %d parts", sequence.name, decided.grid.size, len(cut))
    report(progress, 0.02, "Preparing the volume")
    reconstructor, results, counts, notes = _worked(decided, beside, cut, part(progress, 0.02, 0.95))
    if not counts.inserted:
        what = f"{sequence.name}: no frame falls into the volume ({describe_skipped(counts.skipped)})."
        box = "Check its box ({grid_like}, or the configuration's OutputOrigin and OutputExtent) and {reference}."
        raise NoUsableFramesError(what, box)
    for last in np.cumsum([len(each) for each in sequence.sweeps]) - 1:
        if last not in decided.order or decided.poses.problems[last] is not None:
            # Nobody has looked at the end of the file yet: one that is cut short must not pass unnoticed
            sequence.images[int(last)]
    result = reconstructor.made(results, counts, notes, part(progress, 0.95, 1.0))
    report(progress, 1.0, "Reconstructed")
    told = sequence.name, result.frames_inserted, len(sequence), settings.method, result.grid.size
    logger.info("%s: %d of %d frames by %s into %s voxels", *told)
    gray_notes = imaging.gray_levels.notes if settings.gray_levels else ()
    warnings = dict.fromkeys(warning for each in sequence.sweeps for warning in each.configuration.warnings)
    inputs = input_files(sequence)
    found_width = isinstance(decided.source, LabeledBone) and decided.source.is_automatic(decided.method)
    result = with_origin(result, imaging, decided.asked, settings, sequence.configuration, inputs, found_width)
    before = (*warnings, *decided.parts.notes, *decided.poses.notes, *imaging.notes, *gray_notes)
    result = replace(
        result,
        messages=(*before, *result.messages, *decided.messages),
        sweeps=shares(sequence, decided.order, result.skipped),
    )
    labeled = decided.source if isinstance(decided.source, LabeledBone) else None
    return ReconstructionOutput(result, labeled, decided.sequence, decided.motion)


def tracking_of(job: ReconstructionJob, result: Reconstruction) -> dict[str, TrackingReport]:
    """How each sweep of a job was tracked, by its name."""
    names = job.recipe.image_to_reference, job.recipe.reference
    each = enumerate(zip(result.sweeps, job.sequence.sweeps, strict=True))
    return {share.name: tracking_report(one, sweep_poses(one, *names), result, n) for n, (share, one) in each}


def plain_mean(job: ReconstructionJob, result: Reconstruction, progress: Progress | None = None) -> Volume:
    """The plain mean of the echoes on the voxels of a result, with the same holes filled, of the sweep as it lies."""
    limit = result.hole_limit or job.recipe.hole_limit
    plain = replace(job.recipe, method=AVERAGE.name, best_cosine=False, hole_limit=limit, motion="off")
    measured = ReconstructionJob(job.sequence, plain, None, result.grid, beside=())
    return reconstruct_job(measured, progress).result.intensity


def _worked(
    decided: ReconstructionPlan, beside: Collection[str], cut: list[Planes], progress: Progress | None
) -> tuple[Reconstructor, Results, FrameCounts, tuple[str, ...]]:
    """Insert the frames into one part of the volume after the other; into each but the first those that reach it.

    Frames are read again for every part that they reach. Returns the first part's reconstructor, the results without
    their holes filled, what became of the frames, and what is to be said.
    """
    sequence, parts, imaging, order = decided.sequence, decided.parts, decided.imaging, decided.order
    workers: list[Reconstructor] = []
    results, counts = None, FrameCounts()
    still = still_images_of(sequence, decided.poses, order)
    for number, planes in enumerate(cut):
        step = part(progress, number / len(cut), (number + 1) / len(cut))
        placing = 0.15 if needs_bone(decided.method, decided.settings) else 0.0
        reconstructor = Reconstructor(
            decided.grid,
            decided.settings.left_open(*BEFORE_FRAMES),
            decided.bone,
            probe=imaging.probe,
            region=imaging.region,
            threads=parts.threads,
            importance=parts.importance,
            holes=parts.holes,
            fixed_point=parts.fixed_point,
            beside=beside,
            planes=planes if len(cut) > 1 else None,
            progress=part(step, 0.0, placing),
        )
        if workers:
            reconstructor.lay_out_as(workers[0])
        reaching = frames_of(planes, counts.reached)
        numbers = order if results is None else [n for n in order if n in reaching]
        # Which stand still is told by all of them, not by those that reach another part
        with read_ahead(tracked_frames(sequence, decided.poses, numbers, still if results is None else None)) as frames:
            reconstructor.insert(frames, part(step, placing, 1.0), len(numbers))
        if results is None:
            counts = reconstructor.counts
        else:
            counts.merge(reconstructor.counts, reaching)
        results = reconstructor.put_into(results)
        workers.append(reconstructor)
    rank = {int(number): place for place, number in enumerate(order)}
    counts.skipped = {reason: array("q", sorted(numbers, key=rank.__getitem__)) for reason, numbers in counts.skipped.items()}
    # Beside the whole volume is what is beside every part
    beside_bone = all(BESIDE_BONE in worker.notes for worker in workers)
    notes = tuple(note for note in workers[0].notes if note != BESIDE_BONE or beside_bone)
    if results is None:
        raise ValueError("Input cut must have parts; got none.")
    return workers[0], results, counts, (*notes, *still.notes)
