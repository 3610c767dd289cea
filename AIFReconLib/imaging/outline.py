"""The outline of an area of an image, and the sector that it is the lit part of, where only parts of that can be seen.

A side may be dark, covered, or cut by the border. Beams start at the apex, so sides lie on rays through it and the near and the far end on
arcs about it: any two of these tell it. What cannot be told to a part of a millimeter is refused.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Integers, Mask, Reals
from .region import Fan

BORDER_PX = 4
"""Outlines that end closer to the image's border than this are cut off there."""

TOLERANCES_PX = (4.0, 2.5, 1.5, 1.5, 1.5, 1.5)
"""How far a point of an outline may be from the fit, in each round."""

STEEPEST_DEG, UPRIGHT_DEG = 75.0, 1.7
"""Sides that lean more, or less, are none of a sector."""

SHORTEST_SIDE, SHORTEST_ARC = 0.2, 0.2
"""Parts of a side's height and of an arc's width that must be seen for it to count."""

MOST_OUTSIDE = 0.02
"""Part of the area that may lie outside what was fitted."""

LARGEST_APEX_ERROR, LARGEST_ONE_SIDED = 1.0, 0.7
"""mm. Estimated error of the apex, on the large side, beyond which a fit is refused, and one of which only one side is seen."""

CRISP_PX2, RAGGED_LENGTH = 0.1, 8.0
"""Mean squared distance of a crisp outline from its side, due to whole pixels; length over which points of a ragged one err alike."""


@dataclass(frozen=True)
class SectorFit:
    """A sector, in pixels of the image but for the angles, which are true."""

    apex_px: tuple[float, float]  #: (column, row)
    angles_deg: tuple[float, float]
    radii: tuple[float, float]  #: In mm
    flat_top: float | None  #: The row of the face, where that is straight
    dark_side: str | None  #: "left" or "right", where that was not seen and is taken to be as wide as the other
    far_end_seen: bool  #: Or cut off by the image's border
    apex_error: float  #: mm, estimated


@dataclass(frozen=True)
class Outline:
    """The ends of an area in each row and column, (n, 2) float64 (x, y) in steps of rows: what is square in mm is square here."""

    left: Floats
    right: Floats
    top: Floats
    bottom: Floats

    def __len__(self) -> int:
        return sum(len(each) for each in (self.left, self.right, self.top, self.bottom))


def outline_of(area: Mask, aspect: float) -> Outline:
    """The outline of an area without what the image's border cuts off; `aspect` is the pixels' width over their height."""
    rows, columns = area.shape
    row, column = np.flatnonzero(area.any(axis=1)), np.flatnonzero(area.any(axis=0))
    left, right = area[row].argmax(axis=1), columns - 1 - area[row, ::-1].argmax(axis=1)
    top, bottom = area[:, column].argmax(axis=0), rows - 1 - area[::-1, column].argmax(axis=0)

    def points(x: Reals | Integers, y: Reals | Integers, kept: Mask) -> Floats:
        return np.stack([x * aspect, y.astype(np.float64)], axis=1)[kept]

    # The outermost pixels lie inside, by half a pixel on the average
    return Outline(
        points(left - 0.5, row, left >= BORDER_PX),
        points(right + 0.5, row, right < columns - BORDER_PX),
        points(column, top - 0.5, top >= BORDER_PX),
        points(column, bottom + 0.5, bottom < rows - BORDER_PX),
    )


def straightest(points: Floats, sign: int) -> tuple[float, float, int] | None:
    """The line x = offset + slope y on which most points are: its offset, slope and their number; `sign` is -1 for a left side."""
    if len(points) < 20:
        return None
    angles = np.radians(np.arange(-4.0, STEEPEST_DEG, 0.25)) * sign
    across = points[:, 0, None] * np.cos(angles) - points[:, 1, None] * np.sin(angles)
    low = np.floor(across.min(axis=0))
    bins = ((across - low) / 1.5).astype(int)
    width = int(bins.max()) + 2
    counts = np.bincount((bins + width * np.arange(len(angles))).reshape(-1), minlength=width * len(angles)).reshape(-1, width)
    counts[:, :-1] += counts[:, 1:]
    best, place = np.unravel_index(int(counts.argmax()), counts.shape)
    near = np.abs(across[:, best] - low[best] - 1.5 * (place + 1)) <= 3.0
    slope, offset = (float(v) for v in np.polyfit(points[near, 1], points[near, 0], 1))
    for _ in range(3):
        near = np.abs(points[:, 0] - offset - slope * points[:, 1]) <= 1.5 * math.hypot(1, slope)
        if near.sum() < 20:
            return None
        slope, offset = (float(v) for v in np.polyfit(points[near, 1], points[near, 0], 1))
    return offset, slope, int(near.sum())


