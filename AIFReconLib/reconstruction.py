"""A recorded sweep becomes a volume, in one call: what the command line, the Slicer module and scripts use."""

from __future__ import annotations

import logging
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from .arrays import Integers, Reals
from .bone.map import BoneMap
from .compounding.intake import require_kinds
from .compounding.needs import needs_beams, needs_bone
from .compounding.reconstructor import Reconstructor
from .compounding.splat_engine import uses_shares
from .compounding.state import Reconstruction, bytes_per_voxel
from .errors import NoUsableFramesError
from .geometry.transforms import pixel_spacing
from .geometry.volume import VoxelGrid
from .holes.automatic import with_limit
from .imaging.beams import ProbeGeometry
from .imaging.extent import grid_around_sweep
from .imaging.region import ImageRegion
from .imaging.sound_speed import depth_factor, depth_scale
from .machine.read_ahead import read_ahead
from .progress import Progress, part, report
from .provenance.record import input_files, with_origin
from .resolve import Imaging, ReconstructorParts, reconstructor_parts, resolve_imaging, resolve_settings
from .settings import ReconstructionSettings
from .sweep.frames import TrackedFrame, TrackedSequence
from .sweep.joined import joined, shares
from .sweep.poses import SweepPoses, describe_skipped, sweep_poses, time_order, tracked_frames

logger = logging.getLogger(__name__)


def _reporting(frames: Iterable[TrackedFrame], count: int, progress: Progress | None) -> Iterable[TrackedFrame]:
    """The same frames, with a report before each."""
    for done, frame in enumerate(frames):
        report(progress, done / count, "Reconstructing")
        yield frame


@dataclass(frozen=True, eq=False)
class _Prepared:
    """What a reconstruction does, before it does it."""

    settings: ReconstructionSettings
    parts: ReconstructorParts
    poses: SweepPoses
    order: Integers
    chosen: Integers
    imaging: Imaging
    uses_bone: bool
    grid: VoxelGrid
    bytes_per_voxel: int


