"""What a scan has met of the bone while it goes on, and where to look next, found out beside the threads that receive and insert."""

from __future__ import annotations

import contextlib
import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...arrays import Floats, Matrix
from ...errors import AIFReconError, OperationCanceled
from ...geometry.transforms import invert, transform_points
from ...geometry.volume import Volume
from ...guidance.bone import GuidedBone, guided_bone
from ...guidance.coverage import Coverage, covered
from ...guidance.met import BoneMet, FrameGeometry
from ...guidance.next_move import Move, NextMove
from ...guidance.probe import ProbeOnBack, Skin, images_like
from ...imaging.beams import ProbeGeometry
from ...imaging.region import ImageRegion
from ...message import Message, said
from ...resolve import Imaging, known_imaging
from ...sweep.configuration import NO_CONFIGURATION, PlusConfiguration
from ..pairing.synchronizer import LiveFrame
from .session import LiveSession

logger = logging.getLogger(__name__)

PERIOD = 0.01
"""s between two looks for a new frame."""

TELL_EVERY = 0.2
"""s between two summaries: colors five times a second."""

ADVISE_EVERY = 0.5
"""s between two advices."""

REST = 3.0
"""By how many times longer the look at candidate passes rests than it works: a quarter of one core at most."""

MOST_POSES = 2000
"""Frames that are looked at again when the CT is placed anew."""


@dataclass(frozen=True, eq=False)
class GuidanceState:
    """What is known now.

    Parameters
    ----------
    coverage : Coverage or None
        Its `met` goes on changing; what is shown should be `best_cosine`.
    best_cosine : (n,) float64 array or None
        Of the points of `coverage.met.bone`, as they were when this was told.
    move : Move or None
        None while candidates are looked at, and when nothing is worth adding.
    problem : Message or None
        Why nothing can be told.
    """

    coverage: Coverage | None = None
    best_cosine: Floats | None = None
    move: Move | None = None
    problem: Message | None = None


class GuidanceWatch:
    """Looks at the frames of a session on a thread of its own; another one looks at candidate passes.

    Parameters
    ----------
    session : LiveSession
        Only its `latest` frame is read.
    labels : Volume of integers
    labels_to_reference : (4, 4) array, mm
    configuration : PlusConfiguration or None
    region, probe : ImageRegion, ProbeGeometry or None
        As for the session. Where neither they nor the configuration tell the probe, a problem says so.
    target : str
        See `GuidedBone.part`.

    Notes
    -----
    Every method returns at once but `stop`. A frame takes some 2 ms; those that come meanwhile are not looked at.
    """

    def __init__(
        self,
        session: LiveSession,
        labels: Volume,
        labels_to_reference: Matrix,
        configuration: PlusConfiguration | None = None,
        region: ImageRegion | None = None,
        probe: ProbeGeometry | None = None,
        target: str = "interspinous",
    ):
        self._session, self._labels, self._target = session, labels, target
        self._imaging: Imaging | None = known_imaging(configuration or NO_CONFIGURATION, True, region, probe)
        self._wanted: Matrix | None = np.asarray(labels_to_reference, dtype=np.float64)
        self._poses: list[Matrix] = []
        self._bone: GuidedBone | None = None
        self._met: BoneMet | None = None
        self._advisor: NextMove | None = None
        self._last: LiveFrame | None = None
        self._told, self._advised = 0.0, 0.0
        self._lock = threading.Lock()
        self._state = GuidanceState()
        self._closing = threading.Event()
        self._threads = [
            threading.Thread(target=self._run, args=(self._look, PERIOD), name="aifrecon guidance", daemon=True),
            threading.Thread(target=self._run, args=(self._prepare, TELL_EVERY), name="aifrecon guidance moves", daemon=True),
        ]
        for thread in self._threads:
            thread.start()

    @property
    def state(self) -> GuidanceState:
        """What is known now."""
        return self._state

    def place(self, labels_to_reference: Matrix, labels: Volume | None = None) -> None:
        """The CT lies elsewhere now, or has other labels; what was met is told anew from the poses so far."""
        with self._lock:
            self._wanted = np.asarray(labels_to_reference, dtype=np.float64)
            self._labels = self._labels if labels is None else labels

    def stop(self) -> None:
        """Look at no more frames."""
        self._closing.set()
        for thread in self._threads:
            thread.join()

    def _run(self, work: Callable[[], None], period: float) -> None:
        while not self._closing.wait(period):
            try:
                work()
            except AIFReconError as error:
                self._fail(error)
            except Exception as error:  # kept and told: the scan goes on
                self._fail(error)

    def _fail(self, error: Exception) -> None:
        problem = said(error)
        if problem != self._state.problem and not self._closing.is_set():  # it may come again with every frame
            logger.exception("What was met could not be told")
        self._state = GuidanceState(problem=problem)

    def _look(self) -> None:
        frame = self._session.latest
        with self._lock:
            wanted, self._wanted, labels = self._wanted, None, self._labels
        if wanted is not None:
            self._bone = self._met = self._advisor = None
            self._bone = guided_bone(labels, wanted)
        if frame is None or frame is self._last or frame.status != "OK" or frame.image is None or frame.image_to_reference is None:
            return
        self._last = frame
        if self._bone is None:
            return
        if self._imaging is None:
            self._state = GuidanceState(problem=Message("The probe is not known, so nobody can tell which bone its beams meet."))
            return
        if self._met is None:
            rows, columns = frame.image.shape[:2]
            geometry = FrameGeometry(self._bone, (columns, rows), self._imaging.known_probe(), self._imaging.region)
            self._met = BoneMet(geometry)
            for pose in self._poses:
                self._met.insert(pose)
        self._met.insert(frame.image_to_reference, frame.image, 255.0 if frame.image.dtype == np.uint8 else float(frame.image.max()) or 1.0)
        self._poses = [*self._poses, frame.image_to_reference][-MOST_POSES:]
        self._tell(self._met, frame.image_to_reference)

    def _tell(self, met: BoneMet, pose: Matrix) -> None:
        now = time.monotonic()
        if now - self._told < TELL_EVERY:
            return
        move = self._state.move
        if self._advisor is not None and now - self._advised >= ADVISE_EVERY:
            move, self._advised = self._advisor.advise(met, pose), now
        self._told = now
        self._state = GuidanceState(covered(met), met.best_cosine.copy(), move if self._advisor else None)

    def _prepare(self) -> None:
        """Look at candidate passes, once for every place of the CT, resting between."""
        bone, met, poses = self._bone, self._met, self._poses
        if self._advisor is not None or bone is None or met is None or not poses:
            return
        beams = met.geometry.beams
        images = images_like(poses[0], beams.frame_size, beams.probe, beams.region)
        skin = Skin.through(transform_points(invert(bone.patient_to_reference), images.faces(np.array(poses))))
        last = time.monotonic()

        def rest(_fraction: float, _what: str) -> bool:
            nonlocal last
            self._closing.wait(REST * (time.monotonic() - last))
            last = time.monotonic()
            return not self._closing.is_set() and self._bone is bone

        with contextlib.suppress(OperationCanceled):
            advisor = NextMove(bone, ProbeOnBack(images, skin, bone.patient_to_reference), self._target, rest)
            if self._bone is bone:
                self._advisor = advisor
