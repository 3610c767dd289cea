"""The distribution step as compiled loops: a batch of frames into one slab of the volume.

Each kernel goes through the frames in time order and through their pixels row by row, and does what falls into its slab. Slabs share
no voxel, so that any number of threads gives the voxels of the plain loop over pixels, to the last bit: every operation is that of
`rules` and in its order, none is fused or reassociated.

A row of pixels is a straight line through the volume. What lies within volume and slab is therefore one interval of columns, found
once per row; its voxel numbers and weights are then computed as vectors, and only the update of the voxels goes pixel by pixel.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...arrays import Floats, Integers, Matrix, Numbers, Singles
from ...machine.numba_compile import called, compiled, inlined
from .groups import AifFactors, Bone, Evidence, Frames, Slab, Voxels, WeightedFactors, Whole

ZERO, ONE, ONCE = np.float32(0), np.float32(1), np.uint32(1)
LARGEST_COMPENSATION = np.float32(3)

ROW, START, STOP, OFFSET = range(4)
"""Columns of `RowPieces.table`."""

LOW, HIGH, NEAREST, FARTHEST = range(4)
"""Last axis of the spans: columns [low, high) of a piece that lie in the volume, and their range of voxels along the slabs' axis."""

AVERAGE, LATEST, MAXIMUM, PACKED = range(4)
"""Rules of `insert_plain`."""

HIT = np.uint32(2**20)
"""`HIT` of the state."""


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
def clip_to_volume(matrices: Matrix, pieces: Integers, bounds: Floats, axis: int, spans: Integers) -> None:
    """Find out which columns of every piece of a row fall into the volume, and between which voxels along `axis` they lie.

    Parameters
    ----------
    matrices : (frames, 4, 4) float64 array, image_to_ijk
    pieces : (n, 4) int64 array
    bounds : (2, 3) float64 array, along i, j, k
        The first voxel of the part that counts, and the one after the last.
    spans : (frames, n, 4) int32 array
        Result.
    """
    for frame in range(matrices.shape[0]):
        matrix = matrices[frame]
        for piece in range(pieces.shape[0]):
            row, low, high = pieces[piece, ROW], pieces[piece, START], pieces[piece, STOP]
            for along in range(3):
                base = matrix[along, 1] * row + (matrix[along, 3] + 0.5)
                low, high = clipped(matrix[along, 0], base, bounds[0, along], bounds[1, along], low, high)
            high = max(low, high)
            base = matrix[axis, 1] * row + (matrix[axis, 3] + 0.5)
            one, other = np.floor(matrix[axis, 0] * low + base), np.floor(matrix[axis, 0] * (high - 1) + base)
            spans[frame, piece, LOW], spans[frame, piece, HIGH] = low, high
            inside = low < high
            spans[frame, piece, NEAREST] = np.int32(min(one, other)) if inside else np.int32(0)
            spans[frame, piece, FARTHEST] = np.int32(max(one, other)) if inside else np.int32(-1)


@inlined
def misses(spans: Integers, frame: int, piece: int, slab: Slab) -> bool:
    """Whether nothing of a piece lies in the slab.

    A function of its own, so small that compilers put it into the loop: most pieces get no further.
    """
    beside: bool = spans[frame, piece, FARTHEST] < slab[1] or spans[frame, piece, NEAREST] >= slab[2]
    return beside


@inlined
def span_in_slab(matrices: Matrix, pieces: Integers, spans: Integers, frame: int, piece: int, slab: Slab) -> tuple[Whole, Whole]:
    """The columns [low, high) of a piece that lie in the slab.

    Whole arrays come in, because a view for each of so many pieces would cost more than the rest.
    """
    axis, bottom, top = slab
    low: Whole = np.int64(spans[frame, piece, LOW])
    high: Whole = np.int64(spans[frame, piece, HIGH])
    if spans[frame, piece, NEAREST] < bottom or spans[frame, piece, FARTHEST] >= top:
        base = matrices[frame, axis, 1] * pieces[piece, ROW] + (matrices[frame, axis, 3] + 0.5)
        low, high = clipped(matrices[frame, axis, 0], base, float(bottom), float(top), low, high)
    return low, high


