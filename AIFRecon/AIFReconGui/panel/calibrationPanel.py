"""What belongs to the light Calibration: calibrates the chosen sweeps by what they show, when asked to, and takes that back."""

import slicer
from AIFReconScene.inputs import readiness
from AIFReconScene.panelWords import inPanelWords
from AIFReconScene.registration.moves import Moves
from AIFReconScene.registration.sweepCalibration import calibrated
from slicer.i18n import tr as _

from .layout import enable, say
from .panelPart import PanelPart


class CalibrationPanel(PanelPart):
    """Connects the buttons below the light to `calibrated` and its `Moves`.

    `others` have a method `forget`: what they show of a sweep is of its former calibration once that has changed.
    """

    def __init__(self, ui, work, refresh, live, logic, *others):
        super().__init__(ui, work, refresh)
        self._live, self._logic, self._others = live, logic, others
        self._moves, self._about = Moves(), ()
        ui.calibrateButton.connect("clicked(bool)", self.onCalibrate)
        ui.undoCalibrationButton.connect("clicked(bool)", self.onUndo)

    def update(self) -> None:
        """Enable what can be done; what was said of other nodes goes."""
        ui, parameters = self._ui, self._parameterNode
        missing = self._live.whyNotNow() or readiness.whyNotRegister(parameters, self._logic.sweep.summary(parameters))
        does = _("Find the calibration with which the echoes lie on the CT's bone, and use it where the sweep tells; it can be undone")
        enable(ui.calibrateButton, missing, does)
        ui.undoCalibrationButton.enabled = self._moves.canUndo
        if self._about != (about := (parameters.sweep, parameters.bone)):
            self._about = about
            self._say("")

    def close(self) -> None:
        """The scene or the panel is being closed."""
        self._moves, self._about = Moves(), ()

    def onCalibrate(self) -> None:
        """Calibrate; nothing is changed where the sweep does not tell."""
        self._ui.calibrationMoreButton.checked = True
        failure = _("The sweep could not be calibrated. Nothing was changed.")
        self._say(self._do(_("Calibrating"), failure, self._calibrate))

    def onUndo(self) -> None:
        """Bring back the calibration that was there before the last one."""
        if self._moves.undo():
            self._changed()
            self._say(_("The calibration is back as it was."))
        self._refresh()

    def _calibrate(self, parameters, progress) -> str:
        found, moves = calibrated(parameters, progress)
        if moves:
            with slicer.util.RenderBlocker():
                self._moves.do(*moves)
            self._changed()
        return "\n".join(map(inPanelWords, found.lines))

    def _changed(self) -> None:
        for other in self._others:
            other.forget()

    def _say(self, text: str) -> None:
        if self._ui.calibrationLabel:  # destroyed: the application is being closed
            self._ui.calibrationLabel.visible = bool(text)
            say(self._ui.calibrationLabel, text)