def fit_sector(area: Mask, spacing: tuple[float, float]) -> SectorFit | None:
    """The sector that an area (rows, columns) is part of; None where that cannot be told. `spacing` is (x, y) in mm."""
    aspect = spacing[0] / spacing[1]
    outline = outline_of(area, aspect)
    if len(outline) < 100:
        return None
    fits = (_refined(outline, start, area, spacing) for start in _starts(outline))
    return next((fit for fit in fits if fit is not None), None)


def has_ragged_narrow_side(area: Mask, fan: Fan) -> bool:
    """Whether the side of a sector that leans less is the edge of a shadow: the outline of an area is much more ragged there."""
    aspect = fan.pixel_size[0] / fan.pixel_size[1]
    outline, apex = outline_of(area, aspect), np.array([fan.apex_px[0] * aspect, fan.apex_px[1]])
    return _is_ragged(outline, apex, [math.radians(angle) for angle in fan.angles_deg])


def _is_ragged(outline: Outline, apex: Floats, angles: list[float]) -> bool:
    narrow = int(angles[0] + angles[1] < 0)
    spreads = [_spread(_distances((outline.left, outline.right)[side], apex, angles, [], side)) for side in (narrow, 1 - narrow)]
    return spreads[0] >= MORE_RAGGED * spreads[1]


def _starts(outline: Outline) -> Iterator[tuple[float, float]]:
    """Where the apex may be: where two straight sides meet, or where arcs about a point of one side fit best."""
    steep = math.tan(math.radians(UPRIGHT_DEG))
    lines = [straightest(outline.left, -1), straightest(outline.right, 1)]
    if lines[0] is not None and lines[1] is not None and lines[1][1] - lines[0][1] > 2 * steep:
        y = (lines[0][0] - lines[1][0]) / (lines[1][1] - lines[0][1])
        yield lines[0][0] + lines[0][1] * y, y
    for line, sign in zip(lines, (-1, 1), strict=True):
        if line is None or sign * line[1] < steep:
            continue
        offset, slope, _ = line
        top = float(min(outline.left[:, 1].min(initial=np.inf), outline.right[:, 1].min(initial=np.inf)))
        rows = top + 10 - np.geomspace(1, 4000, 120)
        apexes = np.stack([offset + slope * rows, rows], axis=1)[:, None]
        seen = [_most_together(np.linalg.norm(points - apexes, axis=-1), 3.0) for points in (outline.top, outline.bottom)]
        best = int(np.argmax(np.add(*seen)))
        yield offset + slope * float(rows[best]), float(rows[best])


def _most_together(values: Floats, width: float) -> Floats:
    """How many of each row's values (rows, n) lie within `width` of each other, at most."""
    ordered = np.sort(values, axis=-1)
    upto = (np.searchsorted(row, row + width, "right") for row in ordered)
    return np.array([(last - np.arange(last.size)).max(initial=0) for last in upto], dtype=np.float64)


def most_at(radii: Floats, tolerance: float) -> tuple[float, int]:
    """The radius, or row, or column, near which most points are, and how many."""
    if not len(radii):
        return 0.0, 0
    ordered = np.sort(radii)
    counts = np.searchsorted(ordered, ordered + 2 * tolerance, "right") - np.arange(len(ordered))
    first = int(counts.argmax())
    return float(np.median(ordered[first : first + counts[first]])), int(counts[first])


