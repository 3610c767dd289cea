"""How the panel looks and can be worked with: narrow, with large letters, on dense screens, by keyboard alone.

    python Testing/host/panel_looks.py

Prints what it found as JSON, for `Testing/Python/module/test_panel_accessibility.py`; every list in it should be empty. For a dense
screen run it with QT_SCALE_FACTOR=2. Only Qt can tell these things, so they are asked of Qt: with its Fusion style and the stand-ins for
CTK's widgets, not with the styles of the Slicer application. Exit status: 0, or 2 where the host cannot run.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(REPOSITORY / "Testing"), str(REPOSITORY / "Testing" / "Slicer")]
from host import missing, runHost  # noqa: E402 - the folders must be known first

PANEL_WIDTH = 400
LARGE = 1.3

NODE_SELECTORS = ("qMRMLNodeComboBox",)
"""They show names that the user has given, which may be longer than any line; what they show without a node must fit."""

LOOKS: dict[str, dict] = {
    "light": {},
    "open": {"opened": True},
    "large letters": {"opened": True, "letters": LARGE},
    "live": {"opened": True, "tab": 1},
    "live, large letters": {"opened": True, "tab": 1, "letters": LARGE},
}
TABS = ("recorded", "live")


def set_look(module, opened=False, letters=1.0, tab=0) -> None:
    """Shows a tab, opens all sections, or enlarges the letters of the whole application."""
    from PySide6 import QtWidgets

    application = QtWidgets.QApplication.instance()
    font = application.font()
    font.setPointSizeF(module.letters_at_first * letters)
    application.setFont(font)
    for section in sections(module.native):
        section.setProperty("collapsed", not opened if section.objectName() not in module.open_at_first else False)
    module.widget.ui.tabWidget.currentIndex = tab
    for name in ("tracking", "registration", "coverage", "live"):
        getattr(module.widget.ui, f"{name}MoreButton").checked = opened
    module.host.process_events()


def sections(panel) -> list:
    """The collapsible parts of a panel."""
    from PySide6 import QtWidgets

    return [each for each in panel.findChildren(QtWidgets.QWidget) if each.objectName().endswith(("CollapsibleButton", "GroupBox"))]


class Panel:
    """The panel on the small scene of the self tests, as a native widget of a given width."""

    def __init__(self, host):
        import slicer
        from PySide6 import QtWidgets

        self.host = host
        host.start(REPOSITORY / "AIFRecon" / "AIFRecon.py")
        slicer.mrmlScene.Clear()
        self.widget = host.open("AIFRecon")
        self.native = host.take_out(self.widget.parent)
        self.letters_at_first = QtWidgets.QApplication.font().pointSizeF()
        self.open_at_first = {each.objectName() for each in sections(self.native) if not each.property("collapsed")}

    def lay_out(self) -> None:
        self.host.picture(self.native, PANEL_WIDTH)
        before = None
        while before != (before := self.places()):  # what shows itself late asks for its room late
            # Layouts keep what other letters asked for, until they get another width
            for wide in (PANEL_WIDTH + 1, PANEL_WIDTH, PANEL_WIDTH):
                self.native.resize(wide, self.native.layout().totalHeightForWidth(wide))
                self.host.process_events()

    def places(self) -> list[tuple]:
        """Where all that is shown stands."""
        from PySide6 import QtWidgets

        return [self.place(each).getRect() for each in self.shown(QtWidgets.QWidget)]

    def shown(self, kind) -> list:
        return [each for each in self.native.findChildren(kind) if each.isVisible()]

    def place(self, widget):
        from PySide6 import QtCore

        return QtCore.QRect(widget.mapTo(self.native, QtCore.QPoint(0, 0)), widget.size())


def named(widget) -> str:
    """What to call a widget in a finding."""
    while not widget.objectName() or widget.objectName().startswith("qt_"):
        widget = widget.parentWidget()
    return widget.objectName()


def cut_texts(panel) -> list[str]:
    """Widgets whose text does not fit into them, and those that reach over the panel's edge."""
    from PySide6 import QtWidgets

    found = []
    for widget in panel.shown(QtWidgets.QWidget):
        wanted, got = room_for_text(widget)
        if wanted > got or widget.height() < min(widget.fontMetrics().height(), widget.minimumSizeHint().height()):
            found.append(f"{named(widget)}: {wanted} px of text in {got}")
        if panel.place(widget).right() >= PANEL_WIDTH:
            found.append(f"{named(widget)} ends at {panel.place(widget).right()}")
    return found


