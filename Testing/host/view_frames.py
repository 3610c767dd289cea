"""Views put side by side as one picture, each with the bar and the orientation letters that a reader of images expects.

In the application these come from widgets and from a script over the views, neither of which is in slicer-core; here they are painted.
Everything that they say is read from the MRML nodes.
"""

from __future__ import annotations

import numpy as np
from PySide6 import QtCore, QtGui

BAR = 20
"""Height of the bar above a view, pixels."""

GAP = 4
RULER = 22
INK = QtGui.QColor(255, 255, 255)
SHADOW = QtGui.QColor(0, 0, 0, 190)

OBLIQUE = 0.35
"""A direction is told by its second letter too from this share of it on (about 20 degrees)."""


def direction_letters(direction_ras) -> str:
    """Where a direction points, in the patient: "L", or "LA" where it is oblique, the stronger first.

    Parameters
    ----------
    direction_ras : (3,) array_like
        Right, anterior, superior; any length but 0.
    """
    direction = np.asarray(direction_ras, dtype=float)
    shares = direction / np.linalg.norm(direction)
    order = np.argsort(-np.abs(shares), kind="stable")
    return "".join("RAS"[axis] if shares[axis] > 0 else "LPI"[axis] for axis in order if abs(shares[axis]) > OBLIQUE)


def slice_letters(slice_node) -> dict[str, str]:
    """Which way the sides of a slice view lie: "left", "right", "top", "bottom"."""
    import slicer

    axes = slicer.util.arrayFromVTKMatrix(slice_node.GetSliceToRAS())[:3]
    return {
        "right": direction_letters(axes[:, 0]),
        "left": direction_letters(-axes[:, 0]),
        "top": direction_letters(axes[:, 1]),
        "bottom": direction_letters(-axes[:, 1]),
    }


def slice_title(slice_logic) -> str:
    """The words in the bar of a slice view: its label, its orientation and where it lies."""
    node = slice_logic.GetSliceNode()
    orientation = node.GetOrientation()
    letter = {"Axial": "S", "Sagittal": "R", "Coronal": "A"}.get(orientation)
    place = f"{letter}: {round(slice_logic.GetSliceOffset(), 1) + 0.0:.1f} mm" if letter else "in the plane of the frame"
    return f"{node.GetLayoutLabel()}   {orientation if letter else 'Reformat'}   {place}"


def framed(pixels: np.ndarray, title: str, color, letters=None) -> QtGui.QImage:
    """A view under its bar.

    Parameters
    ----------
    pixels : (height, width, 3) uint8 array
    title : str
        In the bar.
    color : (3,) of float, 0 to 1
        The bar's color, as the layout gives it.
    letters : dict of str to str, or None
        As `slice_letters` gives them.
    """
    pixels = np.ascontiguousarray(pixels)
    height, width = pixels.shape[:2]
    view = QtGui.QImage(pixels.data, width, height, 3 * width, QtGui.QImage.Format.Format_RGB888).copy()
    painter = QtGui.QPainter(view)
    painter.setRenderHint(QtGui.QPainter.RenderHint.TextAntialiasing)
    area, side = QtCore.QRect(6, 4, width - 12, height - 8), QtCore.Qt.AlignmentFlag
    _font(painter, 14, bold=True)
    for place, alignment in (
        ("left", side.AlignLeft | side.AlignVCenter),
        ("right", side.AlignRight | side.AlignVCenter),
        ("top", side.AlignHCenter | side.AlignTop),
        ("bottom", side.AlignHCenter | side.AlignBottom),
    ):
        # The ruler lies along the lower edge
        _shadowed(painter, area.adjusted(0, 0, 0, -RULER), alignment, (letters or {}).get(place, ""))
    painter.end()
    return titled(view, title, QtGui.QColor.fromRgbF(*color))


def titled(picture: QtGui.QImage, title: str, bar: QtGui.QColor | None = None) -> QtGui.QImage:
    """A picture of a window or view under a bar with its title, as a window manager would draw one."""
    whole = QtGui.QImage(picture.width(), picture.height() + BAR, QtGui.QImage.Format.Format_RGB888)
    painter = QtGui.QPainter(whole)
    painter.setRenderHint(QtGui.QPainter.RenderHint.TextAntialiasing)
    painter.fillRect(0, 0, whole.width(), BAR, bar or QtGui.QColor("#6C7A89"))
    painter.drawImage(0, BAR, picture)
    _font(painter, 12, bold=True)
    painter.setPen(INK if bar is None or bar.lightnessF() <= 0.45 else QtGui.QColor(0, 0, 0))
    painter.drawText(QtCore.QRect(8, 0, whole.width() - 16, BAR), QtCore.Qt.AlignmentFlag.AlignVCenter, title)
    painter.end()
    return whole


def tiled(rows: list[list[QtGui.QImage]], background: int = 48) -> QtGui.QImage:
    """Pictures in rows, with small gaps between them; `background` is the gray of the gaps."""
    width = max(sum(picture.width() for picture in row) + GAP * (len(row) - 1) for row in rows)
    heights = [max(picture.height() for picture in row) for row in rows]
    whole = QtGui.QImage(width, sum(heights) + GAP * (len(rows) - 1), QtGui.QImage.Format.Format_RGB888)
    whole.fill(QtGui.QColor(background, background, background))
    painter = QtGui.QPainter(whole)
    top = 0
    for row, height in zip(rows, heights):
        left = 0
        for picture in row:
            painter.drawImage(left, top, picture)
            left += picture.width() + GAP
        top += height + GAP
    painter.end()
    return whole


def write_png(picture: QtGui.QImage, path) -> None:
    """Writes a picture as small as PNG gets. OSError where it cannot be written."""
    if not picture.save(str(path), "PNG", 0):  # type: ignore[call-overload]
        raise OSError(f"cannot write {path}")


def _font(painter, pixel_size: int, bold: bool = False) -> None:
    font = QtGui.QFont("DejaVu Sans")
    font.setPixelSize(pixel_size)
    font.setBold(bold)
    painter.setFont(font)


def _shadowed(painter, area, alignment, text: str) -> None:
    if not text:
        return
    for color, offset in ((SHADOW, 1), (INK, 0)):
        painter.setPen(color)
        painter.drawText(area.translated(offset, offset), int(alignment), text)
