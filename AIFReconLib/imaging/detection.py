"""Recognizing the probe from its images: ultrasound stands on a black surround as a rectangle (linear) or a sector.

Used where neither options nor a configuration say what the image shows. It refuses rather than guesses.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Integers, Mask, Numbers
from ..errors import BeamGeometryError
from ..remedies import Remedy
from .beams import LINEAR, SECTOR, ProbeGeometry
from .images import ImageStack
from .masks import closed, largest_area, opened
from .region import ClipRectangle, Fan, ImageRegion

FRAMES_LOOKED_AT = 24
LIT = 0.01
"""A pixel is lit when it exceeds this part of the brightest pixel in any of the frames looked at."""

CLOSED_PX, OPENED_PX = 4, 2
"""Steps by which gaps between lit pixels are closed, and thin lines dropped."""

VERTICAL_SLOPE = 0.03
"""Sides that lean less than this (columns per row) are those of a linear probe."""

LINE_TOLERANCE_PX = 2.0
"""How far a side may be from its straight line."""

EDGE_PARTS, FEWEST_PARTS = 16, 5
"""Parts of an upper or lower edge, whose median rows are looked at."""

SMALLEST_BEND_PX, SMOOTH_PX, SMOOTH_UPPER, SMOOTH_LOWER = 1.2, 0.4, 0.5, 0.06
"""How far the middle of an edge must be from its ends to be bent, and how near, in pixels or as a part of that, the edge to its arc."""

DIRECTIONS = 64
"""Directions in which the outer radius of a sector is looked for."""

BORDER_PX = 4
"""An area that ends closer to the image's border than this has no side there that can be seen."""


Sides = tuple[tuple[float, float], tuple[float, float]]
"""Left and right side of a lit area, each as (column at row 0, columns per row)."""


@dataclass(frozen=True)
class DetectedImaging:
    """What was recognized: probe, the pixels that are ultrasound, and the finding in words."""

    probe: ProbeGeometry
    region: ImageRegion
    description: str


