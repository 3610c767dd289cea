"""Snapshots of a growing volume, made beside whoever shows them: a user interface must not wait for them."""

from __future__ import annotations

import logging
from concurrent.futures import Future, wait

from ...compounding.state import Reconstruction
from .session import LiveSession

logger = logging.getLogger(__name__)


class SnapshotMaker:
    """Makes one snapshot at a time in the session's pool.

    `request` and `take` return at once. A request while one is being made, or was not taken yet, is met by that one. What goes wrong in
    making one is kept in `error` until one succeeds.
    """

    def __init__(self, session: LiveSession):
        self._session = session
        self._making: Future[Reconstruction | None] | None = None
        self._inserted = -1
        self.error: BaseException | None = None

    def request(self) -> None:
        """Ask for a snapshot, which is made if frames have been inserted since the last one."""
        inserted = self._session.statistics.inserted
        if self._making is None and inserted != self._inserted:
            self._inserted = inserted
            self._making = self._session.pool.submit(self._session.snapshot)

    def take(self) -> Reconstruction | None:
        """The newest snapshot that has not been taken yet, or None."""
        if self._making is None or not self._making.done():
            return None
        made, self._making = self._making, None
        before, self.error = self.error, made.exception()
        if self.error is None:
            return made.result()
        if str(self.error) != str(before):  # it may come again with every request
            logger.error("A snapshot of a live scan could not be made", exc_info=self.error)
        return None

    def stop(self) -> None:
        """Wait for the one that is being made."""
        if self._making is not None:
            wait([self._making])