def _refined(
    outline: Outline, start: tuple[float, float], area: Mask, spacing: tuple[float, float], dark: int | None = None
) -> SectorFit | None:
    """The sector about an apex near `start` that fits best; None where it does not fit, or is not sure enough."""
    apex = np.array(start)
    sides, arcs = (outline.left, outline.right), (outline.top, outline.bottom)
    angles: list[float] = []
    error = np.inf
    for tolerance in TOLERANCES_PX:
        equations, counted, angles, radii = [], [], [], []
        for points in sides:
            x, y = (points - apex).T
            angle, radius = np.arctan2(x, y), np.hypot(x, y)
            middle = _crowded(angle, radius, tolerance)
            near = np.abs(radius * (angle - middle)) <= tolerance
            angles.append(middle)
            counted.append(points[near])
            # d(distance from the ray) by apex x, apex y, and the ray's angle
            by_x, by_y = np.full(near.sum(), -math.cos(middle)), np.full(near.sum(), math.sin(middle))
            equations.append((by_x, by_y, -radius[near], radius[near] * (angle[near] - middle)))
        for points in arcs:
            x, y = (points - apex).T
            radius = np.hypot(x, y)
            middle = most_at(radius, tolerance)[0]
            near = np.abs(radius - middle) <= tolerance
            radii.append(middle)
            counted.append(points[near])
            equations.append((-x[near] / radius[near], -y[near] / radius[near], np.full(near.sum(), -1.0), radius[near] - middle))
        used = _enough(outline, counted, angles, radii, apex)
        if dark is not None:
            used[dark] = False
        flat = _flat_top(outline.top, counted[2])
        if flat is not None:
            used[2] = False
        if sum(used) < 2 or not (used[0] or used[1]):
            return None
        chosen = [number for number in range(4) if used[number]]
        matrix = np.zeros((sum(len(equations[n][3]) for n in chosen), 2 + len(chosen)))
        at = 0
        for own, number in enumerate(chosen):
            by_x, by_y, by_own, _ = equations[number]
            rows = slice(at, at + len(by_x))
            matrix[rows, 0], matrix[rows, 1], matrix[rows, 2 + own] = by_x, by_y, by_own
            at += len(by_x)
        rest = np.concatenate([equations[n][3] for n in chosen])
        scale = np.maximum(np.linalg.norm(matrix, axis=0), 1e-9)
        step = np.linalg.lstsq(matrix / scale, -rest, rcond=None)[0] / scale
        if not np.isfinite(step).all() or np.hypot(*step[:2]) > 400:
            return None
        apex = apex + step[:2]
        covariance = np.linalg.pinv((matrix / scale).T @ (matrix / scale)) / np.outer(scale, scale)
        error = math.sqrt(covariance[0, 0] + covariance[1, 1])
        for own, number in enumerate(chosen):
            if number < 2:
                angles[number] += step[2 + own]
            else:
                radii[number - 2] += step[2 + own]
    return _checked(outline, area, spacing, apex, angles, radii, used, flat, error)


def _crowded(angle: Floats, radius: Floats, tolerance: float) -> float:
    """The direction near which most points of a side are."""
    if not len(angle):
        return 0.0
    width = 2 * tolerance / max(float(np.median(radius)), 1.0)
    ordered = np.sort(angle)
    counts = np.searchsorted(ordered, ordered + width, "right") - np.arange(len(ordered))
    first = int(counts.argmax())
    return float(np.median(ordered[first : first + counts[first]]))


def _enough(outline: Outline, counted: list[Floats], angles: list[float], radii: list[float], apex: Floats) -> list[bool]:
    """Which of left side, right side, near end and far end are seen along enough of their length to count."""
    width, height = np.ptp(np.concatenate([outline.left, outline.right, outline.top, outline.bottom]), axis=0)
    upright = math.radians(UPRIGHT_DEG)
    used = [
        len(points) >= max(SHORTEST_SIDE * height, 20) and sign * angle > upright
        for points, angle, sign in zip(counted, angles, (-1, 1), strict=False)
    ]
    for points, radius, all_points, sign in zip(counted[2:], radii, (outline.top, outline.bottom), (-1, 1), strict=True):
        beyond = sign * (np.hypot(*(all_points - apex).T) - radius) > 4.0
        # The near end is as much shorter than the far one as it is nearer
        longest = width * (radii[0] / max(radii[1], 1.0) if sign < 0 else 1.0)
        used.append(len(points) >= max(SHORTEST_ARC * longest, 20) and beyond.sum() <= 0.1 * len(beyond))
    return used


def _flat_top(top: Floats, on_arc: Floats) -> float | None:
    """The row of a straight face; None where an arc suits the upper outline better."""
    row, count = most_at(top[:, 1], 1.5)
    return row if count > 1.1 * len(on_arc) and count > 0.3 * len(top) else None


