"""How the panel tells errors: what a user can mend in a message, everything else as Slicer tells bugs."""

import contextlib

import slicer
from AIFReconScene.panelWords import errorsInPanelWords

from AIFReconLib.errors import AIFReconError, OperationCanceled


class Outcome:
    """What became of a block: its `error` is what was shown, or a cancel."""

    def __init__(self):
        self.error = None


@contextlib.contextmanager
def errorsShown(failure: str, waitCursor: bool = False):
    """Errors of the library end the block and are shown under `failure`, in the panel's words; others are raised. Yields the `Outcome`.

    Slicer's error display leaves a traceback and marks the application's error log, and so does its warning: right for a bug, wrong for
    a calibration that was not given. A bug still goes that way.
    """
    outcome = Outcome()
    with slicer.util.tryWithErrorDisplay(failure, waitCursor=waitCursor):
        try:
            with errorsInPanelWords():
                yield outcome
        except AIFReconError as error:
            outcome.error = error
    if outcome.error is not None and not isinstance(outcome.error, OperationCanceled):
        slicer.util.infoDisplay(f"{failure}\n\n{outcome.error}", windowTitle=slicer.app.applicationName)
