"""A reconstruction as a program with windows asks for it: plain values come in, and all that is shown of it goes back in one piece.

What computes is imported where it is used: who asks does not load it.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Floats, Matrix
from ..compounding.methods.average import AVERAGE
from ..compounding.methods.table import COMPARED_METHODS, is_own_method, method_named
from ..compounding.state import Reconstruction
from ..errors import AIFReconError, BeamGeometryError, GeometryError, InsufficientMemoryError, MethodError, OperationCanceled
from ..geometry.transforms import pixel_spacing, transform_points
from ..geometry.volume import Volume, VoxelGrid
from ..imaging.beams import ProbeGeometry
from ..imaging.region import ImageRegion, extreme_pixels
from ..inspection.bone_surface import ShownSurface, bone_surface
from ..inspection.summary import summary_lines
from ..inspection.tracking_report import TrackingReport, tracking_report
from ..message import Spelling, advised, as_argument
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..sweep.frames import TrackedSequence
from ..sweep.poses import sweep_poses

if TYPE_CHECKING:
    from ..bone.map import BoneMap
    from ..evaluation.quantities import BoneMetrics
    from ..registration.agreement import Comparison
    from ..registration.labeled_bone import LabeledBone

FOR_VIEWS = ("score", "hits")
"""What of a reconstruction tells where it shows bone."""


@dataclass(frozen=True, eq=False)
class PlacedBone:
    """Bone as somebody gives it: labels, or its probability."""

    volume: Volume
    to_reference: Matrix  #: (4, 4), mm. From the volume's own coordinates
    name: str = ""  #: What errors call it
    is_labeled: bool = True


@dataclass(frozen=True, eq=False)
class Asked:
    """What is to be reconstructed, and of what."""

    sequence: TrackedSequence
    recipe: Recipe = field(default_factory=Recipe)
    grid: VoxelGrid | None = None
    bone: PlacedBone | None = None  #: Where the frames say where bone is, it only judges what comes of it
    predictions: TrackedSequence | None = None  #: What a network has said of the frames
    model: Path | None = None  #: A network in a file
    search_path: tuple[str, ...] = ()  #: Folders in which a method of the user's own is looked for

    @property
    def sees_bone(self) -> bool:
        """Whether the frames themselves say where bone is."""
        return self.recipe.bone_from_sweep or self.predictions is not None or self.model is not None


@dataclass(frozen=True, eq=False)
class Made:
    """What became of it."""

    result: Reconstruction  #: With the volumes that are kept
    tracking: TrackingReport  #: Of the first sweep
    lines: tuple[str, ...]  #: What was done, in the words of who asked
    comparison: Comparison | None = None  #: Of CT and sweep, where bone is labeled
    measured: Volume | None = None  #: The plain mean of the echoes, on the same voxels
    surface: ShownSurface | None = None  #: Of the bone that shows


def reconstructed(
    asked: Asked,
    keep: Collection[str] = (),
    for_views: bool = False,
    words: Spelling = as_argument,
    progress: Progress | None = None,
) -> Made:
    """Reconstruct what is asked for.

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
    know_method(asked.recipe.method, asked.search_path)
    bone, labeled = _bone_of(asked, part(progress, 0.0, 0.1))
    unasked: tuple[str, ...] = ()
    if bone is None and labeled is None:
        from ..bone.echoes.surface import bone_unasked

        recipe, bone, unasked = bone_unasked(asked.sequence, asked.recipe, part(progress, 0.0, 0.1))
        asked = replace(asked, recipe=recipe)
    has_bone = bone is not None or labeled is not None
    method = method_named(asked.recipe.method_for(has_bone))
    wanted = [name for name in FOR_VIEWS if name in keep]
    wished = FOR_VIEWS if for_views and method.needs_bone else ()
    share = part(progress, 0.1, 0.75)
    try:
        result = _one(asked, asked.recipe, bone, labeled, sorted({*wanted, *wished}), share)
    except InsufficientMemoryError:
        if not wished:
            raise
        result = _one(asked, asked.recipe, bone, labeled, wanted, share)
    lines = summary_lines(replace(result, said=(*result.said, *unasked)), len(asked.sequence), spelling=words)
    comparison = None if labeled is None else labeled.comparison(part(progress, 0.75, 0.8))
    if labeled is not None and comparison is not None and labeled.is_automatic(result.method):
        lines += [advised(line, words) for line in labeled.lines(result.method)[len(comparison.lines) :]]
    measured = surface = None
    if for_views and method_named(result.method).needs_bone:
        try:
            measured = plain_mean(asked.sequence, asked.recipe, result, part(progress, 0.8, 0.9))
            surface = _surface(result, labeled, part(progress, 0.9, 0.95))
        except OperationCanceled:
            raise
        except AIFReconError as error:
            lines.append(f"The plain echo and the bone in 3D were not made. {error}")
    first = asked.sequence.sweeps[0]
    tracking = tracking_report(first, sweep_poses(first), result)
    report(progress, 1.0, "Reconstructed")
    return Made(_with(result, {*keep, "score"} if for_views else keep), tracking, tuple(lines), comparison, measured, surface)


@dataclass(frozen=True, eq=False)
class Compared:
    """What methods made of the same sweep, by their names."""

    results: dict[str, Reconstruction]
    metrics: dict[str, BoneMetrics]  #: Nothing where the bone has no surface
    lines: tuple[str, ...]


