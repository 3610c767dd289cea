"""Images and poses of any origin become a tracked sequence, every convention said and none guessed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...arrays import Floats, Mask, Matrix
from ...errors import SettingsError
from ...geometry.transform_graph import MISSING, TransformName, TransformSample, TransformStatus
from ...geometry.transforms import invert, why_not_an_image_pose, why_not_rigid
from ...message import Sentence, message_of
from ...remedies import (
    CALIBRATION_UNIT,
    NAME_THE_CALIBRATION,
    NO_PIXEL_SIZE,
    PIXEL_SIZE,
    SAME_MOVEMENT,
    SURE,
    TIME_OFFSET,
    TIME_UNIT,
    UNITS,
)
from ...sweep.frames import FrameRecord, TrackedSequence
from ...sweep.pixel_size import implausible_size
from ...sweep.pose_tracks import PoseTrack
from ...sweep.time_offset import BEGUN_MM, IN_STEP, first_change
from ..sequence.orientation import IN_MEMORY, parse_orientation
from .calibration import read_calibration
from .images import ImportedImages, bare_name, flipped
from .options import ImportOptions
from .poses.files import PoseTable
from .poses.headings import LENGTHS
from .poses.rotations import in_millimeters
from .poses.sheet import has_none
from .poses.times import FASTEST, SLOWEST

IMAGE_FRAME, REFERENCE_FRAME = "Image", "Reference"

BEGUN_TURN = 0.02
"""Part of a turn by which a tool has begun to move."""

LONGER = 1.0
"""s by which poses may last longer than images at a steady rate before it is said."""

FROM_ZERO = 1.0
"""s. A clock that begins below counts from 0."""

_Calibration = tuple[TransformName, Matrix]

_Place = tuple[Matrix, dict[TransformName, TransformSample], str]
"""Poses, transforms of the header, and in words where the image is."""

_Pairs = tuple[list[TransformSample], Floats | None, str]
"""One sample per image, times, and in words how that was done."""


def _calibration_of(options: ImportOptions) -> _Calibration | None:
    """Name and matrix of the calibration that is given.

    A configuration names its transforms itself; other files hold the calibration of the probe whose poses there are.
    """
    if not options.calibration:
        return None
    name, _, file = options.calibration.rpartition("=")
    source, target = options.poses_of.source, options.poses_of.target
    own = None if file.lower().endswith(".xml") else TransformName(IMAGE_FRAME, "Probe" if "Probe" in (source, target) else source)
    return read_calibration(file, TransformName.parse(name) if name else own)


def import_sequence(
    images: ImportedImages, poses: PoseTable, settings: ImportOptions, patient: PoseTable | None = None
) -> tuple[TrackedSequence, tuple[str, ...]]:
    """The sequence of these images and poses, and in words how they were understood.

    `patient` are the poses of the marker on the patient, in the direction of the others; it is the frame Reference.

    Raises SettingsError when images and poses do not fit each other, or something that is needed is not known.
    """
    name, calibration = settings.poses_of, _calibration_of(settings)
    offset = 0.0 if isinstance(settings.time_offset, str) else settings.time_offset
    if settings.rate is not None:
        images = replace(images, times=np.arange(len(images.stack)) / settings.rate)
    zero, clocks = _clocks(images, poses, offset)
    if not np.isfinite(poses.matrices).all(axis=(1, 2)).any():
        raise SettingsError(f"The poses must hold at least one that is valid; all {len(poses.matrices)} are missing. Export them again.")
    rigid = _are_rigid(poses.matrices, name)
    matrices = in_millimeters(poses.matrices, poses.length_unit, takes_pixels=IMAGE_FRAME in (name.source, name.target) and not rigid)
    # What the tracker did not see stands somewhere, too, often at zero
    seen = np.array([sample.status is TransformStatus.OK for sample in _samples(matrices, poses)])
    doubts = _doubts(matrices, seen, poses, settings) if seen.any() else []
    matrices, header, how = _placed(matrices, rigid, images, settings, calibration)
    samples, times, pairing = _paired(images, poses, _samples(matrices, poses), settings.rate, offset + zero)
    every = {name: samples}
    if patient is not None:
        marker, placed = _of_patient(patient, name, (IMAGE_FRAME, calibration[0].target if calibration else IMAGE_FRAME, "Probe"))
        every[marker] = _paired(images, patient, _samples(placed, patient), settings.rate, offset + zero)[0]
    moments = [None] * len(samples) if times is None else times.tolist()
    records = [FrameRecord(time, transforms={name: of[n] for name, of in every.items()}) for n, time in enumerate(moments)]
    orientation = parse_orientation(settings.orientation)
    stack = images.stack if orientation[:2] == IN_MEMORY[:2] else flipped(images.stack, orientation)
    understood = (
        f"images: {images.description}, orientation {orientation[:2]}",
        *(Sentence(f"poses: {line}", message_of(line)) for line in poses.understood),
        *(f"direction: {each} takes points of {each.source} to {each.target}" for each in every),
        f"place of the image: {how}",
        f"pairing: {pairing}",
        "times: " + ("none; frames are taken in this order" if times is None else _span(times)),
        *doubts,
        *clocks,
        *_lasting(times, poses, settings),
    )
    return TrackedSequence(stack, records, transforms=header), understood


def _of_patient(patient: PoseTable, name: TransformName, may_move: Sequence[str]) -> tuple[TransformName, Matrix]:
    """What the poses of the marker on the patient are, and the poses, beside those of `name`, one end of which moves."""
    ends = (name.source, name.target)
    moving = next((frame for frame in may_move if frame in ends), name.source)
    marker = TransformName(name.source, REFERENCE_FRAME) if moving == name.target else TransformName(REFERENCE_FRAME, name.target)
    if REFERENCE_FRAME in ends:
        told = f"The poses of {name} are those in Reference already, and there is a marker on the patient."
        raise SettingsError(told, "Leave out {reference_tool}.")
    matrices = in_millimeters(patient.matrices, patient.length_unit, takes_pixels=False)
    _are_rigid(matrices, marker, " of the marker")
    return marker, matrices


def _clocks(images: ImportedImages, poses: PoseTable, offset: float) -> tuple[float, list[str]]:
    """What makes two clocks begin at one moment, s, where one counts from 0 and nothing overlaps; and what was taken for granted."""
    taken = images.times
    if taken is None or poses.times is None or poses.images is not None:
        return 0.0, []
    begin, first = float(taken[0]), float(np.nanmin(poses.times))
    from_zero = {abs(begin) < FROM_ZERO, abs(first) < FROM_ZERO}
    apart = taken[-1] + offset < first or begin + offset > np.nanmax(poses.times)
    if apart and len(from_zero) > 1 and not (len(taken) == len(poses.times) and _in_step(poses.times, taken)):
        told = f"note: images and poses count from different moments; the images were taken to begin {offset:g} s after the poses."
        return first - begin, [Sentence(told, TIME_OFFSET)]
    if from_zero != {True}:
        return 0.0, []
    both = "note: images and poses both count from 0, and were taken to begin at one moment."
    told = f"note: the images were taken to begin {offset:g} s after the poses." if offset else both
    moves, changes = _first_motion(poses), first_change(images.stack, range(len(images.stack)), taken)
    if moves is not None and changes is not None and abs(moves - changes - offset) > IN_STEP:
        told += f" The tool begins to move at {moves:.2f} s, and the images to change at {changes:.2f} s."
        return 0.0, [Sentence(told, SAME_MOVEMENT, offset=f"{moves - changes:.2f}")]
    return 0.0, [] if offset else [Sentence(told, TIME_OFFSET)]


def _first_motion(poses: PoseTable) -> float | None:
    """s until the tool leaves the place where it was at first; None where that is not seen."""
    known = np.isfinite(poses.matrices).all(axis=(1, 2))
    if poses.times is None or not known.any():
        return None
    matrices = in_millimeters(poses.matrices[known], poses.length_unit, takes_pixels=False)
    turned = np.linalg.norm(matrices[:, :3, :3] - matrices[0, :3, :3], axis=(1, 2))
    gone = np.flatnonzero((np.linalg.norm(matrices[:, :3, 3] - matrices[0, :3, 3], axis=1) > BEGUN_MM) | (turned > BEGUN_TURN))
    return float(poses.times[known][gone[0]]) if gone.size else None


def _lasting(times: Floats | None, poses: PoseTable, settings: ImportOptions) -> list[str]:
    """That images at a steady rate do not last as long as the poses: they may have paused."""
    if settings.rate is None or times is None or poses.times is None:
        return []
    images_last, poses_last = np.ptp(times), np.nanmax(poses.times) - np.nanmin(poses.times)
    if poses_last < images_last + LONGER:
        return []
    told = f"note: the images last {images_last:.1f} s at {settings.rate:g} a second, the poses {poses_last:.1f} s."
    return [Sentence(told, "If the images paused, give {times:FILE} instead of {rate}.")]


def _are_rigid(matrices: Matrix, name: TransformName, of: str = "") -> bool:
    """Whether all poses that there are are rigid; those that are neither that nor those of an image are refused by their number."""
    known = np.flatnonzero(np.isfinite(matrices).all(axis=(1, 2)))
    reasons = {number: reason for number in known.tolist() if (reason := why_not_rigid(matrices[number]))}
    for number, reason in reasons.items():
        pixels = matrices[number] if name.source == IMAGE_FRAME else invert(matrices[number])
        if IMAGE_FRAME not in (name.source, name.target) or "mirrored" in reason or why_not_an_image_pose(pixels):
            told = f"Pose {number}{of} must be a rotation and a translation; it is {reason}. Check the columns."
            raise SettingsError(told, "Where matrices are written column by column, give {column_major}.")
    return not reasons


def _placed(matrices: Matrix, rigid: bool, images: ImportedImages, settings: ImportOptions, calibration: _Calibration | None) -> _Place:
    """Poses that take pixels where they are the image's; header transforms; and where the image is, in words."""
    name, spacing, origin = settings.poses_of, settings.spacing or images.spacing, settings.image_origin_px or (0.0, 0.0)
    if IMAGE_FRAME not in (name.source, name.target):
        return (matrices, *_placed_by_probe(spacing, images, settings, calibration))
    if calibration:
        raise SettingsError(f"{name} places the image itself, so there is no calibration to apply.", "Leave out {calibration}.")
    if not rigid:
        if settings.spacing or settings.image_origin_px:
            raise SettingsError(f"The matrices of {name} hold the size of a pixel already.", NO_PIXEL_SIZE, or_calibration="")
        first = matrices[np.isfinite(matrices).all(axis=(1, 2))][0]
        _about_image(first if name.source == IMAGE_FRAME else invert(first), images, settings)
        return matrices, {}, f"{name} takes pixels (its axes are not of length 1)"
    if spacing is None:
        why = f": {images.unknown_spacing}" if images.unknown_spacing else ""
        told = f"The poses of {name} are rigid, so they take millimeters, and the size of a pixel is not known{why}."
        raise SettingsError(told, PIXEL_SIZE)
    pixel_to_image = _pixels_to_mm(spacing, origin)
    _about_image(pixel_to_image, images, settings)
    matrices = matrices @ pixel_to_image if name.source == IMAGE_FRAME else invert(pixel_to_image) @ matrices
    source = "" if settings.spacing else " (from the image files)"
    return matrices, {}, f"pixels of {spacing[0]:g} x {spacing[1]:g} mm{source}, {name} places pixel {origin[0]:g} {origin[1]:g}"


