"""The true surface of bone, from a segmentation or a signed distance: points between the voxels, each with its normal and area.

Results are measured against this surface, never against the smoothed probability that the reconstruction steers by.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Floats, Integers, Mask, Numbers, Reals
from ..bone.field import require_bone
from ..errors import GeometryError
from ..geometry.box import box_around
from ..geometry.transforms import transform_points
from ..geometry.volume import Volume, nearest
from ..machine.memory import LARGEST_GRID, require_memory

DISTANCE_LIMIT = 12.0
"""mm. Distances to bone are known up to here; farther is cut off."""

BYTES_PER_LABEL = 64
"""Bytes for each voxel while distances are made of labels."""

SMOOTHING_VOXELS = 1.0
"""Gaussian that takes the stairs off a distance made from labels. It moves a surface of radius R inward by about 1 / R voxels^2."""

PITCH = 1.0
"""mm. About one point is kept per square of this side."""

GAP_LIMIT = 15.0
"""mm across an interspinous gap: wider than the widest usual one at L2 to L5 with its laminae."""

GAP_FACING_DEG = 60.0
"""A border faces the neighboring vertebra when its normal is within this angle of the way to the nearest point there."""

GAP_HALF_WIDTH = 10.0
"""mm from the midline: spinous process and laminae, without the facets."""

GAP_POSTERIOR_FROM = 0.33
"""The border begins at this part of the way from a vertebra's center of mass to the tip of its spinous process: behind the canal."""


@dataclass(frozen=True, eq=False)
class BoneSurface:
    """Points on the surface of bone.

    Parameters
    ----------
    points_reference : (n, 3) float64 array, mm
    normals_reference : (n, 3) float64 array, unit vectors
        Out of bone.
    areas : (n,) float64 array, mm^2
        What each point stands for; they sum to the area of the surface.
    labels : (n,) int array
        Which bone, as in the segmentation; 1 everywhere where there is none.
    """

    points_reference: Floats
    normals_reference: Floats
    areas: Floats
    labels: Integers

    def __len__(self) -> int:
        return len(self.areas)


def distance_from_labels(labels: Volume) -> Volume:
    """Signed distance to the surface of everything labeled, float32, mm: negative inside, cut off at `DISTANCE_LIMIT`.

    Raises GeometryError when no voxel, or every voxel, is labeled.

    Parameters
    ----------
    labels : Volume of integers or bool
        Any label above 0 is bone.

    Returns
    -------
    distance : Volume
        On the part of the labels' voxels that lies within the limit of bone.

    Notes
    -----
    Distance to the nearest bone voxel less distance to the nearest other voxel, both between centers, so that 0 lies half-way; then
    a Gaussian of `SMOOTHING_VOXELS`, for the surface is smoother than its voxels.
    """
    bone = labels.array > 0
    require_bone(bone)
    spacing_kji = labels.grid.spacing[::-1]
    box = box_around(bone, np.ceil(DISTANCE_LIMIT / spacing_kji).astype(int) + 1)
    bone = bone[box]
    require_memory(bone.shape[::-1], labels.grid.spacing, BYTES_PER_LABEL, most=LARGEST_GRID)
    distance = np.asarray(scipy.ndimage.distance_transform_edt(~bone, sampling=spacing_kji)).astype(np.float32)
    distance -= np.asarray(scipy.ndimage.distance_transform_edt(bone, sampling=spacing_kji)).astype(np.float32)
    np.clip(distance, -DISTANCE_LIMIT, DISTANCE_LIMIT, out=distance)
    distance = scipy.ndimage.gaussian_filter(distance, SMOOTHING_VOXELS, mode="nearest")
    return Volume(distance, labels[box].ijk_to_reference)


