"""Stand-ins for the CTK widgets that the module's .ui may hold, on PySide6.

Each class has the Qt properties of CTK's header and, in `api`, the names of the methods (public slots and Q_INVOKABLE methods),
signals and enumeration values that PythonQt shows of it. A test compares both with CTK's headers where they are present. Getters
and setters that are plain C++ methods are not offered: PythonQt does not show them.
"""

from __future__ import annotations

import re

from PySide6 import QtWidgets
from PySide6.QtCore import Property, Qt, Signal


class ctkSliderWidget(QtWidgets.QWidget):
    """A slider and a spin box for one floating point number, rounded to `decimals`."""

    api = {
        "methods": ("setValue", "setDecimals"),
        "signals": {
            "valueChanged(double)": "valueChanged",
            "valueIsChanging(double)": "valueIsChanging",
            "decimalsChanged(int)": "decimalsChanged",
        },
    }
    valueChanged = Signal(float)
    valueIsChanging = Signal(float)
    decimalsChanged = Signal(int)

    def __init__(self, parent=None):
        super().__init__(parent)
        self._slider = QtWidgets.QSlider(Qt.Orientation.Horizontal, self)
        self._spin = QtWidgets.QDoubleSpinBox(self)
        self._tracking = True
        row = QtWidgets.QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self._slider)
        row.addWidget(self._spin)
        self.setFocusProxy(self._spin)
        self.setSizePolicy(QtWidgets.QSizePolicy.Policy.Expanding, QtWidgets.QSizePolicy.Policy.Fixed)
        self._slider.setRange(0, 1000)
        self._spin.valueChanged.connect(self._spun)

    def _place(self):
        low, high = self._spin.minimum(), self._spin.maximum()
        blocked = self._slider.blockSignals(True)
        self._slider.setValue(round(1000 * (self._spin.value() - low) / (high - low)) if high > low else 0)
        self._slider.blockSignals(blocked)

    def _spun(self, value):
        self._place()
        if not self._tracking:
            self.valueIsChanging.emit(value)
        self.valueChanged.emit(value)

    def _set(self, what, value):
        getattr(self._spin, what)(value)
        self._place()

    def setValue(self, value):
        self._spin.setValue(value)

    def setDecimals(self, decimals):
        self._spin.setDecimals(decimals)
        self.decimalsChanged.emit(decimals)

    value = Property(float, lambda self: self._spin.value(), setValue)
    minimum = Property(float, lambda self: self._spin.minimum(), lambda self, v: self._set("setMinimum", v))
    maximum = Property(float, lambda self: self._spin.maximum(), lambda self, v: self._set("setMaximum", v))
    singleStep = Property(float, lambda self: self._spin.singleStep(), lambda self, v: self._spin.setSingleStep(v))
    pageStep = Property(float, lambda self: float(self._slider.pageStep()), lambda self, v: self._slider.setPageStep(int(v)))
    decimals = Property(int, lambda self: self._spin.decimals(), setDecimals)
    prefix = Property(str, lambda self: self._spin.prefix(), lambda self, v: self._spin.setPrefix(v))
    suffix = Property(str, lambda self: self._spin.suffix(), lambda self, v: self._spin.setSuffix(v))
    tracking = Property(bool, lambda self: self._tracking, lambda self, v: setattr(self, "_tracking", v))


def _value(name: str, kind):
    """A property that is only kept."""
    return Property(kind, lambda self: self._values[name], lambda self, value: self._values.__setitem__(name, value))


