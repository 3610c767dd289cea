"""The algorithm of the design as two plain loops over pixels: slow, obvious, and what every engine is held against.

It shares no code with the library's compounding: each step is written out from the design's formulas. Arithmetic is float32, one
operation at a time, so that agreement can be asked for to the last bit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass
class LoopResult:
    intensity: np.ndarray
    score: np.ndarray
    hits: np.ndarray
    cosine: np.ndarray


def plain_loop(
    frames,
    grid,
    method,
    *,
    mask=None,
    directions=None,
    bone=None,
    alpha=0.1,
    beta=0.1,
    maximum=255.0,
    evidence=None,
    floor=0.02,
    gain=1.0,
):
    """Reconstruct `frames` (image, image_to_reference) on `grid`.

    mask : (rows, columns) bool, pixels that count; directions : (rows, columns, 2), beam directions in the image plane;
    bone : BoneOnGrid; evidence : (reach, onset), each (rows, columns), per frame, for `weighted`.
    """
    real = np.float32
    ni, nj, nk = grid.size
    value, weight, best = (np.zeros((nk, nj, ni), real) for _ in range(3))
    total = np.zeros((nk, nj, ni), np.float64)
    hits = np.zeros((nk, nj, ni), np.uint32)
    alpha, beta, maximum, floor, gain, one, zero = (real(v) for v in (alpha, beta, maximum, floor, gain, 1, 0))
    for number, (image, image_to_reference) in enumerate(frames):
        image_to_ijk = grid.reference_to_ijk @ image_to_reference
        x_axis, y_axis = (axis.astype(real) for axis in _plane_axes(image_to_reference))
        for row in range(image.shape[0]):
            for column in range(image.shape[1]):
                if mask is not None and not mask[row, column]:
                    continue
                i, j, k = (
                    math.floor(image_to_ijk[a, 1] * row + (image_to_ijk[a, 3] + 0.5) + image_to_ijk[a, 0] * column) for a in range(3)
                )
                if not (0 <= i < ni and 0 <= j < nj and 0 <= k < nk):
                    continue
                pixel = real(image[row, column])
                hits[k, j, i] += 1
                cosine = probability = zero
                if bone is not None:
                    v = bone.directions_reference[k, j, i].astype(real)
                    probability = real(bone.probability[k, j, i])
                    along_x = (v[0] * x_axis[0] + v[1] * x_axis[1]) + v[2] * x_axis[2]
                    along_y = (v[0] * y_axis[0] + v[1] * y_axis[1]) + v[2] * y_axis[2]
                    beam = directions[row, column].astype(real)
                    cosine = min(max(beam[0] * along_x + beam[1] * along_y, zero), one)
                    best[k, j, i] = max(best[k, j, i], cosine)
                at = (k, j, i)
                if method == "average":
                    total[at] += np.float64(pixel)
                    weight[at] += one
                elif method == "latest":
                    value[at] = pixel
                    weight[at] += one
                elif method == "maximum":
                    value[at] = pixel if hits[at] == 1 else max(value[at], pixel)
                    weight[at] += one
                elif method in ("aif", "aif-compensated"):
                    angle_weight = cosine
                    if method == "aif-compensated" and cosine > beta:
                        angle_weight = one / cosine
                    w = angle_weight * probability
                    v_temp = min(maximum, pixel + (alpha * pixel) * w)
                    value[at] = (weight[at] * value[at] + v_temp) / (weight[at] + one)
                    weight[at] += w
                elif method == "weighted":
                    reach, onset = (real(image[row, column]) for image in evidence[number])
                    gate = (onset * probability) * probability
                    w = (floor + gate) * reach
                    compensation = min(one / cosine, real(3)) if cosine > beta else one
                    v_temp = pixel * (one + (gain * gate) * compensation)
                    value[at] += w * min(maximum, v_temp)
                    weight[at] += w
                else:
                    raise ValueError(method)
    if method == "average":
        value = np.where(hits > 0, total / np.maximum(hits, 1), 0).astype(np.float32)
    if method == "weighted":
        value = np.where(hits > 0, value / np.where(hits > 0, weight, one), zero)
    return LoopResult(value.astype(np.float32), weight.astype(np.float32), hits, best.astype(np.float32))


def gray(values):
    """What an 8-bit volume shows: rounded half up."""
    return np.floor(np.clip(values, 0, 255) + np.float32(0.5)).astype(np.uint8)


def _plane_axes(image_to_reference):
    """Unit vectors along the image's x and y, turned equally toward a right angle where they are not at one."""
    x = image_to_reference[:3, 0] / np.linalg.norm(image_to_reference[:3, 0])
    y = image_to_reference[:3, 1] / np.linalg.norm(image_to_reference[:3, 1])
    u, _, vt = np.linalg.svd(np.stack([x, y], axis=1), full_matrices=False)
    nearest = u @ vt
    return nearest[:, 0], nearest[:, 1]
