"""Snapshots of a growing volume, made beside whoever shows them: a user interface must not wait for them."""

from __future__ import annotations

import logging
import threading

from ...compounding.state import Reconstruction
from .session import LiveSession

logger = logging.getLogger(__name__)


class SnapshotMaker:
    """Makes one snapshot at a time on a thread of its own.

    `request` and `take` return at once. A request while one is being made is met by that one. What goes wrong in making one is kept in
    `error` until one succeeds.
    """

    def __init__(self, session: LiveSession):
        self._session = session
        self._wanted = threading.Event()
        self._lock = threading.Lock()
        self._ready: Reconstruction | None = None
        self._inserted = -1
        self._closing = False
        self.error: Exception | None = None
        self._thread = threading.Thread(target=self._make, name="aifrecon snapshots", daemon=True)
        self._thread.start()

    def request(self) -> None:
        """Ask for a snapshot, which is made if frames have been inserted since the last one."""
        self._wanted.set()

    def take(self) -> Reconstruction | None:
        """The newest snapshot that has not been taken yet, or None."""
        with self._lock:
            ready, self._ready = self._ready, None
        return ready

    def stop(self) -> None:
        """Make no more; waits for the one that is being made."""
        self._closing = True
        self._wanted.set()
        self._thread.join()

    def _make(self) -> None:
        while True:
            self._wanted.wait()
            self._wanted.clear()
            if self._closing:
                return
            inserted = self._session.statistics.inserted
            if inserted == self._inserted:
                continue
            self._inserted = inserted
            try:
                made = self._session.snapshot()
            except Exception as error:  # kept and told: the scan goes on, and the next request tries again
                if str(error) != str(self.error):  # it may come again with every request
                    logger.exception("A snapshot of a live scan could not be made")
                self.error = error
                continue
            self.error = None
            with self._lock:
                self._ready = made
