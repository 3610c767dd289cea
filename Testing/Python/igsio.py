"""IGSIO's volume reconstruction with nearest-neighbor interpolation, emulated from the facts in plus-conventions.md.

An oracle only: `test_igsio_references.py` first shows that it reproduces what IGSIO wrote, voxel by voxel, and then holds our results
against it where the two mean to agree.
"""

from __future__ import annotations

import numpy as np

from AIFReconLib.region import ImageRegion

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
            _add_to_mean(value, hits, flat, pixels)
        np.add.at(hits, flat, 1)
    return value.reshape(grid.shape), hits.reshape(grid.shape)


def _add_to_mean(value, hits, flat, pixels):
    """v = (256 p + v acc) // (acc + 256), acc = 256 hits; from 255 hits on, v = trunc(p / 256 + v 255 / 256)."""
    order = np.argsort(flat, kind="stable")
    flat, pixels = flat[order], pixels[order]
    first = np.r_[True, flat[1:] != flat[:-1]]
    rank = np.arange(flat.size) - np.maximum.accumulate(np.where(first, np.arange(flat.size), 0))
    for turn in range(int(rank.max()) + 1):
        now = rank == turn
        at, p = flat[now], pixels[now]
        seen = hits[at] + turn
        acc = 256 * seen
        value[at] = np.where(seen < 255, (256 * p + value[at] * acc) // (acc + 256), (p + value[at] * 255) // 256)
