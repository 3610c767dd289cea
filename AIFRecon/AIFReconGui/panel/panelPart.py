"""What the parts of the panel have in common: widgets, long work, and a look at something now and then."""

import qt

from ..fields.choosers import Follower


class PanelPart(Follower):
    """Connects some widgets of AIFRecon.ui to what they stand for.

    `work` is the panel's `LongWork`; `refresh` is called without arguments when what can be pressed in the panel has changed.
    """

    def __init__(self, ui, work, refresh):
        self._ui, self._work, self._refresh = ui, work, refresh

    def _do(self, title: str, failure: str, work) -> str:
        """Do long work and return what it said: a cancel too, nothing after an error that was shown."""
        try:
            return self._work.run(title, failure, work, self._parameterNode)
        finally:
            self._refresh()


def every(milliseconds: int, slot):
    """A timer that calls a slot so often once it is started."""
    timer = qt.QTimer()
    timer.setInterval(milliseconds)
    timer.connect("timeout()", slot)
    return timer
