"""The tab Recorded: what is opened, Reconstruct, the lights below it, and the settings."""

import pathlib

import qt
import slicer
from AIFReconScene.display.segmentDisplay import BoneOutlines
from AIFReconScene.inputs import readiness
from AIFReconScene.inputs.boneSource import describeBone, hasBone, lacksBoneOfCT
from AIFReconScene.inputs.boxes import clipAsRecognized
from AIFReconScene.inputs.parameters import ProbeShape, Region, SigmaUnit, fileFrom
from AIFReconScene.registration.sweepVerdicts import isOfNow
from AIFReconScene.sceneNodes import addedTogether
from AIFReconScene.volumes.phantomSample import beginPhantom
from slicer.i18n import tr as _

from AIFReconLib.message import shorten
from AIFReconLib.progress import part
from AIFReconLib.worker.recordings import opened_suffixes

from ..fields.choosers import BoxChooser, MethodChooser, PresetChooser, SegmentsChooser, SweepsChooser, boneSourceOfRecorded
from ..fields.pathField import PATHS, PathField
from ..packages import offerSpeed, packagesAreThere
from .importDialog import ImportDialog
from .layout import enable, say
from .lights import Lights
from .panelPart import PanelPart
from .pathsPanel import PathsPanel
from .picturePanel import PicturePanel
from .reportPanel import ReportPanel

FOLDER_SETTING = "AIFRecon/OpenFolder"

LONGEST_NAMES = 40
"""Letters of the names in the header of what has folded away."""


