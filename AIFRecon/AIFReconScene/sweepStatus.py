"""What the panel knows of the chosen sweep, looked up again only when another is chosen or it has changed."""


class SweepStatus:
    """Remembers the `SweepSummary` of the sweep that the parameters name: it is asked for whenever any parameter changes."""

    def __init__(self):
        self._key = None
        self._summary = None

    def summary(self, parameters):
        """The `SweepSummary`, or None where no sweep is chosen."""
        from .sequenceReader import sweepSummary

        sweep, images = parameters.sweep, parameters.imageSequence
        if sweep is None:
            return None
        key = (sweep.GetID(), sweep.GetMTime(), images.GetID() if images is not None else None)
        if self._key != key:
            self._key, self._summary = key, sweepSummary(sweep, images)
        return self._summary

    def text(self, parameters) -> str:
        """The findings in words, a line each."""
        summary = self.summary(parameters)
        return "\n".join(summary.lines) if summary is not None else ""
