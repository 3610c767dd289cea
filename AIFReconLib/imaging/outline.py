"""The outline of an area of an image, and the sector that it is the lit part of, where only parts of that can be seen.

A side may be dark, covered, or cut by the border. Beams start at the apex, so sides lie on rays through it and the near and the far end on
arcs about it: any two of these tell it. One side leans as much as the other. What cannot be told to a part of a millimeter is refused.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import scipy

from ..arrays import Floats, Integers, Mask, Reals
from .region import Fan

BORDER_PX = 4
"""Outlines that end closer to the image's border than this are cut off there."""

TOLERANCES_PX = (4.0, 2.5, 1.5, 1.0, 0.75, 0.75)
"""How far a point of an outline may be from the fit, in each round."""

STEEPEST_DEG, UPRIGHT_DEG = 75.0, 1.7
"""Sides that lean more, or less, are none of a sector."""

SHORTEST_SIDE, SHORTEST_ARC = 0.2, 0.2
"""Parts of a side's height and of an arc's width that must be seen for it to count."""

FEWEST_RINGING, MOST_BETWEEN, STEP_PX = 8, 0.5, 6.0
"""Rows of a dark side that the ringing at the probe's face must show, and how many as many may lie near that side and not on it."""

MOST_OUTSIDE = 0.02
"""Part of the area that may lie outside what was fitted."""

SPECKS = 0.003
"""Part of the area that may lie beyond a side that is seen."""

NEARER = 0.001
"""Part of the area that may lie nearer than the near end."""

LARGEST_APEX_ERROR, LARGEST_ONE_SIDED = 1.0, 0.7
"""mm. Estimated error of the apex, on the large side, beyond which a fit is refused, and one of which only one side is seen."""

CRISP_PX2, RAGGED_LENGTH = 0.1, 8.0
"""Mean squared distance of a crisp outline from its side, due to whole pixels; length over which points of a ragged one err alike."""

RAGGED_PX = 6.0
"""Points of the outline nearer than this belong to a side or an end, and are off it if they do not lie on it."""

MOST_LOPSIDED_DEG, MORE_RAGGED = 1.5, 3.0
"""Degrees by which one side may lean more than the other, and how many times as ragged the edge of a shadow is then."""

LEAST_FILLED, CUT_OFF = 0.3, 0.2
"""Part of an arc about the apex that is lit where the image still goes on, and of a width that must end inside the image to be its end."""

FARTHEST_STEP = 400.0
"""Steps of rows that the apex may move in one round."""

LEFT, RIGHT, NEAR, FAR = range(4)
"""The parts of an outline."""


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


Outline = tuple[Floats, Floats, Floats, Floats]
"""The ends of an area in each row and column, left, right, top and bottom, (n, 2) each, (x, y) in steps of rows: what is square in mm is
square here."""


