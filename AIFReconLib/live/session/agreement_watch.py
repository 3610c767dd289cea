"""Whether CT and patient agree while a scan goes on."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

from ...arrays import Floats
from ...bone.echoes.found import SweepEchoes
from ...bone.field import BoneField
from ...registration.agreement import Agreement
from ...registration.live import LiveAgreement
from ..pairing.synchronizer import LiveFrame
from .session import LiveSession
from .watch import Watch

PERIOD = 0.2
"""s between two looks at the newest frame."""

MOST_SEEN = 6000
"""Echoes of the scan so far that are kept, evenly in space; a few times as many between two sortings."""


class AgreementWatch(Watch):
    """Compares the bone echoes of the newest frame with the placed CT, from time to time. Memory does not grow with the scan.

    Parameters
    ----------
    labels_to_reference : (4, 4) array, mm
        Rigid.

    Attributes
    ----------
    agreement : Agreement or None
        Of the last seconds; None while they have shown too little bone.
    has_fallen : bool
        CT and patient agreed in this scan and do so no longer.
    """

    def __init__(self, session: LiveSession, bone: BoneField, labels_to_reference: Floats):
        super().__init__(session, PERIOD)
        self._bone, self._labels_to_reference = bone, labels_to_reference
        self._live: LiveAgreement | None = None
        # Of the scan so far, and of the last seconds: replaced together
        self._echoes: tuple[list[SweepEchoes], SweepEchoes] = [], SweepEchoes.joined(())
        self.agreement: Agreement | None = None
        self.has_fallen = False
        self._start()

    def place(self, labels_to_reference: Floats) -> None:
        """The CT lies elsewhere now; the last seconds are judged anew."""
        self._ask("place", partial(self._move, labels_to_reference))

    def echoes(self) -> SweepEchoes:
        """Bone echoes to place the CT by: of the whole scan, or since CT and patient have come apart, but at least of the last seconds."""
        has_fallen, (scan, recent) = self.has_fallen, self._echoes
        seen = SweepEchoes.joined(scan)
        return recent if has_fallen and len(seen) < len(recent) else seen

    def _tell_problem(self, problem: str) -> None:
        super()._tell_problem(problem)
        self.agreement = None

    def _move(self, labels_to_reference: Floats) -> None:
        self._labels_to_reference = labels_to_reference
        if self._live is not None:
            self._live.place(labels_to_reference)
            self._judge(self._live, self._echoes[0])

    def _look(self, frame: LiveFrame | None) -> Iterable[object]:
        imaging = None if frame is None else self._session.imaging()
        if frame is None or imaging is None:
            return ()
        if self._live is None:
            self._live = LiveAgreement(self._bone, self._labels_to_reference, imaging)
        scan = [*self._echoes[0], self._live.add(frame)]
        if sum(map(len, scan)) > 3 * MOST_SEEN:
            scan = [SweepEchoes.joined(scan).thinned(MOST_SEEN)]
        self._judge(self._live, scan)
        return ()

    def _judge(self, live: LiveAgreement, scan: list[SweepEchoes]) -> None:
        has_fallen = live.has_fallen()
        # What was seen before is of a patient who lay elsewhere
        self._echoes = ([] if has_fallen and not self.has_fallen else scan), live.echoes()
        self.agreement, self.has_fallen, self.problem = live.agreement(), has_fallen, None
