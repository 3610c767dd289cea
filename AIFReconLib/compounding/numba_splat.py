"""Linear interpolation, compiled; see `splat_engine` for the rules."""

from __future__ import annotations

import numpy as np

from ..numba_compile import compiled

AVERAGE, LATEST, MAXIMUM = 0, 1, 2


@compiled
def spread(rule, places, values, importance, size, least_share, value, weight, hits):
    """Pixels enter the voxels around them; returns how many could.

    Parameters
    ----------
    rule : AVERAGE, LATEST or MAXIMUM
    places : (3, n) float64 array, [i, j, k] in voxels
    values : (n,) float32 array
    importance : (n,) float32 array
        Empty where all pixels count alike.
    size : (3,) int64 array, voxels along i, j, k
    least_share : float
        Smallest share of a pixel with which it acts, for rules other than AVERAGE.
    value, weight, hits : (voxels,) arrays
        The state; `weight` is looked at for AVERAGE alone.
    """
    entered = 0
    lower = np.empty(3, np.int64)
    share = np.empty((3, 2))
    for pixel in range(values.shape[0]):
        inside = True
        for axis in range(3):
            floor = np.floor(places[axis, pixel])
            fraction = places[axis, pixel] - floor
            upper = floor + 1.0 if fraction > 0.0 else floor
            if not (floor >= 0.0 and upper <= size[axis] - 1):
                inside = False
                break
            lower[axis] = int(floor)
            share[axis, 0], share[axis, 1] = 1 - fraction, fraction
        if not inside:
            continue
        entered += 1
        for i in range(2):
            for j in range(2):
                for k in range(2):
                    part = share[0, i] * share[1, j] * share[2, k]
                    if part <= 0.0 or (rule != AVERAGE and part < least_share):
                        continue
                    voxel = ((lower[2] + k) * size[1] + lower[1] + j) * size[0] + lower[0] + i
                    hits[voxel] += np.uint32(1)
                    if rule == LATEST:
                        value[voxel] = values[pixel]
                    elif rule == MAXIMUM:
                        value[voxel] = max(value[voxel], values[pixel])
                    else:
                        if importance.shape[0]:
                            part *= importance[pixel]
                        value[voxel] += part * values[pixel]
                        weight[voxel] += part
    return entered
