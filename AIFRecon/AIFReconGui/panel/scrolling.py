"""Bringing parts of the panel into view: Slicer shows every module in an area that scrolls."""

import qt

SETTLED = 100
"""ms until every layout around a widget that has changed has asked the next one for room."""


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
