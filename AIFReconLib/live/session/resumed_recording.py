"""Frames of a recording that was not finished, because its program has died: they come before those of the stream."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...errors import AIFReconError
from ...io.sequence.files import read_sequence
from ...message import message_of
from ...sweep.configuration import PlusConfiguration
from ...sweep.poses import SweepPoses, sweep_poses
from ..pairing.synchronizer import LiveFrame
from .recording import growing_files
from .statistics import ALL, Spans


def unfinished_frames(path: Path, configuration: PlusConfiguration, spans: Spans = ALL) -> Iterator[tuple[LiveFrame, bool]]:
    """The frames of an unfinished recording in their order, placed as a session places them, and whether each counts.

    None where there is no such recording. It stays as it is: a `Recorder` that takes it up goes on behind them.

    Parameters
    ----------
    path : Path
        What was to be recorded.
    configuration : PlusConfiguration
        As for the session.
    spans : Spans
        Which frames enter the volume; others are recorded only.
    """
    try:
        sequence = replace(read_sequence(growing_files(path)[0]), configuration=configuration)
    except AIFReconError:  # a `Recorder` tells what it cannot take up
        return
    try:
        poses = sweep_poses(sequence)
    except AIFReconError as error:
        # Of a scan before the tracker was connected, for example
        poses = SweepPoses(np.full((len(sequence), 4, 4), np.nan), (message_of(error),) * len(sequence), ())
    for number, record in enumerate(sequence.records):
        problem = poses.problems[number]
        pose = None if problem else poses.image_to_reference[number]
        image, now = np.array(sequence.images[number]), time.monotonic()
        counts = any(first <= number and (stop is None or number < stop) for first, stop in spans)
        yield LiveFrame(image, pose, record.timestamp or 0.0, problem or "OK", number, record, now), counts
