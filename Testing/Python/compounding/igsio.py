"""IGSIO's volume reconstruction, emulated from the facts in plus-conventions.md.

An oracle only: `test_igsio_references.py` first shows that it reproduces what IGSIO wrote, voxel by voxel, and then holds our results
against it where the two mean to agree.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from AIFReconLib.imaging.region import ImageRegion

FLOOR_TOLERANCE = 2.0**-17


def fixed_point_index(image_to_ijk, columns, rows):
    """Voxel (i, j, k) of pixels with Optimization FULL: the matrix to 14 binary digits."""
    f = np.rint(image_to_ijk * 2**14).astype(np.int64)
    return [(f[a, 0] * columns + f[a, 1] * rows + f[a, 3] + 2**13) >> 14 for a in range(3)]


def double_index(image_to_ijk, columns, rows):
    """Voxel (i, j, k) of pixels with Optimization NONE: double precision, rounded half up."""
    return [
        np.floor(image_to_ijk[a, 0] * columns + image_to_ijk[a, 1] * rows + image_to_ijk[a, 3] + 0.5).astype(np.int64) for a in range(3)
    ]


def optimized_fan(region: ImageRegion, columns: int, rows: int) -> np.ndarray:
    """The pixels of Optimization FULL: its fan is a pixel narrower at the sides and the outer arc, and reaches one into the inner."""

    def floor(x):
        return np.floor(x + FLOOR_TOLERANCE)

    fan = region.fan
    assert fan is not None
    column = np.arange(columns)[None, :]
    y = np.arange(rows)[:, None] - fan.apex_px[1]
    left, right = (np.tan(np.radians(angle)) for angle in fan.angles_deg)
    apex = fan.apex_px[0]
    outer = np.sqrt(np.maximum(fan.radii[1] ** 2 - y * y, 0))
    inner = np.sqrt(np.maximum(fan.radii[0] ** 2 - y * y, 0))
    mask = ImageRegion(region.clip).mask(columns, rows) & (y >= 0) & (y * y <= fan.radii[1] ** 2)
    mask &= (column >= -floor(-(left * y + apex + 1))) & (column <= floor(right * y + apex - 1))
    mask &= (column >= -floor(-(apex - outer + 1))) & (column <= floor(apex + outer - 1))
    skipped = (column >= -floor(-(apex - inner + 1))) & (column <= floor(apex + inner - 1)) & (y * y < fan.radii[0] ** 2)
    return mask & ~skipped


def paste(images, poses, grid, mask, index, method):
    """Reconstruct; returns gray levels and pixel counts, both [k, j, i].

    `index` is `fixed_point_index` or `double_index`; `method` latest, maximum or mean (IGSIO's truncating integer mean).
    """
    rows, columns = np.nonzero(mask)
    ni, nj, nk = grid.size
    value = np.zeros(ni * nj * nk, np.int64)
    hits = np.zeros(ni * nj * nk, np.int64)
    for image, pose in zip(images, poses, strict=True):
        i, j, k = index(grid.reference_to_ijk @ pose, columns, rows)
        inside = (i >= 0) & (i < ni) & (j >= 0) & (j < nj) & (k >= 0) & (k < nk)
        flat = ((k * nj + j) * ni + i)[inside]
        pixels = image[rows, columns][inside].astype(np.int64)
        if method == "latest":
            value[flat] = pixels
        elif method == "maximum":
            np.maximum.at(value, flat, pixels)
        else:
            # v = (256 p + v acc) // (acc + 256), acc = 256 hits; from 255 hits on, v = trunc(p / 256 + v 255 / 256)
            for turn, (now, at) in enumerate(in_turn(flat)):
                seen, p = hits[at] + turn, pixels[now]
                mean = (256 * p + value[at] * 256 * seen) // (256 * seen + 256)
                value[at] = np.where(seen < 255, mean, (p + value[at] * 255) // 256)
        np.add.at(hits, flat, 1)
    return value.reshape(grid.shape), hits.reshape(grid.shape)


def in_turn(flat):
    """Pixels enter their voxels in their order: at each turn, the next one of every voxel; which pixels, and their voxels."""
    order = np.argsort(flat, kind="stable")
    flat = flat[order]
    first = np.flatnonzero(np.r_[True, flat[1:] != flat[:-1]])
    counts = np.diff(first, append=flat.size)
    for turn in range(int(counts.max(initial=0))):
        yield order[first[counts > turn] + turn], flat[first[counts > turn]]


@dataclass(frozen=True)
class Arithmetic:
    """How IGSIO computes: `one` is the number that stands for 1.

    Parameters
    ----------
    one : int
        2^14 with Optimization FULL, which computes in whole numbers of 2^-14; 1 with NONE, in double precision.
    stores_whole_numbers : bool
        IGSIO keeps gray levels and 1/256 of a pixel's weight after every pixel. False: as if it kept what it computed.
    """

    one: int = 1
    stores_whole_numbers: bool = True

    def number(self, x):
        """A double as it is represented."""
        return np.rint(x * self.one).astype(np.int64) if self.one > 1 else x

    def split(self, x):
        """Whole part and remainder."""
        floor = x // self.one if self.one > 1 else np.floor(x + FLOOR_TOLERANCE)
        return floor.astype(np.int64), x - floor * self.one

    def times(self, x, y):
        """A product of two such numbers."""
        return (x * y + self.one // 2) // self.one if self.one > 1 else x * y

    def over(self, x, y):
        """A quotient of two such numbers."""
        return self.number(x / y)

    def rounded(self, x):
        """As it is stored."""
        return np.floor(x / self.one + (0.5 + FLOOR_TOLERANCE)) if self.stores_whole_numbers else x / self.one


def paste_linear(images, poses, grid, mask, method, arithmetic):
    """Reconstruct with trilinear splatting; returns gray levels, and for means what IGSIO's accumulation buffer holds, [k, j, i].

    `method` latest, maximum or mean.
    """
    rows, columns = np.nonzero(mask)
    size = np.array(grid.size)
    value, accumulated = np.zeros((2, grid.voxels))
    for image, pose in zip(images, poses, strict=True):
        matrix = arithmetic.number(grid.reference_to_ijk @ pose)
        parts = [arithmetic.split(matrix[a, 0] * columns + matrix[a, 1] * rows + matrix[a, 3]) for a in range(3)]
        low, remainder = (np.stack(part) for part in zip(*parts, strict=True))
        inside = ((low >= 0) & (low + (remainder != 0) < size[:, None])).all(axis=0)
        low, remainder = low[:, inside], remainder[:, inside]
        flat, shares = _corners(low, remainder, size, arithmetic)
        chosen = np.nonzero(shares if method == "mean" else shares >= arithmetic.one / 8)
        pixels = image[rows, columns][inside].astype(np.int64)[chosen[0]]
        if method == "latest":
            value[flat[chosen]] = pixels
        elif method == "maximum":
            np.maximum.at(value, flat[chosen], pixels)
        else:
            kept = arithmetic.stores_whole_numbers
            for now, at in in_turn(flat[chosen]):
                share, before = shares[chosen][now], accumulated[at] * arithmetic.one / 256
                total = share + before
                value[at] = arithmetic.rounded(arithmetic.over(share * pixels[now] + before * value[at], total))
                accumulated[at] = np.minimum(arithmetic.rounded(256 * total), 65535) if kept else 256 * total / arithmetic.one
    return value.reshape(grid.shape), accumulated.reshape(grid.shape)


def _corners(low, remainder, size, arithmetic):
    """Flat voxels and shares of the corners of every pixel, (pixels, 8), in IGSIO's order."""
    flat, shares = [], []
    for corner in itertools.product((1, 0), repeat=3):
        along = [r if high else arithmetic.one - r for r, high in zip(remainder, corner, strict=True)]
        shares.append(arithmetic.times(along[0], arithmetic.times(along[1], along[2])))
        i, j, k = low + np.array(corner)[:, None]
        flat.append((k * size[1] + j) * size[0] + i)
    return np.stack(flat, axis=1), np.stack(shares, axis=1)
