"""What is found out beside a scan, by a pool of threads: reception and insertion never wait for it, nor share their moments with it."""

from __future__ import annotations

import logging
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from concurrent.futures import wait

from ...message import message_of
from ..pairing.synchronizer import LiveFrame
from .session import LiveSession

logger = logging.getLogger(__name__)

PATIENCE, SHORT_PATIENCE = 0.05, 0.02
"""s after which it looks though nothing was inserted, while a scan is scouted or paused; and after which a step is done though a frame
waits: where they always do, for cores are too few, it would never be."""

BREATH, LITTLE = 0.25, 0.001
"""By how many times longer it rests between two steps than it worked, for they make way to frames at once and last for seconds in all; and
the s of work after which it does not."""

REST = 1.0
"""By how many times longer it rests than it worked: at most half of one core is taken, however fast frames come."""


class Watch(ABC):
    """Follows a session: looks at its newest frame, again and again.

    Parameters
    ----------
    session : LiveSession
        Of which `latest`, `imaging`, `wait_for_rest` and `pool` are used.
    period : float, s
        Between two looks at least.

    Attributes
    ----------
    problem : str or None
        Why nothing, or no more, can be told.

    Notes
    -----
    Work begins when a frame was just inserted and none waits: until the next one comes, cores, memory and interpreter are free. Who works
    longer than some 10 ms does so in steps of 5 ms, of which none is begun while a frame waits. What goes wrong
    is told and kept; the scan goes on. Everything but what others ask happens on one thread: what they want changed is handed to it by
    `_ask`. `stop` waits for the step under way, all else returns at once.
    """

    def __init__(self, session: LiveSession, period: float = 0.0):
        self._session, self._period = session, period
        self._asked: dict[str, Callable[[], None]] = {}
        self._newest: LiveFrame | None = None
        self._last: LiveFrame | None = None
        self._closing = threading.Event()
        self._resumed = time.monotonic()
        self._logged: str | None = None
        self.problem: str | None = None

    def _start(self) -> None:
        self._running = self._session.pool.submit(self._run)

    @property
    def looked_at(self) -> int:
        """Number of the last frame that was looked at, -1 before the first."""
        return -1 if self._last is None else self._last.number

    def stop(self, wait_for_it: bool = True) -> None:
        """Look at no more frames; where asked to, it waits for the step under way."""
        self._closing.set()
        if wait_for_it:
            wait([self._running])

    @abstractmethod
    def _look(self, frame: LiveFrame | None) -> Iterable[object]:
        """Look at a frame with image and pose that was not seen before (None: there is no new one); what takes longer is done in steps."""

    def _tell_problem(self, problem: str) -> None:
        """Say why nothing can be told."""
        self.problem = problem

    def _ask(self, what: str, change: Callable[[], None]) -> None:
        """Have something done before the next look, in the place of what was asked under the same name."""
        self._asked[what] = change

    def _run(self) -> None:
        while self._breathe():
            try:
                while self._asked:
                    self._asked.pop(next(iter(self._asked)))()
                for _ in self._look(self._next_frame()):
                    if not self._make_way():
                        return
            except Exception as error:  # kept and told: the scan goes on
                problem = message_of(error)
                if problem != self._logged:  # it may come again with every frame
                    self._logged = problem
                    logger.exception("Something that is told beside a live scan could not be told")
                self._tell_problem(problem)

    def _breathe(self) -> bool:
        """Wait for the next moment in which nothing is received or inserted; False when the end has come."""
        if not self._closing.wait(max(self._period, REST * (time.monotonic() - self._resumed))):
            self._session.wait_for_rest(PATIENCE)
        return self._resume()

    def _make_way(self) -> bool:
        """Rest for a moment, and where a frame waits until it was inserted; False when the end has come."""
        worked = time.monotonic() - self._resumed
        if worked >= LITTLE:
            self._closing.wait(BREATH * worked)
        if not self._closing.is_set() and not self._session.wait_for_rest(0.0):
            self._session.wait_for_rest(SHORT_PATIENCE)
        return self._resume()

    def _resume(self) -> bool:
        self._resumed = time.monotonic()
        return not self._closing.is_set()

    def _next_frame(self) -> LiveFrame | None:
        self._newest = frame = self._session.latest
        if frame is None or frame is self._last or frame.status != "OK" or frame.image is None or frame.image_to_reference is None:
            return None
        self._last = frame
        return frame
