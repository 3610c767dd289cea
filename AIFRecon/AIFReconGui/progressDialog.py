"""The one adapter from the library's progress to Qt: a dialog with a bar, a message and Cancel."""

import slicer
from AIFReconScene.panelWords import inPanelWords


class ProgressDialog:
    """Shows progress and asks for cancel; use it as a context manager and pass it on as `progress`.

    Parameters
    ----------
    title : str
        What is being done, translated.

    Notes
    -----
    This is the only place below the widget's slots that lets Qt handle events while work goes on, so that the views stay alive and
    Cancel is heard. `cancel` may be called from outside as well, as the widget does when the scene is closed.
    """

    STEPS = 1000
    WIDTH = 400
    """Pixels: it does not change its size with every message."""

    def __init__(self, title: str):
        self._title = title
        self._canceled = False
        self._dialog = None

    def __enter__(self):
        self._dialog = slicer.util.createProgressDialog(
            windowTitle=self._title, labelText=self._title, maximum=self.STEPS, autoClose=False, autoReset=False, minimumWidth=self.WIDTH
        )
        slicer.app.processEvents()
        return self

    def __exit__(self, *exception):
        dialog, self._dialog = self._dialog, None
        dialog.close()
        dialog.deleteLater()

    def __call__(self, fraction: float, message: str) -> bool:
        """Show `fraction` (0 to 1) and `message`; False when the user has asked to stop."""
        dialog = self._dialog
        dialog.labelText = inPanelWords(message)
        dialog.value = int(fraction * self.STEPS)
        slicer.app.processEvents()
        self._canceled = self._canceled or dialog.wasCanceled
        return not self._canceled

    def cancel(self) -> None:
        """Stop at the next report."""
        self._canceled = True
