"""Traffic lights below Reconstruct: tracking, registration, coverage, calibration and motion, each in words with what to do."""

from html import escape

from AIFReconScene.panelWords import inPanelWords
from AIFReconScene.registration.sweepVerdicts import NAMES, WITHOUT_CT
from slicer.i18n import tr as _

from ..fields.choosers import Follower
from ..painting import paint
from ..signals import signOf
from .layout import say
from .panelPart import every

LOOKED_EVERY = 100
"""ms between two looks whether more is known."""


class Lights(Follower):
    """Shows the verdicts of `SweepVerdicts`, and opens and closes what belongs to each."""

    def __init__(self, ui, verdicts):
        self._ui, self._verdicts, self._drawing = ui, verdicts, None
        self._timer = every(LOOKED_EVERY, self._look)
        for name in NAMES:
            button, details = getattr(ui, f"{name}MoreButton"), getattr(ui, f"{name}Details")
            button.connect("toggled(bool)", details.setVisible)
            button.connect("toggled(bool)", lambda checked: self.update())

    def update(self) -> None:
        """Show what is known of the chosen sweep and CT."""
        if self._parameterNode is None:
            return
        shown = self._verdicts.of(self._parameterNode)
        for name, verdict in shown.items():
            known = name not in self._verdicts.sought
            # One advice at a time: guidance goes step by step
            isGuided = name == "coverage" and verdict.advice and self._parameterNode.guidance
            advice = _("Guidance below leads there.") if isGuided else verdict.advice
            self._show(name, verdict.level.value, verdict.finding if known else _("being worked out ..."), advice if known else "")
        ui, hasSweep, hasBone = self._ui, self._parameterNode.sweep is not None, self._parameterNode.bone is not None
        for name in NAMES:
            # An empty scene's panel is seen whole on a small screen; without a CT nothing is told of one
            isShown = (hasSweep or name not in ("calibration", "motion")) and (hasBone or not hasSweep or name in WITHOUT_CT)
            for part in ("SignalLabel", "VerdictLabel", "MoreButton"):
                getattr(ui, f"{name}{part}").visible = isShown
        # At hand where it is needed, and with the rest of its kind else
        isWrong, isPlaced = shown["calibration"].level.value == "look", shown["registration"].level.value == "good"
        ui.placeButton.visible = ui.registrationMoreButton.checked or (ui.placeButton.enabled and not isPlaced)
        ui.takeOutMotionCheckBox.visible = (
            ui.motionMoreButton.checked or shown["motion"].level.value == "look" or not ui.takeOutMotionCheckBox.checked
        )
        self._draw(shown["motion"].drawing)
        ui.calibrateButton.visible = ui.calibrationMoreButton.checked or (ui.calibrateButton.enabled and isWrong)

    @property
    def isLooking(self) -> bool:
        """Whether something is still to be told."""
        return self._timer.isActive()

    def lookBeside(self) -> None:
        """Have the worker look at what was reconstructed."""
        if self._parameterNode is not None:
            self._verdicts.beginBeside(self._parameterNode)
            if self._verdicts.sought:
                self._timer.start()
        self.update()

    def cancel(self) -> None:
        """Look no further: the scene or the panel is being closed, or something else is done."""
        self._timer.stop()
        self._verdicts.cancelBeside()

    def _look(self) -> None:
        if self._verdicts.takeBeside() or not self._verdicts.sought:
            self.update()
        if not self._verdicts.sought:
            self._timer.stop()

    def _draw(self, drawing) -> None:
        if drawing is self._drawing:
            return
        self._drawing = drawing
        self._ui.motionDetails.clear()
        if drawing is not None:
            paint(drawing, self._ui.motionDetails, 1.0)

    def _show(self, name: str, level: str, finding, advice) -> None:
        titles = {
            "tracking": _("Tracking"),
            "registration": _("Registration"),
            "coverage": _("Coverage"),
            "calibration": _("Calibration"),
            "motion": _("Motion"),
        }
        sign, label = getattr(self._ui, f"{name}SignalLabel"), getattr(self._ui, f"{name}VerdictLabel")
        word, style = signOf(level)
        if sign.text != word:
            sign.text, sign.styleSheet = word, style
        words = inPanelWords(advice)
        advised = f"<br>{escape(words)}" if words else ""
        # Qt breaks lines after a slash, unless a word joiner follows
        text = f"<b>{escape(titles[name])}:</b> {escape(finding)}{advised}".replace("mm/s", "mm/\u2060s")
        if label.text != text:
            say(label, text)