@compiled
def clip_to_slab(matrices: Matrix, pieces: Integers, spans: Integers, slab: Slab, columns: Integers) -> None:
    """Find out which columns of every piece lie in a slab.

    Arguments as in `clip_to_volume`; the result, `columns` (frames, n, 2) int32, gets the first column and the one after the last.
    """
    for frame in range(matrices.shape[0]):
        for piece in range(pieces.shape[0]):
            low: Whole = np.int64(0)
            high: Whole = np.int64(0)
            if not misses(spans, frame, piece, slab):
                low, high = span_in_slab(matrices, pieces, spans, frame, piece, slab)
            columns[frame, piece, 0], columns[frame, piece, 1] = low, high


@inlined
def number_voxels(matrix: Matrix, row: int, columns: Floats, bounds: Floats, voxels: NDArray[np.uint32]) -> None:
    """Write the flat numbers of the voxels at `columns` (n,) float64 of a row, all within the part, to `voxels` (more than n,).

    After them follows a number that is not that of the voxel before it: it ends the last run of pixels in one voxel without a test.
    """
    count, along, rows, before = columns.size, bounds[1, 0], bounds[1, 1], bounds[0, 2]
    base_i = matrix[0, 1] * row + (matrix[0, 3] + 0.5)
    base_j = matrix[1, 1] * row + (matrix[1, 3] + 0.5)
    base_k = matrix[2, 1] * row + (matrix[2, 3] + 0.5)
    step_i, step_j, step_k = matrix[0, 0], matrix[1, 0], matrix[2, 0]
    first, last = columns[0], columns[count - 1]
    j, k = np.floor(base_j + step_j * first), np.floor(base_k + step_k * first)
    # Numbers stay below 2^31: exact in float64. None is negative, so that a conversion to integers rounds down
    if j == np.floor(base_j + step_j * last) and k == np.floor(base_k + step_k * last):
        # The row runs along a line of voxels: sums that only rise or only fall are the same everywhere if they are at both ends
        line = np.int32(((k - before) * rows + j) * along)
        for n in range(count):
            voxels[n] = np.uint32(line + np.int32(base_i + step_i * columns[n]))
    else:
        for n in range(count):
            column = columns[n]
            i, j, k = np.floor(base_i + step_i * column), np.floor(base_j + step_j * column), np.floor(base_k + step_k * column)
            voxels[n] = np.uint32(np.int32(((k - before) * rows + j) * along + i))
    voxels[count] = ~voxels[count - 1]


@inlined
def columns_of(images: Numbers) -> Floats:
    """The columns of an image as float64: reading them is faster than to convert counters, which some processors do one by one."""
    # A loop compiles in a third of the time of `arange`
    columns = np.empty(images.shape[2], np.float64)
    for column in range(columns.size):
        columns[column] = column
    return columns


@inlined
def limited_cosine(beam_x: np.float32, beam_y: np.float32, facing_x: np.float32, facing_y: np.float32) -> np.float32:
    """`rules.cosine_of_incidence`."""
    cosine = beam_x * facing_x + beam_y * facing_y
    cosine = cosine if cosine > ZERO else ZERO
    return cosine if cosine < ONE else ONE


