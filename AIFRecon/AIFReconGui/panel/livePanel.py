"""The tab Live: starts and stops a scan, and says in large letters whether the probe is seen, and what to do next."""

import time

import slicer
from AIFReconScene.inputs.parameters import LiveSource
from AIFReconScene.live.liveFiles import recordingPath, sizeOf
from AIFReconScene.live.liveWords import LiveWords, counts, linesOf
from AIFReconScene.panelWords import inPanelWords
from slicer.i18n import tr as _

from AIFReconLib.live.wire.search import answering, as_text, from_text

from ..fields.choosers import boneSourceOfScan
from ..fields.pathField import PathField
from ..longWork import errorsShown
from ..packages import packagesAreThere
from ..signals import GRAY, GREEN, RED, styleOf
from .layout import reveal, say
from .panelPart import PanelPart, every

LOOK_EVERY, COUNTED_EVERY = 10, 0.5
"""ms between two looks whether the scan has answered, and s between two updates of what is counted: each number that has changed has Qt lay
out the whole panel anew."""

REMEMBERED_ATTRIBUTE = "AIFRecon.LiveServer"
"""Of a parameter node that has been given the server of the last scan: once, for another that is entered must stay."""

SERVERS_SETTING = "AIFRecon/LiveServers"
"""Where servers have been, for the search."""

SIZE_EVERY = 2.0
"""s between two looks at how large the recording is."""

LARGE = 26
"""Pixels: letters that are read from two meters."""


