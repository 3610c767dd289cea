"""The tab Live: starts and stops a scan, and says in large letters whether the probe is seen, and what to do next."""

import importlib
import time

import qt
import slicer
from AIFReconScene.background import inBackground
from AIFReconScene.inputs.parameters import LiveSource
from AIFReconScene.live.liveFiles import recordingPath, sizeOf
from AIFReconScene.live.serverSearch import answering, asText, fromText
from AIFReconScene.live.turns import Turns
from AIFReconScene.panelWords import inPanelWords
from slicer.i18n import tr as _

from .. import inTurns
from ..errorsShown import errorsShown
from ..fields.boneSource import ofScan
from ..fields.pathField import PathField
from ..packages import packagesAreThere
from .layout import reveal, say
from .signals import GRAY, GREEN, RED, styleOf

COLLECTED_EVERY, SHOWN_EVERY = 0, 100
"""ms between two looks at the scene's image (0: whenever events were handled; the threads of the scan have a turn then), and between two
updates of what is shown, unless drawing takes so long that those threads fall behind."""

REMEMBERED_ATTRIBUTE = "AIFRecon.LiveServer"
"""Of a parameter node that has been given the server of the last scan: once, for another that is entered must stay."""

SERVERS_SETTING = "AIFRecon/LiveServers"
"""Where servers have been, for the search."""

SIZE_EVERY = 2.0
"""s between two looks at how large the recording is."""

LARGE = 26
"""Pixels: letters that are read from two meters."""