def room_for_text(widget) -> tuple[int, int]:
    """Pixels that the text of a widget takes (along the line; down the page where lines are broken), and those that it has."""
    from PySide6 import QtWidgets

    letters, style = widget.fontMetrics(), widget.style()
    if isinstance(widget, QtWidgets.QLabel):
        if widget.wordWrap():
            return widget.heightForWidth(widget.width()), widget.height()
        return letters.horizontalAdvance(widget.text()), widget.contentsRect().width()
    if isinstance(widget, QtWidgets.QComboBox) and not widget.isEditable():
        option = QtWidgets.QStyleOptionComboBox()
        widget.initStyleOption(option)
        field = style.subControlRect(style.ComplexControl.CC_ComboBox, option, style.SubControl.SC_ComboBoxEditField, widget)
        selector = next((each for each in (widget, widget.parentWidget()) if type(each).__name__ in NODE_SELECTORS), None)
        counts = selector is None or widget.currentText() == selector.property("noneDisplay")
        return letters.horizontalAdvance(widget.currentText()) if counts else 0, field.width()
    if isinstance(widget, QtWidgets.QAbstractSpinBox):
        line = widget.lineEdit()
        return letters.horizontalAdvance(line.displayText()), line.contentsRect().width() - 2
    if isinstance(widget, QtWidgets.QLineEdit) and widget.placeholderText():
        return letters.horizontalAdvance(widget.placeholderText()), widget.contentsRect().width()
    if isinstance(widget, QtWidgets.QAbstractButton | QtWidgets.QGroupBox):
        return widget.minimumSizeHint().width(), widget.width()
    return 0, 0


def walk_by_tab(panel) -> list:
    """The widgets that Tab goes to, from the first one on until it is back there."""
    from PySide6 import QtCore, QtTest, QtWidgets

    application = QtWidgets.QApplication.instance()
    panel.native.activateWindow()
    panel.native.setFocus()
    panel.host.process_events()
    walked = []
    for _step in range(300):
        QtTest.QTest.keyClick(application.focusWidget() or panel.native, QtCore.Qt.Key.Key_Tab)
        now = application.focusWidget()
        if now is None or now in walked:
            break
        walked.append(now)
    return walked


def by_keyboard(panel) -> dict:
    """What Tab does not reach, and what has no name."""
    from PySide6 import QtCore, QtWidgets

    walked = walk_by_tab(panel)
    wanted = {
        named(each)
        for each in panel.shown(QtWidgets.QWidget)
        if each.isEnabled() and each.focusPolicy() & QtCore.Qt.FocusPolicy.TabFocus and not isinstance(each, QtWidgets.QLabel)
    }
    unnamed = [named(each) for each in walked if not any(map(name_of, ancestors(each, panel.native)))]
    unreached = sorted(wanted - {named(each) for each in walked})
    return {"walked": len(walked), "unreached": unreached, "unnamed": unnamed}


def ancestors(widget, top):
    """A widget, and those that it is part of up to the first with a name of its own in the .ui file."""
    while widget is not None and widget is not top:
        yield widget
        if widget.objectName() and not widget.objectName().startswith("qt_"):
            return
        widget = widget.parentWidget()


def name_of(widget) -> str:
    """What a screen reader says of a widget: its own name or text, or that of the label whose buddy it is."""
    from PySide6 import QtGui

    interface = QtGui.QAccessible.queryAccessibleInterface(widget)
    return interface.text(QtGui.QAccessible.Text.Name) if interface is not None else ""


def look_around(panel) -> dict:
    """Everything that is looked at."""
    import tinyScene

    found: dict = {"pixels per point": panel.native.devicePixelRatioF(), "cut": {}, "newcomer": {}}
    for number, name in enumerate(TABS):
        set_look(panel, tab=number)
        panel.lay_out()
        found["newcomer"][name] = panel.native.layout().totalHeightForWidth(PANEL_WIDTH)
    set_look(panel, opened=True, letters=LARGE)
    panel.lay_out()
    found["cut"]["without inputs"] = cut_texts(panel)
    parameters = panel.widget._parameterNode
    parameters.sweep, parameters.spacing = tinyScene.addSweep(), 1.0
    parameters.ctVolume, parameters.bone, _registration = tinyScene.addCT()
    panel.host.raise_slot_errors()
    for name, look in LOOKS.items():
        set_look(panel, **look)
        panel.lay_out()
        found["cut"][name] = cut_texts(panel)
    set_look(panel, opened=True)
    panel.lay_out()
    found["keyboard"] = by_keyboard(panel)
    panel.widget.ui.applyButton.click()
    panel.host.raise_slot_errors()
    panel.lay_out()
    found["cut"]["after a reconstruction"] = cut_texts(panel)
    return found


def main() -> int:
    """Prints the findings; returns the exit status."""
    if reason := missing():
        print(f"The panel cannot be looked at: it cannot run here: {reason}.", file=sys.stderr)
        return 2
    host = runHost()
    try:
        panel = Panel(host)  # it must live until the host is closed
        print(json.dumps(look_around(panel), indent=1))
    finally:
        host.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
