"""Whether CT and patient agree while a scan goes on, found out beside the threads that receive and insert: these never wait for it."""

from __future__ import annotations

import threading
from dataclasses import dataclass

from ...arrays import Floats
from ...imaging.beams import ProbeGeometry
from ...imaging.region import ImageRegion
from ...registration.agreement import Agreement
from ...registration.bone_field import BoneField
from ...registration.echoes import SweepEchoes
from ...registration.live import LiveAgreement
from ...sweep.configuration import PlusConfiguration
from ..pairing.synchronizer import LiveFrame
from .session import LiveSession
from .watch import Watch

PERIOD = 0.2
"""s between two looks at the newest frame."""

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
    problem: str | None = None


class AgreementWatch(Watch):
    """Looks at the newest frame of a session from time to time, on a thread of its own.

    Parameters
    ----------
    session : LiveSession
    bone : BoneField
    labels_to_reference : (4, 4) array, mm
        Rigid.
    configuration, region, probe
        See `Watch`.

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
        super().__init__(session, "aifrecon live agreement", PERIOD, configuration, region, probe)
        self._bone, self._place = bone, labels_to_reference
        self._live: LiveAgreement | None = None
        self._lock = threading.Lock()
        self._wanted: Floats | None = None
        self._seen: list[SweepEchoes] = []
        self._recent = SweepEchoes.joined(())
        self._state = LiveState()
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
        """Bone echoes to place the CT by: of the whole scan, or since CT and patient have come apart, but at least of the last seconds."""
        with self._lock:
            seen = SweepEchoes.joined(self._seen)
            return self._recent if self._state.has_fallen and len(seen) < len(self._recent) else seen

    def _tell_problem(self, problem: str) -> None:
        self._state = LiveState(None, self._state.has_fallen, problem)

    def _look(self, frame: LiveFrame | None) -> None:
        with self._lock:
            place, self._wanted = self._wanted, None
        if place is not None:
            self._place = place
            if self._live is not None:
                self._live.place(place)
                self._judge()
        imaging = None if frame is None else self._imaging(frame)
        if frame is None or imaging is None:
            return
        if self._live is None:
            self._live = LiveAgreement(self._bone, self._place, imaging)
        self._keep(self._live.add(frame))
        self._judge()

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
            if fallen and not self._state.has_fallen:
                # What was seen before is of a patient who lay elsewhere
                self._seen = []
            self._recent = recent
            self._state = LiveState(agreement, fallen)
