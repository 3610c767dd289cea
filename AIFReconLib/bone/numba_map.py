"""A bone map between its voxels, as compiled loops: the numbers of scipy's interpolation and `sobel`, several times as fast."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Integers, Singles
from ..machine.numba_compile import compiled, inlined
from .placed.at_voxels import SHORTEST

SEEN = 2**12
"""Voxels that are remembered while others are looked up."""


@inlined
def found_at(array: Singles, k: int, j: int, i: int) -> float:
    """A value of the array, 0 outside of it."""
    if 0 <= k < array.shape[0] and 0 <= j < array.shape[1] and 0 <= i < array.shape[2]:
        return float(array[k, j, i])
    return 0.0


@inlined
def interpolated(array: Singles, at_k: float, at_j: float, at_i: float) -> float:
    """A value between voxels.

    sum of ((v w_k) w_j) w_i over the 8 neighbors, i fastest, in float64: the order of scipy's interpolation of order 1, so that a bone map
    does not depend on whether numba is there.
    """
    planes, rows, columns = array.shape
    below_k, below_j, below_i = np.floor(at_k), np.floor(at_j), np.floor(at_i)
    if not (-1.0 <= below_k < planes and -1.0 <= below_j < rows and -1.0 <= below_i < columns):
        return 0.0
    wk, wj, wi = at_k - below_k, at_j - below_j, at_i - below_i
    vk, vj, vi = 1.0 - wk, 1.0 - wj, 1.0 - wi
    a, b, c = int(below_k), int(below_j), int(below_i)
    if 0 <= a < planes - 1 and 0 <= b < rows - 1 and 0 <= c < columns - 1:
        flat = array.ravel()
        one = np.uint64((a * rows + b) * columns + c)
        right, down, behind = np.uint64(1), np.uint64(columns), np.uint64(rows * columns)
        total: float = ((flat[one] * vk) * vj) * vi
        total += ((flat[one + right] * vk) * vj) * wi
        total += ((flat[one + down] * vk) * wj) * vi
        total += ((flat[one + down + right] * vk) * wj) * wi
        total += ((flat[one + behind] * wk) * vj) * vi
        total += ((flat[one + behind + right] * wk) * vj) * wi
        total += ((flat[one + behind + down] * wk) * wj) * vi
        total += ((flat[one + behind + down + right] * wk) * wj) * wi
        return total
    total = ((found_at(array, a, b, c) * vk) * vj) * vi
    total += ((found_at(array, a, b, c + 1) * vk) * vj) * wi
    total += ((found_at(array, a, b + 1, c) * vk) * wj) * vi
    total += ((found_at(array, a, b + 1, c + 1) * vk) * wj) * wi
    total += ((found_at(array, a + 1, b, c) * wk) * vj) * vi
    total += ((found_at(array, a + 1, b, c + 1) * wk) * vj) * wi
    total += ((found_at(array, a + 1, b + 1, c) * wk) * wj) * vi
    total += ((found_at(array, a + 1, b + 1, c + 1) * wk) * wj) * wi
    return total


@compiled
def sample_linearly(
    array: Singles,
    matrix: Floats,
    starts: Floats,
    result: Singles,
    first: tuple[int, int, int],
    stop: tuple[int, int, int],
) -> None:
    """Interpolate `array` at the voxels from `first` to before `stop` of `result`.

    Parameters
    ----------
    array : [k, j, i] float32 array
        Around it lie zeros.
    matrix, starts : float64 arrays
        Of `Placement`: voxel first + (0, j, i) of plane k lies at (starts[k] + j matrix[:, 1]) + i matrix[:, 2].
    result : [k, j, i] float32 array
    first, stop : tuple of 3 int, [k, j, i]
    """
    for k in range(first[0], stop[0]):
        for j in range(stop[1] - first[1]):
            line = result[k, first[1] + j, first[2] : stop[2]]
            begin_k, begin_j, begin_i = starts[k, 0] + j * matrix[0, 1], starts[k, 1] + j * matrix[1, 1], starts[k, 2] + j * matrix[2, 1]
            for i in range(line.size):
                line[i] = interpolated(array, begin_k + i * matrix[0, 2], begin_j + i * matrix[1, 2], begin_i + i * matrix[2, 2])


@inlined
def smoothed(values: Singles, step: int, result: Singles) -> None:
    """Every value of a patch, twice, and its neighbors `step` before and after it."""
    for n in range(step, 64 - step):
        result[n] = np.float64(values[n]) * 2.0 + (np.float64(values[n - step]) + np.float64(values[n + step]))


@inlined
def sobel_slope(patch: Singles, step: int, other: int, third: int, rise: Singles, room: Singles) -> None:
    """scipy's `sobel` of the inner values of a patch, flat, along the axis of `step`; then come the other axes in scipy's order."""
    for n in range(step, 64 - step):
        rise[n] = np.float64(patch[n + step]) - np.float64(patch[n - step])
    smoothed(rise, other, room)
    smoothed(room, third, rise)


@compiled
def look_up(
    arrays: tuple[Singles, Singles, Singles, Singles],
    part: tuple[tuple[int, int, int], tuple[int, int], tuple[int, int], tuple[int, int]],
    starts: Floats,
    matrix: Floats,
    voxels: Integers,
    probability: Singles,
    directions: Singles,
) -> None:
    """Probability and direction of bone at some voxels.

    Parameters
    ----------
    arrays : probability and potential [k, j, i], slopes (3, k, j, i), to_reference (3, 3), float32, of `BoneAtVoxels`
        Slopes are empty where they are the Sobel gradient of the potential.
    part : shape, planes, rows and columns of the `Placement`
    starts, matrix : float64 arrays of the `Placement`
    voxels : (m,) int64 array, flat [k, j, i]
    probability : (m,) float32 array
        Result.
    directions : (m, 3) float32 array
        Result; left alone where the probability is 0.

    Notes
    -----
    The sums are those of `interpolated`. A Sobel gradient is made of the 4 x 4 x 4 values around a place, flat, of which the inner
    2 x 2 x 2 get one: differences along its axis, then sums along the others in their order, each rounded to float32 as scipy does. What
    the other values get is of no account.
    """
    source, potential, slopes, turn = arrays
    shape, in_planes, in_rows, in_columns = part
    planes, rows, columns = source.shape
    patch, rise, summed = np.zeros(64, np.float32), np.zeros(64, np.float32), np.zeros(64, np.float32)
    slope = np.empty(3, np.float32)
    seen = np.full(SEEN, -1)
    for n in range(voxels.size):
        # Pixels of a frame meet a voxel several times
        before = seen[voxels[n] % SEEN]
        if before >= 0 and voxels[before] == voxels[n]:
            probability[n] = probability[before]
            directions[n] = directions[before]
            continue
        seen[voxels[n] % SEEN] = n
        line, i = divmod(voxels[n], shape[2])
        k, j = divmod(line, shape[1])
        probability[n] = 0
        if not (in_planes[0] <= k < in_planes[1] and in_rows[0] <= j < in_rows[1] and in_columns[0] <= i < in_columns[1]):
            continue
        row, column = j - in_rows[0], i - in_columns[0]
        at_k = (starts[k, 0] + row * matrix[0, 1]) + column * matrix[0, 2]
        at_j = (starts[k, 1] + row * matrix[1, 1]) + column * matrix[1, 2]
        at_i = (starts[k, 2] + row * matrix[2, 1]) + column * matrix[2, 2]
        a, b, c = int(np.floor(at_k)), int(np.floor(at_j)), int(np.floor(at_i))
        wk, wj, wi = at_k - a, at_j - b, at_i - c
        for term in range(4):
            if term > 0 and slopes.size == 0:
                if term == 1:
                    # Beyond the border of the map lies what is on it
                    for m in range(16):
                        z, y = min(max(a - 1 + (m >> 2), 0), planes - 1), min(max(b - 1 + (m & 3), 0), rows - 1)
                        for right in range(4):
                            patch[4 * m + right] = potential[z, y, min(max(c - 1 + right, 0), columns - 1)]
                if term == 1:
                    sobel_slope(patch, 1, 16, 4, rise, summed)
                elif term == 2:
                    sobel_slope(patch, 4, 16, 1, rise, summed)
                else:
                    sobel_slope(patch, 16, 4, 1, rise, summed)
            total = 0.0
            for corner in range(8):
                z, y, x = corner >> 2, (corner >> 1) & 1, corner & 1
                value = 0.0
                if 0 <= a + z < planes and 0 <= b + y < rows and 0 <= c + x < columns:
                    if term == 0:
                        value = np.float64(source[a + z, b + y, c + x])
                    elif slopes.size > 0:
                        value = np.float64(slopes[term - 1, a + z, b + y, c + x])
                    else:
                        value = np.float64(rise[(z + 1) * 16 + (y + 1) * 4 + x + 1])
                total += ((value * (wk if z > 0 else 1.0 - wk)) * (wj if y > 0 else 1.0 - wj)) * (wi if x > 0 else 1.0 - wi)
            if term > 0:
                slope[term - 1] = total
                continue
            probability[n] = total
            if probability[n] == 0:
                break
        if probability[n] == 0:
            continue
        for component in range(3):
            directions[n, component] = (turn[component, 0] * slope[0] + turn[component, 1] * slope[1]) + turn[component, 2] * slope[2]
        along, down, deep = np.float64(directions[n, 0]), np.float64(directions[n, 1]), np.float64(directions[n, 2])
        length = np.sqrt((along * along + down * down) + deep * deep)
        for component in range(3):
            directions[n, component] = directions[n, component] / np.float32(length) if length >= SHORTEST else np.float32(0)
