"""Bone that the frames of a scan show by themselves, by which those that come later are weighted at once."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...arrays import Numbers
from ...bone.echoes.found import BoneEchoes
from ...bone.growing_bone import GrowingBone
from ...bone.predicted_bone import BoneEstimator, PointsOfFrames
from ...bone.predictions import Prediction
from ...bone.recorded_predictions import COVERS, SAME_TIME, probability_of
from ...effective_settings import Imaging
from ...errors import GeometryError
from ..pairing.synchronizer import LiveFrame
from ..wire.messages import ImageMessage
from .recording import Recorder
from .session import LiveSession
from .watch import PATIENCE, Watch

SPREAD_EVERY = 0.5
"""s between two updates of the volume's bone at least."""

BEHIND = 5
"""Frames that wait to be inserted from which on an estimator rests as other watches do."""

LONGEST_WAIT = 1.0
"""s that a prediction waits for its frame to be placed."""


class BoneWatch(Watch):
    """Lets a bone map grow while a session goes on.

    Parameters
    ----------
    session : LiveSession
        Made with `bone`.
    estimator : callable from Imaging to BoneEstimator, or None
        What tells bone in a frame, made when region and probe are known; None: the predictions that the session receives.
    record : Path or None
        A sequence file for the predictions, 8 bit, which `RecordedPredictions` takes with the recorded scan. See `Recorder`.

    Attributes
    ----------
    frames : int
        In which bone was looked for, or for which a prediction came.
    unmatched : int
        Predictions that belong to no frame.

    Notes
    -----
    An estimator looks at the newest frame as soon as it is done with the one before, for a network leaves Python to others while it
    works: one core at most is taken, and half of one while insertion is behind. Frames that come meanwhile are passed over, as
    evenly as they come. Streamed predictions are all taken. What is found while a scan has no box yet is kept for the volume that it
    gets. Another watch brings it to the volume.
    """

    def __init__(
        self,
        session: LiveSession,
        bone: GrowingBone,
        estimator: Callable[[Imaging], BoneEstimator] | None,
        record: Path | None = None,
    ):
        super().__init__(session)
        self._bone, self._make_estimator = bone, estimator
        self._recorder = None if record is None else Recorder(record)
        self.recorded: Path | None = None
        self._estimator: BoneEstimator | None = None
        self._points: PointsOfFrames | None = None
        self._waiting: list[ImageMessage] = []
        self._full = 1.0
        self.frames = self.unmatched = 0
        self._spreading = _Spreading(session, bone, self._tell_problem)
        self._start()

    def lines(self, frames: int) -> tuple[str, ...]:
        """How it goes with so many frames received, in words."""
        lines = [f"Bone is known from {self.frames} of {frames} frames."]
        if self.unmatched:
            lines.append(f"{self.unmatched} predictions belong to no frame with a pose.")
        return tuple(lines if self.problem is None else [*lines, self.problem])

    def stop(self, wait_for_it: bool = True) -> None:
        """Look at no more frames, and finish the recording of what was said."""
        super().stop(wait_for_it)
        self._spreading.stop(wait_for_it)
        recorder, self._recorder = self._recorder, None
        if recorder is not None and wait_for_it:
            self.recorded = recorder.finish()
            self.problem = recorder.failure or self.problem

    def _breathe(self) -> bool:
        """Wait for a frame, unless one has come meanwhile; where insertion is behind, rest as others do. False when the end has come."""
        if self._session.statistics.waiting >= BEHIND:
            return super()._breathe()
        if self._session.latest is self._newest:
            self._session.wait_for_rest(PATIENCE)
        return self._resume()

    def _look(self, frame: LiveFrame | None) -> Iterable[object]:
        if self._make_estimator is None:
            for of_frame, message in self._matched():
                self._take(of_frame, Prediction(self._streamed(message)))
        elif frame is not None and (imaging := self._session.imaging()) is not None:
            self._estimator = self._estimator or self._make_estimator(imaging)
            prediction = self._estimator.estimate(frame)
            if prediction is not None:
                self._take(frame, prediction)
        return ()

    def _take(self, frame: LiveFrame, prediction: Prediction | BoneEchoes | Numbers) -> None:
        imaging = self._session.imaging()
        self.frames, self.problem = self.frames + 1, None
        if self._recorder is not None and isinstance(prediction, Prediction):
            self._recorder.append(_as_frame(frame, prediction))
        if imaging is not None:
            self._points = self._points or PointsOfFrames(imaging)
            self._bone.learn(self._points.of(frame, prediction))

    def _matched(self) -> list[tuple[LiveFrame, ImageMessage]]:
        """Predictions whose frames are placed; others wait a little."""
        placed = [frame for frame in tuple(self._session.recent) if frame.status == "OK"]
        times = np.array([frame.timestamp for frame in placed])
        found, waiting, now = [], [], time.monotonic()
        while self._session.predictions:
            self._waiting.append(self._session.predictions.popleft())
        for message in self._waiting:
            near = int(np.abs(times - message.timestamp).argmin()) if times.size else -1
            if near >= 0 and abs(times[near] - message.timestamp) <= SAME_TIME:
                found.append((placed[near], message))
            elif now - message.received < LONGEST_WAIT:
                waiting.append(message)
            else:
                self.unmatched += 1
        self._waiting = waiting
        return found

    def _streamed(self, message: ImageMessage) -> np.ndarray[tuple[int, ...], np.dtype[np.float32]]:
        """A streamed image as probabilities. Of 8 bit, 1 is certain until something larger has come."""
        if message.image.dtype == np.uint8:
            if int(message.image.max(initial=0)) > 1:
                self._full = 255.0
        elif message.image.dtype.kind != "f":
            raise GeometryError(
                f"{message.device}: predictions must be 8 bit, 0 to 255, or floating point, 0 to 1; got {message.image.dtype.name}. "
                "Stream them as one of these."
            )
        return probability_of(message.image, self._full if message.image.dtype == np.uint8 else 1.0, message.device)


class _Spreading(Watch):
    """Brings what is known of bone to the volume, in moments in which nothing is inserted."""

    def __init__(self, session: LiveSession, bone: GrowingBone, tell: Callable[[str], None]):
        super().__init__(session, SPREAD_EVERY)
        self._bone, self._tell = bone, tell
        self._start()

    def _look(self, frame: LiveFrame | None) -> Iterable[object]:
        return self._bone.spread()

    def _tell_problem(self, problem: str) -> None:
        self._tell(problem)


def predictions_beside(record: Path) -> Path:
    """Where what is said of bone is recorded beside the recording of a scan."""
    return record.with_name(f"{record.name[: -len(record.suffix)]}-bone{record.suffix}")


def _as_frame(frame: LiveFrame, prediction: Prediction) -> LiveFrame:
    """A prediction as the image of its frame, for a recording."""
    image = np.rint(255 * prediction.probability).astype(np.uint8)
    rows, columns = frame.placed()[0].shape
    rectangle = prediction.rectangle or (0.0, 0.0, float(columns), float(rows))
    covers = {COVERS: " ".join(f"{value:g}" for value in rectangle)}
    return replace(frame, image=image, record=replace(frame.record, fields={**frame.record.fields, **covers}))
