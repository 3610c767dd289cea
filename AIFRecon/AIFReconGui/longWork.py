"""Long work of the panel: with progress and cancel, its errors shown in the panel's words."""

from AIFReconScene.panelWords import inPanelWords
from slicer.i18n import tr as _

from .errorsShown import errorsShown
from .progressDialog import ProgressDialog


class LongWork:
    """Does one thing at a time.

    Parameters
    ----------
    panel : QWidget
        Takes no input while work goes on.
    """

    def __init__(self, panel):
        self._panel = panel
        self._progress = None

    @property
    def isRunning(self) -> bool:
        """Whether something is being done."""
        return self._progress is not None

    def cancel(self) -> None:
        """Stop what is being done at its next report."""
        if self._progress is not None:
            self._progress.cancel()

    def run(self, title: str, failure: str, work, parameters) -> str:
        """Call ``work(parameters, progress=...)`` and return what it did, in words.

        An error of the library is shown under `failure`, and nothing was done; another one is a bug: it is shown and raised again. A cancel
        leaves the scene as it was.
        """
        from AIFReconLib.errors import OperationCanceled

        try:
            with errorsShown(failure, waitCursor=True) as outcome, ProgressDialog(title) as self._progress:
                self._panel.enabled = False
                return inPanelWords(work(parameters, progress=self._progress))
            return _("Canceled. Nothing was changed.") if isinstance(outcome.error, OperationCanceled) else ""
        finally:
            self._progress = None
            self._panel.enabled = True
