"""Stand-ins for CTK's widgets that hide their contents. See `widgets_ctk.py` for the rules."""

from __future__ import annotations

from PySide6 import QtCore, QtGui, QtWidgets
from PySide6.QtCore import Property, Qt, Signal

WIDEST = 16777215
"""Qt's QWIDGETSIZE_MAX."""


def hide_contents(widget) -> list:
    """Hides the widgets inside; returns those that were not hidden before."""
    shown = [child for child in widget.children() if isinstance(child, QtWidgets.QWidget) and not child.isHidden()]
    for child in shown:
        child.hide()
    return shown


class ctkCollapsibleButton(QtWidgets.QAbstractButton):
    """A button above contents that it hides: checked and not collapsed are the same thing."""

    api = {"signals": {"contentsCollapsed(bool)": "contentsCollapsed"}}
    contentsCollapsed = Signal(bool)

    def __init__(self, parent=None) -> None:
        super().__init__(parent)
        self._collapsed = False
        self._hidden_by_us: list = []
        self._collapsed_height = 14
        self.setCheckable(True)
        self.setChecked(True)
        self.setSizePolicy(QtWidgets.QSizePolicy.Policy.Minimum, QtWidgets.QSizePolicy.Policy.Preferred)
        self.setContentsMargins(0, self._header_size().height(), 0, 0)
        self.setBackgroundRole(QtGui.QPalette.ColorRole.Window)
        self.toggled.connect(lambda checked: self._collapse(not checked))

    def _collapse(self, collapsed):
        if collapsed == self._collapsed:
            return
        self._collapsed = collapsed
        if collapsed:
            self._hidden_by_us = hide_contents(self)
        else:
            for child in self._hidden_by_us:
                child.show()
            self._hidden_by_us = []
        # The contents' margins and spacing would stay as a gap below the header
        self.setMaximumHeight(self._header_size().height() + self._collapsed_height if collapsed else WIDEST)
        self.updateGeometry()
        self.contentsCollapsed.emit(collapsed)

    collapsed = Property(bool, lambda self: self._collapsed, lambda self, on: self.setChecked(not on))
    collapsedHeight = Property(int, lambda self: self._collapsed_height, lambda self, h: setattr(self, "_collapsed_height", h))

    def _header_size(self):
        option = QtWidgets.QStyleOptionButton()
        option.initFrom(self)
        text = self.fontMetrics().size(Qt.TextFlag.TextShowMnemonic, self.text() or "MMMM")
        return self.style().sizeFromContents(QtWidgets.QStyle.ContentsType.CT_PushButton, option, text + QtCore.QSize(24, 0), self)

    def _header(self):
        option = QtWidgets.QStyleOptionButton()
        option.initFrom(self)
        option.text = self.text()
        option.state |= QtWidgets.QStyle.StateFlag.State_Sunken if self.isDown() else QtWidgets.QStyle.StateFlag.State_Raised
        option.rect.setHeight(self._header_size().height())
        return option

    def sizeHint(self):
        header = self._header_size()
        if self._collapsed:
            return QtCore.QSize(header.width(), header.height() + self._collapsed_height)
        return super().sizeHint().expandedTo(header)

    def minimumSizeHint(self):
        return self.sizeHint() if self._collapsed else super().minimumSizeHint().expandedTo(self._header_size())

    def paintEvent(self, event):
        """Draws the header: an arrow that points down over open contents and right over collapsed ones, and the text."""
        option = self._header()
        painter = QtGui.QPainter(self)
        style = QtWidgets.QStyle
        self.style().drawControl(style.ControlElement.CE_PushButtonBevel, option, painter, self)
        arrow = QtWidgets.QStyleOption()
        arrow.initFrom(self)
        height = option.rect.height()
        arrow.rect = QtCore.QRect((height - 10) // 2, (height - 10) // 2, 10, 10)
        kind = style.PrimitiveElement.PE_IndicatorArrowRight if self._collapsed else style.PrimitiveElement.PE_IndicatorArrowDown
        self.style().drawPrimitive(kind, arrow, painter, self)
        option.rect.setLeft(height)
        alignment = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter | Qt.TextFlag.TextShowMnemonic
        self.style().drawItemText(
            painter, option.rect, alignment, option.palette, self.isEnabled(), self.text(), QtGui.QPalette.ColorRole.ButtonText
        )
        painter.end()


class ctkCollapsibleGroupBox(QtWidgets.QGroupBox):
    """A group box whose title hides its contents."""

    api: dict = {}

    def __init__(self, parent=None) -> None:
        super().__init__(parent)
        self._hidden_by_us: list = []
        self._collapsed_height = 14
        self.setCheckable(True)
        self.setChecked(True)
        self.toggled.connect(self._expand)

    def _expand(self, expanded):
        if expanded:
            for child in self._hidden_by_us:
                child.show()
            self._hidden_by_us = []
        else:
            self._hidden_by_us = hide_contents(self)
        self.setMaximumHeight(WIDEST if expanded else self.fontMetrics().height() + self._collapsed_height)

    collapsed = Property(bool, lambda self: not self.isChecked(), lambda self, on: self.setChecked(not on))
    collapsedHeight = Property(int, lambda self: self._collapsed_height, lambda self, h: setattr(self, "_collapsed_height", h))

    def paintEvent(self, event):
        painter = QtWidgets.QStylePainter(self)
        option = QtWidgets.QStyleOptionGroupBox()
        self.initStyleOption(option)
        style = QtWidgets.QStyle
        painter.drawComplexControl(style.ComplexControl.CC_GroupBox, option)
        box = style.SubControl.SC_GroupBoxCheckBox
        arrow = QtWidgets.QStyleOption()
        arrow.initFrom(self)
        arrow.rect = self.style().subControlRect(style.ComplexControl.CC_GroupBox, option, box, self)
        painter.fillRect(arrow.rect, self.palette().window())
        arrow.rect.adjust(2, 2, -2, -2)
        kind = style.PrimitiveElement.PE_IndicatorArrowDown if self.isChecked() else style.PrimitiveElement.PE_IndicatorArrowRight
        painter.drawPrimitive(kind, arrow)
        painter.end()