def outline_of(area: Mask, aspect: float) -> Outline:
    """The outline of an area without what the image's border cuts off; `aspect` is the pixels' width over their height."""
    rows, columns = area.shape
    row, column = np.flatnonzero(area.any(axis=1)), np.flatnonzero(area.any(axis=0))
    left, right = area[row].argmax(axis=1), columns - 1 - area[row, ::-1].argmax(axis=1)
    top, bottom = area[:, column].argmax(axis=0), rows - 1 - area[::-1, column].argmax(axis=0)

    def points(x: Reals | Integers, y: Reals | Integers, kept: Mask) -> Floats:
        return np.stack([x * aspect, y.astype(np.float64)], axis=1)[kept]

    # The outermost pixels lie inside, by half a pixel on the average
    return (
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


def most_at(values: Floats, tolerance: float) -> tuple[float, int]:
    """The radius, or row, or column, near which most points are, and how many."""
    if not len(values):
        return 0.0, 0
    ordered = np.sort(values)
    counts = np.searchsorted(ordered, ordered + 2 * tolerance, "right") - np.arange(len(ordered))
    first = int(counts.argmax())
    return float(np.median(ordered[first : first + counts[first]])), int(counts[first])


def fit_sector(area: Mask, spacing: tuple[float, float], may_lean: bool = False) -> SectorFit | None:
    """The sector that an area (rows, columns) is part of; None where that cannot be told. `spacing` is (x, y) in mm.

    Where it `may_lean`, each of its sides is believed as it is; else one leans as much as the other.
    """
    aspect = spacing[0] / spacing[1]
    outline = outline_of(area, aspect)
    if sum(map(len, outline)) < 100:
        return None
    # One pixel in four is enough
    rows, columns = 2 * np.array(np.nonzero(area[::2, ::2]))
    pixels = np.stack([columns * aspect, rows], axis=1).astype(np.float64)
    best: SectorFit | None = None
    for start, mirrored in _starts(outline):
        seen, apex = mirrored, start
        if seen is None:
            free = _fitted(outline, start)
            if free is None:
                continue
            seen, apex = _sides_seen(free, outline, pixels, may_lean), free.apex
        leans = may_lean and mirrored is None and all(seen)
        fit = _fitted(outline, apex, None if leans else seen) if any(seen) else None
        # That a side mirrors the other is only taken where its ringing shows: the sector may have been steered
        if fit is None or (mirrored is not None and not all(fit.used[:NEAR])):
            continue
        found = _checked(fit, seen, outline, pixels, spacing)
        if found is not None and (best is None or found.apex_error < best.apex_error):
            best = found
        # From here the ringing of a dark side may not show, and from another start it does
        if found is not None and all(fit.used[:NEAR]):
            break
    return best


def has_ragged_narrow_side(area: Mask, fan: Fan) -> bool:
    """Whether the side of a sector that leans less is the edge of a shadow: the outline of an area is much more ragged there."""
    aspect = fan.pixel_size[0] / fan.pixel_size[1]
    apex, angles = np.array([fan.apex_px[0] * aspect, fan.apex_px[1]]), [math.radians(angle) for angle in fan.angles_deg]
    return _is_ragged(outline_of(area, aspect), apex, angles)


def _is_ragged(outline: Outline, apex: Floats, angles: list[float]) -> bool:
    narrow = RIGHT if angles[LEFT] + angles[RIGHT] < 0 else LEFT
    spreads = [_spread(_off(outline[side], side, apex, angles[side])) for side in (narrow, 1 - narrow)]
    return spreads[0] >= MORE_RAGGED * spreads[1]


def _starts(outline: Outline) -> Iterator[tuple[Floats, list[bool] | None]]:
    """Where the apex may be, and which sides are seen then, or None where that is not known.

    It may be where two straight sides meet, where one meets the outermost line that leans as much to the other side, or where arcs about
    a point of one fit best.
    """
    steep = math.tan(math.radians(UPRIGHT_DEG))
    lines = [straightest(outline[LEFT], -1), straightest(outline[RIGHT], 1)]
    if lines[0] is not None and lines[1] is not None and lines[1][1] - lines[0][1] > 2 * steep:
        y = (lines[0][0] - lines[1][0]) / (lines[1][1] - lines[0][1])
        yield np.array([lines[0][0] + lines[0][1] * y, y]), None
    alike = None not in lines and abs(sum(math.atan(line[1]) for line in lines if line)) < math.radians(MOST_LOPSIDED_DEG)
    top = float(min(outline[LEFT][:, 1].min(initial=np.inf), outline[RIGHT][:, 1].min(initial=np.inf)))
    for side, sign in ((LEFT, -1), (RIGHT, 1)):
        line, others = lines[side], outline[1 - side]
        if line is None or sign * line[1] < steep:
            continue
        offset, slope, _ = line
        # Where both sides lean alike none is dark: what lies outside is a clock or text
        if len(others) >= FEWEST_RINGING and not alike:
            outermost = -sign * float(np.sort(-sign * (others[:, 0] + slope * others[:, 1]))[-FEWEST_RINGING // 2])
            y = (outermost - offset) / (2 * slope)
            yield np.array([offset + slope * y, y]), [side == LEFT, side == RIGHT]
        rows = top + 10 - np.geomspace(1, 4000, 120)
        apexes = np.stack([offset + slope * rows, rows], axis=1)
        seen = [_most_together(np.linalg.norm(points - apexes[:, None], axis=-1), 3.0) for points in (outline[NEAR], outline[FAR])]
        yield apexes[int(np.argmax(np.add(*seen)))], None


def _most_together(values: Floats, width: float) -> Floats:
    """How many of each row's values (rows, n) lie within `width` of each other, at most."""
    ordered = np.sort(values, axis=-1)
    upto = (np.searchsorted(row, row + width, "right") for row in ordered)
    return np.array([(last - np.arange(last.size)).max(initial=0) for last in upto], dtype=np.float64)


@dataclass(frozen=True)
class _Fit:
    """What fits an outline best, in its steps."""

    apex: Floats
    values: list[float]  #: Angles of left and right side, rad, radii of near and far end
    used: list[bool]  #: Which of these were seen well enough to count
    flat: float | None  #: The row of a straight face
    error: float  #: Of the apex, estimated


def _fitted(outline: Outline, apex: Floats, seen: list[bool] | None = None) -> _Fit | None:
    """What fits best about an apex near this one; None where too little fits.

    Where it is told which sides are `seen`, one leans as much as the other, and of one that is not only what the ringing shows counts.
    """
    dark = None if seen is None or all(seen) else seen.index(False)
    for tolerance in TOLERANCES_PX:
        values = [_crowded(points, part, apex, tolerance) for part, points in enumerate(outline)]
        if seen is not None:
            half = (values[RIGHT] - values[LEFT]) / 2 if dark is None else abs(values[1 - dark])
            values[LEFT], values[RIGHT] = -half, half
        near = [points[np.abs(_off(points, part, apex, values[part])) <= tolerance] for part, points in enumerate(outline)]
        used = _enough(outline, near, values, apex)
        if dark is not None:
            used[dark] = ringing_shows(_off(outline[dark], dark, apex, values[dark]) * (1, -1)[dark], tolerance)
        flat = _flat_top(outline[NEAR], near[NEAR])
        if flat is not None:
            used[NEAR] = False
        if sum(used) < 2 or not any(used[:NEAR]):
            return None
        # A ragged part tells less; of a dark side only what rings belongs to it
        errors = {}
        for part in (part for part in range(4) if used[part]):
            spread = _typical(_off(near[part] if part == dark else outline[part], part, apex, values[part]))
            errors[part] = math.sqrt(3 * CRISP_PX2 + RAGGED_LENGTH * (spread - CRISP_PX2))

        def off(told: Floats, near: list[Floats] = near, errors: dict[int, float] = errors) -> Floats:
            sides = (told[2], told[3]) if seen is None else (told[2], -told[2])
            each = (*sides, told[4], told[5])
            return np.concatenate([_off(near[part], part, told[:2], each[part]) / error for part, error in errors.items()])

        # What nothing tells keeps its value
        found = cast("Any", scipy.optimize.least_squares)(off, [*apex, *values], method="lm")
        if np.hypot(*(found.x[:2] - apex)) > FARTHEST_STEP:
            return None
        covariance = np.linalg.pinv(found.jac.T @ found.jac, hermitian=True)
        apex, values = found.x[:2], found.x[2:].tolist()
        if seen is not None:
            values[RIGHT] = -values[LEFT]
    return _Fit(apex, values, used, flat, math.sqrt(covariance[0, 0] + covariance[1, 1]))


def _crowded(points: Floats, part: int, apex: Floats, tolerance: float) -> float:
    """The angle or radius near which most points of a part are."""
    x, y = (points - apex).T
    radius = np.hypot(x, y)
    if part >= NEAR or not len(points):
        return most_at(radius, tolerance)[0]
    return most_at(np.arctan2(x, y), tolerance / max(float(np.median(radius)), 1.0))[0]


def _off(points: Floats, part: int, apex: Floats, value: float) -> Floats:
    """How far points lie from a ray of this angle, to its right, or outside an arc of this radius."""
    x, y = (points - apex).T
    radius = np.hypot(x, y)
    off: Floats = radius * (np.arctan2(x, y) - value) if part < NEAR else radius - value
    return off


def _enough(outline: Outline, near: list[Floats], values: list[float], apex: Floats) -> list[bool]:
    """Which of left side, right side, near end and far end are seen along enough of their length to count."""
    width, height = np.ptp(np.concatenate(outline), axis=0)
    upright = math.radians(UPRIGHT_DEG)
    used = [len(near[side]) >= max(SHORTEST_SIDE * height, 20) and sign * values[side] > upright for side, sign in ((LEFT, -1), (RIGHT, 1))]
    for part, sign in ((NEAR, -1), (FAR, 1)):
        beyond = sign * _off(outline[part], part, apex, values[part]) > 4.0
        # The near end is as much shorter than the far one as it is nearer
        longest = width * (values[NEAR] / max(values[FAR], 1.0) if part == NEAR else 1.0)
        used.append(len(near[part]) >= max(SHORTEST_ARC * longest, 20) and beyond.sum() <= 0.1 * len(beyond))
    return used


def ringing_shows(inward: Floats, tolerance: float) -> bool:
    """Whether a dark side shows where the probe's face rings: some rows end on it and below they end far inward, not little by little."""
    on, between = (np.abs(inward) <= tolerance).sum(), ((inward > tolerance) & (inward <= STEP_PX)).sum()
    return bool(on >= FEWEST_RINGING and between <= MOST_BETWEEN * on)


def _flat_top(top: Floats, on_arc: Floats) -> float | None:
    """The row of a straight face; None where an arc suits the upper outline better."""
    row, count = most_at(top[:, 1], 1.5)
    return row if count > 1.1 * len(on_arc) and count > 0.3 * len(top) else None


def _beyond(fit: _Fit, pixels: Floats, side: int) -> float:
    """The part of an area's pixels that lies beyond a side."""
    x, y = (pixels - fit.apex).T
    return float(np.mean((-1, 1)[side] * (np.arctan2(x, y) - fit.values[side]) > _margin(np.hypot(x, y))))


def _margin(radius: Floats) -> Floats:
    margin: Floats = np.maximum(2.0 / np.maximum(radius, 1.0), math.radians(0.3))
    return margin


def _sides_seen(fit: _Fit, outline: Outline, pixels: Floats, may_lean: bool) -> list[bool]:
    """Whether left and right side are seen, as nothing lies beyond them; the edge of a shadow is none."""
    seen = [fit.used[side] and _beyond(fit, pixels, side) < SPECKS for side in (LEFT, RIGHT)]
    angles = fit.values[:NEAR]
    if all(seen) and not may_lean and abs(sum(angles)) > math.radians(MOST_LOPSIDED_DEG):
        if not _is_ragged(outline, fit.apex, angles):
            return [False, False]  # a sector that was steered
        seen[RIGHT if sum(angles) < 0 else LEFT] = False
    return seen


def _checked(fit: _Fit, seen: list[bool], outline: Outline, pixels: Floats, spacing: tuple[float, float]) -> SectorFit | None:
    """The fit, in pixels of the image, if it explains the area and is sure enough."""
    x, y = (pixels - fit.apex).T
    angle, radius = np.arctan2(x, y), np.hypot(x, y)
    left, right, first, last = fit.values
    if y.min() < -2 or max(_beyond(fit, pixels, side) for side in (LEFT, RIGHT)) > SPECKS:
        return None
    if not fit.used[NEAR]:
        # Specks lie nearer; what is left out with them is made good, as a sector's area grows with the square of its radius
        nearest, farthest = np.quantile(radius, (NEARER, 1 - NEARER))
        innermost = math.sqrt(max(nearest**2 - NEARER * farthest**2, 0.0))
        first = max(fit.flat - fit.apex[1], 0.0) if fit.flat is not None else innermost
    # What rings ends above, where a dark side begins
    cut_off = np.count_nonzero(outline[FAR][:, 1] > pixels[:, 1].mean()) < CUT_OFF * np.ptp(pixels[:, 0])
    if not fit.used[FAR]:
        # Far beams may fade to black one by one, where the other three parts tell the sector
        faded = cut_off or all(fit.used[:FAR])
        last = float(radius.max()) if faded else _last_filled(radius, angle, (left, right))
    margin = _margin(radius)
    inside = (angle > left - margin) & (angle < right + margin) & (radius > first - 2.0) & (radius < last + 2.0)
    error = fit.error * spacing[1]
    if 1 - inside.mean() > MOST_OUTSIDE or error > (LARGEST_APEX_ERROR if all(seen) else LARGEST_ONE_SIDED):
        return None
    return SectorFit(
        (float(fit.apex[0] * spacing[1] / spacing[0]), float(fit.apex[1])),
        (math.degrees(left), math.degrees(right)),
        (float(first * spacing[1]), float(last * spacing[1])),
        fit.flat,
        None if all(seen) else ("left", "right")[seen.index(False)],
        bool(fit.used[FAR] or cut_off),
        error,
    )


def _last_filled(radius: Floats, angle: Floats, angles: tuple[float, float]) -> float:
    """The radius up to which the arcs about the apex are lit along a good part; of an area's pixels, one in four."""
    within = (angle > angles[0]) & (angle < angles[1])
    counts = np.bincount(radius[within].astype(int)) / (0.25 * (angles[1] - angles[0]))
    filled = counts > LEAST_FILLED * np.maximum(np.arange(counts.size), 1)
    return float(np.flatnonzero(filled)[-1]) if filled.any() else 0.0


def _typical(off: Floats) -> float:
    """The same where some notches do not count, as of text, or of a bright echo beside a side: that of as many evenly spread ones."""
    near = off[np.abs(off) <= RAGGED_PX]
    return max(4 / 3 * float(np.median(near**2)), CRISP_PX2) if near.size else np.inf


def _spread(off: Floats) -> float:
    """Mean squared distance of what belongs to a side or an end, px^2."""
    near = off[np.abs(off) <= RAGGED_PX]
    return max(float(np.mean(near**2)), CRISP_PX2) if near.size else np.inf
