"""Linear interpolation of a volume on a turned grid as a compiled loop: the voxels of scipy's `affine_transform`, several times as fast."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Singles
from ..machine.numba_compile import compiled, inlined


@inlined
def found_at(array: Singles, k: int, j: int, i: int) -> float:
    """A value of the array, 0 outside of it."""
    if 0 <= k < array.shape[0] and 0 <= j < array.shape[1] and 0 <= i < array.shape[2]:
        return float(array[k, j, i])
    return 0.0


@compiled
def sample_linearly(
    array: Singles,
    matrix: Floats,
    offset: Floats,
    result: Singles,
    first: tuple[int, int, int],
    stop: tuple[int, int, int],
    passed: int,
) -> None:
    """Interpolate `array` at the voxels from `first` to before `stop` of `result`.

    Parameters
    ----------
    array : [k, j, i] float32 array
    matrix : (3, 3) float64 array
    offset : (3,) float64 array
        Voxel first + (k - passed, j, i) of the result lies at matrix @ (k, j, i) + offset in the array, whose surroundings are 0.
    result : [k, j, i] float32 array
    first, stop : tuple of 3 int, [k, j, i]
    passed : int
        How many planes of `offset` lie before the first.

    Notes
    -----
    sum of ((v w_k) w_j) w_i over the 8 neighbors, i fastest, in float64: the order of scipy's `affine_transform` of order 1, so that a
    bone map does not depend on whether numba is there.
    """
    planes, rows, columns = array.shape
    flat = array.ravel()
    for k in range(passed, passed + stop[0] - first[0]):
        for j in range(stop[1] - first[1]):
            line = result[first[0] + k - passed, first[1] + j, first[2] : stop[2]]
            for i in range(line.size):
                at_k = ((offset[0] + k * matrix[0, 0]) + j * matrix[0, 1]) + i * matrix[0, 2]
                at_j = ((offset[1] + k * matrix[1, 0]) + j * matrix[1, 1]) + i * matrix[1, 2]
                at_i = ((offset[2] + k * matrix[2, 0]) + j * matrix[2, 1]) + i * matrix[2, 2]
                below_k, below_j, below_i = np.floor(at_k), np.floor(at_j), np.floor(at_i)
                if not (-1.0 <= below_k < planes and -1.0 <= below_j < rows and -1.0 <= below_i < columns):
                    line[i] = 0.0
                    continue
                wk, wj, wi = at_k - below_k, at_j - below_j, at_i - below_i
                vk, vj, vi = 1.0 - wk, 1.0 - wj, 1.0 - wi
                a, b, c = int(below_k), int(below_j), int(below_i)
                if 0 <= a < planes - 1 and 0 <= b < rows - 1 and 0 <= c < columns - 1:
                    one = np.uint64((a * rows + b) * columns + c)
                    right, down, behind = np.uint64(1), np.uint64(columns), np.uint64(rows * columns)
                    total = ((flat[one] * vk) * vj) * vi
                    total += ((flat[one + right] * vk) * vj) * wi
                    total += ((flat[one + down] * vk) * wj) * vi
                    total += ((flat[one + down + right] * vk) * wj) * wi
                    total += ((flat[one + behind] * wk) * vj) * vi
                    total += ((flat[one + behind + right] * wk) * vj) * wi
                    total += ((flat[one + behind + down] * wk) * wj) * vi
                    total += ((flat[one + behind + down + right] * wk) * wj) * wi
                else:
                    total = ((found_at(array, a, b, c) * vk) * vj) * vi
                    total += ((found_at(array, a, b, c + 1) * vk) * vj) * wi
                    total += ((found_at(array, a, b + 1, c) * vk) * wj) * vi
                    total += ((found_at(array, a, b + 1, c + 1) * vk) * wj) * wi
                    total += ((found_at(array, a + 1, b, c) * wk) * vj) * vi
                    total += ((found_at(array, a + 1, b, c + 1) * wk) * vj) * wi
                    total += ((found_at(array, a + 1, b + 1, c) * wk) * wj) * vi
                    total += ((found_at(array, a + 1, b + 1, c + 1) * wk) * wj) * wi
                line[i] = total