def bone_surface(distance: Volume, labels: Volume | None = None, pitch: float = PITCH) -> BoneSurface:
    """The zero level of a signed distance.

    Raises GeometryError when the distance is nowhere 0.

    Parameters
    ----------
    distance : Volume of float, mm
        Negative inside bone; smooth about 0. Placed in Reference.
    labels : Volume of integers or None
        Tells the bones apart; any grid.
    pitch : float, mm
        Points are thinned to about one per pitch^2, evenly; 0 keeps all.

    Notes
    -----
    Points are where voxel edges cross the level, by linear interpolation; normals are central differences there. Grid lines along
    axis a, of pitches h_b and h_c, cross a surface of unit normal n `|n_a| / (h_b h_c)` times per mm^2 (Crofton), so each crossing
    stands for the area `1 / (|n_i| / (h_j h_k) + |n_j| / (h_i h_k) + |n_k| / (h_i h_j))`.
    """
    array = distance.array
    crossings = []
    for axis in range(3):
        kji_axis = 2 - axis
        before = array[tuple(slice(None, -1) if a == kji_axis else slice(None) for a in range(3))]
        after = array[tuple(slice(1, None) if a == kji_axis else slice(None) for a in range(3))]
        found = np.nonzero((before > 0) != (after > 0))
        start, stop = before[found].astype(np.float64), after[found].astype(np.float64)
        ijk = np.stack(found[::-1], axis=1).astype(np.float64)
        ijk[:, axis] += start / (start - stop)
        crossings.append(ijk)
    ijk = np.concatenate(crossings)
    if not len(ijk):
        raise GeometryError("Input distance to bone must change its sign somewhere; got no surface. Was the right volume chosen?")
    ijk = ijk[np.lexsort(np.floor(ijk).T)]
    slope = np.empty_like(ijk)
    for axis in range(3):
        step = np.zeros(3)
        step[axis] = 0.75
        slope[:, axis] = _sample(array, ijk + step) - _sample(array, ijk - step)
    spacing = distance.grid.spacing
    slope /= spacing
    length = np.linalg.norm(slope, axis=1)
    usable = length > 0
    ijk, normals_grid = ijk[usable], slope[usable] / length[usable, None]
    areas = np.prod(spacing) / (np.abs(normals_grid) @ spacing)
    if pitch > 0:
        wanted = int(np.ceil(areas.sum() / pitch**2))
        if wanted < len(areas):
            kept = np.floor((np.arange(wanted) + 0.5) * (len(areas) / wanted)).astype(np.int64)
            scale = areas.sum() / areas[kept].sum()
            ijk, normals_grid, areas = ijk[kept], normals_grid[kept], areas[kept] * scale
    points = transform_points(distance.ijk_to_reference, ijk)
    normals = normals_grid @ (distance.ijk_to_reference[:3, :3] / spacing).T
    return BoneSurface(points, normals, areas, _label_of(points, normals, labels))


