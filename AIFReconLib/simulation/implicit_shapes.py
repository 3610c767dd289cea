"""Smooth solids as signed distance functions: negative inside, positive outside, in the unit of the coordinates.

Coordinates come as three float32 arrays x, y, z of shapes that broadcast. Distances are exact on the surface and first-order
accurate near it, which is all that a surface, a cortical shell of 2 mm or an angle of incidence needs.

References
----------
Hart (1996), Sphere tracing, The Visual Computer 12:527-545, doi:10.1007/s003710050084 (distance bounds of implicit solids).
"""

from __future__ import annotations

import numpy as np

from ..arrays import Reals

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


def swept_ellipsoid(x: Reals, y: Reals, z: Reals, start: Triple, end: Triple, radii_start: Triple, radii_end: Triple) -> Reals:
    """Distance to an ellipsoid moved along a segment while its radii change: a capsule with a flattened section.

    Parameters
    ----------
    x, y, z : float32 arrays
    start, end : (3,)
        Centers of the ellipsoid at both ends.
    radii_start, radii_end : (3,)
        Its radii along x, y, z there.
    """
    axis = np.subtract(end, start).astype(np.float32)
    position = ((x - start[0]) * axis[0] + (y - start[1]) * axis[1] + (z - start[2]) * axis[2]) / float(axis @ axis)
    position = np.clip(position, 0.0, 1.0)
    square: Reals | float = 0.0
    slope: Reals | float = 0.0
    for coordinate, origin, direction, r0, r1 in zip((x, y, z), start, axis, radii_start, radii_end):
        radius = np.float32(r0) if r0 == r1 else r0 + (r1 - r0) * position
        scaled = (coordinate - origin - direction * position) / radius
        square = square + scaled * scaled
        slope = slope + (scaled / radius) ** 2
    length = np.sqrt(np.maximum(square, 1e-8))
    distance: Reals = length * (length - 1.0) / np.sqrt(np.maximum(slope, 1e-10))
    return distance


def rounded_box(
    x: Reals, y: Reals, z: Reals, half_x: Reals | float, half_y: Reals | float, half_z: Reals | float, rounding: float
) -> Reals:
    """Distance to a box about the origin with rounded edges; half sizes are outer ones and may be arrays."""
    outside_x, outside_y, outside_z = (np.abs(c) - half + rounding for c, half in ((x, half_x), (y, half_y), (z, half_z)))
    inside = np.minimum(np.maximum(np.maximum(outside_x, outside_y), outside_z), 0.0)
    square = np.maximum(outside_x, 0.0) ** 2 + np.maximum(outside_y, 0.0) ** 2 + np.maximum(outside_z, 0.0) ** 2
    distance: Reals = np.sqrt(square) + inside - rounding
    return distance
