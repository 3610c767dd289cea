"""How well a sweep was tracked: the library's report, kept from the last reconstruction or made when it is asked for."""

from AIFReconLib.inspection.tracking_report import tracking_report
from AIFReconLib.sweep.poses import sweep_poses

from .browserItems import checkRecorded
from .sequenceReader import sequenceFromBrowser
from .sweepStatus import sweepKey


class SweepReport:
    """Remembers the `TrackingReport` of one sweep, and what was made of it."""

    def __init__(self):
        self._key = self._report = None
        self._title = ""

    def remember(self, inputs, method: str, report) -> None:
        """Keep the `TrackingReport` of what a method made of `Inputs`; of several sweeps that of the first."""
        self._key = sweepKey(inputs.sweep, inputs.imageSequence)
        self._title, self._report = f"{inputs.sweep.GetName()} {method}", report

    def of(self, parameters) -> tuple:
        """Title and `TrackingReport` of the chosen sweep; without a reconstruction of it, the coverage is not known.

        Raises AIFReconError when the sweep cannot be read, or is still being recorded.
        """
        checkRecorded(parameters.sweep)
        key = sweepKey(parameters.sweep, parameters.imageSequence)
        if self._key != key:
            sequence = sequenceFromBrowser(parameters.sweep, parameters.imageSequence)
            self._report, self._title, self._key = tracking_report(sequence, sweep_poses(sequence)), parameters.sweep.GetName(), key
        return self._title, self._report
