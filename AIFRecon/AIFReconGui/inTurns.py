"""What the user has just chosen is done in steps and drawn view by view, each in a turn of the event loop of its own."""

import contextlib

import qt
import slicer
from AIFReconScene.display.viewByView import drawnInTheEnd, viewByView

from .breath import Breath

_underWay = 0


def isUnderWay() -> bool:
    """Whether something is still being done or drawn: another's steps had better wait, for windows would wait for both."""
    return _underWay > 0


def inTurns(steps) -> None:
    """Take steps, an iterator, each in a turn of its own from the next one on; nothing is drawn before the last.

    Windows are alive between them, and the user may have chosen otherwise by then: each step looks whether it is still wanted.
    """
    _takeNext(drawnInTheEnd(steps))


@contextlib.contextmanager
def drawnInTurns():
    """Nothing is drawn within, however many nodes change; after it windows are alive between one view and the next."""
    slicer.app.pauseRender()
    try:
        yield
    finally:
        _takeNext(viewByView())


def _takeNext(steps) -> None:
    global _underWay
    breath = Breath()

    def take() -> None:
        global _underWay
        if breath.isNeeded():
            qt.QTimer.singleShot(0, take)
            return
        _underWay -= 1
        if next(steps, steps) is not steps:
            _takeNext(steps)

    _underWay += 1
    qt.QTimer.singleShot(0, take)
