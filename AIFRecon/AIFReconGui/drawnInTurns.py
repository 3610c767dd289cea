"""What the user has just chosen is drawn view by view, each in a turn of the event loop of its own, and nobody waits for it."""

import contextlib

import qt
import slicer
from AIFReconScene.display.viewByView import viewByView


@contextlib.contextmanager
def drawnInTurns():
    """Nothing is drawn within, however many nodes change; after it windows are alive between one view and the next."""
    slicer.app.pauseRender()
    try:
        yield
    finally:
        _drawNext(viewByView())


def _drawNext(steps) -> None:
    def draw() -> None:
        if next(steps, steps) is not steps:
            _drawNext(steps)

    qt.QTimer.singleShot(0, draw)
