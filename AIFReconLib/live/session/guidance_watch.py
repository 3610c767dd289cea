"""What a scan has met of the bone while it goes on, and where to look next, found out beside the threads that receive and insert."""

from __future__ import annotations

import contextlib
import threading
import time
from dataclasses import dataclass

import numpy as np

from ...arrays import Bytes, Floats, Matrix
from ...errors import OperationCanceled
from ...geometry.transforms import invert, transform_points
from ...geometry.volume import Volume
from ...guidance.bone import GuidedBone, guided_bone
from ...guidance.colors import ColoredBone
from ...guidance.coverage import Coverage, covered, is_awry
from ...guidance.directions import Direction, directions
from ...guidance.met import BoneMet, FrameGeometry
from ...guidance.next_move import Move, NextMove
from ...guidance.probe import ProbeOnBack, Skin, images_like
from ...imaging.beams import ProbeGeometry
from ...imaging.region import ImageRegion
from ...message import Message
from ...sweep.configuration import PlusConfiguration
from ..pairing.synchronizer import LiveFrame
from .session import LiveSession
from .watch import Watch

PERIOD = 0.0
"""s between two looks: every frame counts, if there is time for it."""

TELL_EVERY = 0.15
"""s between two summaries, so that colors change five times a second."""

ADVISE_EVERY = 0.5
"""s between two advices."""

SKIN_AFTER = 30
"""Frames that have felt the skin before candidate passes are laid upon it."""

MOST_POSES = 2000
"""Frames that are looked at again when the CT is placed anew."""

AT_ONCE = 5
"""Of those, between two looks at new ones."""

FAR_AFTER = 60
"""Frames after which bone that none has come near to is probably not where the CT has it."""

FAR = Message("No frame has come near the bone of the CT so far. Place the CT on the patient first.")


@dataclass(frozen=True, eq=False)
class GuidanceState:
    """What is known now.

    Parameters
    ----------
    colored : ColoredBone or None
        The surface in the labels' own coordinates; the same object until the labels change.
    levels : (n,) uint8 array or None
        Of its corners; see `AIFReconLib.guidance.colors`.
    coverage : Coverage or None
        Its `met` goes on changing, its shares do not.
    best_cosine : (n,) float64 array or None
        Of the points of `coverage.met.bone`, as they were when this was told.
    move : Move or None
        None while candidates are looked at, and when nothing is worth adding.
    directions : tuple of Direction
        To the move from where the probe is now.
    is_preparing : bool
        Whether candidate passes are still looked at.
    problem : Message or None
        Why nothing can be told.
    """

    colored: ColoredBone | None = None
    levels: Bytes | None = None
    coverage: Coverage | None = None
    best_cosine: Floats | None = None
    move: Move | None = None
    directions: tuple[Direction, ...] = ()
    is_preparing: bool = False
    problem: Message | None = None