class ctkPathLineEdit(QtWidgets.QWidget):
    """A line for a path, with the paths used before and a button that opens a file dialog."""

    api = {
        "methods": ("comboBox", "setCurrentPath"),
        "signals": {"currentPathChanged(QString)": "currentPathChanged"},
    }
    currentPathChanged = Signal(str)
    Dirs, Files, Drives, NoSymLinks, Readable, Writable, Executable, Hidden = 1, 2, 4, 8, 0x10, 0x20, 0x40, 0x100

    def __init__(self, parent=None):
        super().__init__(parent)
        self._values = {"label": "", "filters": 7, "nameFilters": [], "settingKey": ""}
        self._box = QtWidgets.QComboBox(self)
        self._box.setEditable(True)
        self._box.setInsertPolicy(QtWidgets.QComboBox.InsertPolicy.NoInsert)
        self._box.setSizePolicy(QtWidgets.QSizePolicy.Policy.Expanding, QtWidgets.QSizePolicy.Policy.Fixed)
        self._box.setMinimumContentsLength(7)
        self._button = QtWidgets.QToolButton(self)
        self._button.setText("...")
        self._button.setToolTip("Open a dialog")
        row = QtWidgets.QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(0)
        row.addWidget(self._box)
        row.addWidget(self._button)
        self.setFocusProxy(self._box.lineEdit())
        self.setSizePolicy(QtWidgets.QSizePolicy.Policy.Expanding, QtWidgets.QSizePolicy.Policy.Fixed)
        self._box.lineEdit().textChanged.connect(self._tell)

    def comboBox(self):
        return self._box

    def setCurrentPath(self, path):
        self._box.lineEdit().setText(path)

    def _tell(self, text):
        """As CTK: only a path that fits the name filters is one; an empty line never is, nor a suffix in capitals."""
        suffixes = [suffix for words in self._values["nameFilters"] for suffix in re.findall(r"\*\.(\w+)", words)]
        if re.fullmatch("|".join(rf".*\.{suffix}?" for suffix in suffixes) or ".+", text):
            self.currentPathChanged.emit(text)

    currentPath = Property(str, lambda self: self._box.currentText(), setCurrentPath)
    label = _value("label", str)
    filters = _value("filters", int)
    nameFilters = _value("nameFilters", "QStringList")
    settingKey = _value("settingKey", str)
    minimumContentsLength = Property(
        int, lambda self: self._box.minimumContentsLength(), lambda self, v: self._box.setMinimumContentsLength(v)
    )


class ctkCheckableComboBox(QtWidgets.QComboBox):
    """A combo box whose items have check boxes; the line lists the checked ones."""

    api = {
        "methods": (
            "checkedIndexes",
            "allChecked",
            "setCheckState",
            "checkState",
        ),
        "signals": {"checkedIndexesChanged()": "checkedIndexesChanged"},
    }
    checkedIndexesChanged = Signal()

    def __init__(self, parent=None):
        super().__init__(parent)
        self._watch(self.model())

    def _watch(self, model):
        model.rowsInserted.connect(self._adopt)
        model.dataChanged.connect(lambda *_: self.update())

    def _adopt(self, parent, first, last):
        for row in range(first, last + 1):
            index = self.model().index(row, 0, parent)
            if index.data(Qt.ItemDataRole.CheckStateRole) is None:
                self.model().setData(index, int(Qt.CheckState.Unchecked.value), Qt.ItemDataRole.CheckStateRole)

    def _indexes(self):
        return [self.model().index(row, 0) for row in range(self.count())]

    def checkedIndexes(self):
        return [index for index in self._indexes() if self.checkState(index) == Qt.CheckState.Checked]

    def allChecked(self):
        return len(self.checkedIndexes()) == self.count()

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
        option.currentText = "All" if names and self.allChecked() else ", ".join(names) or "None"
        painter.drawComplexControl(QtWidgets.QStyle.ComplexControl.CC_ComboBox, option)
        painter.drawControl(QtWidgets.QStyle.ControlElement.CE_ComboBoxLabel, option)
        painter.end()


class ctkMessageBox(QtWidgets.QMessageBox):
    """A message box; `slicer.util.messageBox` shows this one."""

    api: dict = {"methods": ("setDontShowAgain", "onFinished", "addDontShowAgainButtonRole")}

    def __init__(self, parent=None):
        super().__init__(parent)
        self._values = {"dontShowAgain": False, "dontShowAgainSettingsKey": "", "dontShowAgainVisible": False}

    dontShowAgain = Property(bool, lambda self: self._values["dontShowAgain"], lambda self, v: self._values.update(dontShowAgain=v))
    dontShowAgainVisible = Property(
        bool, lambda self: self._values["dontShowAgainVisible"], lambda self, v: self._values.update(dontShowAgainVisible=v)
    )
    dontShowAgainSettingsKey = Property(
        str, lambda self: self._values["dontShowAgainSettingsKey"], lambda self, v: self._values.update(dontShowAgainSettingsKey=v)
    )
