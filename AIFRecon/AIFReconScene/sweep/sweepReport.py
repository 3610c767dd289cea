"""How well a sweep was tracked: the library's report, kept from the last reconstruction or made when it is asked for."""

from ..background import inBackground
from .browserItems import checkRecorded
from .sweepStatus import sweepKey


class SweepReport:
    """Remembers the `TrackingReport` of one sweep, and what was made of it."""

    def __init__(self):
        self._key = None
        self._report = None
        self._title = ""

    def remember(self, inputs, sequence, result, progress=None) -> None:
        """Keep the report of a reconstruction.

        Parameters
        ----------
        inputs : Inputs
        sequence : TrackedSequence
            What was reconstructed from them; of several sweeps the report is that of the first.
        result : Reconstruction
            Only numbers are kept of it.
        progress : callable or None
            A cancel leaves what was kept before.
        """
        self._make(inputs.sweep, inputs.imageSequence, sequence.sweeps[0], result, progress)

    def of(self, parameters) -> tuple:
        """Title and `TrackingReport` of the chosen sweep; without a reconstruction of it, the coverage is not known.

        Raises
        ------
        AIFReconError
            When the sweep cannot be read, or is still being recorded.
        """
        from .sequenceReader import sequenceFromBrowser

        checkRecorded(parameters.sweep)
        if self._key != sweepKey(parameters.sweep, parameters.imageSequence):
            sequence = sequenceFromBrowser(parameters.sweep, parameters.imageSequence)
            self._make(parameters.sweep, parameters.imageSequence, sequence)
        return self._title, self._report

    def _make(self, sweep, imageSequence, sequence, result=None, progress=None) -> None:
        from AIFReconLib.inspection.tracking_report import tracking_report
        from AIFReconLib.sweep.poses import sweep_poses

        self._report = inBackground(lambda _progress: tracking_report(sequence, sweep_poses(sequence), result), progress)
        self._title = sweep.GetName() if result is None else f"{sweep.GetName()} {result.method}"
        self._key = sweepKey(sweep, imageSequence)
