"""A bone map between its voxels, as compiled loops: the numbers of scipy's interpolation and `sobel`, several times as fast."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Integers, Singles
from ..machine.numba_compile import compiled, inlined
from .placed.at_voxels import SHORTEST

STEPS = ((1, 16, 4), (4, 16, 1), (16, 4, 1))
"""In a patch of 4 x 4 x 4, flat: a step along i, j or k, and along the other axes in scipy's order."""

REMEMBERED = 2**12
"""Voxels that are remembered while others are looked up."""


@inlined
def smoothed(values: Singles, step: int, result: Singles) -> None:
    """Every value of a patch, twice, and its neighbors `step` before and after it."""
    stride = np.uint64(step)
    for n in range(stride, np.uint64(64) - stride):
        result[n] = np.float64(values[n]) * 2.0 + (np.float64(values[n - stride]) + np.float64(values[n + stride]))


@compiled
def look_up(
    arrays: tuple[Singles, Singles, Singles],
    slopes: Singles | None,
    box: tuple[tuple[int, int, int], tuple[int, int], tuple[int, int], tuple[int, int]],
    coordinates: tuple[Floats, Floats],
    voxels: Integers,
    everywhere: bool,
    found: tuple[Singles, Singles],
) -> None:
    """Probability and direction of bone at some voxels.

    A Sobel gradient is made of the 4 x 4 x 4 values around a place, flat, of which the inner 2 x 2 x 2 get one: differences along its
    axis, then sums along the others in their order, each rounded to float32 as scipy does. Other values are not used. So a bone
    map does not depend on whether numba is there. Branches for an argument that is None are left out when this is compiled.

    Parameters
    ----------
    arrays : probability, flat, potential [k, j, i] and to_reference (3, 3), float32, of `BoneAtVoxels`
    slopes : (3 k j i,) float32 array, or None where they are the Sobel gradient of the potential
    box : shape, planes, rows and columns of the `MapCoordinates`
    coordinates : starts and matrix, float64, of the `MapCoordinates`
    voxels : (m,) int64 array, flat [k, j, i]
    everywhere : bool
        Whether directions are wanted where the probability is 0, too; else they are 0 there.
    found : probability (m,) and directions (m, 3), float32
        Results.
    """
    flat, potential, turn = arrays
    starts, matrix = coordinates
    probability, directions = found
    shape, in_planes, in_rows, in_columns = box
    planes, rows, columns = potential.shape
    patch, rise, summed = np.empty(64, np.float32), np.empty(64, np.float32), np.empty(64, np.float32)
    slope, cube = np.empty(3, np.float32), np.empty(8, np.float32)
    rises = flat if slopes is None else slopes
    # A loop compiles in a fraction of the time of `zeros`
    seen = np.empty(REMEMBERED, np.int64)
    for n in range(REMEMBERED):
        seen[n] = 0
    for n in range(voxels.size):
        # Pixels of a frame meet a voxel several times
        before = seen[voxels[n] % REMEMBERED]
        if before < n and voxels[before] == voxels[n]:
            probability[n] = probability[before]
            for component in range(3):
                directions[n, component] = directions[before, component]
            continue
        seen[voxels[n] % REMEMBERED] = n
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
        wk, wj, wi = at_k - a, at_j - b, at_i - c
        vk, vj, vi = 1.0 - wk, 1.0 - wj, 1.0 - wi
        inner, one = 0 <= a < planes - 1 and 0 <= b < rows - 1 and 0 <= c < columns - 1, (a * rows + b) * columns + c
        for term in range(4):
            if slopes is None:
                if term == 1:
                    # Beyond the border of the map lies what is on it
                    for m in range(16):
                        z, y = min(max(a - 1 + (m >> 2), 0), planes - 1), min(max(b - 1 + (m & 3), 0), rows - 1)
                        for right in range(4):
                            patch[4 * m + right] = potential[z, y, min(max(c - 1 + right, 0), columns - 1)]
                if term > 0:
                    step, other, third = STEPS[term - 1]
                    stride = np.uint64(step)
                    for m in range(stride, np.uint64(64) - stride):
                        rise[m] = np.float64(patch[m + stride]) - np.float64(patch[m - stride])
                    smoothed(rise, other, summed)
                    smoothed(summed, third, rise)
            for corner in range(8):
                z, y, x = corner >> 2, (corner >> 1) & 1, corner & 1
                cube[corner] = 0
                if inner or (0 <= a + z < planes and 0 <= b + y < rows and 0 <= c + x < columns):
                    there = one + (z * rows + y) * columns + x
                    if term == 0:
                        cube[corner] = flat[there]
                    elif slopes is None:
                        cube[corner] = rise[21 + 16 * z + 4 * y + x]
                    else:
                        cube[corner] = rises[(term - 1) * flat.size + there]
            total = ((cube[0] * vk) * vj) * vi
            total += ((cube[1] * vk) * vj) * wi
            total += ((cube[2] * vk) * wj) * vi
            total += ((cube[3] * vk) * wj) * wi
            total += ((cube[4] * wk) * vj) * vi
            total += ((cube[5] * wk) * vj) * wi
            total += ((cube[6] * wk) * wj) * vi
            total += ((cube[7] * wk) * wj) * wi
            if term > 0:
                slope[term - 1] = total
                continue
            probability[n] = total
            if not everywhere and probability[n] == 0:
                break
        if not everywhere and probability[n] == 0:
            continue
        for component in range(3):
            directions[n, component] = (turn[component, 0] * slope[0] + turn[component, 1] * slope[1]) + turn[component, 2] * slope[2]
        along, down, deep = np.float64(directions[n, 0]), np.float64(directions[n, 1]), np.float64(directions[n, 2])
        length = np.sqrt((along * along + down * down) + deep * deep)
        for component in range(3):
            directions[n, component] = directions[n, component] / np.float32(length) if length >= SHORTEST else np.float32(0)
