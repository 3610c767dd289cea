"""Vertebrae told apart by their shape: the bodies are thick and stand in a column, discs lie between them."""

from __future__ import annotations

import numpy as np
import scipy

from ...arrays import Bytes, Floats, Integers, Mask
from ...geometry.box import Box
from ...geometry.transforms import transform_points
from ...geometry.volume import Volume

BODY, THICKEST = 7.5, 22.0
"""mm from the middle of a body to its surface, at least and at most."""

ALIKE = 0.7
"""Of the thickest body, what each is at least: processes are thinner."""

STEP = (15.0, 60.0)
"""mm from one body to the next."""

ASIDE = 35.0
"""mm by which a body may lie beside or before the line through its neighbors."""

LEVEL = 0.5
"""mm between the depths at which bone is flooded from its bodies."""

BLOCK = 1.4
"""mm between the voxels on which bone is divided."""


def in_vertebrae(bone: Mask, ct: Volume, box: Box) -> tuple[Bytes, int]:
    """The vertebrae of bone as labels 1, 2, ... from the uppermost down, and how many there are; all 1 and 0 where they cannot be told.

    Bone that touches no vertebra gets the number after the last.

    Parameters
    ----------
    bone : [k, j, i] bool array
        With its inside.
    ct : Volume
        In RAS, of which the bone is the part `box`.
    """
    whole = bone.astype(np.uint8)
    factors = np.maximum(np.round(BLOCK / ct.spacing[::-1]), 1).astype(int)
    k, j, i = (int(n) for n in factors)
    coarse = bone[::k, ::j, ::i]
    depth = scipy.ndimage.distance_transform_edt(np.pad(coarse, 1), ct.spacing[::-1] * factors)[1:-1, 1:-1, 1:-1]
    # A body that is not filled all through is one all the same
    solid = scipy.ndimage.binary_fill_holes(scipy.ndimage.binary_closing(np.pad(coarse, 3), iterations=2))
    thick = scipy.ndimage.distance_transform_edt(solid, ct.spacing[::-1] * factors)[3:-3, 3:-3, 3:-3]
    seeds, count = scipy.ndimage.label((thick > BODY) & coarse)
    if count < 2:
        return whole, 0
    numbers = np.arange(1, count + 1)
    deepest = np.array(scipy.ndimage.maximum(thick, seeds, numbers))
    middles = np.array(scipy.ndimage.maximum_position(thick, seeds, numbers)).reshape(-1, 3) * factors + [part.start for part in box]
    places = transform_points(ct.ijk_to_reference, middles[:, ::-1].astype(float))
    column = _column(places, deepest)
    if len(column) < 2:
        return whole, 0
    flooded: Integers = np.zeros(coarse.shape, np.int16)
    for label, seed in enumerate(column, 1):
        flooded[seeds == numbers[seed]] = label
    # Flooding from the bodies, thick places first, meets in the narrow ones: joints before pedicles
    for level in np.arange(BODY - LEVEL, -LEVEL / 2, -LEVEL):
        _flood(flooded, depth > max(level, 0.0), len(column))
    flooded = _reached(flooded, coarse, len(column))
    # Every voxel goes with the nearest block
    nearest = scipy.ndimage.distance_transform_edt(flooded == 0, return_distances=False, return_indices=True)
    flooded = flooded[tuple(nearest)]
    wide = flooded.repeat(k, 0).repeat(j, 1).repeat(i, 2)[: bone.shape[0], : bone.shape[1], : bone.shape[2]]
    labels: Bytes = np.where(bone, wide, 0).astype(np.uint8)
    return labels, len(column)


def _flood(flooded: Integers, region: Mask, last: int) -> None:
    """Give every piece of a region that holds labels these labels: the only one, or for each block the nearest."""
    pieces, count = scipy.ndimage.label(region)
    held = np.zeros((count + 1, last + 1), bool)
    held[pieces, flooded] = True
    held[:, 0] = False
    held[0] = False
    several = held.sum(axis=1) > 1
    open_ = region & (flooded == 0)
    only = open_ & ~several[pieces]
    flooded[only] = np.where(held.any(axis=1), held.argmax(axis=1), 0)[pieces[only]]
    shared = open_ & several[pieces]
    if shared.any():
        nearest = scipy.ndimage.distance_transform_edt(flooded == 0, return_distances=False, return_indices=True)
        flooded[shared] = flooded[tuple(axis[shared] for axis in nearest)]


def _column(places: Floats, deepest: Floats) -> Integers:
    """Which of the thick places stand in a column, from the uppermost down; none where they do not."""
    order = np.argsort(-places[:, 2])
    order = order[(deepest[order] >= ALIKE * deepest.max()) & (deepest[order] <= THICKEST)]
    if len(order) < 2:
        return np.empty(0, np.int64)
    # A body's two halves, or a thick process, do not count beside a thicker place at the same height
    kept: list[int] = []
    for place in order.tolist():
        if kept and np.linalg.norm(places[kept[-1]] - places[place]) < STEP[0]:
            kept[-1] = place if deepest[place] > deepest[kept[-1]] else kept[-1]
        else:
            kept.append(place)
    found = np.array(kept)
    steps = np.linalg.norm(np.diff(places[found], axis=0), axis=1)
    aside = np.linalg.norm(places[found, :2] - np.median(places[found, :2], axis=0), axis=1)
    stand = len(found) >= 2 and bool((steps <= STEP[1]).all() and (aside <= ASIDE).all())
    return found if stand else found[:0]


def _reached(flooded: Integers, coarse: Mask, last: int) -> Integers:
    """The flooded blocks, with pieces of bone that hold no body as the number after the last."""
    pieces, count = scipy.ndimage.label(coarse, np.ones((3, 3, 3), int))
    seeded = np.zeros(count + 1, bool)
    seeded[np.unique(pieces[flooded > 0])] = True
    out: Integers = np.where(coarse & ~seeded[pieces], last + 1, flooded)
    return out