def _checked(
    outline: Outline,
    area: Mask,
    spacing: tuple[float, float],
    apex: Floats,
    angles: list[float],
    radii: list[float],
    used: list[bool],
    flat: float | None,
    error: float,
) -> SectorFit | None:
    """The fit if it explains the area and is sure enough."""
    # One pixel in four is enough
    rows, columns = 2 * np.array(np.nonzero(area[::2, ::2]))
    x, y = columns * (spacing[0] / spacing[1]) - apex[0], rows - apex[1]
    angle, radius = np.arctan2(x, y), np.hypot(x, y)
    margin = np.maximum(2.0 / np.maximum(radius, 1.0), math.radians(0.3))
    seen = []
    for side, sign in enumerate((-1, 1)):
        beyond = sign * (angle - angles[side]) > margin
        seen.append(used[side] and beyond.mean() < SPECKS)
    if not any(seen) or y.min() < -2:
        return None
    dark = None
    if all(seen) and abs(angles[0] + angles[1]) > math.radians(MOST_LOPSIDED_DEG):
        # The edge of a shadow, which is ragged, or a sector that was steered
        if not _is_ragged(outline, apex, angles):
            return None
        seen[int(angles[0] + angles[1] < 0)] = False
    if not all(seen):
        if used[seen.index(False)]:
            # Its straight edge is that of a shadow, which only about follows a beam
            return _refined(outline, (float(apex[0]), float(apex[1])), area, spacing, seen.index(False))
        dark = "left" if seen[1] else "right"
        angles[seen.index(False)] = -angles[seen.index(True)]
    first = radii[0] if used[2] else max(flat - apex[1], 0.0) if flat is not None else float(np.quantile(radius, 0.001))
    last = radii[1] if used[3] else _last_filled(radius, angle, angles)
    inside = (angle > angles[0] - margin) & (angle < angles[1] + margin) & (radius > first - 2.0) & (radius < last + 2.0)
    parts = (outline.left, outline.right, outline.top, outline.bottom)
    off = np.concatenate([_distances(each, apex, angles, radii, number) for number, each in enumerate(parts) if used[number]])
    spread = _spread(off)
    error *= spacing[1] * math.sqrt(3 * CRISP_PX2 + RAGGED_LENGTH * (spread - CRISP_PX2))
    if 1 - inside.mean() > MOST_OUTSIDE or error > (LARGEST_APEX_ERROR if dark is None else LARGEST_ONE_SIDED):
        return None
    return SectorFit(
        (float(apex[0] * spacing[1] / spacing[0]), float(apex[1])),
        (math.degrees(angles[0]), math.degrees(angles[1])),
        (first * spacing[1], last * spacing[1]),
        flat,
        dark,
        bool(used[3] or len(outline.bottom) < 0.2 * np.count_nonzero(area.any(axis=0))),
        error,
    )


def _last_filled(radius: Floats, angle: Floats, angles: list[float]) -> float:
    """The radius up to which the arcs about the apex are lit along a good part; of an area's pixels, one in four."""
    within = (angle > angles[0]) & (angle < angles[1])
    counts = np.bincount(radius[within].astype(int)) / (0.25 * (angles[1] - angles[0]))
    filled = counts > LEAST_FILLED * np.maximum(np.arange(counts.size), 1)
    return float(np.flatnonzero(filled)[-1]) if filled.any() else 0.0


LEAST_FILLED = 0.3
"""Part of an arc about the apex."""


def _distances(points: Floats, apex: Floats, angles: list[float], radii: list[float], part: int) -> Floats:
    """How far points lie from a ray (parts 0 and 1) or an arc (2 and 3)."""
    x, y = (points - apex).T
    radius = np.hypot(x, y)
    off: Floats = radius * np.abs(np.arctan2(x, y) - angles[part]) if part < 2 else np.abs(radius - radii[part - 2])
    return off


def _spread(off: Floats) -> float:
    """Mean squared distance of what belongs to a side or an end, px^2."""
    near = off[off <= RAGGED_PX]
    return max(float(np.mean(near**2)), CRISP_PX2) if near.size else np.inf


RAGGED_PX = 6.0
"""Points of the outline nearer than this belong to a side or an end, and are off it if they do not lie on it."""

MOST_LOPSIDED_DEG, MORE_RAGGED = 1.5, 3.0
"""Degrees by which one side may lean more than the other, and how many times as ragged the edge of a shadow is then."""

SPECKS = 0.003
"""Part of the area that may lie beyond a side that is seen."""
