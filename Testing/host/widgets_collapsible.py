"""Stand-ins for CTK's widgets that hide their contents. See `widgets_ctk.py` for the rules."""

from __future__ import annotations

from PySide6 import QtCore, QtGui, QtWidgets
from PySide6.QtCore import Property, Qt, Signal

from .node_combo_box import kept

WIDEST = 16777215
"""Qt's QWIDGETSIZE_MAX."""


class _Collapsible:
    """Hides its contents: checked and not collapsed are the same thing."""

    def _begin(self):
        self._hidden_by_us: list = []
        self.setCheckable(True)
        self.setChecked(True)
        self.toggled.connect(self._expand)

    def _expand(self, expanded):
        if not expanded:
            self._hidden_by_us = [each for each in self.children() if isinstance(each, QtWidgets.QWidget) and not each.isHidden()]
        for child in self._hidden_by_us:
            child.setVisible(expanded)
        # The contents' margins and spacing would stay as a gap below the header
        self.setMaximumHeight(WIDEST if expanded else self._header_height() + self.collapsedHeight)
        self.updateGeometry()

    def _arrow(self, painter, rect):
        """Down over open contents and right over collapsed ones."""
        style, arrow = QtWidgets.QStyle.PrimitiveElement, QtWidgets.QStyleOption()
        arrow.initFrom(self)
        arrow.rect = rect
        kind = style.PE_IndicatorArrowDown if self.isChecked() else style.PE_IndicatorArrowRight
        self.style().drawPrimitive(kind, arrow, painter, self)


class ctkCollapsibleButton(_Collapsible, QtWidgets.QAbstractButton):
    """A button above contents that it hides."""

    api = {"signals": {"contentsCollapsed(bool)": "contentsCollapsed"}}
    contentsCollapsed = Signal(bool)

    def __init__(self, parent=None) -> None:
        super().__init__(parent)
        self._begin()
        self.toggled.connect(lambda expanded: self.contentsCollapsed.emit(not expanded))
        self.setSizePolicy(QtWidgets.QSizePolicy.Policy.Minimum, QtWidgets.QSizePolicy.Policy.Preferred)
        self.setContentsMargins(0, self._header_height(), 0, 0)
        self.setBackgroundRole(QtGui.QPalette.ColorRole.Window)

    collapsed = Property(bool, lambda self: not self.isChecked(), lambda self, on: self.setChecked(not on))
    collapsedHeight = kept("collapsedHeight", int, 14)

    def _header_size(self):
        option = QtWidgets.QStyleOptionButton()
        option.initFrom(self)
        text = self.fontMetrics().size(Qt.TextFlag.TextShowMnemonic, self.text() or "MMMM")
        return self.style().sizeFromContents(QtWidgets.QStyle.ContentsType.CT_PushButton, option, text + QtCore.QSize(24, 0), self)

    def _header_height(self):
        return self._header_size().height()

    def sizeHint(self):
        header = self._header_size()
        return super().sizeHint().expandedTo(header) if self.isChecked() else header + QtCore.QSize(0, self.collapsedHeight)

    def minimumSizeHint(self):
        return super().minimumSizeHint().expandedTo(self._header_size()) if self.isChecked() else self.sizeHint()

    def paintEvent(self, event):
        """Draws the header: an arrow and the text."""
        option, painter = QtWidgets.QStyleOptionButton(), QtGui.QPainter(self)
        option.initFrom(self)
        option.state |= QtWidgets.QStyle.StateFlag.State_Raised
        height = self._header_height()
        option.rect.setHeight(height)
        self.style().drawControl(QtWidgets.QStyle.ControlElement.CE_PushButtonBevel, option, painter, self)
        self._arrow(painter, QtCore.QRect((height - 10) // 2, (height - 10) // 2, 10, 10))
        option.rect.setLeft(height)
        alignment = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter | Qt.TextFlag.TextShowMnemonic
        ink = QtGui.QPalette.ColorRole.ButtonText
        self.style().drawItemText(painter, option.rect, alignment, option.palette, self.isEnabled(), self.text(), ink)
        painter.end()


class ctkCollapsibleGroupBox(_Collapsible, QtWidgets.QGroupBox):
    """A group box whose title hides its contents."""

    api: dict = {}

    def __init__(self, parent=None) -> None:
        super().__init__(parent)
        self._begin()

    collapsed = Property(bool, lambda self: not self.isChecked(), lambda self, on: self.setChecked(not on))
    collapsedHeight = kept("collapsedHeight", int, 14)

    def _header_height(self):
        return self.fontMetrics().height()

    def paintEvent(self, event):
        painter = QtWidgets.QStylePainter(self)
        option, style = QtWidgets.QStyleOptionGroupBox(), QtWidgets.QStyle
        self.initStyleOption(option)
        painter.drawComplexControl(style.ComplexControl.CC_GroupBox, option)
        box = self.style().subControlRect(style.ComplexControl.CC_GroupBox, option, style.SubControl.SC_GroupBoxCheckBox, self)
        painter.fillRect(box, self.palette().window())
        self._arrow(painter, box.adjusted(2, 2, -2, -2))
        painter.end()
