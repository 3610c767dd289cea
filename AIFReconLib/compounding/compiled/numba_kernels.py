"""The distribution step as compiled loops: a batch of frames into one box of the volume.

Each kernel goes through the frames in time order and through their pixels row by row, and does what falls into its box. Boxes share
no voxel, so that any number of threads gives the voxels of the plain loop over pixels, to the last bit: every operation is that of
`rules` and in its order, none is fused or reassociated.

A row of pixels is a straight line through the volume. What lies within the box is therefore one interval of columns, found once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Floats, Integers, Matrix, Numbers, Reals, Singles
from ...machine.numba_compile import called, compiled, inlined

ZERO, ONE, ONCE = np.float32(0), np.float32(1), np.uint32(1)

ROW, START, STOP, OFFSET = range(4)
"""Columns of `PixelLayout.pieces`."""

AVERAGE, LATEST, MAXIMUM = range(3)
"""Rules of `insert_plain`."""

Whole = int | np.integer
"""Columns and voxels, as they come."""

Frames = tuple[Numbers, Matrix, Integers, Integers, Floats]
"""What is inserted.

images : (frames, rows, columns) uint8 or float32; matrices : (frames, 4, 4) float64, image_to_ijk; pieces : (n, 4) int64; spans : as
`clip` writes them; part : (3,) float64, voxels along i and along j, and the first plane of the state.
"""

Voxels = tuple[Numbers, NDArray[np.uint32], Reals]
"""value, hits, weight : (voxels,) arrays of the state, `weight` and `hits` empty where none are kept."""

Bone = tuple[Singles, Singles, Singles, Singles, Singles]
"""Where bone is, and from where it is seen.

