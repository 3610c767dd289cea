"""The upright rectangle that an area of an image is the lit part of, and what tells it from a sector whose sides were covered."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Integers, Mask
from .outline import (
    BORDER_PX,
    CUT_OFF,
    FAR,
    FEWEST_RINGING,
    LEFT,
    MOST_OUTSIDE,
    NEAR,
    RIGHT,
    STEP_PX,
    UPRIGHT_DEG,
    most_at,
    outline_of,
    ringing_shows,
    straightest,
)

Box = tuple[int, int, int, int]
"""First and last column, first and last row."""

TALLEST_TRACE = 0.1
"""Part of an image's height up to which a band from border to border is no ultrasound."""

EDGE_PARTS, FEWEST_PARTS = 16, 5
"""Parts of an upper or lower edge, whose median rows are looked at."""

SMALLEST_BEND_PX, SMOOTH_PX = 1.2, 0.4
"""How far the middle of an edge must be from its ends to be bent, and how near the edge to its arc, or that as a part of its depth:"""

SMOOTH_ON_BLACK, SMOOTH_NEAR, SMOOTH_LOWER = 0.5, 0.1, 0.08
"""An upper edge on black, one of what changes, which may be ragged where the near field is dark, and a lower edge."""

SMALLEST, SMALLEST_ON_BLACK = 40, 10
"""Rows and columns of a rectangle at least."""

FEWEST_ROWS, CRISP, LEVEL = 5, 0.5, 0.8
"""Rows that a column of a rectangle has at least; part of a side that must lie on one line; part of an end that is surely no arc."""


