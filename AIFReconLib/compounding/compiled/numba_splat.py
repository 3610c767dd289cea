"""Linear interpolation on all processor cores: the same voxels as `SplatEngine`, to the last bit.

Slabs share no voxel: a pixel whose corners lie in two of them is met in both, and gives each its own.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...arrays import Floats, Integers, Mask
from ...machine.numba_compile import compiled, inlined
from ..batch import FrameBatch
from ..engine import Job
from ..evidence import ScanLines
from ..layout import CENTER_TOLERANCE, PixelLayout
from ..methods import average, latest, maximum
from ..splat_engine import weights_of
from .groups import Pixels, Slab, SplatFrames, Voxels
from .numba_kernels import OFFSET, ROW, START, STOP, clip_to_slab, clip_to_volume
from .slabs import SlabEngine, cut_into_slabs

AVERAGE, LATEST, MAXIMUM = range(3)
SPREAD_RULES = {average.AVERAGE.name: AVERAGE, latest.LATEST.name: LATEST, maximum.MAXIMUM.name: MAXIMUM}
ONCE, NEXT = np.uint32(1), np.uint64(1)


@inlined
def place_along(along: Floats, columns: Floats, rows: Floats, tolerance: float, places: Floats) -> None:
    """`PixelLayout.places` of pixels along one axis, (n,): `along` is a row of the matrix."""
    for n in range(places.size):
        place = along[0] * columns[n] + along[1] * rows[n] + along[3]
        whole = np.rint(place)
        places[n] = whole if abs(place - whole) < tolerance else place


@inlined
def give(voxel: np.uint64, share: float, pixel: np.float32, state: Voxels) -> None:
    """A share of a pixel enters the average of a voxel."""
    value, hits, weight = state
    hits[voxel] += ONCE
    value[voxel] += share * pixel
    weight[voxel] += share


@inlined
def give_to_all(
    first: np.uint64, line: int, plane: int, part: tuple[float, float, float], factor: float, pixel: np.float32, state: Voxels
) -> None:
    """A pixel enters the averages of all eight voxels around it, of which `first` is the lower one."""
    part_i, part_j, part_k = part
    rest_i, rest_j, rest_k = 1.0 - part_i, 1.0 - part_j, 1.0 - part_k
    one, two, three, four = rest_i * rest_j, part_i * rest_j, rest_i * part_j, part_i * part_j
    below, far = first + np.uint64(line), first + np.uint64(plane)
    beyond = below + np.uint64(plane)
    give(first, (one * rest_k) * factor, pixel, state)
    give(first + NEXT, (two * rest_k) * factor, pixel, state)
    give(below, (three * rest_k) * factor, pixel, state)
    give(below + NEXT, (four * rest_k) * factor, pixel, state)
    give(far, (one * part_k) * factor, pixel, state)
    give(far + NEXT, (two * part_k) * factor, pixel, state)
    give(beyond, (three * part_k) * factor, pixel, state)
    give(beyond + NEXT, (four * part_k) * factor, pixel, state)


@compiled
def spread(
    rule: int,
    frames: SplatFrames,
    slab: Slab,
    pixels: Pixels,
    tolerance: float,
    least_share: float,
    state: Voxels,
    entered: Integers,
) -> None:
    """Pixels enter those of the eight voxels around them that lie in a slab.

    Parameters
    ----------
    rule : AVERAGE, LATEST or MAXIMUM
    tolerance : float, voxels
        As in `PixelLayout.places`.
    least_share : float
        Smallest share of a pixel with which it acts, for rules other than AVERAGE.
    state : Voxels
        `weight` is looked at for AVERAGE alone.
    entered : (frames,) int64 array
        Result: raised by the pixels that enter and whose lower corner lies in the slab.
    """
    images, matrices, pieces, columns, size = frames
    axis, bottom, top = slab
    first_plane, stop_plane = size[3], size[4]
    coordinates, importance = pixels
    value, hits, _ = state
    line, plane = size[0], size[0] * size[1]
    last_i, last_j, last_k = float(size[0] - 1), float(size[1] - 1), float(size[2] - 1)
    equal, as_shown = importance.size == 0, coordinates.size == 0
    width = images.shape[2]
    all_columns, same_row = np.arange(width).astype(np.float64), np.empty(width)
    places_i, places_j, places_k = np.empty(width), np.empty(width), np.empty(width)
    for frame in range(images.shape[0]):
        m = matrices[frame]
        for piece in range(pieces.shape[0]):
            row = pieces[piece, ROW]
            low, high = columns[frame, piece, 0], columns[frame, piece, 1]
            if low >= high:
                continue
            count, first_number = high - low, pieces[piece, OFFSET] + low - pieces[piece, START]
            if as_shown:
                same_row[:] = row
                x, y = all_columns[low:high], same_row[:count]
            else:
                x, y = coordinates[0, first_number : first_number + count], coordinates[1, first_number : first_number + count]
            place_along(m[0], x, y, tolerance, places_i[:count])
            place_along(m[1], x, y, tolerance, places_j[:count])
            place_along(m[2], x, y, tolerance, places_k[:count])
            for n in range(count):
                i, j, k = places_i[n], places_j[n], places_k[n]
                # As numbers with fractions: those of far-off places fit no integer. A corner of share 0 need not lie in the volume
                if not (0.0 <= i <= last_i and 0.0 <= j <= last_j and 0.0 <= k <= last_k):
                    continue
                low_i, low_j, low_k = int(i), int(j), int(k)
                part_i, part_j, part_k = i - low_i, j - low_j, k - low_k
                lower = low_i if axis == 0 else low_j if axis == 1 else low_k
                if lower + 1 < bottom or lower >= top:
                    continue
                entered[frame] += lower >= bottom
                pixel = np.float32(images[frame, row, low + n])
                factor = 1.0 if equal else float(importance[first_number + n])
                first = ((low_k - first_plane) * plane + low_j * line) + low_i
                amid = bottom <= lower < top - 1 and first_plane <= low_k < stop_plane - 1
                if rule == AVERAGE and amid and part_i > 0.0 and part_j > 0.0 and part_k > 0.0:
                    # As nearly always; the loop below would do the same, slowly
                    give_to_all(np.uint64(first), line, plane, (part_i, part_j, part_k), factor, pixel, state)
                    continue
                for corner in range(8):
                    right, down, behind = corner & 1, (corner >> 1) & 1, corner >> 2
                    along = lower + (right if axis == 0 else down if axis == 1 else behind)
                    if along < bottom or along >= top or low_k + behind < first_plane or low_k + behind >= stop_plane:
                        continue
                    share = (part_i if right else 1.0 - part_i) * (part_j if down else 1.0 - part_j) * (part_k if behind else 1.0 - part_k)
                    if share <= 0.0 or (rule != AVERAGE and share < least_share):
                        continue
                    voxel = np.uint64(first + right + down * line + behind * plane)
                    if rule == AVERAGE:
                        give(voxel, share * factor, pixel, state)
                        continue
                    hits[voxel] += ONCE
                    value[voxel] = pixel if rule == LATEST else max(value[voxel], pixel)


class NumbaSplatEngine(SlabEngine):
    """`SplatEngine` for linear interpolation, compiled."""

    def __init__(self, job: Job):
        super().__init__(job)
        (first, stop), (i, j, k) = job.planes, job.grid_size
        self._size = np.array([i, j, k, first, stop], dtype=np.int64)
        # A corner of a pixel beside these planes may lie in them
        self._bounds = np.array([(0, 0, max(first - 1, 0)), (i, j, min(stop + 1, k))], dtype=np.float64)

    def _counting(self, layout: PixelLayout) -> Mask | None:
        importance = weights_of(layout, self.job.importance)
        return None if importance is None else layout.filled(importance > 0)

    def _insert_alike(
        self, batch: FrameBatch, frames: slice, layout: PixelLayout, scan_lines: ScanLines | None, counting: Mask | None
    ) -> list[int]:
        images, matrices = batch.images[frames], batch.image_to_ijk[frames]
        pieces = layout.pieces if counting is None else layout.pieces_within(layout.mask & counting)
        axis, edges = cut_into_slabs(matrices, layout, self._bounds)
        spans = np.empty((len(images), len(pieces), 4), np.int32)
        if layout.moved is None:
            clip_to_volume(matrices, pieces, self._bounds, axis, spans)
        state, importance = self.state, weights_of(layout, self.job.importance)
        pixels = np.empty((2, 0)) if layout.moved is None else layout.moved, np.empty(0, np.float32) if importance is None else importance
        voxels = state.value, state.hits, np.empty(0) if state.weight is None else state.weight

        def put(slab: Slab, entered: Integers) -> Iterator[None]:
            columns = np.empty((len(images), len(pieces), 2), np.int32)
            if layout.moved is None:
                # A pixel's corners are one voxel from the voxel that is nearest to it
                clip_to_slab(matrices, pieces, spans, (axis, slab[1] - 1, slab[2] + 1), columns)
            else:
                columns[:] = pieces[:, [START, STOP]]
            rule, least = SPREAD_RULES[self.method.name], self.method.least_share
            for some in self._pace.steps(len(images)):
                where = images[some], matrices[some], pieces, columns[some], self._size
                spread(rule, where, slab, pixels, CENTER_TOLERANCE, least, voxels, entered[some])
                yield

        return self._in_slabs(put, axis, edges, len(images), batch.progress)