class LivePanel:
    """Connects the widgets of the tab to a `LiveReconstruction`.

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
        self._missing = self._advised = ""
        self._record, self._sized, self._shownID = None, 0.0, None
        self._turns, self._hasStepped = Turns(), False
        self._followers = (ofScan(ui), PathField(ui.liveBoneModelPathLineEdit, "boneModelPath"))
        self._collecting = self._timer(COLLECTED_EVERY, self._collect)
        self._showing = self._timer(SHOWN_EVERY, self._show)
        ui.liveStartButton.connect("clicked(bool)", self.onStart)
        ui.livePauseButton.connect("toggled(bool)", self.onPause)
        ui.liveResetButton.connect("clicked(bool)", self.onReset)
        ui.liveStopButton.connect("clicked(bool)", self.onStop)
        ui.liveUseBoxButton.connect("clicked(bool)", self.onUseBox)
        ui.liveFindButton.connect("clicked(bool)", self.onFind)
        ui.liveMoreButton.connect("toggled(bool)", ui.liveDetails.setVisible)
        ui.guidanceMoveLabel.styleSheet = styleOf(GRAY, LARGE)
        ui.guidanceMoveLabel.toolTip = _("Arrows are for a patient seen from behind, with the head up; left and right are the patient's.")
        ui.liveStateLabel.toolTip = _("Whether the tracker sees the probe, and Reference, the marker on the patient")
        self._showState(_("not started"), GRAY)

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
    def isBehind(self) -> bool:
        """Whether the threads of the scan are owed time by the windows: nothing more should be drawn now."""
        return self._turns.isOwing

    @property
    def guidance(self):
        """The `LiveGuidance` of the scan under way; None where there is none."""
        return self._live.guidance if self._live is not None else None

    def guide(self, wanted: bool) -> None:
        """Let the scan under way tell what it meets, or no longer."""
        if self._live is not None:
            self._live.guide(wanted)

    def showToo(self, name: str, steps) -> None:
        """Show something beside frames and volume, in steps that the scan takes in its turn; of one name the last."""
        self._live.showToo(name, steps)

    def echoes(self):
        """The bone echoes of the scan under way, to place the CT by; a GeometryError where there are too few."""
        return self._live.echoes()

    def followBone(self, progress) -> str:
        """Weight by the CT where it lies now; what that means for the volume, in a sentence."""
        if self._live.followBone(progress):
            return _("The picture so far was made with the CT where it was before: press “Start over...” to begin it anew.")
        return ""

    def whyNotNow(self) -> str:
        """Why other work has to wait; empty where it need not. A scan would write over what was reconstructed meanwhile."""
        return _("Stop the live scan first.") if self.isRunning else ""

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none; a scan that is under way goes on."""
        self._parameterNode = parameterNode
        for follower in self._followers:
            follower.setParameterNode(parameterNode)
        if parameterNode is not None and not parameterNode.parameterNode.GetAttribute(REMEMBERED_ATTRIBUTE):
            parameterNode.parameterNode.SetAttribute(REMEMBERED_ATTRIBUTE, "1")
            parameterNode.liveHost = slicer.util.settingsValue("AIFRecon/LiveHost", parameterNode.liveHost)
            parameterNode.livePort = slicer.util.settingsValue("AIFRecon/LivePort", parameterNode.livePort, converter=int)

    def update(self, missing: str) -> None:
        """Enable what can be done; `missing` says why a scan cannot begin."""
        ui, running = self._ui, self.isRunning
        fromServer = self._parameterNode is None or self._parameterNode.liveSource == LiveSource.OPENIGTLINK
        self._missing = missing
        for follower in self._followers if self._parameterNode is not None else ():
            follower.update()
        for widget in (ui.liveHostLineEdit, ui.livePortSpinBox, ui.liveDeviceLineEdit):
            widget.enabled = fromServer and not running
        ui.liveImageSelector.enabled = not fromServer and not running
        ofBone = (ui.liveBoneSourceComboBox, ui.liveBoneDeviceLineEdit, ui.liveBoneModelPathLineEdit)
        for widget in (ui.liveSourceComboBox, ui.liveRecordPathLineEdit, ui.liveRecordCheckBox, *ofBone):
            widget.enabled = not running
        ui.liveFindButton.enabled = fromServer and not running
        ui.liveStartButton.enabled = not running and not missing
        ui.liveStartButton.toolTip = missing or _("Begin to receive and reconstruct")
        for button in (ui.livePauseButton, ui.liveResetButton, ui.liveStopButton):
            button.enabled = running
        ui.liveUseBoxButton.enabled = running and self._live.isScouting
        if not running:
            self._showMove(self._advised or missing or _("Press Start"))

    # ---- buttons

    def onStart(self) -> None:
        """Begin a scan."""
        failure = _("The live reconstruction could not be started.")
        self._ui.liveStatisticsLabel.text = ""
        self._ui.tabWidget.currentIndex = 1
        if not packagesAreThere(self._parameterNode, failure, live=True):
            return
        self._say(self._do(failure, self._start))
        if self.isRunning:
            self._show()
            reveal(self._ui.tabWidget)

    def onPause(self, paused: bool) -> None:
        """Insert nothing for a while, or go on."""
        if self._live is not None:
            (self._live.session.pause if paused else self._live.session.resume)()

    def onReset(self) -> None:
        """Empty the volume and go on, if the user means it."""
        asked = _("Start over? The picture so far is deleted and begun anew; the scan goes on. The recording, where one is made, is kept.")
        if slicer.util.confirmOkCancelDisplay(asked, windowTitle=_("Start over")) and self._live is not None:
            self._live.session.reset()

    def onFind(self) -> None:
        """Look for a server, and take it."""
        remembered = fromText(slicer.util.settingsValue(SERVERS_SETTING, ""))
        shorter = ""

        def work(parameters, progress):
            nonlocal shorter
            found = inBackground(lambda progress: answering(remembered, progress), progress)
            if found is None:
                shorter = _("Not found: start Plus, or enter the name or address of its computer")
                return _(
                    "Not found: nothing answers on this computer, nor where a scanner was before. Start Plus on the computer of the "
                    "scanner, or enter the name or address of that computer."
                )
            parameters.liveHost, parameters.livePort = found
            return _("Found at {host}, port {port}: press Start.").format(host=found[0], port=found[1])

        said = self._do(_("The search for the scanner failed."), work)
        self._ui.liveRecordedLabel.text = ""
        if said:
            self._say(said)
            self._showMove(shorter or said)

    def onUseBox(self) -> None:
        """Reconstruct in the box that was scanned so far."""
        with errorsShown(_("The scanned area cannot be used yet.")):
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
            self._showState(_("not started"), GRAY)
            self._say("")

    def _do(self, failure: str, work) -> str:
        """Do long work and return what it said: a cancel too, nothing after an error that was shown."""
        try:
            return self._work.run(_("Live reconstruction"), failure, work, self._parameterNode)
        finally:
            self._refresh()

    def _start(self, parameters, progress) -> str:
        # What is imported first is read and compiled, with which the window would stand still
        inBackground(lambda _progress: importlib.import_module("AIFReconScene.live.liveReconstruction"), progress)
        from AIFReconScene.live.liveReconstruction import LiveReconstruction

        self._record, self._sized, self._shownID = recordingPath(parameters), 0.0, None
        self._live = LiveReconstruction(parameters, progress, self._record)
        settings = slicer.app.userSettings()
        settings.setValue("AIFRecon/LiveHost", parameters.liveHost)
        settings.setValue("AIFRecon/LivePort", parameters.livePort)
        before = fromText(slicer.util.settingsValue(SERVERS_SETTING, ""))
        settings.setValue(SERVERS_SETTING, asText([(parameters.liveHost, parameters.livePort), *before]))
        self._ui.livePauseButton.checked = False
        self._turns.forget()
        self._collecting.start()
        self._showing.start()
        return ""

    def _stop(self, parameters, progress) -> str:
        self._stopTimers()
        live, self._live = self._live, None
        try:
            node = live.stop(progress)
        finally:
            self._showState(_("stopped"), GRAY)
            self._say("")
            self._showMove(_("Look at the picture, or press Start"))
        if node is not None:
            parameters.output = node
        lines = [_counts(live.statistics)]
        if live.wasCanceled:
            lines.append(_("Canceled: the volume is as it was shown last."))
        if live.session.recorded is not None:
            lines.append(_("Recorded to {path}.").format(path=live.session.recorded))
            self._showSize(live.session.recorded)
        if live.seen is not None and live.seen.recorded is not None:
            lines.append(_("What the AI model said is in {path}.").format(path=live.seen.recorded))
        lines += [inPanelWords(problem) for problem in _recordingProblems(live.session) if problem]
        return "\n".join(lines)

    # ---- timers

    def _collect(self) -> None:
        """Take a step of what is shown or let the scan's threads work: windows would wait for both, and draw what has changed besides."""
        if self._live is not None:
            self._live.collect()
            self._hasStepped = not self._hasStepped and not inTurns.isUnderWay() and self._live.goOn()
            if not self._hasStepped:
                self._turns.give()

    def _show(self) -> None:
        live = self._live
        if live is None or self.isBehind:
            return
        live.refresh()
        if live.showsVolume and live.volumeNode.GetID() != self._shownID:
            # What follows what is on display, such as the outlines of bone, does so now
            self._shownID = live.volumeNode.GetID()
            self.showToo("followers", self._following())
        statistics = live.statistics
        failed, fit = statistics.phase == "failed", live.agreement
        scouting = live.session.grid is None or statistics.phase == "scouting"
        isSeen = statistics.tracking == "tracked"
        tracking = _("Probe seen") if isSeen else inPanelWords(statistics.tracking)
        tracked = isSeen and not failed
        if failed:
            word = _("Error: the picture no longer grows")
        elif scouting:
            word = _("Quick first scan") if tracked else tracking
        else:
            word = _("Paused") if statistics.phase == "paused" else tracking
        apart = tracked and fit.has_fallen
        word = _("The CT no longer fits") if apart else word
        self._showState(word, GREEN if tracked and not apart else RED)
        self._showMove(self._nextMove(statistics, tracked, scouting, apart))
        if self._record is not None and time.monotonic() - self._sized > SIZE_EVERY:
            self._sized = time.monotonic()
            self._showSize(self._record)
        problems = (statistics.trouble, live.snapshotProblem, live.displayProblem, *_recordingProblems(live.session))
        lines = [_counts(statistics)] if failed else [_rate(statistics), _counts(statistics)]
        lines += [inPanelWords(line) for line in ([] if live.seen is None else live.seen.lines(statistics.frames_received))]
        lines += _agreementLines(fit)
        lines += [inPanelWords(problem) for problem in problems if problem]
        self._say("\n".join(dict.fromkeys(lines)))
        self._ui.liveUseBoxButton.enabled = scouting and live.session.scouted > 0
        if live.volumeNode is not None and self._parameterNode is not None and self._parameterNode.output is not live.volumeNode:
            self._parameterNode.output = live.volumeNode

    def _following(self):
        self._refresh()
        yield

    def _nextMove(self, statistics, tracked: bool, scouting: bool, apart: bool) -> str:
        """What the person with the probe is to do now, in a few words."""
        if statistics.phase == "failed":
            return _("Press “Start over...”, or Stop; why is under “More”")
        if apart:
            return _("Press “Place CT on sweep”")
        if statistics.phase == "paused":
            return _("Press Pause again to go on")
        if not tracked:
            waits = not statistics.frames_received
            return _("Check Plus, and the connection below") if waits else _("Bring what is not seen into the tracker's view")
        if scouting and not self._advised:
            return _("Scan the area once, then press “Use the scanned area”")
        return self._advised or _("Keep scanning")

    def advise(self, text: str) -> None:
        """What guidance says to do next; empty: nothing."""
        self._advised = text
        if not self.isRunning:
            self._showMove(text or self._missing or _("Press Start"))

    def _showMove(self, text: str) -> None:
        label = self._ui.guidanceMoveLabel
        if label and label.text != text:
            label.text = text

    def _showSize(self, path) -> None:
        label = self._ui.liveRecordedLabel
        if label:
            say(label, _("{name}, {size:.0f} MB").format(name=path.name, size=sizeOf(path) / 1e6))
            label.toolTip = str(path)

    def _say(self, text: str) -> None:
        if self._ui.liveStatisticsLabel:  # false once it is destroyed: a scan that is being ended hears of the application's end last
            say(self._ui.liveStatisticsLabel, text, keepsRoom=True)

    def _showState(self, word: str, colors: tuple) -> None:
        if self._ui.liveStateLabel:
            self._ui.liveStateLabel.text = word
            self._ui.liveStateLabel.styleSheet = styleOf(colors, LARGE)

    def _stopTimers(self) -> None:
        self._collecting.stop()
        self._showing.stop()


def _recordingProblems(session) -> tuple:
    """What is wrong with the recording, if there is one; None where nothing is."""
    return session.recording_failure, session.recorder.loss if session.recorder is not None else None


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
    said = _("{inserted} of {received} frames added to the picture").format(
        inserted=statistics.inserted, received=statistics.frames_received
    )
    reasons = "; ".join(f"{count} {inPanelWords(reason)}" for reason, count in statistics.skipped.items())
    return said + (f" ({reasons})" if reasons else "")