def is_bent(edge: Integers, smooth: float, only_down: bool = True) -> bool:
    """Whether the rows of an upper or lower edge, one a column, follow an arc or an angle, over their whole width or its middle half.

    The upper edge of a linear image is the skin, straight. A lower one may be ragged where the image fades, and shadows pull its middle up;
    so it is bent `only_down`, where its middle lies lower, as that of an arc, and along a smooth line.
    """
    for columns in (edge, edge[edge.size // 4 : edge.size - edge.size // 4]):
        parts = np.array_split(columns, min(columns.size // 4 + 1, EDGE_PARTS))
        if len(parts) <= FEWEST_PARTS:
            return False
        rows = np.array([np.median(part) for part in parts])
        x = np.linspace(-1.0, 1.0, len(parts))
        parabola = np.polyfit(x, rows, 2)
        rest = np.sqrt(np.mean((rows - np.polyval(parabola, x)) ** 2))
        depth = -parabola[0] if only_down else abs(parabola[0])
        if depth > SMALLEST_BEND_PX and rest < max(SMOOTH_PX, smooth * depth):
            return True
    return False


def fit_rectangle(area: Mask, has_level_face: bool = False, on_black: bool = False) -> Box | None:
    """First and last column, first and last row of the upright rectangle that an area is part of; None where that cannot be told.

    Two sides that are straight along most of their length and stand upright tell it, or one and a level end.
    That it `has_level_face` may be asked for: of what lies apart, such a face belongs to it. What stands `on_black` may be small, or cut
    off by two borders, but both of its sides must be seen.
    """
    outline = outline_of(area, 1.0)
    rows, columns = np.flatnonzero(area.any(axis=1)), np.flatnonzero(area.sum(axis=0) >= FEWEST_ROWS)
    if not columns.size or min(rows.size, columns.size) < (SMALLEST_ON_BLACK if on_black else SMALLEST):
        return None
    bounds, parts = [float(columns[0]), float(columns[-1]), float(rows[0]), float(rows[-1])], []
    for number, (points, axis, all_) in enumerate(zip(outline, (0, 0, 1, 1), (rows, rows, columns, columns), strict=True)):
        place, count = most_at(points[:, axis], 1.5)
        parts.append(count / all_.size)
        # On black all that is lit belongs to it, however ragged its ends are
        if parts[-1] >= CRISP and not (on_black and number >= NEAR):
            bounds[number] = place + (0.5 if number % 2 == 0 else -0.5)
    lines = [straightest(outline[LEFT], -1), straightest(outline[RIGHT], 1)]
    lean = [None if line is None or line[2] < CRISP * rows.size else abs(math.degrees(math.atan(line[1]))) for line in lines]
    # Of a dark side only what rings along a level face is seen, without a gap
    level = parts[NEAR] * columns.size >= LEVEL * np.ptp(columns)
    if has_level_face and not level:
        return None
    for side, points in enumerate(outline[:NEAR]):
        inward = np.abs(points[:, 0] - columns[-side]) - 0.5
        rings = level and parts[side] < LEVEL and ringing_shows(inward[: 2 * FEWEST_RINGING], 1.5) and ringing_shows(inward, 1.5)
        if rings and not (parts[side] >= CRISP and abs(bounds[side] - columns[-side]) < STEP_PX):
            parts[side], bounds[side], lean[side] = 1.0, float(columns[-side]), None
    crisp = [part >= CRISP for part in parts]
    upright = [seen and degrees is not None and degrees < UPRIGHT_DEG / 2 for seen, degrees in zip(crisp, lean, strict=False)]
    if sum(crisp) < 2 or not any(upright) or any(degrees is not None and degrees > UPRIGHT_DEG for degrees in lean):
        return None
    left, right, top, bottom = (round(bound) for bound in bounds)
    within = area[max(top, 0) : bottom + 1, max(left, 0) : right + 1]
    cut_off = left < BORDER_PX, right >= area.shape[1] - BORDER_PX, top < BORDER_PX
    # What two borders cut off may be a picture of anything; on black no side is dark
    told = all(side or beyond for side, beyond in zip(upright, cut_off, strict=False)) if on_black else sum(cut_off) <= 1
    if within.sum() < (1 - MOST_OUTSIDE) * area.sum() or not told:
        return None
    return left, right, top, bottom


def has_bent_ends(area: Mask, box: Box, smooth_near: float = SMOOTH_NEAR, only_down: bool = True) -> bool:
    """Whether the near or the far end of an area in a rectangle is an arc, as of a sector whose sides were covered."""
    left, right, top, bottom = (max(bound, 0) for bound in box)
    shown = area[top : bottom + 1, left : right + 1]
    shown = shown[:, shown.any(axis=0)]
    return is_bent(shown.argmax(axis=0), smooth_near, only_down) or is_bent(-shown[::-1].argmax(axis=0), SMOOTH_LOWER)


def is_cut_off(area: Mask) -> bool:
    """Whether the image's border cuts an area off below."""
    return bool(len(outline_of(area, 1.0)[FAR]) < CUT_OFF * np.count_nonzero(area.any(axis=0)))


def has_level_end(area: Mask) -> bool:
    """Whether an area ends downward along one row nearly everywhere, as no arc does; upward, where the image's border cuts it off."""
    outline = outline_of(area, 1.0)
    end = outline[NEAR] if is_cut_off(area) else outline[FAR]
    return bool(most_at(end[:, 1], 1.5)[1] >= LEVEL * np.count_nonzero(area.any(axis=0)))


def overlap(one: Box, other: Box) -> float:
    """The part of two rectangles that both have."""
    left, right, top, bottom = (pick(bounds) for pick, bounds in zip((max, min, max, min), zip(one, other, strict=True), strict=True))
    both = max(right - left, 0) * max(bottom - top, 0)
    sizes = sum((box[1] - box[0]) * (box[3] - box[2]) for box in (one, other))
    return both / (sizes - both)


def without_trace(area: Mask) -> Mask:
    """An area without a narrow band below that runs from border to border, as a trace of the heart's beat."""
    last = int(np.flatnonzero(area.any(axis=1))[-1])
    across = area[last::-1, :BORDER_PX].any(axis=1) & area[last::-1, -BORDER_PX:].any(axis=1)
    height = int(across.argmin())
    return area if height > TALLEST_TRACE * len(area) else np.where(np.arange(len(area))[:, None] > last - height, False, area)
