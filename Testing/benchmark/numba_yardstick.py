"""The yardstick of the benchmark: each rule as a plain loop over pixels, compiled as it is written and run on one thread.

Nothing here is tuned, and nothing but the benchmark uses it: how far the engines are ahead of it says what their work is worth on a
machine, whatever its clock.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numba import njit

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.compounding.evidence import ScanLines
from AIFReconLib.compounding.layout import PixelLayout
from AIFReconLib.geometry.transforms import image_plane_axes, pixel_spacing
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.gray_levels import GrayLevels
from AIFReconLib.imaging.region import ImageRegion
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import TrackedFrame

ONE, ZERO, THREE = np.float32(1), np.float32(0), np.float32(3)


@njit(nogil=True, cache=True, inline="always")
def voxel(matrix, row, column):
    """Where a pixel lies, (k, j, i); `matrix` is image_to_ijk."""
    i = math.floor(matrix[0, 1] * row + (matrix[0, 3] + 0.5) + matrix[0, 0] * column)
    j = math.floor(matrix[1, 1] * row + (matrix[1, 3] + 0.5) + matrix[1, 0] * column)
    k = math.floor(matrix[2, 1] * row + (matrix[2, 3] + 0.5) + matrix[2, 0] * column)
    return k, j, i


def plain(rule):
    """The loop that puts one frame's pixels into values and counts [k, j, i], by what becomes of a value that meets a pixel."""
    rule = njit(inline="always")(rule)

    @njit(nogil=True)
    def put(image, matrix, value, hits):
        nk, nj, ni = value.shape
        for row in range(image.shape[0]):
            for column in range(image.shape[1]):
                k, j, i = voxel(matrix, row, column)
                if 0 <= i < ni and 0 <= j < nj and 0 <= k < nk:
                    value[k, j, i] = rule(value[k, j, i], image[row, column])
                    hits[k, j, i] += 1

    return put


@njit(nogil=True, cache=True)
def plain_aif(image, matrix, x_axis, y_axis, beams, probability, directions, alpha, beta, maximum, compensated, value, weight, hits):
    """The paper's rule for one frame; `beams` (rows, columns, 2), `directions` [k, j, i, 3], scalars float32."""
    nk, nj, ni = value.shape
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            k, j, i = voxel(matrix, row, column)
            if 0 <= i < ni and 0 <= j < nj and 0 <= k < nk:
                pixel = np.float32(image[row, column])
                v = directions[k, j, i]
                along_x = v[0] * x_axis[0] + v[1] * x_axis[1] + v[2] * x_axis[2]
                along_y = v[0] * y_axis[0] + v[1] * y_axis[1] + v[2] * y_axis[2]
                w = min(max(beams[row, column, 0] * along_x + beams[row, column, 1] * along_y, ZERO), ONE)
                if compensated and w > beta:
                    w = ONE / w
                w *= probability[k, j, i]
                new = min(maximum, pixel + alpha * pixel * w)
                value[k, j, i] = (weight[k, j, i] * value[k, j, i] + new) / (weight[k, j, i] + ONE)
                weight[k, j, i] += w
                hits[k, j, i] += 1


@njit(nogil=True, cache=True)
def plain_weighted(
    image, matrix, x_axis, y_axis, beams, probability, directions, reach, onset, floor, gain, beta, maximum, value, weight, hits
):
    """The weighted sum for one frame; `reach` and `onset` are images of its evidence, which is not part of this loop."""
    nk, nj, ni = value.shape
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            k, j, i = voxel(matrix, row, column)
            if 0 <= i < ni and 0 <= j < nj and 0 <= k < nk:
                pixel = np.float32(image[row, column])
                v = directions[k, j, i]
                along_x = v[0] * x_axis[0] + v[1] * x_axis[1] + v[2] * x_axis[2]
                along_y = v[0] * y_axis[0] + v[1] * y_axis[1] + v[2] * y_axis[2]
                cosine = min(max(beams[row, column, 0] * along_x + beams[row, column, 1] * along_y, ZERO), ONE)
                gate = (onset[row, column] * probability[k, j, i]) * probability[k, j, i]
                w = (floor + gate) * reach[row, column]
                compensation = min(ONE / cosine, THREE) if cosine > beta else ONE
                value[k, j, i] += w * min(maximum, pixel * (ONE + gain * gate * compensation))
                weight[k, j, i] += w
                hits[k, j, i] += 1


def yardsticks(sweep: list[TrackedFrame], grid: VoxelGrid, bone: BoneMap, probe: ProbeGeometry) -> dict[str, Callable[[], None]]:
    """Functions by method, each of which puts a sweep of like frames into a volume that is there already.

    For `weighted` the evidence is judged once beforehand, and the same for every frame.
    """
    image, pose = sweep[0].placed()
    rows, columns = image.shape
    spacing = pixel_spacing(pose)
    beams = probe.directions(columns, rows, spacing)
    placed = bone.on_grid(grid)
    matrices = [grid.reference_to_ijk @ frame.placed()[1] for frame in sweep]
    axes = [tuple(axis.astype(np.float32) for axis in image_plane_axes(frame.placed()[1])) for frame in sweep]
    value, weight = np.zeros(grid.shape, np.float32), np.zeros(grid.shape, np.float32)
    total, hits = np.zeros(grid.shape, np.float64), np.zeros(grid.shape, np.uint32)
    defaults = ReconstructionSettings()
    alpha, beta, maximum = np.float32(defaults.alpha), np.float32(defaults.beta), np.float32(np.iinfo(str(image.dtype)).max)
    floor, gain = np.float32(defaults.weight_floor), np.float32(defaults.bone_gain)
    layout = PixelLayout.build((columns, rows), spacing, ImageRegion(), probe)
    reach, onset = ScanLines(layout, probe).evidence(layout.values(image), GrayLevels.as_recorded(float(maximum)))
    reach, onset = reach.reshape(rows, columns), onset.reshape(rows, columns)
    known = placed.probability, placed.directions_reference

    def each(put: Callable[..., None], *arguments: object) -> Callable[[], None]:
        """All frames, one after the other."""

        def run() -> None:
            for frame, matrix in zip(sweep, matrices, strict=True):
                put(frame.image, matrix, *arguments)

        return run

    def beamed(put: Callable[..., None], *arguments: object) -> Callable[[], None]:
        """The same with the beams of each."""

        def run() -> None:
            for frame, matrix, (x, y) in zip(sweep, matrices, axes, strict=True):
                put(frame.image, matrix, x, y, beams, *known, *arguments, value, weight, hits)

        return run

    return {
        "average": each(plain(lambda sum, pixel: sum + pixel), total, hits),
        "latest": each(plain(lambda _, pixel: pixel), value, hits),
        "maximum": each(plain(lambda most, pixel: max(most, np.float32(pixel))), value, hits),
        "aif": beamed(plain_aif, alpha, beta, maximum, False),
        "aif-compensated": beamed(plain_aif, alpha, beta, maximum, True),
        "weighted": beamed(plain_weighted, reach, onset, floor, gain, beta, maximum),
    }
