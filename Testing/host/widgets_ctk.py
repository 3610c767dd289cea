"""Stand-ins for the CTK widgets that the module's .ui may hold, on PySide6.

Each class has the Qt properties that the module uses of CTK's and, in `api`, the names of the methods (public slots and Q_INVOKABLE
methods) and signals that PythonQt shows of it. A test compares both with what the application told. Getters and setters that are plain C++
methods are not offered: PythonQt does not show them.
"""

from __future__ import annotations

import re

from PySide6 import QtWidgets
from PySide6.QtCore import Property, Qt, Signal

from .node_combo_box import kept


class ctkSliderWidget(QtWidgets.QWidget):
    """A slider and a spin box for one floating point number, rounded to `decimals`."""

    api = {"methods": ("setValue",), "signals": {"valueChanged(double)": "valueChanged"}}
    valueChanged = Signal(float)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._slider = QtWidgets.QSlider(Qt.Orientation.Horizontal, self)
        self._spin = QtWidgets.QDoubleSpinBox(self)
        row = QtWidgets.QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self._slider)
        row.addWidget(self._spin)
        self.setFocusProxy(self._spin)
        self.setSizePolicy(QtWidgets.QSizePolicy.Policy.Expanding, QtWidgets.QSizePolicy.Policy.Fixed)
        self._slider.setRange(0, 1000)
        self._spin.valueChanged.connect(self._place)
        self._spin.valueChanged.connect(self.valueChanged)

    def _place(self, *_):
        low, high = self._spin.minimum(), self._spin.maximum()
        self._slider.setValue(round(1000 * (self._spin.value() - low) / (high - low)) if high > low else 0)

    def _set(self, what, value):
        getattr(self._spin, what)(value)
        self._place()

    def setValue(self, value):
        self._spin.setValue(value)

    value = Property(float, lambda self: self._spin.value(), setValue)
    minimum = Property(float, lambda self: self._spin.minimum(), lambda self, v: self._set("setMinimum", v))
    maximum = Property(float, lambda self: self._spin.maximum(), lambda self, v: self._set("setMaximum", v))
    singleStep = Property(float, lambda self: self._spin.singleStep(), lambda self, v: self._spin.setSingleStep(v))
    pageStep = Property(float, lambda self: float(self._slider.pageStep()), lambda self, v: self._slider.setPageStep(int(v)))
    suffix = Property(str, lambda self: self._spin.suffix(), lambda self, v: self._spin.setSuffix(v))
    decimals = Property(int, lambda self: self._spin.decimals(), lambda self, v: self._spin.setDecimals(v))


class ctkPathLineEdit(QtWidgets.QWidget):
    """A line for a path, with the paths used before and a button that opens a file dialog."""

    api = {"methods": ("comboBox", "setCurrentPath"), "signals": {"currentPathChanged(QString)": "currentPathChanged"}}
    currentPathChanged = Signal(str)
    Dirs, Files, Drives, NoSymLinks, Readable, Writable, Executable, Hidden = 1, 2, 4, 8, 0x10, 0x20, 0x40, 0x100

    def __init__(self, parent=None):
        super().__init__(parent)
        self._box = QtWidgets.QComboBox(self)
        self._box.setEditable(True)
        self._box.setInsertPolicy(QtWidgets.QComboBox.InsertPolicy.NoInsert)
        self._box.setSizePolicy(QtWidgets.QSizePolicy.Policy.Expanding, QtWidgets.QSizePolicy.Policy.Fixed)
        self._box.setMinimumContentsLength(7)
        button = QtWidgets.QToolButton(self)
        button.setText("...")
        button.setToolTip("Open a dialog")
        row = QtWidgets.QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(0)
        row.addWidget(self._box)
        row.addWidget(button)
        self.setFocusProxy(self._box.lineEdit())
        self.setSizePolicy(QtWidgets.QSizePolicy.Policy.Expanding, QtWidgets.QSizePolicy.Policy.Fixed)
        self._box.lineEdit().textChanged.connect(self._tell)

    def comboBox(self):
        return self._box

    def setCurrentPath(self, path):
        self._box.lineEdit().setText(path)

    def _tell(self, text):
        """As CTK: only a path that fits the name filters is one; an empty line never is, nor a suffix in capitals."""
        suffixes = [suffix for words in self.nameFilters for suffix in re.findall(r"\*\.(\w+)", words)]
        if re.fullmatch("|".join(rf".*\.{suffix}?" for suffix in suffixes) or ".+", text):
            self.currentPathChanged.emit(text)

    currentPath = Property(str, lambda self: self._box.currentText(), setCurrentPath)
    filters = kept("filters", int, 7)
    nameFilters = kept("nameFilters", "QStringList", [])
    settingKey = kept("settingKey", str, "")


class ctkCheckableComboBox(QtWidgets.QComboBox):
    """A combo box whose items have check boxes; the line lists the checked ones."""

    api = {"methods": ("checkedIndexes", "setCheckState", "checkState"), "signals": {"checkedIndexesChanged()": "checkedIndexesChanged"}}
    checkedIndexesChanged = Signal()

    def checkedIndexes(self):
        indexes = [self.model().index(row, 0) for row in range(self.count())]
        return [index for index in indexes if self.checkState(index) == Qt.CheckState.Checked]

    def setCheckState(self, index, state):
        if self.checkState(index) != state:
            self.model().setData(index, int(state.value), Qt.ItemDataRole.CheckStateRole)
            self.checkedIndexesChanged.emit()
            self.update()

    def checkState(self, index):
        return Qt.CheckState(int(getattr(value := index.data(Qt.ItemDataRole.CheckStateRole) or 0, "value", value)))

    def paintEvent(self, event):
        """Draws the checked items' names, or that there are none, in place of the current item."""
        painter = QtWidgets.QStylePainter(self)
        option = QtWidgets.QStyleOptionComboBox()
        self.initStyleOption(option)
        names = [index.data() for index in self.checkedIndexes()]
        option.currentText = "All" if names and len(names) == self.count() else ", ".join(names) or "None"
        painter.drawComplexControl(QtWidgets.QStyle.ComplexControl.CC_ComboBox, option)
        painter.drawControl(QtWidgets.QStyle.ControlElement.CE_ComboBoxLabel, option)
        painter.end()


class ctkMessageBox(QtWidgets.QMessageBox):
    """A message box; `slicer.util.messageBox` shows this one."""

    api: dict = {}
    dontShowAgain = kept("dontShowAgain", bool, False)
    dontShowAgainVisible = kept("dontShowAgainVisible", bool, False)
    dontShowAgainSettingsKey = kept("dontShowAgainSettingsKey", str, "")
