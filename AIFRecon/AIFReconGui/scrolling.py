"""Bringing parts of the panel into view: Slicer shows every module in an area that scrolls."""

import qt


def reveal(first, last) -> None:
    """Scroll the panel so that the widgets from `first` down to `last` are seen, once their layout has settled.

    Parameters
    ----------
    first, last : QWidget
        Where both do not fit at once, `first` is seen.
    """
    area = _areaAround(first)
    if area is not None:
        qt.QTimer.singleShot(0, lambda: _show(area, first, last))


def _show(area, first, last) -> None:
    for widget in (last, first):
        # Either may be gone by now, with the panel
        if area and widget:
            area.ensureWidgetVisible(widget)


def _areaAround(widget):
    while widget is not None and not widget.inherits("QScrollArea"):
        widget = widget.parentWidget()
    return widget
