"""Windows breathe between two things that make them wait: what has been changed is laid out and drawn before anything else is done."""

import time

BUSY = 0.015
"""s of a turn of the event loop that was more than handling a few events, or a turn of the scan's threads."""

MOST = 3
"""Turns that pass in a row: where the loop always has much to do, what is to be done would wait for ever."""


class Breath:
    """Tells a timer without interval to let a turn of the event loop pass, where the loop itself had much to do since the timer's last.

    Parameters
    ----------
    clock : callable
        That of `time`.

    Notes
    -----
    After a widget or a view has changed the loop lays out and draws the window, which takes as long as a step that changes nodes. Both in
    one turn would be one wait for the user.
    """

    def __init__(self, clock=time.perf_counter):
        self._clock, self._since, self._passed = clock, clock(), 0

    def isNeeded(self) -> bool:
        """To be asked in every turn before anything is done: True where this turn should pass."""
        isBusy, self._since = self._clock() - self._since > BUSY, self._clock()
        self._passed = self._passed + 1 if isBusy and self._passed < MOST else 0
        return self._passed > 0

    def isOver(self) -> None:
        """Something was done now; what comes from here on is the event loop's own."""
        self._since = self._clock()
