"""The picture in the panel: how the reconstruction is looked at, and what is told of it on a page or in a line."""

import pathlib

import qt
import slicer
from AIFReconScene.panelWords import inPanelWords
from AIFReconScene.picture import windows
from AIFReconScene.picture.echoView import EchoView
from AIFReconScene.picture.levelNames import LevelNames
from AIFReconScene.picture.probeUp import ProbeUp
from AIFReconScene.picture.spineView import SpineView, spineOf
from AIFReconScene.picture.sweepPage import tellOf, whyNotTell
from AIFReconScene.volumes.volumeNodes import measuredOf
from slicer.i18n import tr as _

from ..longWork import errorsShown
from ..packages import ensurePagePackages
from .layout import enable

UI = pathlib.Path(__file__).resolve().parents[2] / "Resources" / "UI" / "Picture.ui"

BOXES = ("showMeasuredCheckBox", "showRaisedCheckBox", "showSpineCheckBox", "probeUpCheckBox", "showLevelsCheckBox")
IN_ORDER = (*BOXES, "boneOutlinesCheckBox", "opacitySliderWidget", "windowComboBox", "copyLineButton", "saveReportButton")
"""Names of the widgets as they stand, from the top."""


class PicturePanel:
    """A widget of its own, at the end of a layout, which comes `after` another for who goes by keyboard.

    ``trackingOf(parameters) -> (title, TrackingReport)``.
    """

    def __init__(self, layout, after, work, trackingOf):
        widget = slicer.util.loadUI(str(UI))
        layout.addWidget(widget)
        self._ui = ui = slicer.util.childWidgetVariables(widget)
        for name in IN_ORDER:
            qt.QWidget.setTabOrder(after, getattr(ui, name))
            after = getattr(ui, name)
        self._work, self._trackingOf = work, trackingOf
        self._parameterNode = self._bound = None
        self._views = EchoView(), SpineView(), ProbeUp(), LevelNames()
        self._presets = windows.presets()
        for label in (_("as it is"), *(preset[0] for preset in self._presets)):
            ui.windowComboBox.addItem(label)
        ui.windowComboBox.connect("activated(int)", self.onWindow)
        ui.copyLineButton.connect("clicked(bool)", self.onCopyLine)
        ui.saveReportButton.connect("clicked(bool)", self.onSaveReport)

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none."""
        if self._parameterNode is not None:
            self._parameterNode.disconnectGui(self._bound)
            for view in self._views if parameterNode is None else ():
                view.clear()
        self._parameterNode = parameterNode
        self._bound = parameterNode.connectGui(self._ui) if parameterNode is not None else None

    def update(self) -> None:
        """Show what is chosen, and enable what can be."""
        ui, parameters = self._ui, self._parameterNode
        plain, spine = measuredOf(parameters.output), spineOf(parameters.output)
        enhanced = _("Press “Reconstruct” with a method that weights by bone: its plain echo is kept beside it.")
        shown = _("No bone is kept with this volume: press “Reconstruct” with a method that weights by bone. It may have shown none.")
        tells = inPanelWords(whyNotTell(parameters))
        enable(ui.showMeasuredCheckBox, "" if plain else enhanced, _("Show the plain mean of the echoes, in the same gray levels"))
        enable(ui.showRaisedCheckBox, "" if plain else enhanced, _("Violet where the picture is as bright as bone and its echoes are not"))
        enable(ui.showSpineCheckBox, "" if spine else shown, _("Show the bone that was seen as a surface, smoothed for display"))
        noSweep = "" if parameters.sweep else _("Select a tracked sweep.")
        enable(ui.probeUpCheckBox, noSweep, _("Turn the slice views as the scanner does"))
        enable(ui.copyLineButton, tells, _("Copy the summary, one line, to the clipboard"))
        enable(ui.saveReportButton, tells, _("Write a page with pictures, sweep, agreement of the CT, coverage, settings and software"))
        ui.boneOutlinesCheckBox.visible = parameters.output is not None and parameters.bone is not None
        ui.opacityLabel.visible = ui.opacitySliderWidget.visible = parameters.output is not None and parameters.ctVolume is not None
        for view in self._views:
            view.update(parameters)

    def show(self) -> None:
        """Show what is chosen of a volume that is new."""
        with slicer.util.RenderBlocker():
            # The user may have left the panel meanwhile
            for view in self._views if self._parameterNode is not None else ():
                view.update(self._parameterNode)

    # ---- what is done

    def onWindow(self, row: int) -> None:
        """Gray levels of a preset; they are the user's after that."""
        if row > 0 and self._parameterNode is not None:
            windows.showIn(self._presets[row - 1], self._parameterNode.output, self._parameterNode.ctVolume)

    def onCopyLine(self) -> None:
        """Put one line about the reconstruction into the clipboard."""
        self._tell(None, _("The summary could not be made."), qt.QApplication.clipboard().setText)

    def onSaveReport(self) -> None:
        """Ask where to, and write the page."""
        asked = qt.QFileDialog.getSaveFileName(self._ui.saveReportButton, _("Save report"), "report.html", _("Web page (*.html)"))
        # Some Pythons for Qt tell the filter too
        path = asked if isinstance(asked, str) else asked[0]
        if path:
            self.saveReport(pathlib.Path(path))

    def saveReport(self, path: pathlib.Path) -> None:
        """Write the page, completely or not at all; a name without a suffix is given one."""
        path = path if path.suffix.lower() in (".html", ".htm") else path.with_name(f"{path.name}.html")

        failure = _("The report was not saved.")
        with errorsShown(failure) as outcome:
            ensurePagePackages()
        if outcome.error is None:
            self._tell(path, failure)

    def _tell(self, path, failure: str, use=lambda line: None) -> None:
        """Write the page, where there is a path, and use the line."""

        def work(parameters, progress):
            _title, tracking = self._trackingOf(parameters)
            use(tellOf(parameters, tracking, path, progress))
            return ""

        self._work.run(_("Report"), failure, work, self._parameterNode)
