"""Methods of others, for comparison: they are no part of the product.

Most are methods of one's own as docs/own-method.md has them, and are called by their names: ``study.reference_methods:incidence_weighted``.
`largest_contrast` joins volumes and not frames.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy import ndimage, sparse
from scipy.sparse.linalg import splu

from AIFReconLib.compounding.own.method import register_method
from AIFReconLib.compounding.state import Reconstruction
from AIFReconLib.geometry.volume import Volume

ALPHA, BETA, GAMMA = 2.0, 90.0, 0.05
"""Attenuation, steepness and penalty across the beams of the random walks, as their authors give them for B-mode images."""

LEAST_EDGE = 1e-5
"""What every edge of the graph has at least, so that no pixel is cut off."""

COARSE = 3
"""Pixels a side that become one before a walk: the map is smooth, and a direct solution of all pixels takes seconds a frame."""

LEAST = 0.01
"""Weight that is left where a method gives none, so that such a voxel is a plain mean and not empty; `weighted` leaves as much."""

SCALES = (1.0, 2.0, 4.0)
"""Voxels: standard deviations of the Gaussians between which contrast is compared."""


def random_walk_confidence(lines: np.ndarray) -> np.ndarray:
    """How surely a random walk from each pixel comes to the probe's face before it comes to the deepest row, 0 to 1.

    Parameters
    ----------
    lines : (rows, columns) array
        An image whose columns are scan lines, the face above; any scale of gray.

    Notes
    -----
    Karamalis, Wein, Klein and Navab, Ultrasound confidence maps using random walks, Medical Image Analysis 16 (2012) 1101-1112. The graph
    has edges to all eight neighbors. With g the gray level from 0 to 1, l the depth from 0 to 1 and c = g exp(-alpha l), an edge along the
    beam weighs exp(-beta |c_i - c_j|), one across it exp(-beta (|c_i - c_j| + gamma)), a diagonal one exp(-beta (|c_i - c_j| + sqrt(2)
    gamma)). The first row is 1, the last 0, and the others solve the graph's Laplace equation, here directly (SuperLU).
    """
    gray = np.asarray(lines, dtype=np.float64)
    rows, columns = gray.shape
    gray = (gray - gray.min()) / max(float(np.ptp(gray)), 1e-9)
    known = gray * np.exp(-ALPHA * np.linspace(0.0, 1.0, rows))[:, None]
    number = np.arange(rows * columns).reshape(rows, columns)
    starts, ends, edges = [], [], []
    for down, across, penalty in ((1, 0, 0.0), (0, 1, GAMMA), (1, 1, np.sqrt(2) * GAMMA), (1, -1, np.sqrt(2) * GAMMA)):
        here = np.s_[: rows - down, max(-across, 0) : columns - max(across, 0)]
        there = np.s_[down:, max(across, 0) : columns - max(-across, 0)]
        starts.append(number[here].ravel())
        ends.append(number[there].ravel())
        edges.append(np.exp(-BETA * (np.abs(known[here] - known[there]).ravel() + penalty)) + LEAST_EDGE)
    start, end, edge = map(np.concatenate, (starts, ends, edges))
    half = sparse.coo_matrix((edge, (start, end)), shape=(gray.size, gray.size)).tocsc()
    between = half + half.T
    laplacian = (sparse.diags(np.asarray(between.sum(axis=0)).ravel()) - between).tocsc()
    free, face = number[1:-1].ravel(), number[0]
    from_face = -np.asarray(laplacian[free][:, face].sum(axis=1)).ravel()
    solver = splu(laplacian[free][:, free].tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    confidence = np.ones_like(gray)
    confidence[1:-1], confidence[-1] = solver.solve(from_face).reshape(rows - 2, columns), 0.0
    return np.clip(confidence, 0.0, 1.0)


@register_method
def confidence_weighted(intensity):
    """The mean weighted by confidence, of a linear probe: columns are scan lines."""
    return LEAST + _coarsely(intensity), intensity


@register_method
def incidence_weighted(intensity, cosine):
    """The mean weighted by the cosine of incidence.

    Notes
    -----
    After Leotta and Martin, Three-dimensional spatial compounding of ultrasound scans with weighting by incidence angle, Ultrasonic Imaging
    22 (2000) 1-19, who take the surface from the images. Here it is the CT's, and the weight its cosine: aif's without the order of frames.
    """
    return LEAST + cosine, intensity


def largest_contrast(views: Sequence[Reconstruction]) -> Reconstruction:
    """Join volumes of several views by the contrast of each: at every scale that of the largest wins.

    Parameters
    ----------
    views : sequence of Reconstruction
        On one grid, such as plain means of single passes.

    Notes
    -----
    Burt and Adelson, Merging images through pattern decomposition, Proc. SPIE 575 (1985) 173-181, with differences of Gaussians on the full
    grid. With G_0 a view and G_n its Gaussian, both of measured voxels alone, the result is sum_n d_n + m: d_n that G_(n-1) - G_n, among
    the views that measured the voxel, which is largest without its sign; m the mean of their last G. Hung and Galeotti (Good and bad
    boundaries in ultrasound compounding, IJCARS 2021) keep the largest contrast of pyramids likewise; how they weigh it by confidence and
    by the direction of the probe is left out here.
    """
    measured = np.stack([view.mask.array > 0 for view in views])
    contrast, base = np.zeros((len(SCALES), *measured.shape[1:]), np.float32), np.zeros(measured.shape[1:], np.float32)
    for view, has in zip(views, measured, strict=True):
        # What a view did not measure must neither win nor darken what is beside it
        last: np.ndarray = np.where(has, view.intensity.array, 0).astype(np.float32)
        for most, sigma in zip(contrast, SCALES, strict=True):
            share = ndimage.gaussian_filter(has.astype(np.float32), sigma)
            smooth = ndimage.gaussian_filter(np.where(has, view.intensity.array, 0).astype(np.float32), sigma) / np.maximum(share, 1e-6)
            here = np.where(has, last - smooth, 0)
            np.copyto(most, here, where=np.abs(here) > np.abs(most))
            last = smooth
        base += np.where(has, last, 0)
    count = measured.sum(axis=0)
    joined = np.where(count > 0, contrast.sum(axis=0) + base / np.maximum(count, 1), 0)
    volume = views[0].intensity
    gray = Volume(np.clip(np.rint(joined), 0, 255).astype(volume.array.dtype), volume.ijk_to_reference)
    mask = np.where(measured, [view.mask.array for view in views], 255).min(axis=0)
    return replace(views[0], intensity=gray, mask=Volume(np.where(count > 0, mask, 0).astype(np.uint8), volume.ijk_to_reference))


def _coarsely(lines: np.ndarray) -> np.ndarray:
    """Confidence of an image whose columns are scan lines, found on pixels `COARSE` times as large."""
    rows, columns = (size // COARSE for size in lines.shape)
    small = lines[: rows * COARSE, : columns * COARSE].reshape(rows, COARSE, columns, COARSE).mean(axis=(1, 3))
    at = np.meshgrid(*((np.arange(size) - (COARSE - 1) / 2) / COARSE for size in lines.shape), indexing="ij")
    return ndimage.map_coordinates(random_walk_confidence(small), at, order=1, mode="nearest", output=np.float32)
