"""What the panel's layouts do not do by themselves: room for texts of several lines, tabs as high as they need, scrolling to a change."""

import qt

SETTLED = 100
"""ms until every layout around a widget that has changed has asked the next one for room."""


def say(label, text: str, keepsRoom: bool = False) -> None:
    """Show a text in a label that wraps its words, with room for all of its lines.

    Where it `keepsRoom`, room that was needed once stays until there is no text: what lies below would jump with every text. The panel's
    layouts hear of a least height at once, but go by what they knew of the height that a width asks for: without a least height a text that
    grows squeezes the sections around it, in Slicer itself though not everywhere.
    """
    label.text = text
    least = label.minimumHeight if keepsRoom and text else 0
    _fit(label, least)
    if text:
        # A label that is shown only now has not got its width yet
        qt.QTimer.singleShot(0, lambda: _fit(label, least))


def enable(widget, missing: str, does: str) -> None:
    """Let a widget be used where nothing is missing for it; its tool tip says what it does, else what is missing."""
    widget.enabled = not missing
    widget.toolTip = missing or does


def _fit(label, least: int = 0) -> None:
    if label:  # destroyed: the application is being closed
        # A label asks for the least height that it has, however short its text is by now
        label.minimumHeight = least
        if label.text and label.visible:
            label.minimumHeight = label.heightForWidth(label.width)


class RoomForTexts(qt.QObject):
    """Gives every text that wraps its words room for all of its lines again, when the panel has got another width.

    The user makes it narrower, or the scroll bar comes that a longer text has called for. Labels keep the room that the .ui file gives them
    at least: below the large letters of a scan are its buttons, which must not jump from under the finger.
    """

    def __init__(self, panel, ui):
        qt.QObject.__init__(self)
        labels = (each for each in vars(ui).values() if isinstance(each, qt.QLabel) and each.wordWrap)
        self._labels = [(label, label.minimumHeight) for label in labels]
        self._width = panel.width
        panel.installEventFilter(self)

    def eventFilter(self, watched, event):
        """Hear of the panel's events; none is kept from it."""
        if event.type() == qt.QEvent.Resize and watched.width != self._width:
            self._width = watched.width
            qt.QTimer.singleShot(0, self._fit)
        return False

    def _fit(self) -> None:
        for label, least in self._labels:
            _fit(label, least)


class Tabs:
    """The tabs Recorded and Live. The panel is as high as the one that is shown: Qt asks for the room of the highest.

    `onShown` is called when another is shown: its texts need their room anew.
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
