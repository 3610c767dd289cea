"""A recorded sweep becomes a volume, in one call: what the command line, the Slicer module and scripts use."""

from __future__ import annotations

import logging
from array import array
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

import numpy as np

from .arrays import Integers, NumberType
from .bone.echoes.surface import bone_from_sweep, bone_unasked
from .bone.map import BoneMap
from .calibration.check import known_without_ct
from .compounding.compiled.aside import compiled_aside
from .compounding.finishing.parts import Costs, Planes, cut_into_parts, frames_of, left_beside, memory_to_use
from .compounding.finishing.results import Results, bytes_of_results
from .compounding.intake import ImageKind, require_kinds
from .compounding.methods.table import method_named
from .compounding.needs import bone_on_grid, needs_beams, needs_bone, require_grid_as_asked, require_map_as_asked
from .compounding.reconstructor import BESIDE_BONE, FrameCounts, Reconstructor
from .compounding.splat_engine import uses_shares
from .compounding.state import BESIDE, Reconstruction, bytes_per_voxel, part_bytes
from .errors import NoUsableFramesError
from .geometry.transforms import pixel_spacing
from .geometry.volume import Volume, VoxelGrid
from .holes.automatic import with_limit
from .imaging.extent import grid_around_sweep
from .imaging.region import ImageRegion
from .imaging.sound_speed import depth_factor, depth_scale
from .machine.read_ahead import read_ahead
from .progress import Progress, part, report
from .provenance.record import input_files, with_origin
from .recipe.recipe import Recipe
from .registration.comparison import warn_of_disagreement
from .registration.labeled_bone import LabeledBone
from .resolve import BEFORE_FRAMES, RECOGNIZED, Imaging, ReconstructorParts, reconstructor_parts, resolve_imaging, resolve_settings
from .sweep.frames import TrackedFrame, TrackedSequence
from .sweep.joined import joined, shares
from .sweep.poses import SweepPoses, describe_skipped, still_images_of, sweep_poses, time_order, tracked_frames
from .sweep.still_images import STILL

logger = logging.getLogger(__name__)


def _keeping(frames: Iterable[TrackedFrame], kept: dict[int, TrackedFrame]) -> Iterable[TrackedFrame]:
    """The same frames, each kept by its number."""
    for frame in frames:
        kept[frame.number] = frame
        yield frame


@dataclass(frozen=True, eq=False)
class _Prepared:
    """What a reconstruction does, before it does it."""

    settings: Recipe
    parts: ReconstructorParts
    poses: SweepPoses
    order: Integers
    chosen: Integers
    imaging: Imaging
    uses_bone: bool
    grid: VoxelGrid
    costs: Costs


def _prepare(
    sequence: TrackedSequence,
    asked: Recipe,
    has_bone: bool,
    grid: VoxelGrid | None = None,
    beside: Collection[str] = BESIDE,
    poses: SweepPoses | None = None,
) -> _Prepared:
    """Everything that is chosen before the first frame enters; the arguments are those of `reconstruct` and `plan`."""
    settings = resolve_settings(asked, sequence.configuration, has_bone)
    parts = reconstructor_parts(asked, settings, sequence.configuration)
    method = settings.method_for(has_bone)
    poses = sweep_poses(sequence, asked.image_to_reference, asked.reference) if poses is None else poses
    poses.require_usable(sequence.name)
    order = time_order(sequence)[:: settings.skip]
    chosen = order[[poses.problems[number] is None for number in order]]
    if not chosen.size:
        raise NoUsableFramesError(f"{sequence.name}: none of every {settings.skip}th frames can be placed.", "Use a smaller {skip}.")
    uses_beams, uses_bone = needs_beams(method, settings), needs_bone(method, settings)
    imaging = resolve_imaging(sequence, poses, uses_beams or depth_factor(settings) != 1.0, asked)
    if method_named(method).needs_shadows:
        settings = replace(settings, gray_levels=imaging.gray_levels.landmarks)
    costs = _costs(settings, method, parts, sequence.images.dtype, beside)
    if grid is None:
        grid = asked.grid or (parts.grid if asked.image_to_reference is None and asked.reference is None else None)
    if grid is None:
        # Which images stand still is only known once they are read
        placed = poses.image_to_reference[[number for number in order if poses.problems[number] in (None, STILL)]]
        scale = depth_scale(settings, imaging.region.mask(*sequence.frame_size), imaging.probe, pixel_spacing(placed[0]))
        grid = grid_around_sweep(
            placed, sequence.frame_size, imaging.region, settings.spacing_xyz(), costs.results, scale, parts.fits_spacing
        )
    require_grid_as_asked(asked, grid)
    return _Prepared(settings, parts, poses, order, chosen, imaging, uses_bone, grid, costs)


def _costs(settings: Recipe, method: str, parts: ReconstructorParts, pixels: NumberType, beside: Collection[str]) -> Costs:
    """What this takes per voxel, in one part and in several."""
    kind = ImageKind((1, 1), pixels)
    whole = kind.is_8_bit and depth_factor(settings) == 1.0
    asked = method, bone_on_grid(method, settings), settings.best_cosine, uses_shares(settings, parts.importance), whole
    results = bytes_of_results(settings, parts.holes, kind.output_type(settings), beside)
    output = results - 1 - 4 * len({*beside} & {*BESIDE})
    works_in_parts = method_named(method).works_in_parts
    return Costs(bytes_per_voxel(*asked, beside, output), results, part_bytes(*asked, beside), works_in_parts)


