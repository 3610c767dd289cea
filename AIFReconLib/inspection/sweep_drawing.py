"""A drawing of a sweep for a check by eye: the frames' outlines and axes, seen along two axes of Reference."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arrays import Floats, Matrix
from ..imaging.region import ImageRegion, extreme_pixels
from .drawing import Drawing, Stroke, Words

VIEWS = ((0, 1), (2, 1))
"""Axes across and down of each panel: seen along z, and along x."""

MOST_OUTLINES = 60
PANEL = 420.0
"""Points. Size of one panel, without its margin."""

MARGIN = 48.0
_AXES = "xyz"
_COLUMN_COLOR, _ROW_COLOR, _SHOWN_COLOR = "#c0392b", "#1e8449", "#2471a3"


def draw_sweep(
    image_to_reference: Matrix,
    frame_size: tuple[int, int],
    title: str = "",
    reference: str = "Reference",
    region: ImageRegion | None = None,
) -> Drawing:
    """The drawing of a sweep.

    The red line is the image's columns axis (+x, toward the marked side), the green one its rows axis (+y, away from the transducer),
    both of the first frame, in which what is ultrasound is drawn in blue. Both panels have one scale.

    Parameters
    ----------
    image_to_reference : (frames, 4, 4) array, pixels to mm, finite
        In the order in which they were taken: first frames are light, last ones dark.
    frame_size : (columns, rows)
    reference : str
        What the frame of the axes is called.
    region : ImageRegion or None
        The part of the image that is ultrasound, drawn in blue.
    """
    poses = np.asarray(image_to_reference, dtype=np.float64)
    chosen = np.unique(np.linspace(0, len(poses) - 1, min(len(poses), MOST_OUTLINES)).round().astype(int))
    columns, rows = frame_size
    corners = np.array([(0, 0, 0, 1), (columns - 1, 0, 0, 1), (columns - 1, rows - 1, 0, 1), (0, rows - 1, 0, 1)], dtype=np.float64)
    outlines = np.einsum("nij,kj->nki", poses[chosen, :3], corners)
    area = np.empty((0, 3)) if region is None else _placed(extreme_pixels(region.mask(columns, rows)), poses[chosen[0]])
    low, high = outlines.min(axis=(0, 1)), outlines.max(axis=(0, 1))
    extent = max(float((high - low).max()), 1e-6)
    scale = PANEL / extent
    drawn: list[Stroke | Words] = [Words(MARGIN, 20, title, size=14)]
    for number, axes in enumerate(VIEWS):
        corner = np.array([MARGIN + number * (PANEL + 2 * MARGIN), MARGIN])
        middle = (low + high)[list(axes)] / 2

        def on_page(points: Floats, corner: Floats = corner, axes: tuple[int, int] = axes, middle: Floats = middle) -> Floats:
            placed: Floats = corner + PANEL / 2 + (points[..., list(axes)] - middle) * scale
            return placed

        drawn += _panel(on_page(outlines), corner, axes, scale, reference)
        if len(area):
            drawn.append(Stroke(on_page(area), _SHOWN_COLOR, closed=True, tinted=True))
    return Drawing.of(len(VIEWS) * (PANEL + 2 * MARGIN), PANEL + 2 * MARGIN + 24, drawn)


def _axis(ends: Floats, name: str, color: str) -> Iterator[Stroke | Words]:
    """A line from one end to the other, which has a dot and a name."""
    yield Stroke(ends, color, width=2.0, dotted=True)
    yield Words(float(ends[1, 0]) + 5, float(ends[1, 1]) - 4, name, color)


def _placed(pixels: Floats, image_to_reference: Matrix) -> Floats:
    """The outline of an area, (n, 3) mm, from the first and the last pixel of each of its rows."""
    half = len(pixels) // 2
    around = np.concatenate([pixels[:half], pixels[half:][::-1]])
    placed: Floats = around @ image_to_reference[:3, :2].T + image_to_reference[:3, 3]
    return placed


def _panel(outlines: Floats, corner: Floats, axes: tuple[int, int], scale: float, reference: str) -> Iterator[Stroke | Words]:
    """One view of the outlines, (frames, 4, 2) on the page."""
    across, down = (_AXES[axis] for axis in axes)
    yield Stroke(corner + PANEL * np.array([(0, 0), (1, 0), (1, 1), (0, 1)]), "#bbbbbb", closed=True)
    for number, outline in enumerate(outlines):
        level = round(190 - 170 * number / max(len(outlines) - 1, 1))
        yield Stroke(outline, f"#{level:02x}{level:02x}{level:02x}", closed=True)
    yield from _axis(outlines[0, [0, 1]], "columns", _COLUMN_COLOR)
    yield from _axis(outlines[0, [0, 3]], "rows", _ROW_COLOR)
    length = 10.0 ** np.floor(np.log10(PANEL / 2 / scale))
    left, y = float(corner[0]), float(corner[1]) + PANEL + 20
    yield Stroke(np.array([(left, y), (left + length * scale, y)]), "#000000", width=2.0)
    yield Words(left + length * scale + 8, y + 4, f"{length:g} mm; {reference}: +{across} right, +{down} down")
