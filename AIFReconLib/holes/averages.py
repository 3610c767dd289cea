"""Holes filled with an average of the measured voxels in a cube around them, as the Plus toolkit defines it; see `igsio_hole_filling`.

Each function here takes

values, known : [k, j, i] arrays
    `known` says which voxels are measured.
holes : (holes, 3) int array, [k, j, i]
    All at places where `known` is False.
kind : HoleFilling
    Which average.
hits : [k, j, i] array or None
    How many pixels entered each voxel; `gaussian_by_hits` alone asks.

and returns

found : (holes,) bool array
    Which have enough known voxels around them.
averages : (found,) float64 array
    Their values.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from ..arrays import Floats, Integers, Mask, Numbers
from .filling import HoleFilling

MOST_HITS = 65535 / 256
"""Pixels in one voxel beyond which IGSIO counts no further."""


def gaussian(values: Numbers, known: Mask, holes: Integers, kind: HoleFilling) -> tuple[Mask, Floats]:
    """sum(v g) / sum(g), g a Gaussian of the distance."""
    return _averaged(values, known, holes, kind, _gaussian_sum(kind))


def gaussian_by_hits(values: Numbers, known: Mask, holes: Integers, kind: HoleFilling, hits: Numbers | None = None) -> tuple[Mask, Floats]:
    """sum(v g n) / sum(g n), n the hits of a voxel, up to `MOST_HITS`."""
    counts = None if hits is None else np.minimum(hits, MOST_HITS)
    return _averaged(values, known, holes, kind, _gaussian_sum(kind), counts)


def inverse_distance(values: Numbers, known: Mask, holes: Integers, kind: HoleFilling) -> tuple[Mask, Floats]:
    """sum(v / d) / sum(1 / d), d the distance in voxels."""
    z, y, x = np.meshgrid(*[_offsets(kind.size)] * 3, indexing="ij")
    distance = np.sqrt(x * x + y * y + z * z)
    kernel = np.divide(1.0, distance, out=np.zeros_like(distance), where=distance > 0)
    return _averaged(values, known, holes, kind, lambda array: _kernel_sum(array, kernel))


def nearest_cube(values: Numbers, known: Mask, holes: Integers, kind: HoleFilling) -> tuple[Mask, Floats]:
    """The mean of the known voxels of the first cube (sides 3, 5, ... size) with any; it must have enough of them."""
    found, result = np.zeros(len(holes), dtype=bool), np.zeros(len(holes))
    known_values = np.where(known, values, 0).astype(np.float64)
    left = np.arange(len(holes))
    for reach in range(1, kind.reach + 1):
        number = _known_around(known, holes[left], reach)
        # None is never enough
        enough = number / kind.size**3 > kind.known_ratio
        here, left, number = left[enough], left[number == 0], number[enough]
        if here.size:
            total = _box_sum_of(np.ones(2 * reach + 1))(known_values)[tuple(holes[here].T)]
            found[here], result[here] = True, total / number
        if not left.size:
            break
    return found, result[found]


def _averaged(
    values: Numbers,
    known: Mask,
    holes: Integers,
    kind: HoleFilling,
    weighted_sum: Callable[[Floats], Floats],
    hits: Numbers | None = None,
) -> tuple[Mask, Floats]:
    """The average of known voxels around each hole; `weighted_sum` sums an array over the cube around each voxel."""
    number = _known_around(known, holes, (kind.size - 1) // 2)
    found = (number > 0) & (number / kind.size**3 > kind.known_ratio)
    at = tuple(holes[found].T)
    counts = known.astype(np.float64)
    if hits is not None:
        np.multiply(counts, hits, out=counts, where=known)
    total = weighted_sum(counts)[at]
    np.multiply(counts, values, out=counts, where=known)
    averages = np.divide(weighted_sum(counts)[at], total, out=np.zeros(len(total)), where=total > 0)
    # Weights so small that nothing is left of them are no reason for a value
    found[found] = total > 0
    return found, averages[total > 0]


def _known_around(known: Mask, holes: Integers, reach: int) -> Floats:
    """How many known voxels are in the cube that reaches so far to each side of each hole."""
    number: Floats = np.rint(_box_sum_of(np.ones(2 * reach + 1))(known.astype(np.float64))[tuple(holes.T)])
    return number


def _offsets(size: int) -> Floats:
    """Distances from a hole along an axis, in voxels. An even size is centered between voxels, as in IGSIO."""
    reach = (size - 1) // 2
    return np.arange(2 * reach + 1, dtype=np.float64) - (size - 1) / 2


def _gaussian_sum(kind: HoleFilling) -> Callable[[Floats], Floats]:
    return _box_sum_of(np.exp(-(_offsets(kind.size) ** 2) / (2.0 * kind.stdev**2)))


def _box_sum_of(weights: Floats) -> Callable[[Floats], Floats]:
    """The sum over the cube around each voxel, with these weights along each axis; nothing lies outside the volume."""

    def summed(array: Floats) -> Floats:
        for axis in range(3):
            array = np.asarray(scipy.ndimage.correlate1d(array, weights, axis=axis, mode="constant", cval=0.0), dtype=np.float64)
        return array

    return summed


def _kernel_sum(array: Floats, kernel: Floats) -> Floats:
    """The sum over the cube around each voxel, with the weights of an odd-sized `kernel`; nothing lies outside the volume."""
    # A correlation: the kernel the other way round. "same" would be as large as the larger of both
    whole = scipy.signal.fftconvolve(array, kernel[::-1, ::-1, ::-1])
    return np.asarray(whole)[tuple(slice(k // 2, k // 2 + n) for n, k in zip(array.shape, kernel.shape, strict=True))]
