"""Drawings of the library on labels."""

import qt


def paint(drawing, label, scale: float) -> None:
    """Paint a `Drawing` on a label, on its white page and as sharp as the screen: Qt needs no plugin for that."""
    ratio = label.devicePixelRatioF()
    page = qt.QPixmap(round(ratio * scale * drawing.width), round(ratio * scale * drawing.height))
    page.fill(qt.QColor("white"))
    painter = qt.QPainter(page)
    painter.setRenderHint(qt.QPainter.Antialiasing)
    painter.scale(ratio * scale, ratio * scale)
    for stroke in drawing.strokes:
        _stroke(stroke, painter)
    font = painter.font()
    for words in drawing.words:
        font.setPixelSize(round(words.size / scale))
        painter.setFont(font)
        painter.setPen(qt.QPen(qt.QColor(words.color)))
        painter.drawText(qt.QPointF(words.x, words.y), words.text)
    painter.end()
    page.setDevicePixelRatio(ratio)
    label.setPixmap(page)


def _stroke(stroke, painter) -> None:
    pen, tint = qt.QPen(qt.QColor(stroke.color)), qt.QColor(stroke.color)
    pen.setWidthF(stroke.width)
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
