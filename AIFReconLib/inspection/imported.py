"""Images and poses of any origin become a sequence, with all that is to be seen of it before it is used: words, and a drawing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..errors import AIFReconError, BeamGeometryError, SettingsError
from ..geometry.transform_graph import TransformName
from ..geometry.transforms import pixel_spacing
from ..imaging.recognized import recognized
from ..io.foreign.images import timed
from ..io.foreign.importing import IMAGE_FRAME, REFERENCE_FRAME, import_sequence
from ..io.foreign.openers import open_images
from ..io.foreign.options import ImportOptions
from ..io.foreign.poses.files import read_poses, read_times
from ..message import Sentence, message_of
from ..recipe.recipe import AUTOMATIC
from ..remedies import SURE
from ..sweep.frames import TrackedSequence
from ..sweep.poses import SweepPoses, sweep_poses
from .drawing import Drawing
from .offset_estimate import estimate_time_offset
from .pose_reading import is_inverse_better
from .sweep_drawing import draw_sweep
from .tracking_report import tracking_report


@dataclass(frozen=True, eq=False)
class Imported:
    """A sequence of images and poses, how they were understood, and what the poses are."""

    sequence: TrackedSequence
    understood: tuple[str, ...]
    transform: TransformName


@dataclass(frozen=True, eq=False)
class ImportCheck:
    """What is to be seen of it: facts of the sweep, its drawing where the images can be placed, and the frame that it is drawn in."""

    lines: tuple[str, ...]
    drawing: Drawing | None
    reference: str


def import_files(images: Sequence[str | Path], poses: str | Path, options: ImportOptions) -> Imported:
    """The sequence of images and a file of poses.

    Raises FileFormatError when a file cannot be understood; SettingsError when something is not known that decides where an image goes,
    and `questions_of` has the options that answer.
    """
    name = options.poses_of
    table = read_poses(poses, options)
    patient = read_poses(poses, replace(options, tool=options.reference_tool)) if options.reference_tool else None
    opened = open_images(images)
    if options.times:
        opened = timed(opened, *read_times(options.times, options.time_unit))
    sequence, understood = import_sequence(opened, table, options, patient)
    if options.time_offset == AUTOMATIC:
        options = replace(options, time_offset=_found_offset(sequence, name))
        sequence, understood = import_sequence(opened, table, options, patient)
        understood = (*understood, f"time offset: {options.time_offset:.3f} s, found in the images and applied")
    if not (options.sure or patient):
        _check_direction(sequence, name)
    return Imported(sequence, understood, name)


def _reference(sequence: TrackedSequence, name: TransformName) -> str:
    """The frame in which these poses place the image: that of the marker on the patient, else the tracker's."""
    if any(REFERENCE_FRAME in (each.source, each.target) for each in sequence.records[0].transforms):
        return REFERENCE_FRAME
    moving = {IMAGE_FRAME, *(calibration.target for calibration in sequence.transforms)}
    return name.source if name.target in moving else name.target


def _found_offset(sequence: TrackedSequence, name: TransformName) -> float:
    """How far images and poses are out of step, s; SettingsError where the sweep does not tell."""
    try:
        poses = sweep_poses(sequence, reference=_reference(sequence, name))
    except AIFReconError as error:
        raise SettingsError(
            message_of(error), "To find the time offset, give the calibration with {calibration:[ImageToProbe=]FILE}."
        ) from None
    found = estimate_time_offset(sequence, poses)
    if found.time_offset is None:
        told = message_of(found.to_text())
        raise SettingsError(told, told if told.advice else "Give the seconds as {time_offset:S}, or leave it out.")
    return found.time_offset if found.out_of_step else 0.0


def _check_direction(sequence: TrackedSequence, name: TransformName) -> None:
    """Raise SettingsError where images agree clearly better with the inverse of the poses."""
    try:
        placed = sweep_poses(sequence, reference=_reference(sequence, name))
    except AIFReconError:
        return  # the image is not placed yet
    if not len(placed.usable):
        return
    spacing = pixel_spacing(placed.image_to_reference[placed.usable[0]])
    calibrations = [sample.matrix for sample in sequence.transforms.values()]
    image_to_tool = calibrations[0] if calibrations else np.diag([*spacing, sum(spacing) / 2, 1.0])
    if is_inverse_better(sequence, placed.image_to_reference @ np.linalg.inv(image_to_tool), image_to_tool):
        inverse = TransformName(name.target, name.source)
        raise SettingsError(
            f"Images that look alike lie far apart by {name}, and near each other by its inverse, {inverse}: which are the poses?",
            SURE,
        )


def check_import(imported: Imported, name: str) -> ImportCheck:
    """Facts of the sweep, and its drawing, called `name`, where the images can be placed."""
    sequence, transform = imported.sequence, imported.transform
    reference = _reference(sequence, transform)
    try:
        poses = sweep_poses(sequence, reference=reference)
    except AIFReconError:
        return ImportCheck(("no drawing: the image cannot be placed without a calibration",), None, reference)
    if not len(poses.usable):
        return ImportCheck(("no drawing: no frame has a valid pose",), None, reference)
    try:
        seen = recognized(sequence.images, pixel_spacing(poses.image_to_reference[poses.usable[0]]))
        region, probe = seen.region, f"recognized in the images, blue in the drawing: {seen.description}"
    except BeamGeometryError as error:
        region, probe = None, message_of(error)
    drawing = draw_sweep(poses.image_to_reference[poses.usable], sequence.frame_size, name, reference, region)
    rows = [f"{what}: {value}" for what, value in tracking_report(sequence, poses).rows()]
    if np.isfinite(sequence.timestamps).all():
        offset = estimate_time_offset(sequence, poses).to_text()
        rows.append(Sentence(f"clocks: {offset}", message_of(offset)))
    return ImportCheck((_size(sequence, poses), probe, *rows), drawing, reference)


def _size(sequence: TrackedSequence, poses: SweepPoses) -> str:
    columns, rows = sequence.frame_size
    spacing = np.linalg.norm(poses.image_to_reference[poses.usable[0], :3, :2], axis=0)
    return f"one image is {columns * spacing[0]:.1f} x {rows * spacing[1]:.1f} mm, a pixel {spacing[0]:.4g} x {spacing[1]:.4g} mm"
