"""What belongs to the light Tracking: a table of what is known of the sweep, sentences on what may be wrong, and a copy of both."""

import html

import qt
from AIFReconScene.panelWords import inPanelWords
from slicer.i18n import tr as _

from AIFReconLib.errors import AIFReconError

from ..fields.choosers import Follower
from .layout import say


class ReportPanel(Follower):
    """Shows the report while it is wanted; nothing is computed for one that is not seen.

    ``reportOf(parameters) -> (title, TrackingReport)``; an AIFReconError says why there is none.
    """

    def __init__(self, ui, reportOf):
        self._ui, self._reportOf, self._shown = ui, reportOf, None
        ui.trackingMoreButton.connect("toggled(bool)", lambda checked: self.update())
        ui.copyReportButton.connect("clicked(bool)", self.onCopy)

    def update(self) -> None:
        """Show the report of the chosen sweep, if the section is open."""
        if self._parameterNode is None or not self._ui.trackingMoreButton.checked:
            return
        shown = None
        if self._parameterNode.sweep is None:
            message = _("Open a recording, or select a tracked sweep.")
        else:
            try:
                shown = self._reportOf(self._parameterNode)
            except AIFReconError as error:
                message = inPanelWords(error)
        self._ui.copyReportButton.enabled = shown is not None
        if shown is None:
            say(self._ui.reportLabel, html.escape(message))
        elif shown != self._shown:
            say(self._ui.reportLabel, shown[1].as_html(shown[0]))
        self._shown = shown

    def onCopy(self) -> None:
        """Put the report into the clipboard as text."""
        title, report = self._shown
        qt.QApplication.clipboard().setText(report.as_text(title))