class RecordedPanel(PanelPart):
    """Connects the buttons of the tab to the logic, and lets everything follow the parameters."""

    def __init__(self, ui, work, refresh, logic):
        super().__init__(ui, work, refresh)
        self._logic = logic
        self._report, self._about = "", ()
        self._wasComplete, self._begun = False, None
        ui.summaryLabel.visible = False
        self.lights = Lights(ui, logic.verdicts)
        self.importer = ImportDialog(work, refresh, logic.takeImported)
        self._picture = PicturePanel(ui.picturePlace.layout(), ui.undoCalibrationButton, work, logic.trackingReport)
        self._paths = PathsPanel(ui, work, refresh, logic.paths)
        self._followers = (
            SweepsChooser(ui.otherSweepsComboBox, ui.otherSweepsLabel, logic.offeredSweeps),
            SegmentsChooser(ui.segmentsComboBox, ui.segmentsLabel),
            boneSourceOfRecorded(ui),
            *(PathField(getattr(ui, f"{name}LineEdit"), name) for name in PATHS),
            MethodChooser(ui.methodComboBox),
            PresetChooser(ui.presetComboBox),
            BoxChooser(),
            BoneOutlines(),
            ReportPanel(ui, logic.trackingReport),
            self.lights,
            self._picture,
        )
        for button, slot in (
            (ui.openButton, self.onOpen),
            (ui.importButton, lambda pressed: self.importer.show()),
            (ui.sampleButton, self.onSample),
            (ui.thinSampleButton, self.onThinSample),
            (ui.boneFromCTButton, self.onBoneFromCT),
            (ui.loadButton, self.onLoad),
            (ui.recognizeButton, self.onRecognize),
            (ui.applyButton, self.onReconstruct),
            (ui.compareButton, self.onCompare),
            (ui.singleViewButton, self.onSingleView),
        ):
            button.connect("clicked(bool)", slot)
        # What is opened shows all that it holds, also what does not count
        ui.volumeGroupBox.connect("toggled(bool)", lambda opened: self._dependents())
        ui.settingsCollapsibleButton.connect("contentsCollapsed(bool)", lambda collapsed: self._dependents())

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none."""
        super().setParameterNode(parameterNode)
        for follower in (*self._followers, self._paths, self.importer):
            follower.setParameterNode(parameterNode)

    def update(self, waits: str) -> None:
        """Show what follows from the parameters; `waits` says why everything has to wait."""
        parameters = self._parameterNode
        for follower in self._followers:
            follower.update()
        self._paths.update(waits)
        if not self._work.isRunning and self._about != (about := _chosen(parameters)):
            # What was said was about something else
            self._report, self._about = "", about
        self._dependents()
        _enableButtons(self._ui, self._logic, parameters, waits, self._report)
        self._fold(parameters)

    def close(self) -> None:
        """The scene or the panel is being closed."""
        self._report = ""
        self._wasComplete = False
        self.lights.cancel()
        self._paths.close()
        if self._ui.summaryLabel:  # destroyed: the application is being closed
            self._ui.summaryLabel.visible = False
            self._ui.inputsCollapsibleButton.collapsed = False

    def _dependents(self) -> None:
        if self._parameterNode is not None:
            _showDependents(self._ui, self._parameterNode, self._logic.describeSweep(self._parameterNode))

    # ---- buttons

    def onOpen(self) -> None:
        """Ask for files and read them all, whatever they are."""
        paths = self._ask()
        if paths:
            failure = _("Nothing was opened.")
            self._run(_("Opening"), failure, lambda parameters, progress: self._logic.openFiles(parameters, paths, progress))

    def _ask(self) -> list:
        """The files that the user chooses, in the folder where some were chosen before."""
        asked = " ".join(f"*{suffix}" for suffix in opened_suffixes())
        words = _("Recordings, calibrations, CT, segmentations ({suffixes})").format(suffixes=asked)
        folder = slicer.util.settingsValue(FOLDER_SETTING, "")
        names = qt.QFileDialog.getOpenFileNames(self._ui.openButton, _("Open recording, calibration, CT"), folder, words)
        paths = [pathlib.Path(name) for name in names or ()]
        if paths:
            slicer.app.userSettings().setValue(FOLDER_SETTING, str(paths[0].parent))
        return paths

    def onSample(self) -> None:
        """Reconstruct the simulated patient."""
        self._reconstruct(self._sample, failure=_("The sample patient could not be made."))

    def onThinSample(self) -> None:
        """The same of a scan that shows the lights at work."""
        thin = _("This scan is fast and thin on purpose: not all lights are green.")
        self._reconstruct(self._thinSample, thin, failure=_("The sample patient could not be made."))

    def onBoneFromCT(self) -> None:
        """Find the bone in the CT."""
        from AIFReconScene.volumes.segments import boneFromCT

        self._run(_("Bone from CT"), _("The CT's bone could not be found."), boneFromCT)

    def onLoad(self) -> None:
        """Read the recording."""
        self._run(_("Load recording"), _("The recording could not be loaded."), self._logic.loadRecording)

    def onRecognize(self) -> None:
        """Set the clip rectangle to what is recognized."""
        self._run(_("Looking at the images"), _("The clip rectangle was not set."), clipAsRecognized)

    def onReconstruct(self) -> None:
        """Reconstruct."""
        self._reconstruct(self._logic.apply)

    def openAndReconstruct(self, paths) -> None:
        """Read files, and reconstruct the sweep that they hold."""

        def work(parameters, progress) -> str:
            self._logic.openFiles(parameters, paths, part(progress, 0.0, 0.5))
            parameters.output = None  # what is there stays
            return self._logic.apply(parameters, part(progress, 0.5, 1.0))

        self._ui.tabWidget.currentIndex = 0
        self._reconstruct(work)

    def onCompare(self) -> None:
        """Reconstruct with every method that is compared."""

        def told(parameters, progress) -> str:
            message = self._logic.compare(parameters, progress)
            qt.QTimer.singleShot(0, offerSpeed)
            return message

        failure = _("The methods could not be compared.")
        if packagesAreThere(self._parameterNode, failure):
            self._run(_("Compare methods"), failure, told)

    def onSingleView(self) -> None:
        """Go back from the comparison."""
        self._logic.display.showOutput(self._parameterNode)

    def _reconstruct(self, work, *more, failure: str = "") -> None:
        def told(parameters, progress) -> str:
            method, voxels, *notes = work(parameters, progress=part(progress, 0.0, 0.99)).split("\n")
            self._picture.show()
            self._ui.summaryLabel.visible = True
            say(self._ui.summaryLabel, f"{method}\n{voxels}")
            # A first picture comes before any question
            qt.QTimer.singleShot(0, offerSpeed)
            return "\n".join((_("Done."), *notes, *more))

        failure = failure or _("The volume could not be reconstructed.")
        if packagesAreThere(self._parameterNode, failure):
            self.lights.cancel()
            self._run(_("Reconstruction"), failure, told)
            self.lights.lookBeside()

    def _thinSample(self, parameters, progress) -> str:
        return self._sample(parameters, progress, isThin=True)

    def _sample(self, parameters, progress, isThin: bool = False) -> str:
        from ..sampleData import addPhantom

        begun, self._begun = None if isThin else self._begun, None
        with addedTogether():
            addPhantom(part(progress, 0.0, 0.6), isThin, begun)
            readiness.chooseDefaults(parameters)
            return self._logic.apply(parameters, part(progress, 0.6, 1.0))

    def _run(self, title: str, failure: str, work) -> None:
        """Do long work with progress and cancel; its errors are shown, a cancel leaves the scene as it was."""
        self._report = ""
        try:
            self._report = self._work.run(title, failure, work, self._parameterNode)
            self._about = _chosen(self._parameterNode)
        finally:
            self._refresh()

    # ---- what folds away

    def _fold(self, parameters) -> None:
        """Close what was chosen when all of it is there, and open it when nothing is: only then, for the user may want it otherwise."""
        ui, fold = self._ui, self._ui.inputsCollapsibleButton
        complete = parameters.sweep is not None and hasBone(parameters)
        if complete != self._wasComplete:
            self._wasComplete = complete
            fold.collapsed = complete
        names = ", ".join(node.GetName() for node in (parameters.sweep, parameters.ctVolume or parameters.bone) if node is not None)
        fold.text = _("Sweep and CT: {names}").format(names=shorten(names, LONGEST_NAMES)) if names else _("Sweep and CT")
        isOffered = parameters.sweep is None and fileFrom(parameters.recordingPath) is None and not fold.collapsed
        ui.sampleButton.visible = ui.thinSampleButton.visible = isOffered
        self._prepareSample(isOffered)

    def _prepareSample(self, isOffered: bool) -> None:
        """Have the sample made beside the windows while it is offered: it is there when it is asked for."""
        if isOffered and self._begun is None and not slicer.app.testingEnabled():
            self._begun = beginPhantom()
        elif not isOffered and self._begun is not None:
            self._begun.cancel()
            self._begun = None


def _chosen(parameters) -> tuple:
    """What is chosen: what was said of it does not hold for other sweeps, CTs, or files."""
    return (parameters.sweep, parameters.ctVolume, parameters.bone, parameters.recordingPath) if parameters is not None else ()


def _showDependents(ui, parameters, sweepText: str) -> None:
    """Show `sweepText` and what the bone is taken for, and the fields that count with these parameters."""
    say(ui.sweepStatusLabel, sweepText)
    say(ui.boneStatusLabel, describeBone(parameters))
    for label in (ui.sweepStatusLabel, ui.boneStatusLabel):
        label.visible = bool(label.text)
    ui.boneFromCTButton.visible = lacksBoneOfCT(parameters)
    ui.roiLabel.visible = ui.roiSelector.visible = parameters.region == Region.BOX
    ui.regionVolumeLabel.visible = ui.regionVolumeSelector.visible = parameters.region == Region.LIKE_VOLUME
    ui.spacingSpinBox.enabled = parameters.region != Region.LIKE_VOLUME
    ui.apexColumnSpinBox.enabled = ui.apexRowSpinBox.enabled = parameters.probe == ProbeShape.SECTOR
    ui.boneSigmaSpinBox.enabled = parameters.boneSigmaUnit != SigmaUnit.AUTOMATIC
    for spinBox in (ui.fanFirstRadiusSpinBox, ui.fanFirstAngleSpinBox, ui.fanLastAngleSpinBox):
        spinBox.enabled = parameters.fanLastRadius > 0
    ui.scannerSpeedOfSoundSpinBox.enabled = parameters.speedOfSound > 0
    ui.longestGapSpinBox.enabled = parameters.timeOffset != 0
    ui.singleViewButton.enabled = parameters.output is not None


def _enableButtons(ui, logic, parameters, waits: str, report: str) -> None:
    """Enable what can be done, and say what is missing for the rest.

    `waits` says why everything has to wait, `report` what was done last, which stays to be read where something is missing for the next.
    """
    sweep = logic.sweep.summary(parameters)
    cannot = readiness.whyNotReconstruct(parameters, sweep)
    noImages, cannotCompare = readiness.whyNoImages(parameters, sweep), readiness.whyNotCompare(parameters, sweep)
    enable(ui.loadButton, waits or readiness.whyNotLoad(parameters), _("Read the recording into a sweep that can be replayed"))
    enable(ui.applyButton, waits or cannot, _("Reconstruct the volume, and judge tracking, registration and coverage"))
    enable(ui.recognizeButton, waits or noImages, _("Set the rectangle of ultrasound that is recognized"))
    enable(ui.compareButton, waits or cannotCompare, _("Reconstruct with each method and show them side by side"))
    missing = readiness.withoutRepeating(cannot, ui.sweepStatusLabel.text)
    if not isOfNow(parameters):
        report = _("Sweep, CT or its place are others than when this picture was made: press “Reconstruct” again.")
    text = "\n".join(line for line in (report, missing) if line)
    ui.statusLabel.visible = bool(text)
    say(ui.statusLabel, text)
