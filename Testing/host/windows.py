"""The main window with the panel that modules are shown in, laid out by Qt as Slicer's own is; it is never seen.

The panel is as wide as the user pulled it, and wider where a module's contents ask for it: the scroll area never scrolls sideways. Tool
bars, the logo and the data probe are empty places of about the height that they have in Slicer.
"""

from __future__ import annotations

from PySide6 import QtCore, QtWidgets
from PySide6.QtCore import Property, Signal

SIZE = (1400, 1000)
"""Pixels, of the whole window."""

TOOL_BARS, LOGO, DATA_PROBE, STATUS_BAR = 90, 60, 150, 24
"""Pixels of height."""

NARROWEST_VIEWS = 300


class qSlicerModulePanel(QtWidgets.QWidget):
    """What scrolls the panel of the module that is open."""

    api: dict = {}

    def __init__(self):
        super().__init__()
        self.setObjectName("ModulePanel")
        policy = QtWidgets.QSizePolicy.Policy
        self.setSizePolicy(policy.Minimum, policy.Preferred)
        self.area = QtWidgets.QScrollArea(self)
        self.area.setObjectName("ScrollArea")
        self.area.setSizePolicy(policy.Minimum, policy.Expanding)
        self.area.setFrameShape(QtWidgets.QFrame.Shape.NoFrame)
        self.area.setHorizontalScrollBarPolicy(QtCore.Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.area.setWidgetResizable(True)
        contents = QtWidgets.QWidget()
        contents.setSizePolicy(policy.Minimum, policy.Preferred)
        self._inside = QtWidgets.QVBoxLayout(contents)
        self._inside.setSizeConstraint(QtWidgets.QLayout.SizeConstraint.SetMinAndMaxSize)
        self._inside.setContentsMargins(0, 0, 0, 0)
        self._inside.addStretch(0)
        self.area.setWidget(contents)
        layout = QtWidgets.QGridLayout(self)
        layout.setSizeConstraint(QtWidgets.QLayout.SizeConstraint.SetMinimumSize)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.area)

    def put(self, widget):
        before = self._inside.itemAt(0).widget()
        if before is widget:
            return
        if before is not None:
            before.removeEventFilter(self)
            self._inside.removeWidget(before)
            before.hide()
            before.setParent(None)
        if widget is not None:
            widget.layout().setContentsMargins(0, 0, 0, 0)
            self._inside.insertWidget(0, widget, 1)
            widget.setSizePolicy(QtWidgets.QSizePolicy.Policy.Minimum, widget.sizePolicy().verticalPolicy())
            widget.show()
            widget.installEventFilter(self)
        self.updateGeometry()

    def eventFilter(self, watched, event):
        if event.type() == QtCore.QEvent.Type.Resize:
            self.updateGeometry()
        return False

    def minimumSizeHint(self):
        inside, bar = self.area.widget().minimumSizeHint(), self.area.verticalScrollBar().sizeHint()
        return QtCore.QSize(inside.width() + bar.width(), super().minimumSizeHint().height())


class qSlicerModuleSelectorToolBar(QtWidgets.QWidget):
    """Opens modules."""

    api = {"methods": ("selectModule",), "signals": {"moduleSelected(QString)": "moduleSelected"}}
    moduleSelected = Signal(str)

    def __init__(self, manager, panel):
        super().__init__()
        self._manager = manager
        self._panel = panel
        self._current = ""

    def selectModule(self, name):
        """Leaves the module that is open and enters another; "" only leaves."""
        previous = self._manager.module(self._current)
        if previous is not None and previous.widgetRepresentation() is not None:
            previous.widgetRepresentation().exit()
        self._current = name
        module = self._manager.module(name)
        shown = module.widgetRepresentation() if module is not None else None
        self._panel.put(shown)
        if shown is not None:
            shown.enter()
        self.moduleSelected.emit(name)

    selectedModule = Property(str, lambda self: self._current)


class qSlicerMainWindow(QtWidgets.QMainWindow):
    """The main window."""

    api = {"methods": ("moduleSelector",)}

    def __init__(self, manager):
        super().__init__()
        self.setObjectName("qSlicerMainWindow")
        self.setAttribute(QtCore.Qt.WidgetAttribute.WA_DontShowOnScreen)
        bars = QtWidgets.QToolBar()
        bars.setFixedHeight(TOOL_BARS)
        self.addToolBar(bars)
        views = QtWidgets.QWidget()
        views.setObjectName("CentralWidget")
        views.setMinimumWidth(NARROWEST_VIEWS)
        views.setSizePolicy(QtWidgets.QSizePolicy.Policy.Expanding, QtWidgets.QSizePolicy.Policy.Expanding)
        self.setCentralWidget(views)
        self._dock = QtWidgets.QDockWidget("Module Panel")
        self._dock.setObjectName("PanelDockWidget")
        contents = QtWidgets.QWidget()
        column = QtWidgets.QVBoxLayout(contents)
        column.setContentsMargins(0, 0, 0, 0)
        self.panel = qSlicerModulePanel()
        column.addWidget(_place(LOGO))
        column.addWidget(self.panel, 1)
        column.addWidget(_place(DATA_PROBE))
        self._dock.setWidget(contents)
        self.addDockWidget(QtCore.Qt.DockWidgetArea.LeftDockWidgetArea, self._dock)
        self.statusBar().setFixedHeight(STATUS_BAR)
        self._selector = qSlicerModuleSelectorToolBar(manager, self.panel)
        self.resize(*SIZE)

    def moduleSelector(self):
        return self._selector

    def closeEvent(self, event):
        """The user closes the window: the open module is left, and all windows and the application are closed after this event."""
        self._selector.selectModule("")
        event.accept()
        QtCore.QTimer.singleShot(0, self._end)

    @staticmethod
    def _end():
        QtWidgets.QApplication.closeAllWindows()
        QtWidgets.QApplication.exit(0)


def _place(height: int):
    """Room for something that is not there."""
    empty = QtWidgets.QWidget()
    empty.setFixedHeight(height)
    return empty
