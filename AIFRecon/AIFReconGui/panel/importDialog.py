"""Images and poses of any origin become a sweep: what their files leave open is asked, and the sweep is seen before it is loaded."""

import pathlib

import qt
import slicer
from AIFReconScene.inputs.parameters import fileFrom
from AIFReconScene.panelWords import inImportWords
from AIFReconScene.sweep.recordings import ForeignSweep
from slicer.i18n import tr as _

from AIFReconLib.errors import AIFReconError, OperationCanceled
from AIFReconLib.io.foreign.options import ImportOptions, answer, questions_of

from ..painting import paint
from .panelPart import PanelPart

UI = pathlib.Path(__file__).resolve().parents[2] / "Resources" / "UI" / "Import.ui"

TRANSFORMS = (None, "ImageToTracker", "ProbeToTracker", "TrackerToImage", "TrackerToProbe")
"""What the rows of the list stand for."""

SCALE = 0.8
"""Of the page, whose letters keep their size: beside its fields the drawing must fit on the screen of a notebook."""


class ImportDialog(PanelPart):
    """A window of its own, made when it is first wanted; ``take(parameters, foreignSweep, progress)`` loads what was seen in it."""

    def __init__(self, work, refresh, take):
        super().__init__(None, work, refresh)
        self._take, self._window, self._seen, self._answers = take, None, None, {}

    def show(self) -> None:
        """Bring it up."""
        if self._window is None:
            self._make()
        self._window.show()
        self._window.raise_()

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none: then the user leaves, or the scene or the panel is being closed."""
        super().setParameterNode(parameterNode)
        if parameterNode is None:
            if self._window:  # a destroyed one is false: the application is being closed
                self._window.close()
                self._window.deleteLater()
            self._window, self._answers = None, {}

    def _make(self) -> None:
        self._window = qt.QDialog(slicer.util.mainWindow())
        self._window.windowTitle = _("Import images and poses")
        self._window.connect("finished(int)", lambda result: self._change())
        widget = slicer.util.loadUI(str(UI))
        layout = qt.QVBoxLayout(self._window)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(widget)
        self._ui = ui = slicer.util.childWidgetVariables(widget)
        for field in (ui.imagesLineEdit, ui.posesLineEdit):
            field.comboBox().connect("editTextChanged(QString)", lambda text: self._begin())
        ui.calibrationLineEdit.comboBox().connect("editTextChanged(QString)", lambda text: self._change())
        for box in (ui.transformComboBox, ui.orientationComboBox):
            box.connect("currentIndexChanged(int)", lambda row: self._change())
        ui.folderButton.connect("clicked(bool)", self.onFolder)
        ui.importCheckButton.connect("clicked(bool)", self.onCheck)
        ui.takeButton.connect("clicked(bool)", self.onTake)
        ui.importCloseButton.connect("clicked(bool)", lambda pressed: self._window.close())
        self._begin()

    # ---- buttons

    def onFolder(self) -> None:
        """Ask for a folder of images."""
        folder = qt.QFileDialog.getExistingDirectory(self._window, _("Folder of images"), self._ui.imagesLineEdit.currentPath)
        if folder:
            self._ui.imagesLineEdit.currentPath = folder

    def onCheck(self) -> None:
        """Have the files read, and show how they were understood, or ask what they leave open."""
        self._change()
        message = self._run(_("Reading images and poses"), _("The files could not be read."), self._read)
        if message and self._window:
            self._ui.importWordsEdit.plainText = message

    def onTake(self) -> None:
        """Load what was seen."""

        def work(parameters, progress) -> str:
            message = self._take(parameters, self._seen, progress)
            self._window.close()
            return message

        self._run(_("Import"), _("The sweep could not be imported."), work)

    def _run(self, title: str, failure: str, work) -> str:
        self._window.enabled = False
        try:
            return self._do(title, failure, work)
        finally:
            if self._window:
                self._window.enabled = True

    def _read(self, parameters, progress) -> str:
        ui = self._ui
        try:
            texts = {name: box.currentText for name, box in self._answers.items()}
            given = {name: answer(name, text) for name, text in texts.items() if text.strip()}
            calibration = fileFrom(pathlib.Path(ui.calibrationLineEdit.currentPath))
            given |= {"calibration": calibration and str(calibration), "orientation": ui.orientationComboBox.currentText}
            options = ImportOptions(transform=TRANSFORMS[ui.transformComboBox.currentIndex], **given)
            images, poses = self._files()
            self._seen = ForeignSweep(images, poses, options, progress)
        except OperationCanceled:
            raise
        except AIFReconError as error:
            message = [error]
        else:
            message = [*self._seen.understood, *self._seen.checked.lines]
        for each in message:
            self._ask(questions_of(each))
        self._show(self._seen and self._seen.checked.drawing)
        return "\n".join(map(inImportWords, message))

    # ---- what is shown

    def _files(self) -> tuple:
        return pathlib.Path(self._ui.imagesLineEdit.currentPath), pathlib.Path(self._ui.posesLineEdit.currentPath)

    def _begin(self) -> None:
        """Other files: nothing was asked of them yet."""
        for box in self._answers.values():
            self._ui.questionsGroupBox.layout().removeRow(box)
        self._answers = {}
        self._ui.questionsGroupBox.visible = False
        self._change()

    def _change(self) -> None:
        """What was seen is not of what is chosen now."""
        seen, self._seen, ui = self._seen, None, self._ui
        if seen is not None:
            seen.forget()
        missing = ""
        if any(fileFrom(path) is None or not path.exists() for path in self._files()):
            missing = _("Choose the images and the file of their poses.")
        elif not ui.transformComboBox.currentIndex:
            missing = _("Choose what the poses are.")
        ui.importCheckButton.enabled = not missing
        ui.importWordsEdit.plainText = missing
        self._show(None)

    def _show(self, drawing) -> None:
        ui = self._ui
        if drawing is not None:
            paint(drawing, ui.drawingLabel, SCALE)
        ui.drawingLabel.visible = drawing is not None
        ui.takeButton.enabled = self._seen is not None
        ui.takeButton.toolTip = _("Load the sweep and select it") if ui.takeButton.enabled else _("Press “Check” first")
        self._window.adjustSize()

    def _ask(self, questions) -> None:
        """A row for each question without a field, with the answers that are known; rows that are there keep what was answered."""
        for question in questions:
            if hasattr(self._ui, f"{question.name}LineEdit"):
                continue
            if question.name not in self._answers:
                self._answers[question.name] = self._row(question)
            box = self._answers[question.name]
            written = box.currentText
            box.clear()
            box.addItems(["", *question.choices])
            box.currentText = written
        self._ui.questionsGroupBox.visible = bool(self._answers)

    def _row(self, question):
        box, label = qt.QComboBox(), qt.QLabel(question.rule["label"])
        box.objectName, label.objectName = f"{question.name}ComboBox", f"{question.name}Label"
        box.editable = question.rule["choices"] is None and question.rule["kind"] != "flag"
        box.toolTip = label.toolTip = question.rule["help"]
        label.setBuddy(box)
        self._ui.questionsGroupBox.layout().addRow(label, box)
        qt.QWidget.setTabOrder([self._ui.importWordsEdit, *self._answers.values()][-1], box)
        # The user's choice is looked at on the spot; what is typed, with Check
        box.connect("activated(int)", lambda row: self.onCheck())
        return box