probability : (voxels,) float32; directions : (voxels, 3) float32; axes : (frames, 6) float32, the image's x and y axis in Reference;
beam_x, beam_y : (n,) float32, the beams' directions along them.
"""

AifFactors = tuple[np.float32, np.float32, np.float32, bool]
"""alpha, beta and maximum, and whether to compensate."""

WeightedFactors = tuple[np.float32, np.float32, np.float32]
"""floor, gain and maximum."""


@called
def first_column(step: float, base: float, bound: float, rising: bool, low: Whole, high: Whole) -> Whole:
    """The first column of [low, high] at which a coordinate that rises has reached `bound`, or one that falls is below it.

    Division gives a guess; what decides is the rounded sum itself, as in `PixelLayout.voxels`, and it never turns back.
    """
    guess = (bound - base) / step
    column = low if guess <= low else high if guess >= high else int(guess)
    while column > low and (step * (column - 1) + base >= bound) == rising:
        column -= 1
    while column < high and (step * column + base >= bound) != rising:
        column += 1
    return column


@inlined
def clipped(step: float, base: float, bottom: float, top: float, low: Whole, high: Whole) -> tuple[Whole, Whole]:
    """The columns within [low, high) at which bottom <= step column + base < top."""
    if step == 0.0:
        return (low, high) if bottom <= base < top else (low, low)
    rising = step > 0.0
    enters, leaves = (bottom, top) if rising else (top, bottom)
    first = first_column(step, base, enters, rising, low, high)
    return first, first_column(step, base, leaves, rising, first, high)


@compiled
def clip(matrices: Matrix, pieces: Integers, box: Floats, axis: int, spans: Integers) -> None:
    """Find out which columns of every piece of a row fall into a box.

    Parameters
    ----------
    matrices : (frames, 4, 4) float64 array, image_to_ijk
    pieces : (n, 4) int64 array
    box : (2, 3) float64 array, along i, j, k
        Its first voxel, and the one after its last.
    axis : int
        Along which the box is thin: most pieces are told to miss it there.
    spans : (frames, n, 2) int32 array
        Result: the first column, and the one after the last.
    """
    for frame in range(matrices.shape[0]):
        matrix = matrices[frame]
        for piece in range(pieces.shape[0]):
            row, low, high = pieces[piece, ROW], pieces[piece, START], pieces[piece, STOP]
            for turn in range(3):
                along = (axis + turn) % 3
                if low < high:
                    base = matrix[along, 1] * row + (matrix[along, 3] + 0.5)
                    low, high = clipped(matrix[along, 0], base, box[0, along], box[1, along], low, high)
            spans[frame, piece, 0], spans[frame, piece, 1] = low, high


@inlined
def row_within(frames: Frames, number: int, voxels: NDArray[np.uint32]) -> tuple[int, int, Whole, Whole, Whole]:
    """A row of pixels of all that may fall into the box: frame, row, first column, how many, and the first's number.

    The flat numbers of their voxels within the part are written to `voxels`. No generator: one that numba compiles never lets go of
    the arrays that it was given.
    """
    _, matrices, pieces, spans, part = frames
    frame, piece = divmod(number, pieces.shape[0])
    low, high = spans[frame, piece]
    matrix, row = matrices[frame], pieces[piece, ROW]
    step_i, step_j, step_k = matrix[0, 0], matrix[1, 0], matrix[2, 0]
    base_i = matrix[0, 1] * row + (matrix[0, 3] + 0.5)
    base_j = matrix[1, 1] * row + (matrix[1, 3] + 0.5)
    base_k = matrix[2, 1] * row + (matrix[2, 3] + 0.5)
    for n in range(high - low):
        column = np.float64(low + n)
        i, j, k = np.floor(base_i + step_i * column), np.floor(base_j + step_j * column), np.floor(base_k + step_k * column)
        # Numbers stay below 2^31: exact in float64
        voxels[n] = np.uint32(np.int32(((k - part[2]) * part[1] + j) * part[0] + i))
    return frame, row, low, high - low, pieces[piece, OFFSET] + low - pieces[piece, START]


@inlined
def cosine_at(bone: Bone, frame: int, voxel: Whole, pixel: Whole) -> np.float32:
    """`rules.cosine_of_incidence` of a pixel of a frame in a voxel."""
    directions, axes, beam_x, beam_y = bone[1], bone[2], bone[3], bone[4]
    x, y, z = directions[voxel, 0], directions[voxel, 1], directions[voxel, 2]
    facing_x = (x * axes[frame, 0] + y * axes[frame, 1]) + z * axes[frame, 2]
    facing_y = (x * axes[frame, 3] + y * axes[frame, 4]) + z * axes[frame, 5]
    cosine = beam_x[pixel] * facing_x + beam_y[pixel] * facing_y
    cosine = cosine if cosine > ZERO else ZERO
    return cosine if cosine < ONE else ONE


@compiled
def insert_plain(rule: int, frames: Frames, state: Voxels) -> None:
    """Average, latest and maximum."""
    images, value, hits = frames[0], state[0], state[1]
    voxels = np.empty(images.shape[2], np.uint32)
    for number in range(frames[3].shape[0] * frames[3].shape[1]):
        frame, row, low, count, _ = row_within(frames, number, voxels)
        for n in range(count):
            voxel = voxels[n]
            pixel = value.dtype.type(images[frame, row, low + n])
            if rule == AVERAGE:
                value[voxel] += pixel
            elif rule == LATEST:
                value[voxel] = pixel
            else:
                value[voxel] = pixel if pixel > value[voxel] else value[voxel]
            hits[voxel] += ONCE


@compiled
def insert_cosine(frames: Frames, best: Singles, bone: Bone) -> None:
    """The best cosine of incidence of every voxel, `best` (voxels,) float32."""
    voxels = np.empty(frames[0].shape[2], np.uint32)
    for number in range(frames[3].shape[0] * frames[3].shape[1]):
        frame, _, _, count, first = row_within(frames, number, voxels)
        for n in range(count):
            cosine = cosine_at(bone, frame, voxels[n], first + n)
            best[voxels[n]] = cosine if cosine > best[voxels[n]] else best[voxels[n]]


@compiled
def insert_aif(frames: Frames, state: Voxels, bone: Bone, factors: AifFactors) -> None:
    """The paper's running average. Where no bone is expected its weight stays 0, and the rule comes down to the last pixel."""
    images, probability = frames[0], bone[0]
    value, hits, weight = state
    alpha, beta, maximum, compensated = factors
    voxels = np.empty(images.shape[2], np.uint32)
    for number in range(frames[3].shape[0] * frames[3].shape[1]):
        frame, row, low, count, first = row_within(frames, number, voxels)
        for n in range(count):
            voxel, pixel = voxels[n], np.float32(images[frame, row, low + n])
            hits[voxel] += ONCE
            expected = probability[voxel]
            if expected == ZERO:
                value[voxel] = pixel if pixel < maximum else maximum
                continue
            w = cosine_at(bone, frame, voxel, first + n)
            if compensated and w > beta:
                w = ONE / w
            w *= expected
            new = pixel + (alpha * pixel) * w
            before = weight[voxel]
            value[voxel] = (before * value[voxel] + (new if new < maximum else maximum)) / (before + ONE)
            weight[voxel] = before + w


@compiled
def insert_weighted(frames: Frames, state: Voxels, evident: Singles, factors: WeightedFactors) -> None:
    """The weighted sum; `evident` (frames, 3, n) are reach, gate and compensation of the pixels, the last read where the gate is open."""
    images = frames[0]
    value, hits, weight = state
    floor, gain, maximum = factors
    counts = hits.size > 0
    voxels = np.empty(images.shape[2], np.uint32)
    for number in range(frames[3].shape[0] * frames[3].shape[1]):
        frame, row, low, count, first = row_within(frames, number, voxels)
        for n in range(count):
            voxel, pixel, gate = voxels[n], np.float32(images[frame, row, low + n]), evident[frame, 1, first + n]
            w = (floor + gate) * evident[frame, 0, first + n]
            if gate > ZERO:
                pixel *= ONE + (gain * gate) * evident[frame, 2, first + n]
            value[voxel] += w * (pixel if pixel < maximum else maximum)
            weight[voxel] += w
            if counts:
                hits[voxel] += ONCE
