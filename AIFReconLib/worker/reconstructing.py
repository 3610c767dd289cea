"""A reconstruction as a program with windows asks for it: plain values come in, and all that is shown of it goes back in one piece.

What computes is imported where it is used: who asks does not load it.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Floats
from ..compounding.methods.method import CompoundingMethod
from ..compounding.methods.table import COMPARED_METHODS, is_own_method, method_named
from ..compounding.state import Reconstruction
from ..errors import AIFReconError, BeamGeometryError, InsufficientMemoryError, MethodError, OperationCanceled
from ..geometry.transforms import pixel_spacing, transform_points
from ..geometry.volume import Volume
from ..imaging.beams import ProbeGeometry
from ..imaging.region import ImageRegion, extreme_pixels
from ..inspection.bone_surface import ShownBoneMesh, bone_surface
from ..inspection.summary import summary_lines
from ..message import Spelling, advised, as_argument
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..sweep.frames import TrackedSequence
from ..sweep.poses import sweep_poses
from ..workflows.job import BoneSource, ReconstructionJob, ReconstructionOutput, ScanJob
from .scanning import shown_of

if TYPE_CHECKING:
    from ..evaluation.quantities import BoneMetrics
    from ..registration.labeled_bone import LabeledBone
    from .scan import Scan

FOR_VIEWS = ("score", "hits")
"""What of a reconstruction tells where it shows bone."""


def reconstructed(
    job: ReconstructionJob,
    keep: Collection[str] = (),
    for_views: bool = False,
    words: Spelling = as_argument,
    progress: Progress | None = None,
) -> ReconstructionOutput:
    """Carry out a job, and make what is shown of it.

    Parameters
    ----------
    keep : names of "score", "hits", "cosine"
        Volumes that are wanted beside intensity and mask.
    for_views : bool
        Whether plain echoes and the surface of bone are made too, where the method weights by bone and memory allows; the score is kept
        then, which tells what was seen.
    words : mapping
        What to do about what is said.
    """
    from ..workflows.reconstruct import execute, plain_mean, planned, tracking_of

    know_method(job.recipe.method, job.search_path)
    wanted = [name for name in FOR_VIEWS if name in keep]
    decided = planned(replace(job, beside=wanted), part(progress, 0.0, 0.1))
    weighs_by_bone = method_named(decided.method).needs_bone
    wished = FOR_VIEWS if for_views and weighs_by_bone else ()
    share = part(progress, 0.1, 0.75)
    try:
        output = execute(decided, sorted({*wanted, *wished}), progress=share)
    except InsufficientMemoryError:
        if not wished:
            raise
        output = execute(decided, wanted, progress=share)
    result, labeled = output.result, output.labeled
    lines = summary_lines(result, len(job.sequence), spelling=words)
    comparison = None if labeled is None else labeled.comparison(part(progress, 0.75, 0.8))
    if labeled is not None and comparison is not None and labeled.is_automatic(result.method):
        lines += [advised(line, words) for line in labeled.lines(result.method)[len(comparison.lines) :]]
    measured = surface = None
    if wished:
        try:
            measured = plain_mean(replace(job, sequence=decided.sequence), result, part(progress, 0.8, 0.9))
            surface = _surface(result, labeled, part(progress, 0.9, 0.95))
        except OperationCanceled:
            raise
        except AIFReconError as error:
            lines.append(f"The plain echo and the bone in 3D were not made. {error}")
    report(progress, 1.0, "Reconstructed")
    kept = shown_of(result, {*keep, "score"} if for_views else keep)
    motion = None if decided.motion is None else replace(decided.motion, echoes=None)
    return ReconstructionOutput(kept, None, None, motion, tracking_of(job, result), tuple(lines), comparison, measured, surface)


@dataclass(frozen=True, eq=False)
class _Compared:
    """What methods made of the same sweep, by their names."""

    results: dict[str, Reconstruction]
    metrics: dict[str, BoneMetrics]  #: Nothing where the bone has no surface
    lines: tuple[str, ...]


def compared_methods(
    job: ReconstructionJob, labels: Volume | None = None, words: Spelling = as_argument, progress: Progress | None = None
) -> _Compared:
    """Reconstruct with each of the methods that are compared, in turn, and measure the volumes against `labels` in Reference."""
    from ..workflows.reconstruct import execute, planned
    from .evaluating import measured_volumes

    results: dict[str, Reconstruction] = {}
    for number, method in enumerate(COMPARED_METHODS):
        share = part(progress, *(0.7 * n / len(COMPARED_METHODS) for n in (number, number + 1)))
        recipe = replace(job.recipe, method=method)
        decided = planned(replace(job, recipe=recipe, beside=FOR_VIEWS), part(share, 0.0, 0.1))
        # Looked for once for all methods
        job = replace(job, bone=decided.source, sequence=decided.sequence)
        results[method] = execute(decided, FOR_VIEWS, progress=part(share, 0.1, 1.0)).result
    metrics: dict[str, BoneMetrics] = {}
    if labels is not None:
        # Every method fills the same voxels, so one mask tells for all of them
        mask = next(iter(results.values())).mask
        volumes = {method: result.intensity for method, result in results.items()}
        metrics = measured_volumes(volumes, labels, job.sequence, mask, job.recipe, part(progress, 0.7, 1.0))
    lines = [summary_lines(result, len(job.sequence), spelling=words)[0] for result in results.values()]
    return _Compared({method: shown_of(result) for method, result in results.items()}, metrics, tuple(lines))


def imaging_of(sequence: TrackedSequence, needs_probe: bool, recipe: Recipe) -> tuple[ProbeGeometry | None, ImageRegion]:
    """Probe and region as a reconstruction would use them; the probe is looked for in the images where it is needed.

    Raises AIFReconError when no frame can be placed, or nothing tells what is needed.
    """
    from ..effective_settings import resolve_imaging

    poses = sweep_poses(sequence)
    poses.require_usable(sequence.name)
    imaging = resolve_imaging(sequence, poses, needs_probe, recipe)
    return imaging.probe, imaging.region


def recognized_clip(sequence: TrackedSequence) -> tuple[float, ...]:
    """First column and row, width and height, in pixels, of the upright rectangle of ultrasound that is recognized in the images.

    Raises AIFReconError when no frame can be placed, nothing is recognized, or a sector, which needs no rectangle.
    """
    from ..imaging.recognized import recognized

    poses = sweep_poses(sequence)
    first = poses.require_usable(sequence.name)[0]
    seen = recognized(sequence.images, pixel_spacing(poses.image_to_reference[first]))
    clip = seen.region.clip
    if clip is None or seen.region.fan is not None:
        raise BeamGeometryError(f"{sequence.name}: {seen.description} was recognized, whose pixels are told by it; no rectangle is needed.")
    return (*clip.origin_px, *clip.size_px)


def corners_of_sweep(sequence: TrackedSequence, recipe: Recipe) -> tuple[Floats, Floats]:
    """Least and most coordinates in Reference, (3,) mm each, of the pixels that count."""
    _probe, region = imaging_of(sequence, False, recipe)
    pixels = extreme_pixels(region.mask(*sequence.frame_size))
    corners = np.column_stack([pixels, np.zeros(len(pixels))])
    poses = sweep_poses(sequence)
    points = np.concatenate([transform_points(poses.image_to_reference[number], corners) for number in poses.usable])
    return points.min(axis=0), points.max(axis=0)


@cache
def warm_up() -> None:
    """Load what computes, and compile what is not kept compiled, so that the first call waits for neither."""
    for name in ("evaluation.metrics", "registration.registration", "guidance.guidance", "simulation.scan"):
        importlib.import_module(f"AIFReconLib.{name}")
    poses = np.tile(np.eye(4), (8, 1, 1))
    poses[:, 2, 3] = np.arange(8)
    images = np.zeros((8, 32, 32), np.uint8)
    images[:, 20] = 200
    labels = np.zeros((8, 40, 40), np.uint8)
    labels[:, 20:30, 4:28] = 1
    sequence = TrackedSequence.from_arrays(images, poses, spacing=1.0)
    bone = BoneSource(Volume(labels, np.eye(4)))
    reconstructed(ReconstructionJob(sequence, Recipe(spacing=1.0, probe="linear"), bone), FOR_VIEWS, for_views=True)


def know_method(name: str | CompoundingMethod | None, search_path: Collection[str] = ()) -> None:
    """Import the file of a method of the user's own, anew if that was done before: it may have been changed since.

    Raises MethodError when it is in no file, or cannot be imported from any of these folders.
    """
    if not isinstance(name, str) or not is_own_method(name):
        return
    module = name.partition(":")[0]
    if module == "__main__":
        raise MethodError(f"Method {name} was written into the console. Write it into a file, and import that.")
    sys.path.extend(folder for folder in search_path if folder not in sys.path)
    try:
        if module in sys.modules:
            importlib.reload(sys.modules[module])
        else:
            importlib.import_module(module)
    except Exception as error:
        raise MethodError(f"Method {name} cannot be had: {error}. Correct its file.") from error


def begin_scan(job: ScanJob, progress: Progress | None = None) -> Scan:
    """Begin a live scan; to be kept in the worker."""
    from .scan import Scan

    know_method(job.recipe.method, job.search_path)
    return Scan(job, progress)


def _surface(result: Reconstruction, labeled: LabeledBone | None, progress: Progress | None) -> ShownBoneMesh | None:
    """The bone that a result shows, for 3D; None of one without score and hits."""
    from ..inspection.shown_bone import shown_bone

    if result.score is None or result.hits is None:
        return None
    report(progress, 0.0, "Drawing the bone")
    shown = shown_bone(result) if labeled is None else shown_bone(result, labeled.labels, labeled.labels_to_reference)
    report(progress, 0.6, "Drawing the bone")
    return bone_surface(shown)