class GuidanceWatch(Watch):
    """Looks at the frames of a session on a thread of its own.

    Parameters
    ----------
    session : LiveSession
    labels : Volume of integers
    labels_to_reference : (4, 4) array, mm
        Rigid.
    configuration, region, probe
        See `Watch`.

    Attributes
    ----------
    prepared : threading.Event
        Set when the surface of bone is known, or a problem.

    Notes
    -----
    Every method returns at once but `stop`. A frame takes some 2 ms; those that come meanwhile are not looked at. Candidate passes are
    looked at once for every place of the CT, one between two frames.
    """

    def __init__(
        self,
        session: LiveSession,
        labels: Volume,
        labels_to_reference: Matrix,
        configuration: PlusConfiguration | None = None,
        region: ImageRegion | None = None,
        probe: ProbeGeometry | None = None,
    ):
        super().__init__(session, "aifrecon guidance", PERIOD, configuration, region, probe)
        self.prepared = threading.Event()
        self._lock = threading.Lock()
        self._wanted: tuple[Matrix, Volume | None] | None = (np.asarray(labels_to_reference, dtype=np.float64), labels)
        self._labels = labels
        self._own: GuidedBone | None = None
        self._colored: ColoredBone | None = None
        self._bone: GuidedBone | None = None
        self._met: BoneMet | None = None
        self._advisor: NextMove | None = None
        self._probe_on_back: ProbeOnBack | None = None
        self._poses: list[Matrix] = []
        self._again: list[Matrix] = []
        self._brightest = 1.0
        self._is_preparing = False
        self._told, self._advised = 0.0, 0.0
        self._state = GuidanceState()
        self._thread.start()

    @property
    def state(self) -> GuidanceState:
        """What is known now."""
        return self._state

    def place(self, labels_to_reference: Matrix, labels: Volume | None = None) -> None:
        """The CT lies elsewhere now, or has other labels; what was met is told anew from the poses so far."""
        with self._lock:
            if labels is None and self._wanted is not None:
                labels = self._wanted[1]
            self._wanted = np.asarray(labels_to_reference, dtype=np.float64), labels

    def _tell_problem(self, problem: Message) -> None:
        self._state = GuidanceState(problem=problem)
        self.prepared.set()

    def _look(self, frame: LiveFrame | None) -> None:
        self._follow_place()
        imaging = None if frame is None else self._imaging(frame)
        if frame is not None and imaging is not None and self._own is not None:
            image, pose = frame.placed()
            if self._met is None:
                self._turn_to(pose)
                assert self._bone is not None
                rows, columns = image.shape
                self._met = BoneMet(FrameGeometry(self._bone, (columns, rows), imaging.known_probe(), imaging.region))
                self._again = list(self._poses)
            self._brightest = 255.0 if image.dtype == np.uint8 else max(self._brightest, float(image.max()))
            self._met.insert(pose, image, self._brightest)
            self._poses = [*self._poses, pose][-MOST_POSES:]
        if self._met is None:
            return
        for pose in self._again[:AT_ONCE]:
            self._met.insert(pose)
        self._again = self._again[AT_ONCE:]
        self._tell(self._met)
        if self._advisor is None and not self._is_preparing and len(self._poses) >= SKIN_AFTER:
            self._prepare(self._met)

    def _follow_place(self) -> None:
        with self._lock:
            wanted, self._wanted = self._wanted, None
        if wanted is None:
            return
        place, labels = wanted
        self._bone = self._met = self._advisor = None
        if labels is not None:
            self._own = self._colored = None
            self._labels = labels
            self._take(guided_bone(labels))
        if self._own is not None:
            self._bone = self._own.placed_by(place)
        self._place = place
        self.prepared.set()

    def _take(self, own: GuidedBone) -> None:
        self._own, self._colored = own, ColoredBone.of(own)
        self._state = GuidanceState(self._colored, self._colored.levels(np.full(len(own), np.nan)))

    def _turn_to(self, pose: Matrix) -> None:
        """Where the labels' axes are not the patient's, the first frame says where the front is."""
        assert self._bone is not None
        looks = pose[:3, 1] / np.linalg.norm(pose[:3, 1])
        if is_awry(self._bone.patient_to_reference[:3, 1], looks):
            self._take(guided_bone(self._labels, None, self._place[:3, :3].T @ looks))
            assert self._own is not None
            self._bone = self._own.placed_by(self._place)

    def _tell(self, met: BoneMet) -> None:
        now, colored = time.monotonic(), self._colored
        if now - self._told < TELL_EVERY or colored is None or not self._poses:
            return
        self._told = now
        if len(self._poses) >= FAR_AFTER and not self._again and not (met.frames.any() or met.shadowed.any() or met.dark.any()):
            self._state = GuidanceState(colored, problem=FAR)
            return
        pose, move, ways = self._poses[-1], self._state.move, self._state.directions
        if self._advisor is None or self._probe_on_back is None:
            move = None
        elif now - self._advised >= ADVISE_EVERY:
            move, self._advised = self._advisor.advise(met, pose), now
        if move is not None and self._probe_on_back is not None:
            ways = directions(self._probe_on_back.placement(pose), move.planned.placements(1)[0])
        best = met.best_cosine.copy()
        self._state = GuidanceState(
            colored, colored.levels(best), covered(met), best, move, ways if move is not None else (), self._advisor is None
        )

    def _prepare(self, met: BoneMet) -> None:
        """Look at candidate passes, one after the other, and at frames meanwhile."""
        bone, beams = met.bone, met.geometry.beams
        images = images_like(self._poses[0], beams.frame_size, beams.probe, beams.region)
        skin = Skin.through(transform_points(invert(bone.patient_to_reference), images.faces(np.array(self._poses))))
        on_back = ProbeOnBack(images, skin, bone.patient_to_reference)

        def between(_fraction: float, _what: str) -> bool:
            goes_on = self._breathe()
            self._attempt()
            return goes_on and self._met is met

        self._is_preparing = True
        try:
            with contextlib.suppress(OperationCanceled):
                advisor = NextMove(bone, on_back, bone.aim, between)
                self._advisor, self._probe_on_back = advisor, on_back
        finally:
            self._is_preparing = False
