"""What is the same for every frame of a sweep: which pixels count, and which way sound travels through them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Floats, Integers, Mask, Matrix, Singles
from ..imaging.beams import ProbeGeometry
from ..imaging.region import ImageRegion
from ..imaging.sound_speed import DepthScale
from .methods.method import Beams

SPACING_TOLERANCE = 1e-3
"""Relative change of pixel spacing at which beam directions are computed anew; recorded matrices jitter in the sixth digit."""

CENTER_TOLERANCE = 1e-6
"""Voxels. The box around a sweep begins at a pixel's center, which rounding must not put outside of it."""

FIXED_POINT_ONE = 2**14
"""What stands for 1 where pixels are placed as by Plus's Optimization=FULL."""

NO_BEAMS: Singles = np.empty(0, np.float32)
ALL = slice(None)


Value = TypeVar("Value", bound=np.generic)


@dataclass(frozen=True, eq=False)
class PixelLayout:
    """The pixels that enter a volume, in row-major order.

    Parameters
    ----------
    size : (columns, rows) of the image
    spacing : (x, y), mm
    window : (top, bottom, left, right)
        Smallest rectangle around all of them, bottom and right not included.
    mask : (rows, columns) bool array
        Which pixels of the window count, n of them.
    beam_x, beam_y : (n,) float32 arrays or None
        Beam direction through each, in the image plane.
    moved : (2, n) float64 array or None
        Column and row where each truly is, where that is not where it is shown.
    """

    size: tuple[int, int]
    spacing: tuple[float, float]
    window: tuple[int, int, int, int]
    mask: Mask
    beam_x: Singles | None
    beam_y: Singles | None
    moved: Floats | None = None

    @cached_property
    def inside(self) -> Integers:
        """The flat numbers within the window of the pixels that count, (n,), rising."""
        return np.flatnonzero(self.mask)

    def filled(self, values: NDArray[Value]) -> NDArray[Value]:
        """Values of the pixels that count, (n,), as an image over the window, (rows, columns); 0 or False elsewhere."""
        image = np.zeros(self.mask.shape, dtype=values.dtype)
        image[self.mask] = values
        return image

    def within_window(self, image: NDArray[Value]) -> NDArray[Value]:
        """The window of an image (rows, columns), without a copy."""
        top, bottom, left, right = self.window
        return image[top:bottom, left:right]

    def pieces_within(self, mask: Mask) -> Integers:
        """Pixels `mask` of the layout, (rows, columns) bool over the window, as unbroken pieces of rows, in row-major order.

        Returns
        -------
        pieces : (n, 4) int64 array
            Row and first column in the image, the column that follows the last, and the number of the first pixel within the layout.
        """
        top, _, left, right = self.window
        padded = np.pad(mask, ((0, 0), (1, 1)))
        # What a row begins it ends, so that every other edge is a start
        edges = np.flatnonzero(padded[:, 1:] != padded[:, :-1])
        rows, starts = np.divmod(edges[::2], mask.shape[1] + 1)
        stops = edges[1::2] % (mask.shape[1] + 1)
        offsets = np.searchsorted(self.inside, rows * (right - left) + starts)
        return np.stack([rows + top, starts + left, stops + left, offsets], axis=1).astype(np.int64)

    @classmethod
    def build(
        cls,
        size: tuple[int, int],
        spacing: tuple[float, float],
        region: ImageRegion,
        probe: ProbeGeometry | None,
        depth_scale: DepthScale | None = None,
    ) -> PixelLayout:
        """Lay out an image of `size` (columns, rows); `probe` is None where no beam directions are needed."""
        columns, rows = size
        mask = region.mask(columns, rows)
        kept_rows, kept_columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        window = int(kept_rows[0]), int(kept_rows[-1]) + 1, int(kept_columns[0]), int(kept_columns[-1]) + 1
        mask = mask[window[0] : window[1], window[2] : window[3]]
        beam_x = beam_y = None
        if probe is not None:
            directions = probe.directions(columns, rows, spacing)[window[0] : window[1], window[2] : window[3]]
            beam_x, beam_y = directions[mask].T.copy()
        layout = cls(size, spacing, window, mask, beam_x, beam_y)
        return layout if depth_scale is None else replace(layout, moved=depth_scale.moved(layout.coordinates))

    def fits(self, size: tuple[int, int], spacing: tuple[float, float]) -> bool:
        """Whether it serves a frame of this size and pixel spacing."""
        return self.size == size and all(abs(new - old) <= SPACING_TOLERANCE * old for new, old in zip(spacing, self.spacing, strict=True))

    def beams(self, pixels: Integers | slice, axes: Singles) -> Beams:
        """The beams through `pixels` of a frame whose image axes are `axes` (6,); without components where the layout has none."""
        if self.beam_x is None or self.beam_y is None:
            return Beams(NO_BEAMS, NO_BEAMS, axes[:3], axes[3:])
        return Beams(self.beam_x[pixels], self.beam_y[pixels], axes[:3], axes[3:])

    def has_any(self, kept: Mask) -> bool:
        """Whether any of the pixels that count is among those `kept`, (rows, columns) bool of the whole image."""
        return bool((self.within_window(kept) & self.mask).any())

    def pixels(self, image: NDArray[Value]) -> NDArray[Value]:
        """The pixels that count, (n,), of an image (rows, columns); a view where all do."""
        window = self.within_window(image)
        return window.reshape(-1) if window.size == self.inside.size else window.reshape(-1)[self.inside]

    def values(self, image: Array) -> Singles:
        """The same as float32."""
        return self.pixels(image).astype(np.float32)

    @cached_property
    def coordinates(self) -> Floats:
        """Column and row in the image of the pixels that count, (2, n) float64, as shown."""
        top, _, left, right = self.window
        rows, columns = np.divmod(self.inside, right - left)
        return np.stack([columns + left, rows + top]).astype(np.float64)

    @cached_property
    def bounds(self) -> tuple[float, float, float, float]:
        """Left, right, top, bottom: smallest rectangle around the pixels' true places."""
        if self.moved is None:
            top, bottom, left, right = self.window
            return left, right - 1, top, bottom - 1
        (left, top), (right, bottom) = self.moved.min(axis=1), self.moved.max(axis=1)
        return float(left), float(right), float(top), float(bottom)

    def places(self, image_to_ijk: Matrix, pixels: Integers) -> Floats:
        """Where pixels, (m,) numbers of the n that count, lie between voxels, (3, m) float64, i, j, k.

        Places that a rounding error keeps off a voxel's center are on it.
        """
        column, row = (self.coordinates if self.moved is None else self.moved)[:, pixels]
        # Not a matrix product, whose rounding is the machine's own
        ijk = np.stack([along[0] * column + along[1] * row + along[3] for along in image_to_ijk[:3]])
        whole = np.rint(ijk)
        return np.where(np.abs(ijk - whole) < CENTER_TOLERANCE, whole, ijk)

    def planes_reached(self, image_to_ijk: Matrix, axis: int = 2) -> tuple[int, int]:
        """The lowest and the highest plane along an axis in which a pixel may have a voxel, or a corner of the eight around it."""
        left, right, top, bottom = self.bounds
        along = np.asarray(image_to_ijk)[axis].tolist()
        ends = [along[0] * x + along[1] * y + along[3] for x in (left, right) for y in (top, bottom)]
        return math.floor(min(ends)) - 1, math.ceil(max(ends)) + 1

    def voxels(
        self,
        image_to_ijk: Matrix,
        grid_size: tuple[int, int, int],
        planes: tuple[int, int] | None = None,
        among: Integers | slice = ALL,
    ) -> tuple[Integers, Integers]:
        """Which voxel each pixel falls into.

        Parameters
        ----------
        image_to_ijk : (4, 4) float64 array
        grid_size : (i, j, k)
        planes : (first, stop) or None
            The part of the grid that counts; by default all of it.
        among : (a,) int64 array, or slice
            Numbers of the pixels that are asked for, of the n that count; by default all.

        Returns
        -------
        pixels : (m,) int64 array
            Positions, among those that are asked for, of the pixels that fall into the part, rising.
        voxels : (m,) int64 array
            Their voxels, flat in [k, j, i] of the part.

        Notes
        -----
        ijk = floor(image_to_ijk (column, row, 0, 1) + 0.5) in float64, summed as (row part + offset + 0.5) + column part; every
        engine sums in this order, so that pixels on the border of two voxels fall into the same one everywhere.
        """
        column, row = (self.coordinates if self.moved is None else self.moved)[:, among]
        first, stop = planes or (0, grid_size[2])
        flat, inside = np.zeros(column.size), np.ones(column.size, dtype=bool)
        for axis, (low, high) in ((2, (first, stop)), (1, (0, grid_size[1])), (0, (0, grid_size[0]))):
            along = image_to_ijk[axis]
            place = np.floor((along[1] * row + (along[3] + 0.5)) + along[0] * column)
            inside &= (place >= low) & (place < high)
            # Voxel numbers stay below 2^31: exact in float64
            flat = flat * (high - low) + (place - low)
        pixels = np.flatnonzero(inside)
        return pixels, flat[pixels].astype(np.int64)


def in_fixed_point(image_to_ijk: Matrix) -> Matrix:
    """A (4, 4) matrix with its numbers rounded as IGSIO's fixed-point type holds them.

    Notes
    -----
    With whole columns and rows, places are then whole numbers of 2^-14 voxel, which doubles add up exactly: pixels fall into the voxels
    of IGSIO's integer arithmetic. A pixel moves by at most (columns + rows + 1) 2^-15 voxels along an axis.
    """
    rounded: Matrix = np.rint(image_to_ijk * FIXED_POINT_ONE) / FIXED_POINT_ONE
    return rounded


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
    """The most pixels that any voxel of a grid of `size` (i, j, k) can have got of all images, without a look at the voxels.

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
