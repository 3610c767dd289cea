"""Long work of the panel: with progress and cancel, its errors shown in the panel's words."""

from AIFReconScene.inputs.nodesAtWork import NodesAtWork
from slicer.i18n import tr as _

from AIFReconLib.errors import OperationCanceled
from AIFReconLib.progress import report

from .errorsShown import errorsShown
from .progressDialog import ProgressDialog


class LongWork:
    """Does one thing at a time, and stops it when a node that it needs is deleted or the panel goes, which takes no input meanwhile."""

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

    def close(self) -> None:
        """Stop what is being done; the panel is touched no more, for it is destroyed while the work is still on its way out."""
        self.cancel()
        self._panel = None

    def run(self, title: str, failure: str, work, parameters) -> str:
        """Call ``work(parameters, progress=...)`` and return what it did, in words.

        An error of the library is shown under `failure`, and nothing was done; another one is a bug: it is shown and raised again. A cancel
        leaves the scene as it was, and so does a node that is deleted meanwhile.
        """
        nodes = NodesAtWork(parameters, self.cancel)
        try:
            with errorsShown(failure, waitCursor=True) as outcome, nodes, ProgressDialog(title) as self._progress:
                self._enable(False)
                # A node may have gone while the dialog came up
                report(self._progress, 0.0, title)
                return work(parameters, progress=self._progress)
            return (nodes.lost or _("Canceled. Nothing was changed.")) if isinstance(outcome.error, OperationCanceled) else ""
        finally:
            self._progress = None
            self._enable(True)

    def _enable(self, enabled: bool) -> None:
        if self._panel is not None:
            self._panel.enabled = enabled