@dataclass(frozen=True, eq=False)
class Plan:
    """What `reconstruct` would make of a sweep.

    Parameters
    ----------
    method : str
    grid : VoxelGrid
    memory : int
        Bytes that it takes.
    hole_limit : float, mm
    notes : tuple of str
        What of the configuration does not go with the images; what their gray levels tell of the scanner's knobs; how holes are
        filled, and why.
    region : ImageRegion
        The pixels that enter.
    """

    method: str
    grid: VoxelGrid
    memory: int
    hole_limit: float
    notes: tuple[str, ...]
    region: ImageRegion


def plan(
    sequence: TrackedSequence | Iterable[TrackedSequence],
    recipe: Recipe | None = None,
    *,
    has_bone: bool = False,
    poses: SweepPoses | None = None,
) -> Plan:
    """What `reconstruct` with these arguments would choose, without reconstructing; it raises the same errors.

    `poses` are those that `sweep_poses` finds, where they are known already.
    """
    recipe = recipe or Recipe()
    sequence = joined(sequence, recipe)
    prepared = _prepare(sequence, recipe, has_bone, poses=poses)
    shown = prepared.imaging.region.mask(*sequence.frame_size)
    placed = prepared.poses.image_to_reference[prepared.chosen][:, :3]
    chosen, notes = with_limit(prepared.settings, prepared.parts.holes, placed, shown, prepared.grid)
    memory = prepared.grid.voxels * prepared.costs.whole
    imaging = [note for note in prepared.imaging.notes if not note.startswith(RECOGNIZED)]
    notes = (*imaging, *prepared.imaging.gray_levels.notes, *notes)
    return Plan(prepared.settings.method_for(has_bone), prepared.grid, memory, float(chosen.hole_limit), notes, prepared.imaging.region)


