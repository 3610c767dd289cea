"""Long work of the panel: with progress and cancel, its errors shown in the panel's words.

Errors are told apart: what a user can mend in a message, everything else as Slicer tells bugs.
"""

import contextlib
import types
from typing import Any

import qt
import slicer
from AIFReconScene.inputs.nodesAtWork import NodesAtWork
from AIFReconScene.inputs.parameters import mending
from AIFReconScene.panelWords import inPanelWords
from slicer.i18n import tr as _

from AIFReconLib.errors import AIFReconError, OperationCanceled
from AIFReconLib.progress import report


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

        An error of the library is shown under `failure`, and nothing was done; with a choice of what would mend it the work is done again.
        Another error is a bug: it is shown and raised again. A cancel leaves the scene as it was, and so does a node that goes meanwhile.
        """
        nodes = NodesAtWork(parameters, self.cancel)
        try:
            with errorsShown(failure, parameters, waitCursor=True) as outcome, nodes, ProgressDialog(title) as self._progress:
                self._enable(False)
                # A node may have gone while the dialog came up
                report(self._progress, 0.0, title)
                return work(parameters, progress=self._progress)
        finally:
            self._progress = None
            self._enable(True)
        if outcome.isMended:
            return self.run(title, failure, work, parameters)
        return (nodes.lost or _("Canceled. Nothing was changed.")) if isinstance(outcome.error, OperationCanceled) else ""

    def _enable(self, enabled: bool) -> None:
        if self._panel is not None:
            self._panel.enabled = enabled


@contextlib.contextmanager
def errorsShown(failure: str, parameters=None, waitCursor: bool = False):
    """Errors of the library end the block and are shown under `failure`, in the panel's words; others are raised.

    What it yields has the `error` that was shown, or a cancel, and whether it `isMended`: the user has chosen a setting that would.

    Slicer's error display leaves a traceback and marks the application's error log, and so does its warning: right for a bug, wrong for
    a calibration that was not given. A bug still goes that way.
    """
    outcome, choices = types.SimpleNamespace(error=None, isMended=False), {}
    with slicer.util.tryWithErrorDisplay(failure, waitCursor=waitCursor):
        try:
            yield outcome
        except OperationCanceled as error:
            outcome.error = error
        except AIFReconError as error:
            outcome.error, choices = type(error)(inPanelWords(error)), mending(error, parameters)
    if outcome.error is not None and not isinstance(outcome.error, OperationCanceled):
        outcome.isMended = _tell(f"{failure}\n\n{outcome.error}", choices, parameters)


def _tell(text: str, choices: dict, parameters) -> bool:
    """Show what is wrong, with a button for each choice (parameter and value by its words) that would mend it; whether one was pressed."""
    if not choices or slicer.app.testingEnabled():
        slicer.util.infoDisplay(text, windowTitle=slicer.app.applicationName)
        return False
    box = qt.QMessageBox(slicer.util.mainWindow())
    box.icon, box.text, box.windowTitle = qt.QMessageBox.Information, text, slicer.app.applicationName
    buttons = [(box.addButton(words, qt.QMessageBox.ActionRole), chosen) for words, chosen in choices.items()]
    box.addButton(qt.QMessageBox.Close)
    box.exec_()
    for button, (name, value) in buttons:
        if box.clickedButton() == button:
            setattr(parameters, name, value)
            return True
    return False


class ProgressDialog:
    """Shows progress under a title and asks for cancel; use it as a context manager and pass it on as `progress`.

    This is the one adapter from the library's progress to Qt, and the only place below the widget's slots that lets Qt handle events while
    work goes on, so that the views stay alive and Cancel is heard. `cancel` may be called from outside as well, as the widget does when the
    scene is closed. The application may end in those events: it destroys its panels at once and lets Python go on, so nothing of Qt is
    touched after a cancel but what is still there.
    """

    STEPS = 1000
    WIDTH = 400
    """Pixels: it does not change its size with every message."""

    def __init__(self, title: str):
        self._title = title
        self._canceled = False
        self._dialog: Any = None

    def __enter__(self):
        self._dialog = slicer.util.createProgressDialog(
            windowTitle=self._title, labelText=self._title, maximum=self.STEPS, autoClose=False, autoReset=False, minimumWidth=self.WIDTH
        )
        slicer.app.connect("aboutToQuit()", self.cancel)
        slicer.app.processEvents()
        return self

    def __exit__(self, *exception):
        slicer.app.disconnect("aboutToQuit()", self.cancel)
        dialog, self._dialog = self._dialog, None
        if dialog:  # a destroyed one is false
            dialog.close()
            dialog.deleteLater()

    def __call__(self, fraction: float, message: str) -> bool:
        """Show `fraction` (0 to 1) and `message`, an empty one not; False when the user has asked to stop."""
        if not self._canceled:
            self._dialog.labelText = message or self._dialog.labelText
            self._dialog.value = int(fraction * self.STEPS)
            slicer.app.processEvents()
        # The events may have been the end of the application, with the dialog
        self._canceled = self._canceled or not self._dialog or self._dialog.wasCanceled
        return not self._canceled

    def cancel(self) -> None:
        """Stop at the next report."""
        self._canceled = True


def progressOr(progress, title: str):
    """A context manager: the progress function that somebody gave, else a `ProgressDialog` of this title."""
    return ProgressDialog(title) if progress is None else contextlib.nullcontext(progress)