def compared_methods(
    asked: Asked, labels: Volume | None = None, words: Spelling = as_argument, progress: Progress | None = None
) -> Compared:
    """Reconstruct with each of the methods that are compared, in turn, and measure the volumes against `labels` in Reference."""
    from .evaluating import measured_volumes

    bone, labeled = _bone_of(asked, part(progress, 0.0, 0.05))
    results: dict[str, Reconstruction] = {}
    for number, method in enumerate(COMPARED_METHODS):
        first, last = (0.05 + 0.65 * n / len(COMPARED_METHODS) for n in (number, number + 1))
        results[method] = _one(asked, replace(asked.recipe, method=method), bone, labeled, FOR_VIEWS, part(progress, first, last))
    metrics: dict[str, BoneMetrics] = {}
    if labels is not None:
        # Every method fills the same voxels, so one mask tells for all of them
        mask = next(iter(results.values())).mask
        volumes = {method: result.intensity for method, result in results.items()}
        metrics = measured_volumes(volumes, labels, asked.sequence, mask, asked.recipe, part(progress, 0.7, 1.0))
    lines = [summary_lines(result, len(asked.sequence), spelling=words)[0] for result in results.values()]
    return Compared({method: _with(result, ()) for method, result in results.items()}, metrics, tuple(lines))


def imaging_of(sequence: TrackedSequence, needs_probe: bool, recipe: Recipe) -> tuple[ProbeGeometry | None, ImageRegion]:
    """Probe and region as a reconstruction would use them; the probe is looked for in the images where it is needed.

    Raises AIFReconError when no frame can be placed, or nothing tells what is needed.
    """
    from ..resolve import resolve_imaging

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
    bone = PlacedBone(Volume(labels, np.eye(4)), np.eye(4))
    recipe = Recipe(spacing=1.0, probe="linear")
    reconstructed(Asked(TrackedSequence.from_arrays(images, poses, spacing=1.0), recipe, bone=bone), FOR_VIEWS, for_views=True)


def know_method(name: str | None, search_path: Collection[str] = ()) -> None:
    """Import the file of a method of the user's own, anew if that was done before: it may have been changed since.

    Raises MethodError when it is in no file, or cannot be imported from any of these folders.
    """
    if name is None or not is_own_method(name):
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


def bone_in_frames(asked: Asked, progress: Progress | None = None) -> BoneMap:
    """Where the frames themselves say that bone is: by a network, or by their own echoes."""
    from ..bone.echoes.surface import bone_from_sweep
    from ..bone.network.model import OnnxModel
    from ..bone.predicted_bone import BoneEstimator, bone_from_frames
    from ..bone.recorded_predictions import RecordedPredictions
    from ..machine.threads import usable_cores

    if asked.predictions is not None:
        estimator: BoneEstimator = RecordedPredictions(asked.sequence, asked.predictions, asked.recipe.bone_frames_px)
    elif asked.model is not None:
        estimator = OnnxModel(asked.model, usable_cores())
    else:
        return bone_from_sweep(asked.sequence, recipe=asked.recipe, progress=progress)
    return bone_from_frames(asked.sequence, estimator, recipe=asked.recipe, progress=progress)


def _bone_of(asked: Asked, progress: Progress | None) -> tuple[BoneMap | None, LabeledBone | None]:
    """Where bone is: a map, or labels of which a map is made for each method."""
    from ..bone.map import BoneMap
    from ..registration.labeled_bone import LabeledBone

    bone = asked.bone
    if asked.sees_bone:
        return bone_in_frames(asked, progress), None
    if bone is None:
        return None, None
    with _about(bone.name):
        if not bone.is_labeled:
            return BoneMap.from_probability(bone.volume, bone.to_reference), None
        labeled = LabeledBone(bone.volume, bone.to_reference, asked.sequence, asked.recipe)
        labeled.map(asked.recipe.method_for(True), progress)
        return None, labeled


def _one(
    asked: Asked,
    recipe: Recipe,
    bone: BoneMap | None,
    labeled: LabeledBone | None,
    beside: Collection[str],
    progress: Progress | None,
) -> Reconstruction:
    """One volume, which knows how it was made."""
    from ..reconstruction import reconstruct

    if labeled is not None:
        bone = labeled.map(recipe.method_for(True), part(progress, 0.0, 0.1))
    return reconstruct(asked.sequence, recipe, bone, asked.grid, beside=beside, progress=part(progress, 0.1, 1.0))


def plain_mean(sequence: TrackedSequence, recipe: Recipe, result: Reconstruction, progress: Progress | None = None) -> Volume:
    """The plain mean of the echoes on the voxels of a result that a method has made, with the same holes filled."""
    from ..reconstruction import reconstruct

    limit = result.hole_limit or recipe.hole_limit
    plain = replace(recipe, method=AVERAGE.name, best_cosine=False, hole_limit=limit)
    return reconstruct(sequence, plain, None, result.grid, beside=(), progress=progress).intensity


def _surface(result: Reconstruction, labeled: LabeledBone | None, progress: Progress | None) -> ShownSurface | None:
    """The bone that a result shows, for 3D; None of one without score and hits."""
    from ..inspection.shown_bone import shown_bone

    if result.score is None or result.hits is None:
        return None
    report(progress, 0.0, "Drawing the bone")
    shown = shown_bone(result) if labeled is None else shown_bone(result, labeled.labels, labeled.labels_to_reference)
    report(progress, 0.6, "Drawing the bone")
    return bone_surface(shown)


def _with(result: Reconstruction, keep: Collection[str]) -> Reconstruction:
    """A result without the volumes that nobody wants."""
    return replace(
        result,
        score=result.score if "score" in keep else None,
        hits=result.hits if "hits" in keep else None,
        cosine=result.cosine if "cosine" in keep else None,
    )


@contextmanager
def _about(name: str) -> Iterator[None]:
    """Errors of geometry say what they are about."""
    try:
        yield
    except GeometryError as error:
        raise GeometryError(f"{name}: {error}") from error
