"""Turns at the interpreter: Slicer's windows keep Python to themselves while they draw and even while they wait, unless they hand it on."""

import time

LEAST, LONGEST = 0.004, 0.012
"""s of one turn of the other threads: for so long no event is handled, which nobody notices."""

MOST_OWED = 0.3
"""s that windows owe at most, whatever they did: after something that took long a scan's display must go on."""

HELD_BACK, LET_GO = 0.4, 0.25
"""s for which nothing is drawn because windows owe, and then something all the same: they may be busy with what others draw, such as the
images that another module puts into the scene, and owe for ever."""


class Turns:
    """Hands the interpreter to other threads, as long as the windows' own thread has kept it.

    Parameters
    ----------
    clock, sleep : callables
        Those of `time`.

    Notes
    -----
    The application's event loop is C++ that holds the interpreter's lock: PythonQt's support of threads is off in Slicer. A thread in
    Python gets on only while the windows' thread runs Python that lets go of the lock, so without this a scan would be received between
    the ticks of a timer. `time.sleep` lets go of it. Called by a timer without interval, `give` knows how long events have taken.
    """

    def __init__(self, clock=time.perf_counter, sleep=time.sleep):
        self._clock, self._sleep = clock, sleep
        self._owed, self._since, self._owing = 0.0, None, 0.0

    @property
    def isOwing(self) -> bool:
        """Whether windows have kept the interpreter for so long that one turn does not make up for it: nothing should be drawn now."""
        return self._owed > LONGEST and (self._clock() - self._owing) % (HELD_BACK + LET_GO) < HELD_BACK

    def give(self) -> None:
        """Let other threads work for some milliseconds; to be called whenever events have been handled."""
        now = self._clock()
        if self._owed <= LONGEST:
            self._owing = now
        if self._since is not None:
            self._owed = min(self._owed + now - self._since, MOST_OWED)
        self._sleep(min(max(self._owed, LEAST), LONGEST))
        self._since = self._clock()
        self._owed = max(self._owed - (self._since - now), 0.0)

    def forget(self) -> None:
        """Begin anew: what came before was no scan."""
        self._owed, self._since = 0.0, None
