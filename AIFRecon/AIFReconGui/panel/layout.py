"""What the panel's layouts do not do by themselves: room for texts of several lines, tabs as high as they need, scrolling to a change."""

import qt

SETTLED = 100
"""ms until every layout around a widget that has changed has asked the next one for room."""


def say(label, text: str) -> None:
    """Show a text in a label that wraps its words, with room for all of its lines.

    Notes
    -----
    The panel's layouts hear of a least height at once, but go by what they knew of the height that a width asks for: without a least
    height a text that grows squeezes the sections around it, in Slicer itself though not everywhere.
    """
    label.text = text
    label.minimumHeight = label.heightForWidth(label.width) if text and label.visible else 0


class Tabs:
    """The tabs Recorded and Live. The panel is as high as the one that is shown: Qt asks for the room of the highest.

    Parameters
    ----------
    ui : namespace of the widgets in AIFRecon.ui
    onShown : callable
        Called without arguments when another is shown: its texts need their room anew.
    """

    def __init__(self, ui, onShown):
        self._ui, self._onShown = ui, onShown
        ui.tabWidget.connect("currentChanged(int)", self._show)
        self._show(ui.tabWidget.currentIndex)

    def _show(self, number: int) -> None:
        ui = self._ui
        for each, contents in enumerate((ui.recordedContents, ui.liveContents)):
            contents.visible = each == number
        details = ui.coverageDetails if number == 0 else ui.liveDetails
        details.layout().addWidget(ui.guidanceWords)
        self._onShown()


def reveal(widget) -> None:
    """Scroll the panel, once its layout has settled, so that a widget is as far up as can be: what is below it is seen as well."""
    area = widget
    while area is not None and not area.inherits("QScrollArea"):
        area = area.parentWidget()
    if area is not None:
        qt.QTimer.singleShot(SETTLED, lambda: _toTop(area, widget))


def _toTop(area, widget) -> None:
    # Either may be gone by now, with the panel
    if area and widget:
        area.verticalScrollBar().value = widget.mapTo(area.widget(), qt.QPoint(0, 0)).y()
