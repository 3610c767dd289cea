"""Whether CT and patient agree while a scan goes on, found out beside the threads that receive and insert: these never wait for it."""

from __future__ import annotations

import logging
import threading
import time
from dataclasses import dataclass

from ...arrays import Floats
from ...errors import AIFReconError
from ...imaging.beams import ProbeGeometry
from ...imaging.region import ImageRegion
from ...message import Message, said
from ...registration.agreement import Agreement
from ...registration.bone_field import BoneField
from ...registration.echoes import SweepEchoes
from ...registration.live import LiveAgreement
from ...resolve import Imaging, known_imaging, recognized_imaging
from ...sweep.configuration import NO_CONFIGURATION, PlusConfiguration
from ..pairing.synchronizer import LiveFrame
from .scouting import ScoutedFrames
from .session import FRAMES_LOOKED_AT, LiveSession

logger = logging.getLogger(__name__)

PERIOD, REST = 0.2, 4.0
"""s between two looks at the newest frame, and by how many times longer it rests than a look took: at most a fifth of one core is taken,
however fast frames come, and less where the insertion needs it."""

MOST_SEEN = 6000
"""Echoes of the scan so far that are kept, evenly in space; a few times as many between two sortings."""


@dataclass(frozen=True)
class LiveState:
    """What is known of the last seconds.

    Parameters
    ----------
    agreement : Agreement or None
        None while they have shown too little bone.
    has_fallen : bool
        CT and patient agreed in this scan and do so no longer.
    problem : Message or None
        Why nothing can be told.
    """

    agreement: Agreement | None = None
    has_fallen: bool = False
    problem: Message | None = None


class AgreementWatch:
    """Looks at the newest frame of a session from time to time, on a thread of its own.

    Parameters
    ----------
    session : LiveSession
        Only its `latest` frame is read.
    bone : BoneField
    labels_to_reference : (4, 4) array, mm
        Rigid.
    configuration : PlusConfiguration or None
    region, probe : ImageRegion, ProbeGeometry or None
        As for the session; what they and the configuration leave open is recognized in the first frames.

    Notes
    -----
    Every method returns at once but `stop`, which waits for the frame under way. Memory does not grow with the scan.
    """

    def __init__(
        self,
        session: LiveSession,
        bone: BoneField,
        labels_to_reference: Floats,
        configuration: PlusConfiguration | None = None,
        region: ImageRegion | None = None,
        probe: ProbeGeometry | None = None,
    ):
        self._session, self._bone, self._place = session, bone, labels_to_reference
        self._configuration, self._region, self._probe = configuration or NO_CONFIGURATION, region, probe
        self._imaging: Imaging | None = known_imaging(self._configuration, True, region, probe)
        self._first = ScoutedFrames()
        self._live: LiveAgreement | None = None
        self._last: LiveFrame | None = None
        self._lock = threading.Lock()
        self._wanted: Floats | None = None
        self._seen: list[SweepEchoes] = []
        self._recent = SweepEchoes.joined(())
        self._state = LiveState()
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="aifrecon live agreement", daemon=True)
        self._thread.start()

    @property
    def state(self) -> LiveState:
        """What is known now."""
        return self._state

    def place(self, labels_to_reference: Floats) -> None:
        """The CT lies elsewhere now; the last seconds are judged anew."""
        with self._lock:
            self._wanted = labels_to_reference

    def echoes(self) -> SweepEchoes:
        """Bone echoes to place the CT by: of the whole scan so far, or of its last seconds after CT and patient have come apart."""
        with self._lock:
            return self._recent if self._state.has_fallen else SweepEchoes.joined(self._seen)

    def stop(self) -> None:
        """Look at no more frames."""
        self._closing.set()
        self._thread.join()

    def _watch(self) -> None:
        rest = PERIOD
        while not self._closing.wait(rest):
            began = time.monotonic()
            try:
                self._look()
            except AIFReconError as error:
                self._tell(LiveState(problem=said(error)))
            except Exception as error:  # kept and told: the scan goes on
                self._tell(LiveState(problem=said(error)))
            rest = max(PERIOD, REST * (time.monotonic() - began))

    def _tell(self, state: LiveState) -> None:
        if state.problem is not None and state.problem != self._state.problem:  # it may come again with every frame
            logger.exception("Whether CT and patient agree could not be told")
        self._state = state

    def _look(self) -> None:
        with self._lock:
            place, self._wanted = self._wanted, None
        if place is not None:
            self._place = place
            if self._live is not None:
                self._live.place(place)
                self._judge()
        frame = self._session.latest
        if frame is None or frame is self._last or frame.status != "OK" or frame.image is None:
            return
        self._last = frame
        if self._imaging is None:
            self._imaging = self._recognized(frame)
        if self._imaging is None:
            return
        if self._live is None:
            self._live = LiveAgreement(self._bone, self._place, self._imaging)
        self._keep(self._live.add(frame))
        self._judge()

    def _recognized(self, frame: LiveFrame) -> Imaging | None:
        """Region and probe, as the first frames show them, with this one among them; None while they are too few."""
        self._first.add(frame, 0)
        if self._first.usable < FRAMES_LOOKED_AT:
            return None
        kept, self._first = self._first, ScoutedFrames()
        sequence, poses = kept.sequence()
        return recognized_imaging(sequence.images, poses, self._configuration, True, self._region, self._probe)

    def _keep(self, echoes: SweepEchoes) -> None:
        with self._lock:
            self._seen.append(echoes)
            if sum(map(len, self._seen)) > 3 * MOST_SEEN:
                self._seen = [SweepEchoes.joined(self._seen).thinned(MOST_SEEN)]

    def _judge(self) -> None:
        live = self._live
        if live is None:
            return
        agreement, fallen, recent = live.agreement(), live.has_fallen(), live.echoes()
        with self._lock:
            if fallen:
                # What was seen before is of a patient who lay elsewhere
                self._seen = [recent]
            self._recent = recent
            self._state = LiveState(agreement, fallen)
