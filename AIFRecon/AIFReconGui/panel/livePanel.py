"""The Live section of the panel: starts and stops a scan, and says in large letters whether the probe is seen."""

import qt
import slicer
from AIFReconScene.inputs.parameters import LiveSource
from AIFReconScene.panelWords import inPanelWords
from slicer.i18n import tr as _

from ..errorsShown import errorsShown
from .layout import reveal, say

COLLECTED_EVERY, SHOWN_EVERY = 10, 100
"""ms between two looks at the scene's image, and between two updates of what is shown."""

REMEMBERED_ATTRIBUTE = "AIFRecon.LiveServer"
"""Of a parameter node that has been given the server of the last scan: once, for another that is entered must stay."""

TRACKED_COLOR, LOST_COLOR, IDLE_COLOR = "#1b7a3d", "#b3261e", "#5f6368"
"""Backgrounds of the tracking state; white text has a contrast of 5 or more on each."""


class LivePanel:
    """Connects the widgets of the Live section to a `LiveReconstruction`.

    Parameters
    ----------
    ui : namespace of the widgets in AIFRecon.ui
    work : LongWork
        Does what takes long, with progress, and shows its errors.
    refresh : callable
        Called without arguments when what can be pressed in the panel has changed.
    """

    def __init__(self, ui, work, refresh):
        self._ui = ui
        self._work = work
        self._refresh = refresh
        self._parameterNode = None
        self._live = None
        self._missing = ""
        self._collecting = self._timer(COLLECTED_EVERY, self._collect)
        self._showing = self._timer(SHOWN_EVERY, self._show)
        ui.liveStartButton.connect("clicked(bool)", self.onStart)
        ui.livePauseButton.connect("toggled(bool)", self.onPause)
        ui.liveResetButton.connect("clicked(bool)", self.onReset)
        ui.liveStopButton.connect("clicked(bool)", self.onStop)
        ui.liveUseBoxButton.connect("clicked(bool)", self.onUseBox)
        self._showState(_("not started"), IDLE_COLOR)

    @staticmethod
    def _timer(interval: int, slot):
        timer = qt.QTimer()
        timer.setInterval(interval)
        timer.connect("timeout()", slot)
        return timer

    @property
    def isRunning(self) -> bool:
        """Whether a scan is under way."""
        return self._live is not None

    @property
    def guidance(self):
        """The `LiveGuidance` of the scan under way; None where there is none."""
        return self._live.guidance if self._live is not None else None

    def guide(self, wanted: bool) -> None:
        """Let the scan under way tell what it meets, or no longer."""
        if self._live is not None:
            self._live.guide(wanted)

    def echoes(self):
        """The bone echoes of the scan under way, to place the CT by; a GeometryError where there are too few."""
        return self._live.echoes()

    def followBone(self, progress) -> str:
        """Weight by the CT where it lies now; what that means for the volume, in a sentence."""
        if self._live.followBone(progress):
            return _("The volume so far was weighted with the CT where it was before: Reset begins it anew.")
        return ""

    def whyNotNow(self) -> str:
        """Why other work has to wait; empty where it need not. A scan would write over what was reconstructed meanwhile."""
        return _("Stop the live scan first.") if self.isRunning else ""

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none; a scan that is under way goes on."""
        self._parameterNode = parameterNode
        if parameterNode is not None and not parameterNode.parameterNode.GetAttribute(REMEMBERED_ATTRIBUTE):
            parameterNode.parameterNode.SetAttribute(REMEMBERED_ATTRIBUTE, "1")
            parameterNode.liveHost = slicer.util.settingsValue("AIFRecon/LiveHost", parameterNode.liveHost)
            parameterNode.livePort = slicer.util.settingsValue("AIFRecon/LivePort", parameterNode.livePort, converter=int)

    def update(self, missing: str) -> None:
        """Enable what can be done; `missing` says why a scan cannot begin."""
        ui, running = self._ui, self.isRunning
        fromServer = self._parameterNode is None or self._parameterNode.liveSource == LiveSource.OPENIGTLINK
        self._missing = missing
        for widget in (ui.liveHostLineEdit, ui.livePortSpinBox, ui.liveDeviceLineEdit):
            widget.enabled = fromServer and not running
        ui.liveImageSelector.enabled = not fromServer and not running
        ui.liveSourceComboBox.enabled = ui.liveRecordPathLineEdit.enabled = not running
        ui.liveStartButton.enabled = not running and not missing
        ui.liveStartButton.toolTip = missing or _("Begin to receive and reconstruct")
        for button in (ui.livePauseButton, ui.liveResetButton, ui.liveStopButton):
            button.enabled = running
        ui.liveUseBoxButton.enabled = running and self._live.isScouting

    # ---- buttons

    def onStart(self) -> None:
        """Begin a scan."""
        failure = _("The live reconstruction could not be started.")
        self._ui.liveStatisticsLabel.text = ""
        if self._parameterNode.liveSource == LiveSource.OPENIGTLINK:
            from ..packages import ensureLivePackages

            # It may ask the user: not beneath the progress dialog
            with errorsShown(failure) as outcome:
                ensureLivePackages()
            if outcome.error is not None:
                return
        self._say(self._do(failure, self._start))
        if self.isRunning:
            self._show()
            reveal(self._ui.liveCollapsibleButton)

    def onPause(self, paused: bool) -> None:
        """Insert nothing for a while, or go on."""
        if self._live is not None:
            (self._live.session.pause if paused else self._live.session.resume)()

    def onReset(self) -> None:
        """Empty the volume and go on."""
        self._live.session.reset()

    def onUseBox(self) -> None:
        """Reconstruct in the box that was scanned so far."""
        with errorsShown(_("The box cannot be used yet.")):
            self._live.useScoutedBox()
        self.update(self._missing)

    def onStop(self) -> None:
        """End the scan and keep its volume."""
        self._say(self._do(_("The live reconstruction could not be ended as it should."), self._stop))

    def close(self, sceneStays: bool = False) -> None:
        """End the scan without showing anything more: the scene, the panel or the application is being closed."""
        live, self._live = self._live, None
        self._stopTimers()
        if live is not None:
            live.abandon()
            if sceneStays:
                live.removeFrame()
            self._showState(_("not started"), IDLE_COLOR)
            self._say("")

    def _do(self, failure: str, work) -> str:
        """Do long work and return what it said: a cancel too, nothing after an error that was shown."""
        try:
            return self._work.run(_("Live reconstruction"), failure, work, self._parameterNode)
        finally:
            self._refresh()

    def _start(self, parameters, progress) -> str:
        from AIFReconScene.live.liveReconstruction import LiveReconstruction

        self._live = LiveReconstruction(parameters, progress)
        settings = slicer.app.userSettings()
        settings.setValue("AIFRecon/LiveHost", parameters.liveHost)
        settings.setValue("AIFRecon/LivePort", parameters.livePort)
        self._ui.livePauseButton.checked = False
        self._collecting.start()
        self._showing.start()
        return ""

    def _stop(self, parameters, progress) -> str:
        self._stopTimers()
        live, self._live = self._live, None
        try:
            node = live.stop(progress)
        finally:
            self._showState(_("stopped"), IDLE_COLOR)
            self._say("")
        if node is not None:
            parameters.output = node
        lines = [_counts(live.statistics)]
        if live.wasCanceled:
            lines.append(_("Canceled: the volume is as it was shown last."))
        if live.session.recorded is not None:
            lines.append(_("Recorded to {path}.").format(path=live.session.recorded))
        if live.session.recording_failure:
            lines.append(inPanelWords(live.session.recording_failure))
        return "\n".join(lines)

    # ---- timers

    def _collect(self) -> None:
        if self._live is not None:
            self._live.collect()

    def _show(self) -> None:
        live = self._live
        if live is None:
            return
        live.refresh()
        statistics = live.statistics
        failed, fit = statistics.phase == "failed", live.agreement
        scouting = live.session.grid is None or statistics.phase == "scouting"
        tracking = inPanelWords(statistics.tracking)
        tracked = statistics.tracking == "tracked" and not failed
        if failed:
            word = _("Failed: nothing is inserted")
        elif scouting:
            word = _("Scan once quickly, then use the box") if tracked else tracking
        else:
            word = _("Paused") if statistics.phase == "paused" else tracking
        apart = tracked and fit.has_fallen
        word = _("The CT no longer fits: place it anew") if apart else word
        self._showState(word, TRACKED_COLOR if tracked and not apart else LOST_COLOR)
        problems = (statistics.trouble, live.snapshotProblem, live.displayProblem, statistics.recording_failure)
        lines = [_counts(statistics)] if failed else [_rate(statistics), _counts(statistics)]
        lines += _agreementLines(fit)
        lines += [inPanelWords(problem) for problem in problems if problem]
        self._say("\n".join(dict.fromkeys(lines)))
        self._ui.liveUseBoxButton.enabled = scouting and live.session.scouted > 0
        if live.volumeNode is not None and self._parameterNode is not None and self._parameterNode.output is not live.volumeNode:
            self._parameterNode.output = live.volumeNode

    def _say(self, text: str) -> None:
        if self._ui.liveStatisticsLabel:  # false once it is destroyed: a scan that is being ended hears of the application's end last
            say(self._ui.liveStatisticsLabel, text)

    def _showState(self, word: str, color: str) -> None:
        if not self._ui.liveStateLabel:
            return
        self._ui.liveStateLabel.text = word
        self._ui.liveStateLabel.styleSheet = largeType(color)

    def _stopTimers(self) -> None:
        self._collecting.stop()
        self._showing.stop()


def largeType(color: str) -> str:
    """The style of a label that is read from two meters, with this background."""
    return f"QLabel {{ background-color: {color}; color: white; font-size: 26px; font-weight: bold; padding: 10px; border-radius: 4px; }}"


def _rate(statistics) -> str:
    """Rate and latency of what comes, and from where."""
    unknown = statistics.latency_p50 != statistics.latency_p50
    latency = _("no latency yet") if unknown else _("latency {latency:.0f} ms").format(latency=1000 * statistics.latency_p50)
    return _("{rate:.0f} frames/s, {latency}; {connection}").format(
        rate=statistics.frame_rate, latency=latency, connection=inPanelWords(statistics.connection)
    )


def _agreementLines(fit) -> list:
    """How well the CT agrees with the last seconds of the scan; nothing while that cannot be told."""
    if fit.problem is not None:
        return [inPanelWords(fit.problem)]
    if fit.agreement is None:
        return []
    from AIFReconLib.registration.live import SECONDS

    return [_("Last {seconds:.0f} s: {sentence}").format(seconds=SECONDS, sentence=inPanelWords(fit.agreement.sentence()))]


def _counts(statistics) -> str:
    """Where the frames went."""
    said = _("{inserted} of {received} frames inserted").format(inserted=statistics.inserted, received=statistics.frames_received)
    reasons = "; ".join(f"{count} {inPanelWords(reason)}" for reason, count in statistics.skipped.items())
    return said + (f" ({reasons})" if reasons else "")
