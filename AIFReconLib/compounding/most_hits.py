"""How many pixels one voxel can have got, at most: known before they enter, without a look at the voxels."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Matrix
from .layout import PixelLayout


def most_in_a_voxel(image_to_ijk: Matrix) -> float:
    """A number of pixels that one voxel cannot get more of from an image at this place, (4, 4).

    Notes
    -----
    A plane meets a cube of edge 1 in a convex figure of an area up to sqrt(2) (Ball 1986) and, being no wider than the cube's diagonal, a
    perimeter up to pi sqrt(3). A convex figure holds at most area + perimeter / 2 + 1 points of a square lattice (Nosarzewska 1948).
    """
    (xx, xy), (_, yy) = (image_to_ijk[:3, :2].T @ image_to_ijk[:3, :2]).tolist()
    middle, area = (xx + yy) / 2, math.sqrt(max(xx * yy - xy * xy, 0.0))
    narrowest = math.sqrt(max(middle - math.hypot((xx - yy) / 2, xy), 0.0))
    return math.sqrt(2) / area + math.pi * math.sqrt(3) / 2 / narrowest + 1 if area and narrowest else math.inf


class MostHits:
    """The most that any voxel of a grid of `size` (i, j, k) can have got of all images so far.

    Notes
    -----
    Counted for each plane of voxels along each axis: a voxel lies in one of each, and got no more than any of the three. So a probe that
    moves is told from one that rests.
    """

    def __init__(self, size: tuple[int, int, int]):
        self._along = [np.zeros(count) for count in size]

    def after(self, image_to_ijk: Matrix, layout: PixelLayout) -> float:
        """The most after one image more, at this place, (4, 4)."""
        pixels = most_in_a_voxel(image_to_ijk)
        for axis, planes in enumerate(self._along):
            low, high = layout.planes_reached(image_to_ijk, axis)
            planes[max(low, 0) : max(high + 1, 0)] += pixels
        return min(float(planes.max(initial=0.0)) for planes in self._along)