def _placed_by_probe(
    spacing: tuple[float, float] | None, images: ImportedImages, settings: ImportOptions, given: _Calibration | None
) -> tuple[dict[TransformName, TransformSample], str]:
    """The calibration of a probe as transforms of the header; and where the image is, in words."""
    name, origin = settings.poses_of, settings.image_origin_px
    if given:
        calibration, matrix = given[0], given[1].copy()
        how = f"{calibration} as calibrated"
        unit = LENGTHS[settings.calibration_unit or "mm"]
        matrix[:3, 3] *= unit
        if settings.spacing and why_not_rigid(matrix) is None:  # of millimeters, as hand-eye calibrations of others are
            matrix = matrix @ _pixels_to_mm(settings.spacing, origin or (0.0, 0.0))
            how += f", with pixels of {settings.spacing[0]:g} x {settings.spacing[1]:g} mm"
        elif settings.spacing or origin:
            raise SettingsError("A calibration holds the size of a pixel already.", NO_PIXEL_SIZE, or_calibration=", or the calibration")
        else:
            matrix[:3, :3] *= unit
        if calibration.source != IMAGE_FRAME or calibration.target not in (name.source, name.target):
            must = f"The calibration must lead from {IMAGE_FRAME} to {name.source} or {name.target}; got {calibration}."
            raise SettingsError(must, NAME_THE_CALIBRATION, example=f"{IMAGE_FRAME}To{name.source}")
    elif origin and spacing:
        calibration, matrix = TransformName(IMAGE_FRAME, name.source), _pixels_to_mm(spacing, origin)
        how = f"the image's axes are those of {name.source}, whose origin is pixel {origin[0]:g} {origin[1]:g}"
    elif settings.spacing or origin:
        both = "Give {calibration:FILE}; or both {spacing} and {image_origin_px}, if the axes of the image are those of {frame}."
        raise SettingsError(f"The size of a pixel alone does not say where the image lies in {name.source}.", both, frame=name.source)
    else:
        return {}, f"not in the recording: give {IMAGE_FRAME}To{name.source} when reconstructing"
    _about_image(matrix, images, settings)
    return {calibration: TransformSample(matrix)}, how


