"""A bone map between its voxels, as compiled loops: the numbers of scipy's interpolation, several times as fast."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Integers, Singles
from ..machine.numba_compile import compiled
from .placed.at_voxels import SHORTEST


@compiled
def look_up(
    arrays: tuple[Singles, Singles, Singles],
    box: tuple[tuple[int, int, int], tuple[int, int], tuple[int, int], tuple[int, int]],
    coordinates: tuple[Floats, Floats],
    voxels: Integers,
    everywhere: bool,
    found: tuple[Singles, Singles],
) -> None:
    """Probability and direction of bone at some voxels.

    Sums run in scipy's order, so that a bone map does not depend on whether numba is there.

    Parameters
    ----------
    arrays : probability [k, j, i], slopes (3, k, j, i) and to_reference (3, 3), float32, of `BoneAtVoxels`
    box : shape, planes, rows and columns of the `MapCoordinates`
    coordinates : starts and matrix, float64, of the `MapCoordinates`
    voxels : (m,) int64 array, flat [k, j, i]
    everywhere : bool
        Whether directions are wanted where the probability is 0, too; else they are 0 there.
    found : probability (m,) and directions (m, 3), float32
        Results.
    """
    values, slopes, turn = arrays
    starts, matrix = coordinates
    probability, directions = found
    shape, in_planes, in_rows, in_columns = box
    planes, rows, columns = values.shape
    slope = np.empty(3, np.float32)
    for n in range(voxels.size):
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
        for term in range(4):
            array, total = values if term == 0 else slopes[term - 1], 0.0
            for corner in range(8):
                z, y, x = corner >> 2, (corner >> 1) & 1, corner & 1
                # Around the map lie zeros
                if 0 <= a + z < planes and 0 <= b + y < rows and 0 <= c + x < columns:
                    along_k = np.float64(array[a + z, b + y, c + x]) * (wk if z else 1.0 - wk)
                    total += (along_k * (wj if y else 1.0 - wj)) * (wi if x else 1.0 - wi)
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
