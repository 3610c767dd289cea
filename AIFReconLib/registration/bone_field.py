"""How far from bone a place is: the signed distance to segmented bone, sampled with its slope in microseconds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from ..arrays import Bytes, Floats, Integers, Mask, Singles
from ..errors import GeometryError
from ..geometry.box import box_around
from ..geometry.transforms import transform_points
from ..geometry.volume import Volume
from ..machine.memory import LARGEST_GRID, require_memory
from ..machine.threads import in_parts, usable_cores

REACH = 16.0
"""mm from bone up to which distances are known; farther is that far."""

VOXEL = 1.0
"""mm. Finer labels are averaged to about this before distances are taken: a fraction of the time, and the surface moves by less than 0.1
mm."""

BYTES_PER_BLOCK = 80
"""Bytes for each voxel of the field while it is made: two distances with their helpers."""

SMOOTHING = 0.7
"""Voxels. Gaussian that takes the stairs off the distance."""


@dataclass(frozen=True, eq=False)
class BoneField:
    """Signed distance to bone, mm, negative inside, in the labels' own frame.

    Parameters
    ----------
    distance : Volume of float32
        On a box around bone; `REACH` outside of it.
    labels : Volume of integers
        Which bone is which.
    """

    distance: Volume
    labels: Volume

    @classmethod
    def from_labels(cls, labels: Volume, only: int | None = None) -> BoneField:
        """The field around all labels above 0, or around one of them.

        Raises
        ------
        GeometryError
            When no voxel, or every voxel, is labeled.
        """
        bone = labels.array > 0 if only is None else labels.array == only
        if not bone.any():
            raise GeometryError("Input labels must have voxels above 0; got none. Was the right segmentation chosen?")
        if bone.all():
            raise GeometryError("Input labels must leave voxels that are not bone; got bone everywhere. Was the right segmentation chosen?")
        factors = np.maximum(np.floor(VOXEL / labels.grid.spacing + 0.5), 1).astype(int)
        found = box_around(bone)
        first = np.array([s.start for s in found])[::-1]
        size = np.array([s.stop for s in found])[::-1] - first
        # Whole blocks of voxels with a margin of nothing on every side: bone at the border of a CT ends there
        spacing = labels.grid.spacing * factors
        margin = np.ceil(REACH / spacing).astype(int)
        blocks = -(-size // factors) + 2 * margin
        require_memory((int(blocks[0]), int(blocks[1]), int(blocks[2])), spacing, BYTES_PER_BLOCK + int(factors.prod()), most=LARGEST_GRID)
        padded = np.zeros((blocks * factors)[::-1], dtype=np.uint8)
        start = margin * factors
        padded[tuple(slice(a, a + n) for a, n in zip(start[::-1], size[::-1]))] = bone[found]
        counts = _counted_in_blocks(padded, factors[::-1])
        inside = 2 * counts >= factors.prod()
        if not inside.any():
            inside = counts > 0
        to_labels = np.diag([*factors, 1.0])
        to_labels[:3, 3] = first - start + (factors - 1) / 2
        return cls(Volume(_signed_distance(inside, spacing[::-1]), labels.ijk_to_reference @ to_labels), labels)

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
        return np.where(outside, REACH, v0 + a * (v1 - v0)), slopes

    def distances(self, points: Floats) -> Floats:
        """Distances alone at points (..., 3): to the nearest voxel, without interpolation."""
        array, grid = self.distance.array, self.distance.grid
        to_ijk = grid.reference_to_ijk
        ijk = np.floor(points.reshape(-1, 3) @ to_ijk[:3, :3].T + (to_ijk[:3, 3] + 0.5)).astype(np.int64)
        outside = ((ijk < 0) | (ijk >= grid.size)).any(axis=1)
        ijk[outside] = 0
        i, j, k = ijk.T
        return np.where(outside, np.float32(REACH), array[k, j, i]).reshape(points.shape[:-1])

    def label_at(self, points: Floats) -> Integers:
        """The bone whose surface is nearest to points (n, 3) within some mm, (n,) int; 0 where none was met."""
        distance, slopes = self.sample(points)
        slopes /= np.maximum(np.linalg.norm(slopes, axis=1, keepdims=True), 1e-6)
        result = np.zeros(len(points), dtype=np.int64)
        to_ijk = self.labels.grid.reference_to_ijk
        for depth in (0.5, 1.5, 3.0):
            open_ = np.flatnonzero(result == 0)
            under = points[open_] - (np.maximum(distance[open_], 0.0) + depth)[:, None] * slopes[open_]
            ijk = np.floor(transform_points(to_ijk, under) + 0.5).astype(np.int64)
            known: Mask = np.all((ijk >= 0) & (ijk < np.array(self.labels.grid.size)), axis=1)
            i, j, k = np.where(known[:, None], ijk, 0).T
            result[open_] = np.where(known, self.labels.array[k, j, i], 0)
        return result


def _counted_in_blocks(mask: Bytes, factors: Integers) -> Integers:
    """How many voxels of 1 each block of `factors` [k, j, i] voxels of a mask holds; the blocks fill it."""
    counts = np.zeros(np.array(mask.shape) // factors, dtype=np.int32)
    for k, j, i in np.ndindex(*factors):
        counts += mask[k :: factors[0], j :: factors[1], i :: factors[2]]
    return counts


def _signed_distance(inside: Mask, spacing_kji: Floats) -> Floats:
    """Signed distance to the surface, which lies half a voxel from the centers of the voxels on either side of it; smoothed, float32."""
    half = np.float32(0.5 * np.prod(spacing_kji) ** (1 / 3))
    # No need to look for depth in bone outside of its box
    box = box_around(inside, 1)
    asked = ~inside, inside[box]
    found: list[Singles] = [np.empty(0, np.float32)] * len(asked)

    def measure(which: int) -> None:
        found[which] = np.asarray(scipy.ndimage.distance_transform_edt(asked[which], sampling=spacing_kji)).astype(np.float32)

    in_parts(measure, len(asked), usable_cores())
    distance, depth = found
    distance -= half
    distance[box] = np.where(inside[box], half - depth, distance[box])
    np.clip(distance, -REACH, REACH, out=distance)
    return scipy.ndimage.gaussian_filter(distance, SMOOTHING, mode="nearest")