def detect_imaging(images: ImageStack, spacing: tuple[float, float] = (1.0, 1.0)) -> DetectedImaging:
    """Recognize a linear or sector image by its black surround.

    `images` are (frames, rows, columns), `spacing` is (x, y) in mm: a sector is round in mm.

    Raises BeamGeometryError when the outline is neither a rectangle nor a sector.
    """
    lit = _lit_area(images)
    rows = np.flatnonzero(lit.any(axis=1))
    columns = np.flatnonzero(lit.any(axis=0))
    box = lit[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    sides = _straight_sides(box)
    upright = sides is not None and max(abs(sides[0][1]), abs(sides[1][1])) < VERTICAL_SLOPE
    if box.mean() > 0.97 or upright:
        return _rectangle(lit, box, sides if upright else None, (int(columns[0]), int(rows[0])))
    if sides is None:
        raise _unrecognized("its outline is neither a rectangle nor a sector")
    return _sector(lit, sides, (int(columns[0]), int(rows[0])), spacing)


def _lit_area(images: ImageStack) -> Mask:
    """The largest connected area that is lit in any of the frames looked at, without its holes, (rows, columns) bool."""
    if len(images) == 0:
        raise _unrecognized("there are none")
    numbers = np.unique(np.linspace(0, len(images) - 1, FRAMES_LOOKED_AT).astype(int))
    brightest = np.array(_without_gaps(images[int(numbers[0])]))
    for number in numbers[1:]:
        np.maximum(brightest, _without_gaps(images[int(number)]), out=brightest)
    if not brightest.size or brightest.max() <= 0:
        raise _unrecognized("all images are black")
    # An opening drops rulers, text and borders that touch the sector by a thin line
    lit = opened(closed(brightest > LIT * brightest.max(), CLOSED_PX), OPENED_PX)
    if not lit.any():
        raise _unrecognized("no connected bright area was found")
    return largest_area(lit)


def _without_gaps(image: Numbers) -> Numbers:
    """An image in which what is no finite number is black; the same one where all are finite, as whole numbers are."""
    return image if image.dtype.kind in "bui" else np.nan_to_num(image.astype(np.float32), posinf=0.0, neginf=0.0)


def _straight_sides(box: Mask) -> Sides | None:
    """Left and right side of a lit box as (column at row 0, columns per row); None where they are not straight."""
    height, width = box.shape
    left = box.argmax(axis=1)
    right = width - 1 - box[:, ::-1].argmax(axis=1)
    row = np.arange(height)
    sides = []
    for edge, outermost in ((left, left.min()), (right, right.max())):
        # Below its widest row a sector is bounded by its arc, not by its side
        widest = int(np.flatnonzero(np.abs(edge - outermost) <= 1)[0])
        last = height if widest < 0.2 * height else widest + 1
        line = _robust_line(row[:last], edge[:last])
        if line is None:
            return None
        sides.append(line)
    return sides[0], sides[1]


def _robust_line(columns: Integers, rows: Integers) -> tuple[float, float] | None:
    """Offset and slope of the line that most points are on; None when fewer than 3 in 4 are."""
    if columns.size < 10:
        return None
    x, y = columns.astype(np.float64), rows.astype(np.float64)
    step = max(x.size // 3, 1)
    slope = float(np.median((y[step:] - y[:-step]) / (x[step:] - x[:-step])))
    offset = float(np.median(y - slope * x))
    before: Mask | None = None
    for _ in range(5):
        near = np.abs(y - offset - slope * x) <= LINE_TOLERANCE_PX
        if near.sum() < 10:
            return None
        if before is not None and np.array_equal(near, before):
            break
        before = near
        slope, offset = (float(v) for v in np.polyfit(x[near], y[near], 1))
    near = np.abs(y - offset - slope * x) <= LINE_TOLERANCE_PX
    return (offset, slope) if near.mean() >= 0.75 else None


def _rectangle(lit: Mask, box: Mask, sides: Sides | None, corner: tuple[int, int]) -> DetectedImaging:
    height, width = box.shape
    left, right = 0, width - 1
    if sides is not None:
        # The sides rather than the box: text that touches the image widens the box
        ends = [[offset + slope * row for row in (0, height - 1)] for offset, slope in sides]
        left, right = max(round(min(ends[0])), left), min(round(max(ends[1])), right)
    within = box[:, left : right + 1]
    if right <= left or within.mean() < 0.7 or within.sum() < 0.9 * box.sum():
        raise _unrecognized("its outline is neither a rectangle nor a sector")
    if _is_bent(within.argmax(axis=0)) or _is_bent(-within[::-1].argmax(axis=0), lower=True):
        raise _unrecognized("its sides are upright and its upper or lower edge is bent, as of a sector whose sides were cut off")
    left, right, top, bottom = left + corner[0], right + corner[0], corner[1], corner[1] + height - 1
    if left < BORDER_PX and right >= lit.shape[1] - BORDER_PX:
        raise _unrecognized("they are lit from side to side, with no black surround that would show an outline")
    clip = ClipRectangle((float(left), float(top)), (float(right - left), float(bottom - top)))
    words = f"a linear probe, columns {left} to {right}, rows {top} to {bottom}"
    return DetectedImaging(ProbeGeometry(LINEAR), ImageRegion(clip), words)


def _is_bent(edge: Integers, lower: bool = False) -> bool:
    """Whether the rows of an upper or lower edge, one a column, follow an arc or an angle, over their whole width or its middle half.

    The upper edge of a linear image is the skin, straight. A lower one may be ragged where the image fades, and shadows pull its middle up;
    so it is bent only where its middle lies lower, as that of an arc, and along a smooth line.
    """
    smooth = SMOOTH_LOWER if lower else SMOOTH_UPPER
    for columns in (edge, edge[edge.size // 4 : edge.size - edge.size // 4]):
        parts = np.array_split(columns, min(columns.size // 4 + 1, EDGE_PARTS))
        if len(parts) <= FEWEST_PARTS:
            return False
        rows = np.array([np.median(part) for part in parts])
        x = np.linspace(-1.0, 1.0, len(parts))
        parabola = np.polyfit(x, rows, 2)
        rest = np.sqrt(np.mean((rows - np.polyval(parabola, x)) ** 2))
        depth = -parabola[0] if lower else abs(parabola[0])
        if depth > SMALLEST_BEND_PX and rest < max(SMOOTH_PX, smooth * depth):
            return True
    return False


def _sector(lit: Mask, sides: Sides, corner: tuple[int, int], spacing: tuple[float, float]) -> DetectedImaging:
    (left_offset, left_slope), (right_offset, right_slope) = sides
    # The outermost lit pixels lie inside the side, by half a pixel on average
    left_offset, right_offset = left_offset - 0.5, right_offset + 0.5
    if left_slope >= -VERTICAL_SLOPE or right_slope <= VERTICAL_SLOPE:
        raise _unrecognized("its sides do not spread downward")
    row = (left_offset - right_offset) / (right_slope - left_slope)
    apex = (left_offset + left_slope * row + corner[0], row + corner[1])
    aspect = spacing[0] / spacing[1]
    angles = (math.degrees(math.atan(left_slope * aspect)), math.degrees(math.atan(right_slope * aspect)))
    y, x = np.nonzero(lit)
    radius = np.hypot((x - apex[0]) * spacing[0], (y - apex[1]) * spacing[1])
    angle = np.degrees(np.arctan2((x - apex[0]) * spacing[0], (y - apex[1]) * spacing[1]))
    middle = radius[np.abs(angle - np.mean(angles)) < 0.25 * (angles[1] - angles[0])]
    if not middle.size:
        raise _unrecognized("its sides do not enclose it")
    first, last = float(middle.min()), _outer_radius(radius, (angle - angles[0]) / (angles[1] - angles[0]))
    fan = Fan(apex, angles, (max(first - 0.5 * spacing[1], 0.0), last), spacing)
    inside = fan.mask(lit.shape[1], lit.shape[0])
    if (lit & inside).sum() < 0.95 * lit.sum() or (lit & inside).sum() < 0.7 * inside.sum():
        raise _unrecognized("its outline is not that of a sector")
    words = f"a sector probe, apex at column {apex[0]:.1f}, row {apex[1]:.1f}, {angles[0]:.1f} to {angles[1]:.1f} degrees"
    return DetectedImaging(ProbeGeometry(SECTOR, apex), ImageRegion(fan=fan), words)


def _outer_radius(radius: Floats, across: Floats) -> float:
    """The radius that a sector reaches in some directions at least; `across` of each pixel is 0 at its left side, 1 at its right."""
    farthest = np.zeros(DIRECTIONS)
    within = (across >= 0) & (across < 1)
    np.maximum.at(farthest, (across[within] * DIRECTIONS).astype(int), radius[within])
    # Not quite the largest: a ruler that touches the sector sticks out in one direction or two
    return float(np.sort(farthest)[-4])


def _unrecognized(why: str) -> BeamGeometryError:
    return BeamGeometryError(f"The probe cannot be told from the images: {why}.", Remedy.NAME_THE_PROBE)