@compiled
def insert_plain(rule: int, frames: Frames, slab: Slab, state: Voxels, entered: Integers) -> None:
    """Average (sums in float64, or packed with the hits), latest and maximum; raises `entered` (frames,) by the pixels that entered."""
    images, matrices, pieces, spans, bounds = frames
    value, hits, _ = state
    columns, voxels = columns_of(images), np.empty(images.shape[2] + 1, np.uint32)
    for frame in range(images.shape[0]):
        for piece in range(pieces.shape[0]):
            if misses(spans, frame, piece, slab):
                continue
            low, high = span_in_slab(matrices, pieces, spans, frame, piece, slab)
            if low >= high:
                continue
            row, count = pieces[piece, ROW], high - low
            number_voxels(matrices[frame], row, columns[low:high], bounds, voxels)
            pixels = images[frame, row, low:high]
            if rule == PACKED:
                # From two places at a time: what goes into one voxel needs not wait for what has just gone into the same
                half = count // 2
                for n in range(half):
                    value[voxels[n]] += value.dtype.type(HIT + np.uint32(pixels[n]))
                    value[voxels[n + half]] += value.dtype.type(HIT + np.uint32(pixels[n + half]))
                for n in range(2 * half, count):
                    value[voxels[n]] += value.dtype.type(HIT + np.uint32(pixels[n]))
            elif rule == AVERAGE:
                for n in range(count):
                    value[voxels[n]] += pixels[n]
                    hits[voxels[n]] += ONCE
            elif rule == LATEST:
                for n in range(count):
                    value[voxels[n]] = pixels[n]
                    hits[voxels[n]] += ONCE
            else:
                for n in range(count):
                    pixel = value.dtype.type(pixels[n])
                    value[voxels[n]] = pixel if pixel > value[voxels[n]] else value[voxels[n]]
                    hits[voxels[n]] += ONCE
            entered[frame] += count


@compiled
def insert_cosine(frames: Frames, slab: Slab, best: Singles, bone: Bone) -> None:
    """The best cosine of incidence of every voxel, `best` (voxels,) float32."""
    images, matrices, pieces, spans, bounds = frames
    _, directions, axes, beam_x, beam_y = bone
    columns, voxels = columns_of(images), np.empty(images.shape[2] + 1, np.uint32)
    for frame in range(images.shape[0]):
        xx, xy, xz, yx, yy, yz = axes[frame]
        for piece in range(pieces.shape[0]):
            if misses(spans, frame, piece, slab):
                continue
            low, high = span_in_slab(matrices, pieces, spans, frame, piece, slab)
            if low >= high:
                continue
            row, count = pieces[piece, ROW], high - low
            number_voxels(matrices[frame], row, columns[low:high], bounds, voxels)
            beam = pieces[piece, OFFSET] + low - pieces[piece, START]
            along_x, along_y = beam_x[beam : beam + count], beam_y[beam : beam + count]
            for n in range(count):
                voxel = voxels[n]
                x, y, z = directions[voxel, 0], directions[voxel, 1], directions[voxel, 2]
                facing_x, facing_y = (x * xx + y * xy) + z * xz, (x * yx + y * yy) + z * yz
                cosine = limited_cosine(along_x[n], along_y[n], facing_x, facing_y)
                best[voxel] = cosine if cosine > best[voxel] else best[voxel]


@compiled
def insert_aif(frames: Frames, slab: Slab, state: Voxels, bone: Bone, factors: AifFactors, entered: Integers) -> None:
    """The paper's running average. Arguments as in `insert_plain`, and those that have their own types.

    Notes
    -----
    What belongs to the voxel is held while its pixels last. Where no bone is expected its weight stays 0, and the rule comes down to
    the last pixel.
    """
    images, matrices, pieces, spans, bounds = frames
    value, hits, weight = state
    probability, directions, axes, beam_x, beam_y = bone
    alpha, beta, maximum, compensated = factors
    columns, voxels = columns_of(images), np.empty(images.shape[2] + 1, np.uint32)
    for frame in range(images.shape[0]):
        xx, xy, xz, yx, yy, yz = axes[frame]
        for piece in range(pieces.shape[0]):
            if misses(spans, frame, piece, slab):
                continue
            low, high = span_in_slab(matrices, pieces, spans, frame, piece, slab)
            if low >= high:
                continue
            row, count = pieces[piece, ROW], high - low
            number_voxels(matrices[frame], row, columns[low:high], bounds, voxels)
            beam = pieces[piece, OFFSET] + low - pieces[piece, START]
            along_x, along_y, pixels = beam_x[beam : beam + count], beam_y[beam : beam + count], images[frame, row, low:high]
            # Unsigned, so that no index is tested for being negative
            n = np.uint32(0)
            while n < count:
                voxel, start = voxels[n], n
                expected = probability[voxel]
                if expected == ZERO:
                    while voxels[n] == voxel:
                        n += ONCE
                    pixel = np.float32(pixels[n - ONCE])
                    value[voxel] = pixel if pixel < maximum else maximum
                    hits[voxel] += n - start
                    continue
                x, y, z = directions[voxel, 0], directions[voxel, 1], directions[voxel, 2]
                facing_x, facing_y = (x * xx + y * xy) + z * xz, (x * yx + y * yy) + z * yz
                now, before = value[voxel], weight[voxel]
                while voxels[n] == voxel:
                    pixel = np.float32(pixels[n])
                    w = limited_cosine(along_x[n], along_y[n], facing_x, facing_y)
                    if compensated:
                        inverse = ONE / (w if w > beta else beta)
                        w = inverse if w > beta else w
                    w *= expected
                    new = pixel + (alpha * pixel) * w
                    now = (before * now + (new if new < maximum else maximum)) / (before + ONE)
                    before += w
                    n += ONCE
                value[voxel], weight[voxel] = now, before
                hits[voxel] += n - start
            entered[frame] += count


