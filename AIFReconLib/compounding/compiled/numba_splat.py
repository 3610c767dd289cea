"""Linear interpolation on all processor cores: the same voxels as `SplatEngine`, to the last bit.

Slabs share no voxel: a pixel whose corners lie in two of them is met in both, and gives each its own.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Floats, Integers, Mask, Matrix, Numbers, Singles
from ...machine.numba_compile import compiled, inlined
from ..batch import FrameBatch
from ..evidence import ScanLines
from ..layout import CENTER_TOLERANCE, PixelLayout
from ..methods import average, latest, maximum
from ..splat_engine import weights_of
from .numba_kernels import OFFSET, ROW, START, STOP, Voxels
from .slabs import Put, SlabEngine

AVERAGE, LATEST, MAXIMUM = range(3)
SPREAD_RULES = {average.AVERAGE.name: AVERAGE, latest.LATEST.name: LATEST, maximum.MAXIMUM.name: MAXIMUM}
ONCE = np.uint32(1)

SplatFrames = tuple[Numbers, Matrix, Integers, Integers, Floats, Singles]
"""What is spread. images, matrices, pieces, spans : as in `Frames`; coordinates : (2, pixels) float64, column and row where the layout's
pixels truly are, empty where they are as shown; importance : (pixels,) float32, empty where all count alike."""


@inlined
def place_along(along: Floats, columns: Floats, rows: Floats, places: Floats) -> None:
    """`PixelLayout.places` of pixels along one axis, (n,): `along` is a row of the matrix."""
    step, across, start = along[0], along[1], along[3]
    for n in range(places.size):
        place = step * columns[n] + across * rows[n] + start
        whole = np.rint(place)
        places[n] = whole if abs(place - whole) < CENTER_TOLERANCE else place


@inlined
def give(voxel: int, share: float, pixel: np.float32, state: Voxels) -> None:
    """A share of a pixel enters the average of a voxel."""
    value, hits, weight = state
    at = np.uint64(voxel)
    hits[at] += ONCE
    value[at] += share * pixel
    weight[at] += share


@compiled
def spread(rule: int, frames: SplatFrames, box: Integers, size: Integers, least_share: float, state: Voxels, entered: Integers) -> None:
    """Pixels enter those of the eight voxels around them that lie in a box.

    Parameters
    ----------
    rule : AVERAGE, LATEST or MAXIMUM
    box : (2, 3) int64 array, along i, j, k
        Its first voxel, and the one after its last.
    size : (4,) int64 array
        Voxels along i, j, k, and the first plane of the part that the state is of.
    least_share : float
        Smallest share of a pixel with which it acts, for rules other than AVERAGE.
    state : Voxels
        `weight` is looked at for AVERAGE alone.
    entered : (frames,) int64 array
        Result: raised by the pixels that enter and whose lower corner lies in the box.
    """
    images, matrices, pieces, spans, coordinates, importance = frames
    value, hits, _ = state
    line, plane, first_plane = size[0], size[0] * size[1], size[3]
    last_i, last_j, last_k = float(size[0] - 1), float(size[1] - 1), float(size[2] - 1)
    (from_i, from_j, from_k), (to_i, to_j, to_k) = box
    width = images.shape[2]
    all_columns, same_row, places = np.arange(width).astype(np.float64), np.empty(width), np.empty((3, width))
    for frame in range(images.shape[0]):
        for piece in range(pieces.shape[0]):
            row, low, high = pieces[piece, ROW], spans[frame, piece, 0], spans[frame, piece, 1]
            first_number = pieces[piece, OFFSET] + low - pieces[piece, START]
            same_row[:] = row
            x, y = all_columns[low:high], same_row[low:high]
            if coordinates.size:
                x, y = coordinates[0, first_number : first_number + high - low], coordinates[1, first_number : first_number + high - low]
            for axis in range(3):
                place_along(matrices[frame, axis], x, y, places[axis, : high - low])
            for n in range(high - low):
                i, j, k = places[0, n], places[1, n], places[2, n]
                # As numbers with fractions: those of far-off places fit no integer. A corner of share 0 need not lie in the volume
                if not (0.0 <= i <= last_i and 0.0 <= j <= last_j and 0.0 <= k <= last_k):
                    continue
                low_i, low_j, low_k = int(i), int(j), int(k)
                part_i, part_j, part_k = i - low_i, j - low_j, k - low_k
                entered[frame] += from_i <= low_i < to_i and from_j <= low_j < to_j and from_k <= low_k < to_k
                pixel = np.float32(images[frame, row, low + n])
                factor = float(importance[first_number + n]) if importance.size else 1.0
                first = (low_k - first_plane) * plane + low_j * line + low_i
                amid = from_i <= low_i < to_i - 1 and from_j <= low_j < to_j - 1 and from_k <= low_k < to_k - 1
                if rule == AVERAGE and amid and part_i > 0.0 and part_j > 0.0 and part_k > 0.0:
                    # As nearly always; the loop below would do the same, in three times as long
                    rest_i, rest_j, rest_k = 1.0 - part_i, 1.0 - part_j, 1.0 - part_k
                    one, two, three, four = rest_i * rest_j, part_i * rest_j, rest_i * part_j, part_i * part_j
                    give(first, one * rest_k * factor, pixel, state)
                    give(first + 1, two * rest_k * factor, pixel, state)
                    give(first + line, three * rest_k * factor, pixel, state)
                    give(first + line + 1, four * rest_k * factor, pixel, state)
                    give(first + plane, one * part_k * factor, pixel, state)
                    give(first + plane + 1, two * part_k * factor, pixel, state)
                    give(first + plane + line, three * part_k * factor, pixel, state)
                    give(first + plane + line + 1, four * part_k * factor, pixel, state)
                    continue
                for corner in range(8):
                    right, down, behind = corner & 1, (corner >> 1) & 1, corner >> 2
                    at_i, at_j, at_k = low_i + right, low_j + down, low_k + behind
                    if not (from_i <= at_i < to_i and from_j <= at_j < to_j and from_k <= at_k < to_k):
                        continue
                    share = (part_i if right else 1.0 - part_i) * (part_j if down else 1.0 - part_j) * (part_k if behind else 1.0 - part_k)
                    if share <= 0.0 or (rule != AVERAGE and share < least_share):
                        continue
                    voxel = first + right + down * line + behind * plane
                    if rule == AVERAGE:
                        give(voxel, share * factor, pixel, state)
                        continue
                    hits[np.uint64(voxel)] += ONCE
                    value[np.uint64(voxel)] = pixel if rule == LATEST else max(value[np.uint64(voxel)], pixel)


class NumbaSplatEngine(SlabEngine):
    """`SplatEngine` for linear interpolation, compiled."""

    # A pixel's corners are one voxel from the voxel that is nearest to it
    margin = 1.0

    def _counting(self, layout: PixelLayout) -> Mask | bool:
        importance = weights_of(layout, self.job.importance)
        return True if importance is None else layout.filled(importance > 0)

    def _put(self, batch: FrameBatch, frames: slice, layout: PixelLayout, scan_lines: ScanLines | None) -> Put:
        images, matrices, state = batch.images[frames], batch.image_to_ijk[frames], self.state
        importance = weights_of(layout, self.job.importance)
        pixels = np.empty((2, 0)) if layout.moved is None else layout.moved, np.empty(0, np.float32) if importance is None else importance
        voxels = state.value, state.hits, np.empty(0) if state.weight is None else state.weight
        size = np.array([*self.job.grid_size, self.job.planes[0]])
        rule, least = SPREAD_RULES[self.method.name], self.method.least_share

        def put(pieces: Integers, box: Floats, spans: Integers) -> Integers:
            entered = np.zeros(len(images), np.int64)
            if layout.moved is not None:
                spans[:] = pieces[:, [START, STOP]]
            spread(rule, (images, matrices, pieces, spans, *pixels), box.astype(np.int64), size, least, voxels, entered)
            return entered

        return put
