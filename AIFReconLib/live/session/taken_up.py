"""A recording that was not finished, because its program has died, taken up again: its frames come before those of the stream."""

from __future__ import annotations

import logging
import os
import shutil
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...errors import AIFReconError
from ...io.sequence.files import read_sequence
from ...message import said
from ...sweep.configuration import PlusConfiguration
from ...sweep.poses import sweep_poses
from ..pairing.synchronizer import LiveFrame
from .recording import growing_files
from .statistics import ALL, Spans

logger = logging.getLogger(__name__)


class TakenUp:
    """Sets the files of an unfinished recording aside, so that another of its name can begin, and gives their frames.

    Parameters
    ----------
    record : Path
        What was to be recorded.
    configuration : PlusConfiguration
        As for the session.
    spans : Spans
        Which frames enter the volume; others are recorded only.

    Notes
    -----
    They lie in a folder beside it until the last frame was given: if the program dies again before that, they are all there is.
    """

    def __init__(self, record: Path, configuration: PlusConfiguration, spans: Spans = ALL):
        self._configuration, self._spans = configuration, spans
        growing = growing_files(record)
        self._folder = record.with_name(f"{record.stem}.taken-up")
        self._header = self._folder / growing[0].name
        if not self._header.exists() and growing[0].exists():
            self._folder.mkdir(exist_ok=True)
            for path in reversed(growing):  # the header last: where it is, the pixels are
                os.replace(path, self._folder / path.name)
        for path in growing:
            path.unlink(missing_ok=True)

    def __iter__(self) -> Iterator[tuple[LiveFrame, bool]]:
        """The frames in their order, placed as a session places them, and whether each counts; none where the recording cannot be read."""
        try:
            sequence = replace(read_sequence(self._header), configuration=self._configuration)
            poses = sweep_poses(sequence)
        except AIFReconError as error:
            if self._header.exists():
                logger.warning("The frames of %s are kept, but not taken up: %s", self._header, said(error))
            return
        for number, record in enumerate(sequence.records):
            problem = poses.problems[number]
            pose = None if problem else poses.image_to_reference[number]
            image, now = np.array(sequence.images[number]), time.monotonic()
            counts = any(first <= number and (stop is None or number < stop) for first, stop in self._spans)
            yield LiveFrame(image, pose, record.timestamp or 0.0, problem or "OK", number, record, now), counts

        # Every frame is in the new recording
        del sequence
        self._header.unlink(missing_ok=True)
        shutil.rmtree(self._folder, ignore_errors=True)