@inlined
def first_from(numbers: Integers, frame: int, count: int, least: Whole) -> int:
    """Where in the rising `numbers[frame, :count]` those from `least` on begin."""
    low, high = 0, count
    while low < high:
        middle = (low + high) // 2
        if numbers[frame, middle] < least:
            low = middle + 1
        else:
            high = middle
    return low


@compiled
def insert_weighted(frames: Frames, slab: Slab, state: Voxels, factors: WeightedFactors, evidence: Evidence, entered: Integers) -> None:
    """The weighted sum. Arguments as in `insert_plain`, and those that have their own types.

    Notes
    -----
    Without an onset, as nearly everywhere, the weight is floor R and the value is the pixel.
    """
    images, matrices, pieces, spans, bounds = frames
    value, hits, weight = state
    counts = hits.size > 0
    floor, gain, beta, maximum = factors
    reach, begins, onset, expected, cosine, onsets = evidence
    columns, voxels = columns_of(images), np.empty(images.shape[2] + 1, np.uint32)
    width = images.shape[2]
    weights, raised = np.empty(width, np.float32), np.empty(width, np.float32)
    for frame in range(images.shape[0]):
        for piece in range(pieces.shape[0]):
            if misses(spans, frame, piece, slab):
                continue
            low, high = span_in_slab(matrices, pieces, spans, frame, piece, slab)
            if low >= high:
                continue
            row, count = pieces[piece, ROW], high - low
            number_voxels(matrices[frame], row, columns[low:high], bounds, voxels)
            beam = pieces[piece, OFFSET] + low - pieces[piece, START]
            pixels = images[frame, row, low:high]
            reached = reach[frame, beam : beam + count]
            for n in range(count):
                weights[n] = floor * reached[n]
            for n in range(count):
                pixel = np.float32(pixels[n])
                raised[n] = weights[n] * (pixel if pixel < maximum else maximum)
            for place in range(first_from(begins, frame, onsets[frame], beam), onsets[frame]):
                n = np.int64(begins[frame, place]) - beam
                if n >= count:
                    break
                pixel, probability = np.float32(pixels[n]), expected[frame, place]
                gate = (onset[frame, place] * probability) * probability
                w = (floor + gate) * reached[n]
                if gate > ZERO:
                    facing = cosine[frame, place]
                    inverse = ONE / (facing if facing > beta else beta)
                    inverse = inverse if inverse < LARGEST_COMPENSATION else LARGEST_COMPENSATION
                    pixel *= ONE + (gain * gate) * (inverse if facing > beta else ONE)
                weights[n] = w
                raised[n] = w * (pixel if pixel < maximum else maximum)
            next_pixel = np.uint32(0)
            while next_pixel < count:
                voxel, start = voxels[next_pixel], next_pixel
                total, weighed = value[voxel], weight[voxel]
                while voxels[next_pixel] == voxel:
                    total += raised[next_pixel]
                    weighed += weights[next_pixel]
                    next_pixel += ONCE
                value[voxel], weight[voxel] = total, weighed
                if counts:
                    hits[voxel] += next_pixel - start
            entered[frame] += count
