"""The one adapter from the library's progress to Qt: a dialog with a bar, a message and Cancel."""

import contextlib
from typing import Any

import slicer


class ProgressDialog:
    """Shows progress under a title and asks for cancel; use it as a context manager and pass it on as `progress`.

    This is the only place below the widget's slots that lets Qt handle events while work goes on, so that the views stay alive and
    Cancel is heard. `cancel` may be called from outside as well, as the widget does when the scene is closed. The application may end
    in those events: it destroys its panels at once and lets Python go on, so nothing of Qt is touched after a cancel but what is still
    there.
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
