"""How far from bone a place is: the signed distance to segmented bone, sampled with its slope in microseconds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Floats, Integers, Mask, Singles
from ..errors import GeometryError
from ..geometry.box import block_sums, box_around
from ..geometry.transforms import transform_points
from ..geometry.volume import Volume, nearest
from ..machine.memory import LARGEST_GRID, require_memory
from ..machine.threads import in_parts, usable_cores

FARTHEST_KNOWN = 16.0
"""mm from bone up to which distances are known; farther is that far."""

VOXEL = 1.0
"""mm. Finer labels are averaged to about this before distances are taken, and thicker slices are filled in: a fraction of the time, and
the surface is known from each block's share of bone."""

THINNEST = 8
"""A thick slice is divided into at most so many thin ones."""

BYTES_PER_BLOCK = 80
"""Bytes for each voxel of the field while it is made: two distances with their helpers."""

SMOOTHING, WIDER = 0.9, 2.0
"""Voxels. The Gaussian that takes the stairs off the distance, and a wider one that tells by how much that moves curved surfaces."""


def require_bone(bone: Mask) -> None:
    """Return if some voxels are bone and some are not; a GeometryError otherwise."""
    if not bone.any():
        raise GeometryError("Input labels must have voxels above 0; got none. Was the right segmentation chosen?")
    if bone.all():
        raise GeometryError("Input labels must leave voxels that are not bone; got bone everywhere. Was the right segmentation chosen?")