def _worked(
    sequence: TrackedSequence,
    prepared: _Prepared,
    bone: BoneMap | None,
    beside: Collection[str],
    cut: list[Planes],
    left: float,
    progress: Progress | None,
) -> tuple[Reconstructor, Results, FrameCounts, tuple[str, ...]]:
    """Insert the frames into one part of the volume after the other: all of them into the first, those that reach it into each other.

    Frames are read once where their images fit into the `left` bytes of the memory, else again for every part that they reach. Returns
    the first part's reconstructor, the results without their holes filled, what became of the frames, and what is to be said.
    """
    parts, imaging, grid = prepared.parts, prepared.imaging, prepared.grid
    workers: list[Reconstructor] = []
    results, counts = None, FrameCounts()
    kept: dict[int, TrackedFrame] = {}
    still = still_images_of(sequence, prepared.poses, prepared.order)
    columns, rows = sequence.frame_size
    keeps = len(cut) > 1 and len(prepared.chosen) * columns * rows * sequence.images.dtype.itemsize <= left
    for number, planes in enumerate(cut):
        step = part(progress, number / len(cut), (number + 1) / len(cut))
        placing = 0.15 if prepared.uses_bone else 0.0
        reconstructor = Reconstructor(
            grid,
            prepared.settings.left_open(*BEFORE_FRAMES),
            bone,
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
        reaching = frames_of(planes, counts.reached)
        order = prepared.order if results is None else [n for n in prepared.order if n in reaching]
        tell = part(step, placing, 1.0)
        if kept:
            reconstructor.insert((kept[n] for n in order), tell, len(order))
        else:
            # Which stand still is told by all of them, not by those that reach another part
            with read_ahead(tracked_frames(sequence, prepared.poses, order, still if results is None else None)) as read:
                frames = _keeping(read, kept) if keeps else read
                reconstructor.insert(frames, tell, len(order))
        if results is None:
            counts = reconstructor.counts
        else:
            counts.merge(reconstructor.counts, reaching)
        results = reconstructor.put_into(results)
        workers.append(reconstructor)
    rank = {int(number): place for place, number in enumerate(prepared.order)}
    counts.skipped = {reason: array("q", sorted(numbers, key=rank.__getitem__)) for reason, numbers in counts.skipped.items()}
    # Beside the whole volume is what is beside every part
    beside_bone = all(BESIDE_BONE in worker.notes for worker in workers)
    notes = tuple(note for note in workers[0].notes if note != BESIDE_BONE or beside_bone)
    if results is None:
        raise ValueError("Input cut must have parts; got none.")
    return workers[0], results, counts, (*notes, *still.notes)


def reconstruct(
    sequence: TrackedSequence | Iterable[TrackedSequence],
    recipe: Recipe | None = None,
    bone: BoneMap | LabeledBone | Volume | None = None,
    grid: VoxelGrid | None = None,
    *,
    beside: Collection[str] = BESIDE,
    memory: int | None = None,
    progress: Progress | None = None,
) -> Reconstruction:
    """Reconstruct a volume from one or more recorded sequences.

    Parameters
    ----------
    sequence : TrackedSequence or several in one Reference
        As `read_sequence` returns it; its configuration gives what the recipe leaves open. Several enter in the order given, each placed by
        its own configuration's transforms; the first one's says how the volume is made.
    recipe : Recipe
        Each of its settings is obeyed, or named in a note where it does not concern the method, or refused: what says how a file is read
        (`orientation`, `time_offset`, `longest_gap`) where that was read otherwise, what says how a bone map is made where there is one.
    bone : BoneMap, LabeledBone, Volume of labels, or None
        Needed by methods that weight by incidence. Of labels (in Reference; `LabeledBone` takes the CT's transform) the map is made here:
        as wide as CT and sweep agree, and a `DisagreementWarning` tells where they do not. Without any it is the sweep's own
        (`bone_from_sweep`) where the recipe asks for that, or where neither it nor a configuration names a method and the images show bone;
        a note says which.
    grid : VoxelGrid or None
        Where to reconstruct; by default the recipe's, else the configuration's box, else the one around the sweep, along Reference's axes.
    beside : names of "score" and "hits"
        Which of these are made beside intensity and mask; none leaves their memory free.
    memory : int or None
        Bytes that the volumes may take, by default three quarters of what is free. A box that needs more is worked in parts, with the same
        voxels; what is made of them must fit.
    progress : Progress or None

    Returns
    -------
    Reconstruction
        Its volumes say in the headers of their files how they were made, by which it can be repeated.

    Raises
    ------
    AIFReconError
        One of its kinds, with a message that says what is wrong, where, and what to do. Inputs are untouched.
    """
    require_kinds(recipe=recipe, grid=grid)
    asked = recipe or Recipe()
    sequence = joined(sequence, asked)
    if isinstance(bone, LabeledBone | Volume):
        labeled = (LabeledBone(bone) if isinstance(bone, Volume) else bone).of_sweep(sequence, asked)
        with compiled_aside(asked, sequence.images.dtype):
            bone = labeled.map(asked.method_for(True), part(progress, 0.0, 0.1))
            result = reconstruct(sequence, recipe, bone, grid, beside=beside, memory=memory, progress=part(progress, 0.1, 1.0))
        warn_of_disagreement(labeled.comparison())
        return replace(result, said=(*result.said, *labeled.labels.notes, *labeled.lines(result.method)))
    report(progress, 0.0, "Looking at the sweep")
    unasked: tuple[str, ...] = ()
    if bone is None and asked.bone_from_sweep and needs_bone(asked.method_for(True), asked):
        bone = bone_from_sweep(sequence, asked, part(progress, 0.0, 0.1))
    elif bone is None:
        asked, bone, unasked = bone_unasked(sequence, asked, part(progress, 0.0, 0.1))
    require_kinds(bone=bone)
    require_map_as_asked(asked, bone)
    if bone is not None and "bone_from_sweep" in bone.made:
        unasked = known_without_ct(sequence, asked)
    progress = part(progress, 0.1, 1.0)
    prepared = _prepare(sequence, asked, bone is not None, grid, beside)
    settings, order, imaging = prepared.settings, prepared.order, prepared.imaging
    memory = memory_to_use(memory)
    cut = cut_into_parts(prepared.grid, prepared.costs, memory)
    left = left_beside(prepared.grid, prepared.costs, cut, memory)
    if len(cut) > 1:
        logger.info("%s: %s voxels are worked in %d parts", sequence.name, prepared.grid.size, len(cut))
    report(progress, 0.02, "Preparing the volume")
    reconstructor, results, counts, notes = _worked(sequence, prepared, bone, beside, cut, left, part(progress, 0.02, 0.95))
    if not counts.inserted:
        raise NoUsableFramesError(
            f"{sequence.name}: no frame falls into the volume ({describe_skipped(counts.skipped)}).",
            ("Check its box ({grid_like}, or the configuration's OutputOrigin and OutputExtent) and {reference}."),
        )
    for last in np.cumsum([len(each) for each in sequence.sweeps]) - 1:
        if last not in order or prepared.poses.problems[last] is not None:
            # Nobody has looked at the end of the file yet: one that is cut short or of another size must not pass unnoticed
            sequence.images[int(last)]
    result = reconstructor.made(results, counts, notes, part(progress, 0.95, 1.0))
    report(progress, 1.0, "Reconstructed")
    size, inserted = result.grid.size, result.frames_inserted
    logger.info("%s: %d of %d frames by %s into %s voxels", sequence.name, inserted, len(sequence), settings.method, size)
    gray_notes = imaging.gray_levels.notes if settings.gray_levels else ()
    warnings = dict.fromkeys(warning for each in sequence.sweeps for warning in each.configuration.warnings)
    result = with_origin(result, imaging, asked, settings, sequence.configuration, input_files(sequence))
    return replace(
        result,
        said=(*warnings, *prepared.parts.notes, *prepared.poses.notes, *imaging.notes, *gray_notes, *result.said, *unasked),
        sweeps=shares(sequence, order, result.skipped),
    )