def _pixels_to_mm(spacing: tuple[float, float], origin_px: tuple[float, float]) -> Matrix:
    matrix = np.diag([spacing[0], spacing[1], (spacing[0] + spacing[1]) / 2, 1.0])
    matrix[:2, 3] = -spacing[0] * origin_px[0], -spacing[1] * origin_px[1]
    return matrix


def _samples(matrices: Matrix, poses: PoseTable) -> list[TransformSample]:
    """Poses with the statuses that the file gives them, and MISSING where one has no numbers."""
    has_pose = np.asarray(np.isfinite(matrices).all(axis=(1, 2)))
    parsed = map(TransformStatus.parse, poses.statuses or ["OK"] * len(matrices))
    statuses = (TransformStatus.MISSING if status is TransformStatus.OK and not has else status for status, has in zip(parsed, has_pose))
    return list(map(TransformSample, matrices, statuses))


def _paired(images: ImportedImages, poses: PoseTable, samples: list[TransformSample], rate: float | None, offset: float) -> _Pairs:
    """One sample per image, times, and how that was done: by name, else by time where both have times that disagree, else in order."""
    count = len(images.stack)
    if poses.images is not None:
        return _paired_by_name(images, poses, samples)
    if images.unknown_order:
        advice = "Name the image of each pose in a column 'image', or import one series."
        raise SettingsError(f"The order of the images is not known: {images.unknown_order}. {advice}")
    by_rate = "" if rate is None else f", images {rate:g} times a second"
    image_times = None if images.times is None else images.times + offset
    if offset and (image_times is None or poses.times is None):
        told = "A time offset needs times of images and poses, and one of them has none."
        raise SettingsError(told, "Leave out {time_offset}, or record the sweep with time stamps.")
    if len(samples) == count and not offset and (poses.times is None or image_times is None or _in_step(poses.times, image_times)):
        return samples, poses.times if poses.times is not None else image_times, f"image by image, in order{by_rate}"
    if poses.times is not None and image_times is not None:
        paired = PoseTrack(zip(poses.times.tolist(), samples)).samples(image_times)
        if all(sample is MISSING for sample in paired):
            spans = f"poses {_span(poses.times)}, images {_span(image_times)}{by_rate}"
            raise SettingsError(f"The poses must be of the time of the images; {spans}.", TIME_OFFSET)
        return paired, image_times, f"{len(samples)} poses interpolated at the times of {count} images{by_rate}"
    advice = "If images were taken at a steady rate, give {rate:HZ}, else a table of their times." if poses.times is not None else ""
    must = f"There must be as many poses as images; got {len(samples)} poses for {count} images"
    raise SettingsError(f"{must}. Leave out some, name the image of each pose in a column 'image', or give times on both.", advice)


