"""Windows stay alive: the library's work goes on a thread of its own, and between steps of the main thread they get their turn."""

import concurrent.futures
import threading

from AIFReconLib.machine.threads import give_way
from AIFReconLib.progress import report

ALIVE_EVERY = 0.02
"""s between two looks of the main thread at its events."""


def inBackground(work, progress=None):
    """Call ``work(progress)`` and return what it returns; the caller's `progress` hears of it often, on the caller's thread.

    Parameters
    ----------
    work : callable
        Computes with the library alone: nodes, views and widgets belong to the main thread. It is given a progress function.
    progress : callable or None
        As everywhere; None: nobody waits for events, and `work` is called as it is.

    Raises
    ------
    OperationCanceled
        When `progress` returns False; `work` has ended by then.
    Exception
        Whatever `work` raises.
    """
    if progress is None:
        return work(None)
    relay = _Relay()
    with concurrent.futures.ThreadPoolExecutor(1, "AIFRecon work", initializer=give_way) as worker:
        future = worker.submit(work, relay)
        try:
            while not concurrent.futures.wait([future], ALIVE_EVERY).done:
                if progress(*relay.latest) is False:
                    relay.canceled.set()
        finally:
            relay.canceled.set()
    result = future.result()
    report(progress, *relay.latest)
    return result


class Beside:
    """One piece of the library's work that nobody waits for; its result is asked for from time to time."""

    def __init__(self):
        self._worker = self._future = self._relay = None

    @property
    def isRunning(self) -> bool:
        """Whether something was begun and not taken yet."""
        return self._future is not None

    def begin(self, work) -> None:
        """Call ``work(progress)`` on a thread of its own; what was begun before is dropped."""
        self.cancel()
        self._relay = _Relay()
        self._worker = concurrent.futures.ThreadPoolExecutor(1, "AIFRecon beside", initializer=give_way)
        self._future = self._worker.submit(work, self._relay)

    def take(self):
        """What the work has returned, once; None before and after. Whatever it raises is raised here."""
        if self._future is None or not self._future.done():
            return None
        future, self._future = self._future, None
        self._worker.shutdown(wait=False)
        return future.result()

    def cancel(self) -> None:
        """Drop what was begun; it ends at its next report."""
        if self._future is not None:
            self._relay.canceled.set()
            self._worker.shutdown(wait=False)
            self._future = None


class _Relay:
    """The progress function of the worker: keeps the latest report for the main thread, and tells the worker to stop."""

    def __init__(self):
        self.latest = (0.0, "")
        self.canceled = threading.Event()

    def __call__(self, fraction, message) -> bool:
        self.latest = (fraction, message)
        return not self.canceled.is_set()
