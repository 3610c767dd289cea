"""Whether CT and patient still agree while the scan goes on: the bone echoes of the last seconds against the placed CT."""

from __future__ import annotations

from collections import deque

import numpy as np

from ..arrays import Floats, Integers
from ..bone.echoes.finder import BoneEchoFinder
from ..bone.echoes.found import FEWEST, SweepEchoes
from ..bone.echoes.search import echoes_of
from ..bone.field import BoneField
from ..bone.scan_line_reader import ForEachKind
from ..effective_settings import Imaging
from ..sweep.frames import TrackedFrame
from .agreement import ENOUGH, LARGEST_MEDIAN, Agreement
from .comparison import EchoFit, agreement_of, judged

SECONDS = 5.0
"""s of the scan that are looked back upon."""


class LiveAgreement:
    """Agreement over the last seconds of a live scan; one frame takes a few milliseconds, whatever came before.

    Not for several threads at once. Old frames are dropped as new ones come, so memory does not grow.

    `labels_to_reference` is rigid, (4, 4) in mm; `imaging` must know region and probe.
    """

    def __init__(self, bone: BoneField, labels_to_reference: Floats, imaging: Imaging):
        self._bone, self._place = bone, np.asarray(labels_to_reference, dtype=np.float64)
        self._finders = ForEachKind(BoneEchoFinder, imaging)
        self._recent: deque[tuple[float, SweepEchoes, EchoFit, Integers]] = deque()
        self._has_agreed = self._has_fallen = False

    def place(self, labels_to_reference: Floats) -> None:
        """Put the CT elsewhere; the echoes of the last seconds are judged anew."""
        self._place = np.asarray(labels_to_reference, dtype=np.float64)
        self._has_agreed = self._has_fallen = False
        self._recent = deque((time, echoes, *judged(echoes, self._bone, self._place)) for time, echoes, *_ in self._recent)

    def add(self, frame: TrackedFrame) -> SweepEchoes:
        """Take a frame and return its echoes; one without image or pose is passed over."""
        if frame.image is None or frame.image_to_reference is None:
            return SweepEchoes.joined(())
        echoes = echoes_of(frame, self._finders.of(frame))
        self._recent.append((frame.timestamp, echoes, *judged(echoes, self._bone, self._place)))
        while self._recent[-1][0] - self._recent[0][0] > SECONDS or self._recent[-1][0] < self._recent[0][0]:
            self._recent.popleft()
        return echoes

    def echoes(self) -> SweepEchoes:
        """The bone echoes of the last seconds, to place the CT by anew."""
        return SweepEchoes.joined([echoes for _, echoes, *_ in self._recent])

    def agreement(self) -> Agreement | None:
        """How well CT and the last seconds agree; None while they have shown too little bone."""
        if sum(len(echoes) for _, echoes, *_ in self._recent) < FEWEST:
            return None
        fits = [fit for _, _, fit, _ in self._recent]
        fit = EchoFit(*(np.concatenate([getattr(one, name) for one in fits]) for name in ("distances", "reachable")))
        agreement = agreement_of(fit, np.concatenate([owners for *_, owners in self._recent]))
        self._has_agreed |= agreement.enough
        return agreement

    def has_fallen(self) -> bool:
        """Whether CT and patient agreed once and do so no longer: the patient moved, or the tracker or its marker was bumped.

        While too little bone is seen, it is as it was.
        """
        agreement = self.agreement()
        if agreement is not None and self._has_agreed:
            # A label alone may be at the rim of what the last seconds show: that says nothing yet
            self._has_fallen = agreement.share < ENOUGH or not agreement.median_distance <= LARGEST_MEDIAN
        return self._has_fallen