def _in_step(poses: Floats, images: Floats) -> bool:
    """Whether two clocks tell the same but for when they began: within half of the time between two images."""
    if len(poses) < 2:
        return True
    return float(np.ptp(poses - images)) <= 0.5 * float(np.median(np.abs(np.diff(images)))) + 1e-9


def _paired_by_name(images: ImportedImages, poses: PoseTable, samples: list[TransformSample]) -> _Pairs:
    """Poses of images by the names of their files, whatever their folder."""
    if images.names is None:
        told = "The poses name an image each, but the images are all in one file."
        raise SettingsError(told, "Leave out that column ({columns}, with -).")
    rows: dict[str, int] = {}
    for number, name in enumerate(map(bare_name, poses.images or ())):
        # A row that names no image is a pose without one
        if not has_none(name) and rows.setdefault(name, number) != number:
            raise SettingsError(f"Two poses name the image {name} (poses {rows[name]} and {number}). Remove one of them.")
    for twice in (name for name, count in Counter(images.names).items() if count > 1 and name in rows):
        raise SettingsError(f"Two of the images are called {twice}, and a pose names it. Import one folder at a time.")
    found = [rows[name] for name in images.names if name in rows]
    if not found:
        raise SettingsError(f"No pose names one of the images: poses name {next(iter(rows), None)}, images are {images.names[0]}.")
    paired = [samples[rows[name]] if name in rows else MISSING for name in images.names]
    times = poses.times[found] if poses.times is not None and len(found) == len(paired) else None
    return paired, times, f"by name: {len(found)} of {len(paired)} images have a pose, {len(rows) - len(found)} poses have no image"


