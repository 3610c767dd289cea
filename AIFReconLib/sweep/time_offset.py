"""Images and poses that are out of step: every image gets the pose of the moment it was really taken.

Plus calls the constant `LocalTimeOffsetSec`: seconds added to the time stamps of a device to get to the common clock. Here it is that
of the images, as in Plus's configurations: negative where images arrive late, as frame grabbers do. Poses that arrive late by 0.1 s
are mended by +0.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Floats
from ..errors import SettingsError
from ..geometry.transform_graph import TransformName, TransformSample, TransformStatus
from ..imaging.images import ImageStack
from ..recipe.recipe import LONGEST_GAP, ReadingSettings
from .frames import TrackedSequence
from .pose_tracks import PoseTrack

LARGEST_OFFSET = 10.0
"""s. More is a mistake in the unit."""

BEGUN_MM, SPREAD, IN_STEP = 1.0, 30, 0.2
"""mm by which a tool has begun to move, images that tell the usual change, s that both may differ."""


def first_change(images: ImageStack, numbers: Sequence[int], times: Floats) -> float | None:
    """When images of these numbers have changed by half of their median change; None where that is not seen."""
    first = np.asarray(images[numbers[0]], np.float32)

    def change(number: int) -> float:
        return float(np.abs(np.asarray(images[number], np.float32) - first).mean())

    usual = np.median([change(numbers[at]) for at in np.linspace(0, len(numbers) - 1, SPREAD).astype(int)])
    return next((float(time) for time, number in zip(times, numbers, strict=True) if change(number) > usual / 2), None)


def with_time_offset(sequence: TrackedSequence, time_offset: float, longest_gap: float = LONGEST_GAP) -> TrackedSequence:
    """The sequence with the poses of every frame taken `time_offset` seconds after its time stamp.

    Parameters
    ----------
    sequence : TrackedSequence
        Its images are shared, not copied.
    time_offset : float, s
        `LocalTimeOffsetSec` of the images: image time = time stamp + offset. 0 returns the sequence as it is.
    longest_gap : float, s
        Where valid poses are farther apart than this, or one between them was lost, frames between them get none (status MISSING), and
        neither do frames before the first and after the last; frames that had another status than OK keep it.

    Raises
    ------
    SettingsError
        When the offset or the gap is out of range, or time stamps are missing or all equal.

    Notes
    -----
    Each recorded transform is interpolated on its own: rotations on the shortest arc (slerp), origins along the straight line. Frames
    without an image still say where the tools were.
    """
    if not np.isfinite(time_offset) or abs(time_offset) > LARGEST_OFFSET:
        raise SettingsError(f"Input time_offset must be within {LARGEST_OFFSET:g} s; got {time_offset!r}. Give it in seconds.")
    if not np.isfinite(longest_gap) or longest_gap <= 0:
        raise SettingsError(f"Input longest_gap must be above 0 s; got {longest_gap!r}. Give it in seconds.")
    if time_offset == 0:
        return sequence
    times = sequence.timestamps.tolist()
    if not np.isfinite(times).all() or len(set(times)) < 2:
        raise SettingsError(
            f"{sequence.name}: a time offset needs a time stamp for every frame, and they must differ.",
            "Leave out {time_offset}, or record the sweep with time stamps.",
        )
    images_taken = [time + time_offset for time in times]
    names = dict.fromkeys(name for record in sequence.records for name in record.transforms)
    tracks = {name: _track(sequence, name, times) for name in names}
    records, lost = [], 0
    for record, taken in zip(sequence.records, images_taken, strict=True):
        transforms = {name: _sample(track, taken, longest_gap, record.transforms.get(name)) for name, track in tracks.items()}
        was = {name for name, sample in record.transforms.items() if sample.status is TransformStatus.OK}
        lost += any(transforms[name].status is not TransformStatus.OK for name in was)
        records.append(replace(record, transforms=transforms))
    reading = {**sequence.reading, "time_offset": time_offset, "longest_gap": longest_gap}
    return replace(sequence, records=records, notes=(*sequence.notes, _note(time_offset, lost)), reading=reading)


def as_asked(sequence: TrackedSequence, asked: ReadingSettings) -> TrackedSequence:
    """The sequence as settings ask for it: poses are taken at another time where that was not done when it was read.

    Raises SettingsError when it was read otherwise than asked, which cannot be mended any more.
    """
    if asked.time_offset and "time_offset" not in sequence.reading:
        sequence = with_time_offset(sequence, asked.time_offset, asked.longest_gap)
    for name in ("orientation", "time_offset", "longest_gap"):
        value, done = getattr(asked, name), sequence.reading.get(name)
        if value not in (done, getattr(ReadingSettings, name)):
            how = "without it" if done is None else f"with {done!r}"
            raise SettingsError(
                f"{sequence.name}: {name} counts where a recording is read. It is to be {value!r}, and this one was read {how}. "
                "Read it again, or leave that out."
            )
    return sequence


def _note(time_offset: float, lost: int) -> str:
    """What was done, and how many frames have no pose for it."""
    shift = f"Poses are those of {abs(time_offset):g} s {'after' if time_offset > 0 else 'before'} each image's time stamp"
    if not lost:
        return f"{shift}."
    return f"{shift}; {'1 frame has' if lost == 1 else f'{lost} frames have'} no pose then."


def _track(sequence: TrackedSequence, name: TransformName, times: list[float]) -> PoseTrack:
    samples = ((time, record.transforms.get(name)) for time, record in zip(times, sequence.records, strict=True))
    return PoseTrack((time, sample) for time, sample in samples if sample is not None)


def _sample(track: PoseTrack, time: float, longest_gap: float, recorded: TransformSample | None) -> TransformSample:
    """The pose at one moment; without one, the status that the frame had, unless that was OK."""
    matrix, _ = track.at(time, longest_gap)
    if matrix is not None:
        return TransformSample(matrix)
    status = TransformStatus.MISSING if recorded is None or recorded.status is TransformStatus.OK else recorded.status
    return TransformSample(np.full((4, 4), np.nan), status)
