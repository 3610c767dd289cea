"""What a scan shows is shown in steps, each in its own turn of the event loop, and drawn view by view: windows can breathe between them."""

from ..display.viewByView import drawnInTheEnd


class InSteps:
    """Steps change nodes while nothing is drawn, and then one view is drawn after the other.

    Notes
    -----
    A node that changes costs the application tens of milliseconds, and every view that shows it as many; drawn as they change, views are
    drawn several times, and with something in it that is not in its place yet.
    """

    def __init__(self):
        self._steps = None

    @property
    def isUnderWay(self) -> bool:
        """Whether steps are left."""
        return self._steps is not None

    def begin(self, steps) -> None:
        """These steps, an iterator, are to be taken: the first when `goOn` is called next."""
        self._steps = drawnInTheEnd(steps)

    def goOn(self) -> bool:
        """Take the next step; True while more are left. What goes wrong ends them."""
        steps, self._steps = self._steps, None
        if steps is None or next(steps, self) is self:
            return False
        self._steps = steps
        return True

    def interrupt(self) -> None:
        """Take no more steps; views are drawn again."""
        if self._steps is not None:
            self._steps.close()
            self._steps = None