def _span(times: Floats) -> str:
    return f"{times.min():.3f} to {times.max():.3f} s"


SLOWEST_DOUBTED = 500.0
"""mm/s in the median; no hand scans so fast."""


def _doubts(matrices: Matrix, good: Mask, poses: PoseTable, settings: ImportOptions) -> list[str]:
    """What is unusual and can be right. Raises SettingsError for what no hand or machine does, unless the user is sure of it."""
    moved = matrices[good]
    extent = float(np.ptp(moved[:, :3, 3], axis=0).max())
    doubts: list[str] = []
    if len(moved) > 5 and extent == 0.0 and not np.ptp(moved, axis=0).any():
        doubts.append(Sentence("The tool never moves: all poses are the same. Was it the fixed one of several?", SURE))
    if 0 < extent < 1.0 and len(moved) > 5:
        advice = Sentence("", SURE) if poses.knows_length else Sentence("", UNITS, unit="meters", choice="m")
        doubts.append(Sentence(f"The poses move by {extent:.3g} mm in all.", advice))
    if extent > 2000.0:
        doubts.append(Sentence(f"The poses move by {extent / 1000:.3g} m.", UNITS, unit="another unit", choice=""))
    if poses.times is not None and len(np.unique(poses.times[good])) > 5:
        steps = np.diff(poses.times[good])
        timed, typical = np.flatnonzero(steps), float(np.median(steps))
        # Of what is placed, or of the tracker seen from there: the slower of both
        shifts = (np.diff(way[:, :3, 3], axis=0)[timed] for way in (moved, np.linalg.inv(moved)))
        speed = min(float(np.median(np.linalg.norm(shift, axis=1) / np.abs(steps[timed]))) for shift in shifts)
        if not FASTEST <= typical <= SLOWEST:
            doubts.append(Sentence(f"Poses are {typical:.3g} s apart, in the median.", TIME_UNIT, unit="ms"))
        elif speed > SLOWEST_DOUBTED:
            told = f"The tool moves at {speed / 1000:.2g} m/s, in the median: poses of several tools, or another unit of length or time?"
            doubts.append(Sentence(told, SURE))
    if doubts and not settings.sure and not (poses.knows_length and "in all" in doubts[0]):
        raise SettingsError(doubts[0])
    return [Sentence(f"doubt: {doubt}", message_of(doubt)) for doubt in doubts]


def _about_image(image_to_mm: Matrix, images: ImportedImages, settings: ImportOptions) -> None:
    """Raise SettingsError where an image would be larger or smaller than any probe sees, unless the user is sure of it."""
    rows, columns = images.stack.shape[1:3]
    sentence = implausible_size(image_to_mm[None], (columns, rows))
    if sentence is not None and not settings.sure:
        missing = bool(np.allclose(np.linalg.norm(image_to_mm[:3, :2], axis=0), 1.0, atol=1e-3))
        raise SettingsError(sentence, PIXEL_SIZE if missing else CALIBRATION_UNIT if settings.calibration else SURE)
