"""What is found out beside a scan, on a thread of its own: reception and insertion never wait for it, nor share their moments with it."""

from __future__ import annotations

import logging
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable

from ...message import said
from ..pairing.synchronizer import LiveFrame
from .session import LiveSession

logger = logging.getLogger(__name__)

PATIENCE, SHORT_PATIENCE = 0.05, 0.02
"""s after which it looks though nothing was inserted, while a scan is scouted or paused; and after which a piece of work is done though a
frame waits: where they always do, for cores are too few, it would never be."""

PIECE = 0.005
"""s that a piece of work may take: none is begun when the next frame is expected sooner."""

BREATH, LITTLE = 0.25, 0.001
"""By how many times longer it rests between two pieces than it worked, for they make way to frames at once and last for seconds in all; and
the s of work after which it does not."""

REST = 1.0
"""By how many times longer it rests than it worked: at most half of one core is taken, however fast frames come."""


class Watch(ABC):
    """Follows a session: looks at its newest frame, again and again.

    Parameters
    ----------
    session : LiveSession
        Of which `latest`, `imaging` and `wait_for_rest` are used.
    name : str
        Of the thread.
    period : float, s
        Between two looks at least.

    Notes
    -----
    Work begins when a frame was just inserted and none waits: until the next one comes, cores, memory and interpreter are free. Work that
    takes longer than some 10 ms should be parted: by `_make_way` into pieces of `PIECE`, as many as there is time for between two frames,
    or by `_breathe`, one step for each frame. What goes wrong is told and kept; the scan goes on. Everything but what others ask happens
    on the thread: what they want changed is handed to it by `_ask`. `stop` waits for the step under way, all else returns at once.
    """

    def __init__(self, session: LiveSession, name: str, period: float = 0.0):
        self._session, self._period = session, period
        self._asked: dict[str, Callable[[], None]] = {}
        self._last: LiveFrame | None = None
        self._closing = threading.Event()
        self._resumed = time.monotonic()
        self._logged: str | None = None
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    @property
    def looked_at(self) -> int:
        """Number of the last frame that was looked at, -1 before the first."""
        return -1 if self._last is None else self._last.number

    def stop(self, wait: bool = True) -> None:
        """Look at no more frames; where asked to, it waits for the step under way."""
        self._closing.set()
        if wait and self._thread.ident is not None:
            self._thread.join()

    @abstractmethod
    def _look(self, frame: LiveFrame | None) -> None:
        """Look at a frame with image and pose that was not seen before; None: there is no new one."""

    @abstractmethod
    def _tell_problem(self, problem: str) -> None:
        """Say why nothing can be told."""

    def _ask(self, what: str, change: Callable[[], None]) -> None:
        """Have something done before the next look, in the place of what was asked under the same name."""
        self._asked[what] = change

    def _run(self) -> None:
        while self._breathe():
            self._attempt()

    def _breathe(self) -> bool:
        """Wait for the next moment in which nothing is received or inserted; False when the end has come."""
        rest = max(self._period, REST * (time.monotonic() - self._resumed))
        if not self._closing.wait(rest):
            self._session.wait_for_rest(PATIENCE)
        self._resumed = time.monotonic()
        return not self._closing.is_set()

    def _make_way(self) -> bool:
        """Rest for a moment, and where a frame waits or will come soon until it was inserted; False when the end has come."""
        worked = time.monotonic() - self._resumed
        if worked >= LITTLE:
            self._closing.wait(BREATH * worked)
        if not self._closing.is_set() and self._session.wait_for_rest(0.0) < PIECE:
            self._session.wait_for_rest(SHORT_PATIENCE)
        self._resumed = time.monotonic()
        return not self._closing.is_set()

    def _attempt(self) -> None:
        """What was asked, and one look, whatever comes of it."""
        try:
            while self._asked:
                self._asked.pop(next(iter(self._asked)))()
            self._look(self._next_frame())
        except Exception as error:  # kept and told: the scan goes on
            problem = said(error)
            if problem != self._logged:  # it may come again with every frame
                self._logged = problem
                logger.exception("Something that is told beside a live scan could not be told")
            self._tell_problem(problem)

    def _next_frame(self) -> LiveFrame | None:
        frame = self._session.latest
        if frame is None or frame is self._last or frame.status != "OK" or frame.image is None or frame.image_to_reference is None:
            return None
        self._last = frame
        return frame