@dataclass(frozen=True, eq=False)
class BoneField:
    """Signed distance to bone, mm, negative inside, in the labels' own frame."""

    distance: Volume  #: float32. On a box around bone; `FARTHEST_KNOWN` outside of it.
    labels: Volume  #: integers. Which bone is which.

    @classmethod
    def from_labels(cls, labels: Volume, only: int | None = None) -> BoneField:
        """The field around all labels above 0, or around one of them.

        Raises GeometryError when no voxel, or every voxel, is labeled.
        """
        bone = labels.array > 0 if only is None else labels.array == only
        require_bone(bone)
        factors = np.maximum(np.floor(VOXEL / labels.grid.spacing + 0.5), 1).astype(int)
        found = box_around(bone)
        first = np.array([s.start for s in found])[::-1]
        size = np.array([s.stop for s in found])[::-1] - first
        # Whole blocks of voxels with a margin of nothing on every side: bone at the border of a CT ends there
        spacing = labels.grid.spacing * factors
        margin = np.maximum(np.ceil(FARTHEST_KNOWN / spacing), 2).astype(int)
        blocks = -(-size // factors) + 2 * margin
        more = np.clip(np.floor(spacing / max(VOXEL, spacing.min()) + 0.5), 1, THINNEST).astype(int)
        cost = BYTES_PER_BLOCK * int(more.prod()) + int(factors.prod())
        require_memory((int(blocks[0]), int(blocks[1]), int(blocks[2])), spacing, cost, most=LARGEST_GRID)
        padded = np.zeros((blocks * factors)[::-1], dtype=np.uint8)
        start = margin * factors
        padded[tuple(slice(a, a + n) for a, n in zip(start[::-1], size[::-1]))] = bone[found]
        share = np.divide(block_sums(padded, factors[::-1], np.int32), factors.prod(), dtype=np.float32)
        for axis in range(3):
            if more[axis] > 1:
                share = _between_slices(share, spacing[::-1], 2 - axis, more[axis])
                spacing[axis] /= more[axis]
        to_labels = np.diag([*(factors / more), 1.0])
        to_labels[:3, 3] = first - start + (factors / more - 1) / 2
        distance = _smoothed(_signed_distance(share, spacing[::-1], _side(spacing)))
        return cls(Volume(distance, labels.ijk_to_reference @ to_labels), labels)

    @property
    def middle(self) -> Floats:
        """Center of the box around bone, (3,) mm."""
        return transform_points(self.distance.ijk_to_reference, (np.array(self.distance.grid.size) - 1) / 2)

    def sample(self, points: Floats) -> tuple[Floats, Floats]:
        """Distances (n,) and their slopes (n, 3) at points (n, 3) of the labels' frame, by linear interpolation."""
        array, grid = self.distance.array, self.distance.grid
        ijk = transform_points(grid.reference_to_ijk, points)
        last = np.array(grid.size) - 1
        outside = ((ijk < 0) | (ijk > last) | ~np.isfinite(ijk)).any(axis=1)
        ijk[outside] = 0.0
        low = np.minimum(ijk.astype(np.int64), last - 1)
        a, b, c = (ijk - low).T
        row, plane = grid.size[0], grid.size[0] * grid.size[1]
        at = low @ np.array([1, row, plane])
        flat = array.reshape(-1)
        v000, v100, v010, v110 = flat[at], flat[at + 1], flat[at + row], flat[at + row + 1]
        at += plane
        v001, v101, v011, v111 = flat[at], flat[at + 1], flat[at + row], flat[at + row + 1]
        v00, v10, v01, v11 = (x + c * (y - x) for x, y in ((v000, v001), (v100, v101), (v010, v011), (v110, v111)))
        v0, v1 = v00 + b * (v01 - v00), v10 + b * (v11 - v10)
        along_k = [x + b * (y - x) for x, y in ((v001 - v000, v011 - v010), (v101 - v100, v111 - v110))]
        slopes = np.stack([v1 - v0, (v01 - v00) + a * ((v11 - v10) - (v01 - v00)), along_k[0] + a * (along_k[1] - along_k[0])], axis=1)
        slopes = slopes @ grid.reference_to_ijk[:3, :3]
        slopes[outside] = 0.0
        return np.where(outside, FARTHEST_KNOWN, v0 + a * (v1 - v0)), slopes

    def distances(self, points: Floats) -> Floats:
        """Distances alone at points (..., 3): to the nearest voxel, without interpolation."""
        array, grid = self.distance.array, self.distance.grid
        to_ijk = grid.reference_to_ijk
        ijk = np.floor(points.reshape(-1, 3) @ to_ijk[:3, :3].T + (to_ijk[:3, 3] + 0.5)).astype(np.int64)
        outside = ((ijk < 0) | (ijk >= grid.size)).any(axis=1)
        ijk[outside] = 0
        i, j, k = ijk.T
        return np.where(outside, np.float32(FARTHEST_KNOWN), array[k, j, i]).reshape(points.shape[:-1])

    def label_at(self, points: Floats) -> Integers:
        """The bone whose surface is nearest to points (n, 3) within some mm, (n,) int; 0 where none was met."""
        distance, slopes = self.sample(points)
        slopes /= np.maximum(np.linalg.norm(slopes, axis=1, keepdims=True), 1e-6)
        result = np.zeros(len(points), dtype=np.int64)
        to_ijk = self.labels.grid.reference_to_ijk
        for depth in (0.5, 1.5, 3.0):
            open_ = np.flatnonzero(result == 0)
            under = points[open_] - (np.maximum(distance[open_], 0.0) + depth)[:, None] * slopes[open_]
            result[open_] = nearest(self.labels, transform_points(to_ijk, under))
        return result


def _between_slices(share: Singles, spacing_kji: Floats, axis: int, more: int) -> Singles:
    """Shares of bone in `more` thin slices for each thick one: a cubic through the distances that each slice has to its own outline."""
    others = np.delete(spacing_kji, axis)
    thick = spacing_kji[axis]
    alone = np.where(np.arange(3) == axis, 1e3 * FARTHEST_KNOWN, spacing_kji)  # so far apart that no slice looks into the next
    # Farther than this from an outline, the next slice may hold anything
    outlines = np.clip(_signed_distance(share, alone, np.sqrt(others.prod())), -1.5 * thick, 1.5 * thick)
    count = share.shape[axis]
    thin = np.clip((np.arange(count * more) + 0.5) / more - 0.5, 0, count - 1)
    weights = scipy.interpolate.make_interp_spline(np.arange(count), np.eye(count))(thin).astype(np.float32)
    distance = np.moveaxis(np.tensordot(weights, outlines, (1, axis)), 0, axis)
    spacing = np.where(np.arange(3) == axis, thick / more, spacing_kji)
    slope = np.sqrt(sum(along**2 for along in np.gradient(distance, *spacing)))
    result: Singles = np.clip(0.5 - distance / (np.maximum(slope, 0.5) * _side(spacing)), 0.0, 1.0).astype(np.float32)
    return result


def _signed_distance(share: Singles, spacing_kji: Floats, side: float) -> Singles:
    """Signed distance of blocks to the surface, float32, at most `FARTHEST_KNOWN`.

    The surface crosses the nearest block of at least half bone (from outside; at most half from inside), at the depth that leaves the
    block's share of bone behind it, so that bone and what is not are treated alike.
    """
    if share.max() < 0.5:
        # Bone that fills no block by half is shown all the same
        share = share / (2 * share.max())
    found = (0.5 - share) * np.float32(side)
    # No need to look for depth in bone outside of its box
    asked = (slice(None),) * 3, box_around(share >= 0.5, 1)

    def measure(which: int) -> None:
        within, result = share[asked[which]], found[asked[which]]
        places = scipy.ndimage.distance_transform_edt(
            within < 0.5 if which == 0 else within > 0.5, sampling=spacing_kji, return_distances=False, return_indices=True
        )
        # Plane by plane: distances of all at once would take many times the memory of what is asked
        for plane, indices in enumerate(places.swapaxes(0, 1)):
            whole = np.nonzero(within[plane] <= 0 if which == 0 else within[plane] >= 1)
            k, j, i = indices[(slice(None), *whole)]
            steps = zip((k, j, i), (plane, *whole), spacing_kji)
            away = np.sqrt(sum(((there - here) * size) ** 2 for there, here, size in steps))
            crossed = (0.5 - within[k, j, i]) * np.float32(side)
            result[plane][whole] = (away if which == 0 else -away) + crossed

    in_parts(measure, len(asked), usable_cores())
    return np.clip(found, -FARTHEST_KNOWN, FARTHEST_KNOWN, out=found)


def _smoothed(distance: Singles) -> Singles:
    """A distance without stairs whose curved surfaces stay where they are.

    A Gaussian moves the surface of a sphere inward by its variance over the radius, and so does linear interpolation. By how much, a wider
    one tells, whose effect is taken off to the share that their variances have.
    """
    once = scipy.ndimage.gaussian_filter(distance, SMOOTHING, mode="nearest")
    lost = np.float32((SMOOTHING**2 + 1 / 6) / WIDER**2)
    result: Singles = once + lost * (once - scipy.ndimage.gaussian_filter(once, WIDER, mode="nearest"))
    return result


def _side(spacing_kji: Floats) -> float:
    """Of the cube that is as large as a block, mm."""
    return float(np.prod(spacing_kji) ** (1 / 3))
