"""What the library notes of its work, in the application's log."""

import logging
import threading
from collections import deque

import qt

LIBRARY = "AIFReconLib"
HANDED_ON_EVERY = 500
"""ms between two looks at what other threads have noted."""

MOST_WAITING = 1000
"""Records that wait at most; beyond them the oldest are lost, as nobody would read them."""


class LibraryLog(logging.Handler):
    """Hands the library's records to the root logger, by which Slicer's application log gets them, on the main thread alone.

    It is attached when it is made, until `detach`; both are for the main thread.

    Notes
    -----
    Slicer's own handler puts a record into the model of a table, on whatever thread it was made; the threads of a live scan must not
    touch that. So while this handler is attached the library's records go no other way, and those of other threads wait for the timer.
    """

    def __init__(self):
        super().__init__()
        self._waiting = deque(maxlen=MOST_WAITING)
        self._timer = qt.QTimer()
        self._timer.setInterval(HANDED_ON_EVERY)
        self._timer.connect("timeout()", self.handOn)
        logger = logging.getLogger(LIBRARY)
        logger.addHandler(self)
        logger.propagate = False
        self._timer.start()

    def detach(self) -> None:
        """End, with what still waits."""
        logger = logging.getLogger(LIBRARY)
        self._timer.stop()
        logger.removeHandler(self)
        logger.propagate = True
        self.handOn()

    def emit(self, record) -> None:
        """Keep a record, and hand it on at once where that is allowed."""
        self._waiting.append(record)
        if threading.current_thread() is threading.main_thread():
            self.handOn()

    def handOn(self) -> None:
        """Hand on what waits, in its order."""
        while self._waiting:
            logging.getLogger().handle(self._waiting.popleft())