def _prepare(
    sequence: TrackedSequence,
    asked: ReconstructionSettings | None,
    has_bone: bool,
    grid: VoxelGrid | None,
    region: ImageRegion | None,
    probe: ProbeGeometry | None,
    importance: Reals | None,
    image_to_reference: str | None,
    reference: str | None,
) -> _Prepared:
    """Everything that is chosen before the first frame enters; the arguments are those of `reconstruct`."""
    asked = asked or ReconstructionSettings()
    settings = resolve_settings(asked, sequence.configuration, has_bone, importance is not None)
    parts = reconstructor_parts(asked, settings, sequence.configuration, importance)
    method = settings.method_for(has_bone)
    poses = sweep_poses(sequence, image_to_reference, reference)
    poses.require_usable(sequence.name)
    order = time_order(sequence)[:: settings.skip]
    chosen = order[[poses.problems[number] is None for number in order]]
    if not chosen.size:
        raise NoUsableFramesError(
            "{sequence}: none of every {skip}th frames can be placed. Use a smaller --skip.", sequence=sequence.name, skip=settings.skip
        )
    uses_beams, uses_bone = needs_beams(method, settings), needs_bone(method, settings)
    imaging = resolve_imaging(sequence, poses, uses_beams or depth_factor(settings) != 1.0, region, probe)
    cost = bytes_per_voxel(method, uses_bone, settings.best_cosine, uses_shares(settings, parts.importance))
    if grid is None and parts.grid is not None and image_to_reference is None and reference is None:
        grid = parts.grid
    if grid is None:
        placed = poses.image_to_reference[chosen]
        scale = depth_scale(settings, imaging.region.mask(*sequence.frame_size), imaging.probe, pixel_spacing(placed[0]))
        grid = grid_around_sweep(placed, sequence.frame_size, imaging.region, settings.spacing_xyz(), cost, scale, parts.fits_spacing)
    return _Prepared(settings, parts, poses, order, chosen, imaging, uses_bone, grid, cost)


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
        How holes are filled, and why.
    """

    method: str
    grid: VoxelGrid
    memory: int
    hole_limit: float
    notes: tuple[str, ...]


def plan(
    sequence: TrackedSequence | Iterable[TrackedSequence],
    settings: ReconstructionSettings | None = None,
    *,
    has_bone: bool = False,
    image_to_reference: str | None = None,
    reference: str | None = None,
) -> Plan:
    """What `reconstruct` with these arguments would choose, without reconstructing; it raises the same errors."""
    sequence = joined(sequence)
    prepared = _prepare(sequence, settings, has_bone, None, None, None, None, image_to_reference, reference)
    shown = prepared.imaging.region.mask(*sequence.frame_size)
    poses = prepared.poses.image_to_reference[prepared.chosen][:, :3]
    chosen, notes = with_limit(prepared.settings, prepared.parts.holes, poses, shown, prepared.grid)
    memory = prepared.grid.voxels * prepared.bytes_per_voxel
    return Plan(prepared.settings.method_for(has_bone), prepared.grid, memory, float(chosen.hole_limit), notes)


def reconstruct(
    sequence: TrackedSequence | Iterable[TrackedSequence],
    settings: ReconstructionSettings | None = None,
    bone: BoneMap | None = None,
    grid: VoxelGrid | None = None,
    *,
    region: ImageRegion | None = None,
    probe: ProbeGeometry | None = None,
    importance: Reals | None = None,
    image_to_reference: str | None = None,
    reference: str | None = None,
    progress: Progress | None = None,
) -> Reconstruction:
    """Reconstruct a volume from one or more recorded sequences.

    Parameters
    ----------
    sequence : TrackedSequence or several in one Reference
        As `read_sequence` returns it; its configuration gives what the other arguments leave open. Several enter in the order given, each
        placed by its own configuration's transforms; the first one's says how the volume is made.
    settings : ReconstructionSettings
    bone : BoneMap or None
        Needed by methods that weight by incidence.
    grid : VoxelGrid or None
        Where to reconstruct; by default the configuration's box, else the one around the sweep, along the axes of Reference.
    region, probe : ImageRegion, ProbeGeometry or None
        Override the configuration and what the images show.
    importance : (rows, columns) array, 0 to 1, or None
        Weight of each pixel in an average, as `read_importance_mask` returns it; by default the configuration's.
    image_to_reference, reference : str or None
        See `sweep_poses`.
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
    require_kinds(settings=settings, bone=bone, grid=grid, region=region, probe=probe)
    sequence = joined(sequence)
    asked = settings or ReconstructionSettings()
    report(progress, 0.0, "Looking at the sweep")
    prepared = _prepare(sequence, asked, bone is not None, grid, region, probe, importance, image_to_reference, reference)
    settings, parts, poses, order, imaging = prepared.settings, prepared.parts, prepared.poses, prepared.order, prepared.imaging
    grid = prepared.grid
    report(progress, 0.02, "Preparing the volume")
    bone_part = 0.15 if prepared.uses_bone else 0.02
    reconstructor = Reconstructor(
        grid,
        settings,
        bone,
        probe=imaging.probe,
        region=imaging.region,
        threads=parts.threads,
        importance=parts.importance,
        holes=parts.holes,
        fixed_point=parts.fixed_point,
        progress=part(progress, 0.02, bone_part),
    )
    inserting = part(progress, bone_part, 0.95)
    with read_ahead(tracked_frames(sequence, poses, order)) as frames:
        reconstructor.insert(_reporting(frames, len(order), inserting))
    if not reconstructor.counts.inserted:
        raise NoUsableFramesError(
            "{sequence}: no frame falls into the volume ({reasons}). "
            "Check its box (--grid-like, or the configuration's OutputOrigin and OutputExtent) and --reference.",
            sequence=sequence.name,
            reasons=describe_skipped(reconstructor.counts.skipped),
        )
    for last in np.cumsum([len(each) for each in sequence.parts]) - 1:
        if last not in order or poses.problems[last] is not None:
            # Nobody has looked at the end of the file yet: one that is cut short or of another size must not pass unnoticed
            sequence.images[int(last)]
    result = reconstructor.finish(part(progress, 0.95, 1.0))
    report(progress, 1.0, "Reconstructed")
    logger.info(
        "%s: %d of %d frames by %s into %s voxels", sequence.name, result.frames_inserted, len(sequence), settings.method, grid.size
    )
    warnings = dict.fromkeys(warning for each in sequence.parts for warning in each.configuration.warnings)
    result = with_origin(
        result,
        imaging,
        asked=asked,
        resolved=settings,
        configuration=sequence.configuration,
        inputs=input_files(sequence),
        image_to_reference=image_to_reference,
        reference=reference,
    )
    return replace(
        result,
        said=(*warnings, *parts.notes, *poses.notes, *imaging.notes, *result.said),
        sweeps=shares(sequence, order, result.skipped),
    )
