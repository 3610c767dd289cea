"""Smooth solids as signed distance functions: negative inside, positive outside, in the unit of the coordinates.

Coordinates come as three float32 arrays x, y, z of shapes that broadcast. Distances are exact on the surface and first-order
accurate near it, which is all that a surface, a cortical shell of 2 mm or an angle of incidence needs.

References
----------
Hart (1996), Sphere tracing, The Visual Computer 12:527-545, doi:10.1007/s003710050084 (distance bounds of implicit solids).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Integers, Mask, Reals

Triple = tuple[float, float, float]


def smooth_union(a: Reals, b: Reals, blend: float) -> Reals:
    """Distance of both solids together, with a fillet of about `blend` where they meet (quadratic polynomial minimum)."""
    overlap = np.maximum(blend - np.abs(a - b), 0.0) / blend
    distance: Reals = np.minimum(a, b) - overlap * overlap * (0.25 * blend)
    return distance


def smooth_intersection(a: Reals, b: Reals, blend: float) -> Reals:
    """Distance of what belongs to both solids, with its edges rounded by about `blend`."""
    return -smooth_union(-a, -b, blend)


def ellipse(u: Reals, v: Reals, radius_u: Reals | float, radius_v: Reals | float) -> Reals:
    """First-order distance to an elliptic cylinder about the third axis; the radii may be arrays."""
    scaled = np.maximum(np.hypot(u / radius_u, v / radius_v), 1e-4)
    slope = np.maximum(np.hypot(u / (radius_u * radius_u), v / (radius_v * radius_v)), 1e-6)
    distance: Reals = scaled * (scaled - 1.0) / slope
    return distance


class Bar(NamedTuple):
    """A flat strip with round ends, as thick as said, that may taper: what most parts of a vertebra's arch are.

    Parameters
    ----------
    start, end : (3,)
        Middles of the round ends.
    radii_start, radii_end : (half width, half thickness)
        There; the edges are rounded by the half thickness.
    facing : (3,)
        Across its flat side, of any length; what of it runs along the bar is left out.
    """

    start: Triple
    end: Triple
    radii_start: tuple[float, float]
    radii_end: tuple[float, float]
    facing: Triple

    def reaches(self, x: Reals, y: Reals, z: Reals, margin: float) -> Integers:
        """Places in flat arrays of points that may lie within `margin` of the bar."""
        beyond = max(self.radii_start + self.radii_end) + margin
        inside: Mask | bool = True
        for coordinate, ends in zip((x, y, z), zip(self.start, self.end)):
            inside = inside & (coordinate > min(ends) - beyond) & (coordinate < max(ends) + beyond)
        return np.flatnonzero(inside)

    def distance(self, x: Reals, y: Reals, z: Reals) -> Reals:
        """Distance to its surface: exact where it does not taper."""
        along = np.subtract(self.end, self.start, dtype=np.float64)
        length = float(np.linalg.norm(along))
        along /= length
        across = np.subtract(self.facing, np.dot(self.facing, along) * along)
        across /= np.linalg.norm(across)
        offsets = [coordinate - np.float32(start) for coordinate, start in zip((x, y, z), self.start)]
        way, thick, wide = (
            sum(offset * np.float32(part) for offset, part in zip(offsets, axis)) for axis in (along, across, np.cross(along, across))
        )
        place = np.clip(way / np.float32(length), 0.0, 1.0)
        half_width, half_thickness = (
            np.float32(first) + np.float32(last - first) * place for first, last in zip(self.radii_start, self.radii_end)
        )
        flat = np.maximum(half_width - half_thickness, 0.0)
        aside = np.maximum(np.hypot(way - np.float32(length) * place, wide) - flat, 0.0)
        distance: Reals = np.hypot(aside, thick) - half_thickness
        return distance