def interspinous_border(surface: BoneSurface, centers_reference: dict[int, Floats]) -> Mask:
    """Which points bound an interspinous gap: the edges of spinous processes and laminae that face the next vertebra.

    Parameters
    ----------
    surface : BoneSurface
        With a label per vertebra.
    centers_reference : dict of int to (3,) array, mm
        Each vertebra's center of mass, by its label (`centers_of_mass`).

    Returns
    -------
    border : (n,) bool array
        All False where there is one label only.

    Notes
    -----
    A point is on the border when all of these hold. The nearest point on another vertebra is within `GAP_LIMIT`, and the way there
    is within `GAP_FACING_DEG` of the point's normal. It lies within `GAP_HALF_WIDTH` of the vertebra's midplane, and farther
    posterior than `GAP_POSTERIOR_FROM` of the way from the center of mass to the tip (exceeded by 1% of the vertebra's points),
    which leaves out the bodies with their discs and the facets. The spine's axis at a vertebra is the line through the centers of
    the vertebrae next to it. Posterior is where the surface's third moment about the center of mass points, across that axis:
    transverse processes are a pair and cancel out, the spinous process has no counterpart.
    """
    border = np.zeros(len(surface), dtype=bool)
    present = [label for label in np.unique(surface.labels) if label in centers_reference]
    if len(present) < 2:
        return border
    centers = np.array([centers_reference[label] for label in present])
    first_axis = np.linalg.svd(centers - centers.mean(axis=0))[2][0]
    order = np.argsort(centers @ first_axis)
    for place, n in enumerate(order):
        here = np.flatnonzero(surface.labels == present[n])
        others = np.flatnonzero((surface.labels != present[n]) & np.isin(surface.labels, present))
        axis = centers[order[min(place + 1, len(order) - 1)]] - centers[order[max(place - 1, 0)]]
        axis /= np.linalg.norm(axis)
        points, normals = surface.points_reference[here], surface.normals_reference[here]
        across = points - centers[n]
        across -= (across @ axis)[:, None] * axis
        third_moment = (surface.areas[here] * (across**2).sum(axis=1)) @ across
        length = np.linalg.norm(third_moment)
        if length == 0:
            continue
        posterior = third_moment / length
        distance, number = scipy.spatial.cKDTree(surface.points_reference[others]).query(points, distance_upper_bound=GAP_LIMIT)
        near = np.isfinite(distance) & (distance > 0)
        way = surface.points_reference[others[np.where(near, number, 0)]] - points
        facing = (way * normals).sum(axis=1) >= np.cos(np.radians(GAP_FACING_DEG)) * np.linalg.norm(way, axis=1)
        behind = across @ posterior
        midline = np.abs(across @ np.cross(axis, posterior)) <= GAP_HALF_WIDTH
        border[here] = near & facing & midline & (behind > GAP_POSTERIOR_FROM * np.quantile(behind, 0.99))
    return border


def _label_of(points: Floats, normals: Floats, labels: Volume | None) -> Integers:
    """The label just under each point: the first above 0 within 2 mm, else 1."""
    result = np.zeros(len(points), dtype=np.int64)
    if labels is not None:
        for depth in np.arange(0.25, 2.01, 0.25):
            open_ = np.flatnonzero(result == 0)
            ijk = transform_points(labels.grid.reference_to_ijk, points[open_] - depth * normals[open_])
            result[open_] = nearest(labels, ijk)
    result[result == 0] = 1
    return result


def _sample(array: Numbers, ijk: Floats) -> Floats:
    return scipy.ndimage.map_coordinates(array, ijk.T[::-1], order=1, mode="nearest", output=np.float64)


# ---- statistics over points of a surface, each with its area, of which some are not known (NaN)


def exceeds(a: Floats, b: Floats) -> Floats:
    """1 where a > b, one half where they are equal but for rounding, 0 where a < b, NaN where either is not known."""
    difference = np.where(np.isfinite(a) & np.isfinite(b), a - b, np.nan)
    return np.where(np.abs(difference) <= 1e-5 * np.abs(a), 0.5, (np.sign(difference) + 1) / 2)


def mean_std(values: Reals, weights: Floats | float = 1.0) -> tuple[float, float]:
    """Weighted mean and standard deviation of the values that are not NaN; NaN where there are none."""
    known = np.isfinite(values)
    weights = np.broadcast_to(weights, values.shape)[known]
    total = float(np.sum(weights))
    if total == 0:
        return np.nan, np.nan
    mean = float(np.sum(weights * values[known], dtype=np.float64) / total)
    return mean, float(np.sqrt(np.sum(weights * (values[known] - mean) ** 2, dtype=np.float64) / total))


def median(values: Floats, weights: Floats) -> float:
    """Weighted median of the values that are not NaN; NaN where there are none."""
    known = np.isfinite(values)
    if not known.any():
        return np.nan
    values, weights = values[known], weights[known]
    order = np.argsort(values, kind="stable")
    summed = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(summed, summed[-1] / 2)])


def ratio(numerator: float, denominator: float) -> float:
    """NaN where the denominator is 0 or not known."""
    return numerator / denominator if denominator > 0 else np.nan
