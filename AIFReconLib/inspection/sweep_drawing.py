"""A drawing of a sweep for a check by eye: the frames' outlines and axes, seen along two axes of Reference, as SVG."""

from __future__ import annotations

from collections.abc import Sequence
from xml.sax.saxutils import escape

import numpy as np

from ..arrays import Floats, Matrix
from ..imaging.region import ImageRegion, extreme_pixels

VIEWS = ((0, 1), (2, 1))
"""Axes across and down of each panel: seen along z, and along x."""

MOST_OUTLINES = 60
PANEL = 420.0
"""Points. Size of one panel, without its margin."""

MARGIN = 48.0
_AXES = "xyz"
_COLUMN_COLOR, _ROW_COLOR, _AXIS_COLOR, _SHOWN_COLOR = "#c0392b", "#1e8449", "#6c3483", "#2471a3"


def draw_sweep(
    image_to_reference: Matrix,
    frame_size: tuple[int, int],
    title: str = "",
    reference: str = "Reference",
    lines: Sequence[tuple[str, Floats, Floats]] = (),
    region: ImageRegion | None = None,
) -> str:
    """The text of an SVG file.

    The red line is the image's columns axis (+x, toward the marked side), the green one its rows axis (+y, away from the transducer),
    both of the first frame, in which what is ultrasound is drawn in blue. Both panels have one scale.

    Parameters
    ----------
    image_to_reference : (frames, 4, 4) array, pixels to mm, finite
        In the order in which they were taken: first frames are light, last ones dark.
    frame_size : (columns, rows)
    reference : str
        What the frame of the axes is called.
    lines : sequence of (name, point, direction)
        Axes of the mechanism that moved the probe, in Reference, mm: drawn in violet and dashed, each through its point.
    region : ImageRegion or None
        The part of the image that is ultrasound, drawn in blue.
    """
    poses = np.asarray(image_to_reference, dtype=np.float64)
    chosen = np.unique(np.linspace(0, len(poses) - 1, min(len(poses), MOST_OUTLINES)).round().astype(int))
    columns, rows = frame_size
    corners = np.array([(0, 0, 0, 1), (columns - 1, 0, 0, 1), (columns - 1, rows - 1, 0, 1), (0, rows - 1, 0, 1)], dtype=np.float64)
    outlines = np.einsum("nij,kj->nki", poses[chosen, :3], corners)
    area = np.empty((0, 3)) if region is None else _placed(extreme_pixels(region.mask(columns, rows)), poses[chosen[0]])
    shown = np.concatenate([outlines.reshape(-1, 3), *(point[None] for _, point, _ in lines)])
    low, high = shown.min(axis=0), shown.max(axis=0)
    extent = max(float((high - low).max()), 1e-6)
    scale = PANEL / extent
    width, height = len(VIEWS) * (PANEL + 2 * MARGIN), PANEL + 2 * MARGIN + 24
    elements = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" viewBox="0 0 {width:.0f} {height:.0f}" '
        'font-family="sans-serif" font-size="12">',
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="white"/>',
        f'<text x="{MARGIN:.0f}" y="20" font-size="14">{escape(title)}</text>',
    ]
    for number, axes in enumerate(VIEWS):
        corner = np.array([MARGIN + number * (PANEL + 2 * MARGIN), MARGIN])
        middle = (low + high)[list(axes)] / 2

        def on_page(points: Floats, corner: Floats = corner, axes: tuple[int, int] = axes, middle: Floats = middle) -> Floats:
            placed: Floats = corner + PANEL / 2 + (points[..., list(axes)] - middle) * scale
            return placed

        elements += _panel(on_page(outlines), corner, axes, scale, reference)
        if len(area):
            points = " ".join(f"{x:.1f},{y:.1f}" for x, y in on_page(area))
            elements.append(f'<polygon points="{points}" fill="{_SHOWN_COLOR}" fill-opacity="0.2" stroke="{_SHOWN_COLOR}"/>')
        for name, point, direction in lines:
            elements += _line(name, on_page(np.array([point - extent / 6 * direction, point + extent / 6 * direction])))
    elements.append("</svg>\n")
    return "\n".join(elements)


def _line(name: str, ends: Floats) -> list[str]:
    """An axis, dashed, from one end to the other on the page."""
    (x1, y1), (x2, y2) = ends
    return [
        f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{_AXIS_COLOR}" stroke-width="2" stroke-dasharray="6 4"/>',
        f'<circle cx="{x2:.1f}" cy="{y2:.1f}" r="3" fill="{_AXIS_COLOR}"/>',
        f'<text x="{x2 + 5:.1f}" y="{y2 - 4:.1f}" fill="{_AXIS_COLOR}">{escape(name)}</text>',
    ]


def _placed(pixels: Floats, image_to_reference: Matrix) -> Floats:
    """The outline of an area, (n, 3) mm, from the first and the last pixel of each of its rows."""
    half = len(pixels) // 2
    around = np.concatenate([pixels[:half], pixels[half:][::-1]])
    placed: Floats = around @ image_to_reference[:3, :2].T + image_to_reference[:3, 3]
    return placed


def _panel(outlines: Floats, corner: Floats, axes: tuple[int, int], scale: float, reference: str) -> list[str]:
    """One view of the outlines, (frames, 4, 2) on the page."""
    across, down = (_AXES[axis] for axis in axes)
    elements = [f'<rect x="{corner[0]:.1f}" y="{corner[1]:.1f}" width="{PANEL:.0f}" height="{PANEL:.0f}" fill="none" stroke="#bbb"/>']
    for number, outline in enumerate(outlines):
        level = round(190 - 170 * number / max(len(outlines) - 1, 1))
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in outline)
        elements.append(f'<polygon points="{points}" fill="none" stroke="rgb({level},{level},{level})"/>')
    origin, end_of_columns, _, end_of_rows = outlines[0]
    for end, color, label in ((end_of_columns, _COLUMN_COLOR, "columns"), (end_of_rows, _ROW_COLOR, "rows")):
        elements.append(
            f'<line x1="{origin[0]:.1f}" y1="{origin[1]:.1f}" x2="{end[0]:.1f}" y2="{end[1]:.1f}" stroke="{color}" stroke-width="2"/>'
        )
        elements.append(f'<circle cx="{end[0]:.1f}" cy="{end[1]:.1f}" r="3" fill="{color}"/>')
        elements.append(f'<text x="{end[0] + 5:.1f}" y="{end[1] - 4:.1f}" fill="{color}">{label}</text>')
    length = 10.0 ** np.floor(np.log10(PANEL / 2 / scale))
    y = corner[1] + PANEL + 20
    elements.append(
        f'<line x1="{corner[0]:.1f}" y1="{y:.1f}" x2="{corner[0] + length * scale:.1f}" y2="{y:.1f}" stroke="black" stroke-width="2"/>'
    )
    words = f"{length:g} mm; {escape(reference)}: +{across} right, +{down} down"
    elements.append(f'<text x="{corner[0] + length * scale + 8:.1f}" y="{y + 4:.1f}">{words}</text>')
    return elements
