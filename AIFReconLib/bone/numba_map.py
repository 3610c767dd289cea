"""A bone map between its voxels, as compiled loops: the numbers of scipy's interpolation and `sobel`, several times as fast."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Integers, Singles
from ..machine.numba_compile import compiled, inlined
from .placed.at_voxels import SHORTEST

SEEN = 2**12
"""Voxels that are remembered while others are looked up."""


@inlined
def between(flat: Singles, first: int, down: int, behind: int, wk: float, wj: float, wi: float) -> float:
    """Between 8 values of which `first` is the first along all axes: ((v w_k) w_j) w_i, i fastest, in float64, summed as scipy does."""
    one, low, far = np.uint64(first), np.uint64(down), np.uint64(behind)
    right, vk, vj, vi = np.uint64(1), 1.0 - wk, 1.0 - wj, 1.0 - wi
    total: float = ((flat[one] * vk) * vj) * vi
    total += ((flat[one + right] * vk) * vj) * wi
    total += ((flat[one + low] * vk) * wj) * vi
    total += ((flat[one + low + right] * vk) * wj) * wi
    total += ((flat[one + far] * wk) * vj) * vi
    total += ((flat[one + far + right] * wk) * vj) * wi
    total += ((flat[one + far + low] * wk) * wj) * vi
    total += ((flat[one + far + low + right] * wk) * wj) * wi
    return total


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
    lit: Integers,
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
    lit : (planes + 1, rows + 1, 2) int32 array, of `BoneAtVoxels`; or an empty one
        Directions are wanted where the probability is 0, too, and these are the places at which anything is not 0. Without it they are 0
        there.
    probability : (m,) float32 array
    directions : (m, 3) float32 array
        Results.

    Notes
    -----
    A Sobel gradient is made of the 4 x 4 x 4 values around a place, flat, of which the inner 2 x 2 x 2 get one: differences along its
    axis, then sums along the others in their order, each rounded to float32 as scipy does. What the other values get is of no account.
    So a bone map does not depend on whether numba is there.
    """
    source, potential, slopes, turn = arrays
    shape, in_planes, in_rows, in_columns = part
    planes, rows, columns = source.shape
    patch, rise, summed = np.zeros(64, np.float32), np.zeros(64, np.float32), np.zeros(64, np.float32)
    slope, cube = np.empty(3, np.float32), np.empty(8, np.float32)
    flat, rises, everywhere = source.ravel(), slopes.ravel(), lit.size > 0
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
        probability[n] = directions[n, 0] = directions[n, 1] = directions[n, 2] = np.float32(0)
        if not (in_planes[0] <= k < in_planes[1] and in_rows[0] <= j < in_rows[1] and in_columns[0] <= i < in_columns[1]):
            continue
        row, column = j - in_rows[0], i - in_columns[0]
        at_k = (starts[k, 0] + row * matrix[0, 1]) + column * matrix[0, 2]
        at_j = (starts[k, 1] + row * matrix[1, 1]) + column * matrix[1, 2]
        at_i = (starts[k, 2] + row * matrix[2, 1]) + column * matrix[2, 2]
        a, b, c = int(np.floor(at_k)), int(np.floor(at_j)), int(np.floor(at_i))
        if everywhere and not (-1 <= a < planes and -1 <= b < rows and lit[a + 1, b + 1, 0] <= c <= lit[a + 1, b + 1, 1]):
            continue
        wk, wj, wi = at_k - a, at_j - b, at_i - c
        inner, one = 0 <= a < planes - 1 and 0 <= b < rows - 1 and 0 <= c < columns - 1, (a * rows + b) * columns + c
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
            if not inner:
                for corner in range(8):
                    z, y, x = corner >> 2, (corner >> 1) & 1, corner & 1
                    cube[corner] = 0
                    if 0 <= a + z < planes and 0 <= b + y < rows and 0 <= c + x < columns:
                        if term == 0:
                            cube[corner] = source[a + z, b + y, c + x]
                        elif slopes.size > 0:
                            cube[corner] = slopes[term - 1, a + z, b + y, c + x]
                        else:
                            cube[corner] = rise[(z + 1) * 16 + (y + 1) * 4 + x + 1]
                total = between(cube, 0, 2, 4, wk, wj, wi)
            elif term == 0:
                total = between(flat, one, columns, rows * columns, wk, wj, wi)
            elif slopes.size > 0:
                total = between(rises, (term - 1) * flat.size + one, columns, rows * columns, wk, wj, wi)
            else:
                total = between(rise, 21, 4, 16, wk, wj, wi)
            if term > 0:
                slope[term - 1] = total
                continue
            probability[n] = total
            if probability[n] == 0 and not everywhere:
                break
        if probability[n] == 0 and not everywhere:
            continue
        for component in range(3):
            directions[n, component] = (turn[component, 0] * slope[0] + turn[component, 1] * slope[1]) + turn[component, 2] * slope[2]
        along, down, deep = np.float64(directions[n, 0]), np.float64(directions[n, 1]), np.float64(directions[n, 2])
        length = np.sqrt((along * along + down * down) + deep * deep)
        for component in range(3):
            directions[n, component] = directions[n, component] / np.float32(length) if length >= SHORTEST else np.float32(0)
