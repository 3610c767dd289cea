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

AVERAGE, LATEST, MAXIMUM, PACKED = range(4)
"""Rules of `insert_plain`."""

HIT = np.uint32(2**20)
"""`HIT` of the state."""

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
def number_voxels(matrix: Matrix, row: int, low: Whole, high: Whole, columns: Floats, part: Floats, voxels: NDArray[np.uint32]) -> None:
    """Write the flat numbers of the voxels at columns [low, high) of a row, all within the part, to `voxels`."""
    base_i = matrix[0, 1] * row + (matrix[0, 3] + 0.5)
    base_j = matrix[1, 1] * row + (matrix[1, 3] + 0.5)
    base_k = matrix[2, 1] * row + (matrix[2, 3] + 0.5)
    step_i, step_j, step_k = matrix[0, 0], matrix[1, 0], matrix[2, 0]
    along, lines, plane = part[0], part[1], part[2]
    j, k = np.floor(base_j + step_j * low), np.floor(base_k + step_k * low)
    # Numbers stay below 2^31: exact in float64. None is negative, so that a conversion to integers rounds down
    if j == np.floor(base_j + step_j * (high - 1)) and k == np.floor(base_k + step_k * (high - 1)):
        # The row runs along a line of voxels: sums that only rise or only fall are the same everywhere if they are at both ends
        line = np.int32(((k - plane) * lines + j) * along)
        for n in range(high - low):
            voxels[n] = np.uint32(line + np.int32(base_i + step_i * columns[low + n]))
    else:
        for n in range(high - low):
            column = columns[low + n]
            i, j, k = np.floor(base_i + step_i * column), np.floor(base_j + step_j * column), np.floor(base_k + step_k * column)
            voxels[n] = np.uint32(np.int32(((k - plane) * lines + j) * along + i))


@inlined
def limited_cosine(beam_x: np.float32, beam_y: np.float32, facing_x: np.float32, facing_y: np.float32) -> np.float32:
    """`rules.cosine_of_incidence`."""
    cosine = beam_x * facing_x + beam_y * facing_y
    cosine = cosine if cosine > ZERO else ZERO
    return cosine if cosine < ONE else ONE


@compiled
def insert_plain(rule: int, frames: Frames, state: Voxels) -> None:
    """Average (sums in float64, or packed with the hits), latest and maximum."""
    images, matrices, pieces, spans, part = frames
    value, hits, _ = state
    columns, voxels = np.arange(images.shape[2]).astype(np.float64), np.empty(images.shape[2], np.uint32)
    for frame in range(images.shape[0]):
        for piece in range(pieces.shape[0]):
            low, high = spans[frame, piece]
            if low >= high:
                continue
            row = pieces[piece, ROW]
            number_voxels(matrices[frame], row, low, high, columns, part, voxels)
            pixels = images[frame, row, low:high]
            if rule == PACKED:
                for n in range(high - low):
                    value[voxels[n]] += value.dtype.type(HIT + np.uint32(pixels[n]))
                continue
            for n in range(high - low):
                voxel = voxels[n]
                pixel = value.dtype.type(pixels[n])
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
    images, matrices, pieces, spans, part = frames
    _, directions, axes, beam_x, beam_y = bone
    columns, voxels = np.arange(images.shape[2]).astype(np.float64), np.empty(images.shape[2], np.uint32)
    for frame in range(images.shape[0]):
        xx, xy, xz, yx, yy, yz = axes[frame]
        for piece in range(pieces.shape[0]):
            low, high = spans[frame, piece]
            if low >= high:
                continue
            number_voxels(matrices[frame], pieces[piece, ROW], low, high, columns, part, voxels)
            beam = pieces[piece, OFFSET] + low - pieces[piece, START]
            for n in range(high - low):
                voxel = voxels[n]
                x, y, z = directions[voxel, 0], directions[voxel, 1], directions[voxel, 2]
                facing_x, facing_y = (x * xx + y * xy) + z * xz, (x * yx + y * yy) + z * yz
                cosine = limited_cosine(beam_x[beam + n], beam_y[beam + n], facing_x, facing_y)
                best[voxel] = cosine if cosine > best[voxel] else best[voxel]


@compiled
def insert_aif(frames: Frames, state: Voxels, bone: Bone, factors: AifFactors) -> None:
    """The paper's running average. Where no bone is expected its weight stays 0, and the rule comes down to the last pixel."""
    images, matrices, pieces, spans, part = frames
    value, hits, weight = state
    probability, directions, axes, beam_x, beam_y = bone
    alpha, beta, maximum, compensated = factors
    columns, voxels = np.arange(images.shape[2]).astype(np.float64), np.empty(images.shape[2], np.uint32)
    for frame in range(images.shape[0]):
        xx, xy, xz, yx, yy, yz = axes[frame]
        for piece in range(pieces.shape[0]):
            low, high = spans[frame, piece]
            if low >= high:
                continue
            row = pieces[piece, ROW]
            number_voxels(matrices[frame], row, low, high, columns, part, voxels)
            beam = pieces[piece, OFFSET] + low - pieces[piece, START]
            for n in range(high - low):
                voxel, pixel = voxels[n], np.float32(images[frame, row, low + n])
                hits[voxel] += ONCE
                expected = probability[voxel]
                if expected == ZERO:
                    value[voxel] = pixel if pixel < maximum else maximum
                    continue
                x, y, z = directions[voxel, 0], directions[voxel, 1], directions[voxel, 2]
                facing_x, facing_y = (x * xx + y * xy) + z * xz, (x * yx + y * yy) + z * yz
                w = limited_cosine(beam_x[beam + n], beam_y[beam + n], facing_x, facing_y)
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
    images, matrices, pieces, spans, part = frames
    value, hits, weight = state
    floor, gain, maximum = factors
    counts = hits.size > 0
    columns, voxels = np.arange(images.shape[2]).astype(np.float64), np.empty(images.shape[2], np.uint32)
    for frame in range(images.shape[0]):
        for piece in range(pieces.shape[0]):
            low, high = spans[frame, piece]
            if low >= high:
                continue
            row = pieces[piece, ROW]
            number_voxels(matrices[frame], row, low, high, columns, part, voxels)
            first = pieces[piece, OFFSET] + low - pieces[piece, START]
            for n in range(high - low):
                voxel, pixel, gate = voxels[n], np.float32(images[frame, row, low + n]), evident[frame, 1, first + n]
                w = (floor + gate) * evident[frame, 0, first + n]
                if gate > ZERO:
                    pixel *= ONE + (gain * gate) * evident[frame, 2, first + n]
                value[voxel] += w * (pixel if pixel < maximum else maximum)
                weight[voxel] += w
                if counts:
                    hits[voxel] += ONCE