class LivePanel(PanelPart):
    """Connects the widgets of the tab to a `LiveReconstruction`."""

    def __init__(self, ui, work, refresh, paths):
        super().__init__(ui, work, refresh)
        self._live, self._paths, self._hasScanned = None, paths, False
        self.recorded: list = []  #: The files of the scan that has ended
        self._missing = self._advised = ""
        self._shownID = self._words = None
        self._sized = self._counted = 0.0
        self._followers = (boneSourceOfScan(ui), PathField(ui.liveBoneModelPathLineEdit, "boneModelPath"))
        self._looking = every(LOOK_EVERY, self._look)
        ui.liveStartButton.connect("clicked(bool)", self.onStart)
        ui.livePauseButton.connect("toggled(bool)", self.onPause)
        ui.liveResetButton.connect("clicked(bool)", self.onReset)
        ui.liveStopButton.connect("clicked(bool)", self.onStop)
        ui.liveUseBoxButton.connect("clicked(bool)", self.onUseBox)
        ui.liveFindButton.connect("clicked(bool)", self.onFind)
        ui.liveMoreButton.connect("toggled(bool)", ui.liveDetails.setVisible)
        ui.guidanceMoveLabel.styleSheet = styleOf(GRAY, LARGE)
        ui.guidanceMoveLabel.toolTip = _("Arrows: the patient seen from behind, the head up; without a CT the image, up into it.")
        ui.liveStateLabel.toolTip = _("Whether the tracker sees the probe, and Reference, the marker on the patient")
        self._showState(_("not started"), GRAY)

    @property
    def isRunning(self) -> bool:
        """Whether a scan is under way."""
        return self._live is not None

    @property
    def guidance(self):
        """What the scan under way tells of the bone, a `Guided`; None where it tells nothing."""
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
            return _("The picture so far was made with the CT where it was before: press “Start over...” to begin it anew.")
        return ""

    def whyNotNow(self) -> str:
        """Why other work has to wait; empty where it need not. A scan would write over what was reconstructed meanwhile."""
        return _("Stop the live scan first.") if self.isRunning else ""

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none; a scan that is under way goes on."""
        super().setParameterNode(parameterNode)
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
        ui.liveRebuildButton.enabled = not running
        ui.liveStartButton.enabled = not running and not missing
        ui.liveStartButton.toolTip = missing or _("Begin to receive and reconstruct")
        for button in (ui.livePauseButton, ui.liveResetButton, ui.liveStopButton):
            button.enabled = running
        ui.liveUseBoxButton.enabled = running and self._live.seen.is_scouting
        self.advise(self._advised)

    # ---- buttons

    def onStart(self) -> None:
        """Begin a scan."""
        failure = _("The live reconstruction could not be started.")
        self._ui.liveStatisticsLabel.text = ""
        self._ui.tabWidget.currentIndex = 1
        if not packagesAreThere(self._parameterNode, failure, live=True):
            return
        self._say(self._do(_("Live reconstruction"), failure, self._start))
        if self.isRunning:
            self._show()
            reveal(self._ui.tabWidget)

    def onPause(self, paused: bool) -> None:
        """Insert nothing for a while, or go on."""
        if self._live is not None:
            self._live.pause(paused)

    def onReset(self) -> None:
        """Empty the volume and go on, if the user means it."""
        asked = _("Start over? The picture so far is deleted and begun anew; the scan goes on. The recording, where one is made, is kept.")
        if slicer.util.confirmOkCancelDisplay(asked, windowTitle=_("Start over")) and self._live is not None:
            self._live.reset()

    def onFind(self) -> None:
        """Look for a server, and take it."""
        remembered = from_text(slicer.util.settingsValue(SERVERS_SETTING, ""))

        def work(parameters, progress):
            found = answering(remembered, progress)
            if found is None:
                return _("Not found, here or where one was before: start Plus, or enter the name or address of its computer")
            parameters.liveHost, parameters.livePort = found
            return _("Found at {host}, port {port}: press Start.").format(host=found[0], port=found[1])

        message = self._do(_("Live reconstruction"), _("The search for the scanner failed."), work)
        self._ui.liveRecordedLabel.text = ""
        if message:
            self._say(message)
            self._showMove(message)

    def onUseBox(self) -> None:
        """Reconstruct in the box that was scanned so far."""
        with errorsShown(_("The scanned area cannot be used yet.")):
            self._live.useScoutedBox()
        self.update(self._missing)

    def onStop(self) -> None:
        """End the scan and keep its volume."""
        failure = _("The live reconstruction could not be ended as it should.")
        self._say(self._do(_("Live reconstruction"), failure, self._stop))

    def close(self, sceneStays: bool = False) -> None:
        """End the scan without showing anything more: the scene, the panel or the application is being closed."""
        live, self._live, self._hasScanned = self._live, None, False
        self._looking.stop()
        if live is not None:
            live.abandon()
            if sceneStays:
                live.removeFrame()
            self._showState(_("not started"), GRAY)
            self._say("")

    def _start(self, parameters, progress) -> str:
        from AIFReconScene.live.liveReconstruction import LiveReconstruction

        self._shownID, self._words, self._hasScanned = None, None, False
        self.recorded, self._ui.liveRebuildButton.visible = [], False
        self._sized = self._counted = 0.0
        self._live = LiveReconstruction(parameters, progress, recordingPath(parameters), self._paths.unseen)
        settings = slicer.app.userSettings()
        settings.setValue("AIFRecon/LiveHost", parameters.liveHost)
        settings.setValue("AIFRecon/LivePort", parameters.livePort)
        before = from_text(slicer.util.settingsValue(SERVERS_SETTING, ""))
        settings.setValue(SERVERS_SETTING, as_text([(parameters.liveHost, parameters.livePort), *before]))
        self._ui.livePauseButton.checked = False
        self._looking.start()
        return ""

    def _stop(self, parameters, progress) -> str:
        self._looking.stop()
        live, self._live = self._live, None
        try:
            ended = live.stop(progress)
        finally:
            self._showState(_("stopped"), GRAY)
            self._say("")
            self._hasScanned = True
            self.advise("")
        if live.volumeNode is not None:
            parameters.output = live.volumeNode
            if ended is not None and ended.result is not None:
                self._paths.remember(live.volumeNode, ended.result, ended.skin)
        lines = [counts(live.statistics)]
        if live.wasCanceled:
            lines.append(_("Canceled: the volume is as it was shown last."))
        if live.lost:
            lines.append(inPanelWords(live.lost))
            if live.seen.record is not None:
                lines.append(_("What was recorded is kept unfinished, beside {path}.").format(path=live.seen.record))
        if ended is not None and ended.recorded is not None:
            lines.append(_("Recorded to {path}.").format(path=ended.recorded))
            self._showSize(ended.recorded)
            self.recorded, self._ui.liveRebuildButton.visible = [*filter(None, (ended.recorded, ended.predictions))], True
        if ended is not None and ended.predictions is not None:
            lines.append(_("What the AI model said is in {path}.").format(path=ended.predictions))
        lines += [inPanelWords(problem) for problem in (() if ended is None else ended.problems)]
        return "\n".join(lines)

    # ---- while a scan is under way

    def _look(self) -> None:
        if self._live is not None and self._live.goOn():
            self._show()

    def _show(self) -> None:
        live, now = self._live, time.monotonic()
        if live.volumeNode is not None and live.volumeNode.GetID() != self._shownID:
            # What follows what is on display, such as the outlines of bone, does so now
            self._shownID = live.volumeNode.GetID()
            self._refresh()
        words = LiveWords.of(live, self._advised)
        self._showState(words.state, GREEN if words.isWell else RED)
        self._showMove(words.move)
        if live.seen.record is not None and now - self._sized > SIZE_EVERY:
            self._sized = now
            self._showSize(live.seen.record)
        if words != self._words or now - self._counted >= COUNTED_EVERY:
            self._words, self._counted = words, now
            self._say("\n".join(linesOf(live)))
        self._ui.liveUseBoxButton.enabled = words.isScouting and live.seen.scouted > 0
        if live.volumeNode is not None and self._parameterNode is not None and self._parameterNode.output is not live.volumeNode:
            self._parameterNode.output = live.volumeNode

    def advise(self, text: str) -> None:
        """What guidance says to do next; empty: nothing."""
        self._advised = text
        if not self.isRunning:
            # No order to move the probe outlasts the scan
            ended = _("Look at the picture, or press Start") if self._hasScanned else ""
            self._showMove(ended or text or self._missing or _("Press Start"))

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
        label, style = self._ui.liveStateLabel, styleOf(colors, LARGE)
        if label:
            label.text = word
            # A style that is set is worked out for the whole label anew, be it the one that it has
            if label.styleSheet != style:
                label.styleSheet = style
