"""The library's drawing of a sweep on a label, for which Qt needs no plugin."""

import qt

SCALE = 0.8
"""Of the page, whose letters keep their size: beside its fields the drawing must fit on the screen of a notebook."""


def show(drawing, label) -> None:
    """Paint a `Drawing` on its white page, as sharp as the screen."""
    ratio = label.devicePixelRatioF()
    page = qt.QPixmap(round(ratio * SCALE * drawing.width), round(ratio * SCALE * drawing.height))
    page.fill(qt.QColor("white"))
    painter = qt.QPainter(page)
    painter.setRenderHint(qt.QPainter.Antialiasing)
    painter.scale(ratio * SCALE, ratio * SCALE)
    for stroke in drawing.strokes:
        _paint(stroke, painter)
    font = painter.font()
    for words in drawing.words:
        font.setPixelSize(round(words.size / SCALE))
        painter.setFont(font)
        painter.setPen(qt.QPen(qt.QColor(words.color)))
        painter.drawText(qt.QPointF(words.x, words.y), words.text)
    painter.end()
    page.setDevicePixelRatio(ratio)
    label.setPixmap(page)


def _paint(stroke, painter) -> None:
    pen, tint = qt.QPen(qt.QColor(stroke.color)), qt.QColor(stroke.color)
    pen.setWidthF(stroke.width)
    pen.setStyle(qt.Qt.DashLine if stroke.dashed else qt.Qt.SolidLine)
    tint.setAlphaF(0.2 if stroke.tinted else 0.0)
    first, *others = ([float(each) for each in point] for point in stroke.points)
    line = qt.QPainterPath()
    line.moveTo(*first)
    for point in others:
        line.lineTo(*point)
    if stroke.closed:
        line.closeSubpath()
    painter.setPen(pen)
    painter.setBrush(qt.QBrush(tint))
    painter.drawPath(line)
    if stroke.dotted:
        painter.setBrush(qt.QBrush(qt.QColor(stroke.color)))
        painter.drawEllipse(qt.QPointF(*others[-1]), 2.0, 2.0)
