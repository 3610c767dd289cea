"""Where a registered CT predicts bone, and which way it faces.

The recipe for the probability is the paper's; `surface` directions and the inside of bone are this project's additions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy import ndimage

from ..arrays import Floats, Integers, Matrix, Numbers, Singles
from ..errors import GeometryError
from ..geometry.box import Box, box_around
from ..geometry.volume import Volume, VoxelGrid, as_volume
from ..machine.threads import in_parts, optional_module, usable_cores
from ..message import Described, listed
from ..progress import Progress, part, report

SIGMA_VOXELS = 10.0
"""Smoothing of the probability map in the paper, in voxels of the labels."""

SURFACE_SIGMA = 2.0
"""mm. Smoothing of the labels, alike along all axes, before their gradient is taken as the direction of the surface."""

DIRECTIONS = ("gradient", "surface")

SHORTEST = 1e-30
"""Length below which a gradient has no direction: its components would lose digits in float32."""

GAUSSIAN_REACH = 4.0
"""Where scipy cuts a Gaussian off, in sigmas."""

PARTS = 32
"""Parts that filters and sampling are split into for several threads; always as many, so that results depend on no machine."""


@dataclass(frozen=True, eq=False)
class BoneOnGrid:
    """A bone map sampled on the grid of a reconstruction: what the engines read.

    Parameters
    ----------
    probability : [k, j, i] float32 array, 0 to 1
    directions_reference : [k, j, i, 3] float32 array, unit vectors or zero
        Where bone faces away from the sound, in Reference: along the beam on the near side of a surface.
    map_probability : [k, j, i] float32 array, 0 to 1
        The probability in the map's own voxels: what a frame asks for that leaves the grid, or the part of it that is reconstructed.
    ijk_to_map : (4, 4) array
        From the voxels of the whole grid to those of the map.
    """

    probability: Singles
    directions_reference: Singles
    map_probability: Singles
    ijk_to_map: Matrix

    @property
    def overlaps(self) -> bool:
        """Whether there is any bone on the grid at all."""
        return bool(self.probability.any())


@dataclass(frozen=True, eq=False, repr=False)
class BoneMap(Described):
    """Bone as a CT predicts it, in the CT's own geometry.

    Parameters
    ----------
    probability : Volume of float32, 0 to 1
        V_prob. Its matrix places it in Reference.
    inside : Volume of uint8 or None
        1 within bone, on the same voxels; None when only a probability is known, then bone is where it exceeds one half.
    notes : tuple of str
        What a user should know of how it was made, one sentence each.

    Notes
    -----
    Outside the volume the probability is 0; it falls to it within one voxel.
    """

    probability: Volume
    inside: Volume | None = None
    notes: tuple[str, ...] = ()

    def _facts(self) -> list[tuple[str, str]]:
        known = "probability" if self.inside is None else f"probability and {np.count_nonzero(self.inside.array):,} voxels of bone"
        return [("holds", known), *self.probability.grid.facts()]

    @classmethod
    def from_labels(
        cls,
        labels: Volume | ArrayLike,
        sigma_voxels: float = SIGMA_VOXELS,
        sigma_mm: float | None = None,
        labels_to_reference: Matrix | None = None,
        progress: Progress | None = None,
        *,
        ijk_to_reference: ArrayLike | None = None,
    ) -> BoneMap:
        """The paper's recipe: labels, magnitude of the 3D Sobel gradient, Gaussian, divided by the maximum.

        Parameters
        ----------
        labels : Volume, or [k, j, i] array_like, of integers or bool
            Any label above 0 is bone.
        sigma_voxels, sigma_mm : float
            Width of the Gaussian, in voxels of `labels` (the paper: 10) or, when given, in mm along every axis.
        labels_to_reference : (4, 4) array or None
            The registration of the CT, when its volume does not hold Reference coordinates already.
        ijk_to_reference : (4, 4) array_like, mm, or None
            Where the voxels of an array are; a `Volume` knows it.

        Raises
        ------
        GeometryError
            When no voxel is labeled.
        InputTypeError
            When labels are neither a volume nor an array with its matrix.

        Notes
        -----
        Only the box around the labels that the Gaussian reaches is computed and kept; the rest is 0 in any case.
        """
        report(progress, 0.0, "Making the bone map")
        labels = as_volume(labels, ijk_to_reference, "labels")
        bone = labels.array > 0
        if not bone.any():
            raise GeometryError("Input labels must have voxels above 0; got none. Was the right segmentation chosen?")
        if bone.all():
            raise GeometryError("Input labels must leave voxels that are not bone; got bone everywhere. Was the right segmentation chosen?")
        sigma_kji = np.full(3, float(sigma_voxels)) if sigma_mm is None else float(sigma_mm) / labels.grid.spacing[::-1]
        if not (np.isfinite(sigma_kji).all() and (sigma_kji > 0).all()):
            raise GeometryError("Input sigma must be positive; got {sigma}.", sigma=sigma_voxels if sigma_mm is None else sigma_mm)
        margin = np.ceil(GAUSSIAN_REACH * sigma_kji).astype(int) + 2
        box = box_around(bone, margin)
        bone = bone[box]
        report(progress, 0.1, "Making the bone map")
        probability = _sobel_magnitude(bone.astype(np.float32))
        report(progress, 0.4, "Making the bone map")
        probability = _smoothed(probability, sigma_kji)
        probability /= probability.max()
        report(progress, 0.9, "Making the bone map")
        placed = _matrix_of_box(labels if labels_to_reference is None else labels.placed_by(labels_to_reference), box)
        bone_map = cls(Volume(probability, placed), Volume(bone.astype(np.uint8), placed))
        report(progress, 1.0, "Made the bone map")
        return bone_map

    @classmethod
    def from_probability(
        cls,
        probability: Volume | ArrayLike,
        probability_to_reference: Matrix | None = None,
        *,
        ijk_to_reference: ArrayLike | None = None,
    ) -> BoneMap:
        """A ready probability (a network's output), limited to 0 to 1; not finite values count as 0.

        Parameters
        ----------
        probability : Volume, or [k, j, i] array_like
        probability_to_reference : (4, 4) array or None, mm
            Moves it, when it does not lie in Reference already.
        ijk_to_reference : (4, 4) array_like, mm, or None
            Where the voxels of an array are; a `Volume` knows it.

        Raises
        ------
        GeometryError
            When values go far beyond 1: percent or gray levels.
        InputTypeError
            When it is neither a volume nor an array with its matrix.
        """
        probability = as_volume(probability, ijk_to_reference, "probability")
        if probability.array.size and np.nanmax(np.where(np.isfinite(probability.array), probability.array, 0)) > 2:
            raise GeometryError(
                "Input probability must be 0 to 1; got values up to {largest:g}. "
                "Divide it by its largest possible value, or give labels with --bone-labels.",
                largest=np.nanmax(probability.array),
            )
        array = np.clip(np.nan_to_num(probability.array.astype(np.float32), nan=0.0, posinf=0.0, neginf=0.0), 0.0, 1.0)
        volume = Volume(array, probability.ijk_to_reference)
        return cls(volume if probability_to_reference is None else volume.placed_by(probability_to_reference))

    def _slope(self, potential: Numbers, axis: int) -> Singles:
        """How what V_dir is the gradient of rises along an axis (0: i) of the map, [k, j, i]."""
        slope: Singles = ndimage.sobel(potential, axis=2 - axis, mode="nearest")
        return slope

    def on_grid(
        self, grid: VoxelGrid, direction: str = "gradient", progress: Progress | None = None, planes: tuple[int, int] | None = None
    ) -> BoneOnGrid:
        """Sample the map on the voxels of a reconstruction.

        Parameters
        ----------
        grid : VoxelGrid
        direction : "gradient" or "surface"
            Gradient of the probability (the paper's), which flips its sign at the ridge; or of the smoothed bone itself.
        progress : Progress or None
        planes : (first, stop) or None
            Of the grid, planes [k], the part to sample: the values that it has in the whole, to the last bit. By default all of it.

        Notes
        -----
        V_dir is scipy's Sobel (mode "nearest") along x, y, z in the map's own geometry, taken to mm in Reference as a covector
        (the inverse transpose of the matrix), interpolated linearly to the grid and normalized; zero where there is no gradient.
        """
        if direction not in DIRECTIONS:
            raise GeometryError(
                "Input direction must be {directions}; got {direction!r}.", directions=listed(DIRECTIONS, " or "), direction=direction
            )
        first, stop = planes or (0, grid.shape[0])
        sample = _sampler(self.probability, grid, first, stop)
        report(progress, 0.0, "Placing the bone map")
        probability = sample(self.probability.array, part(progress, 0.0, 0.2))
        potential = self.probability.array
        if direction == "surface":
            bone = self.inside.array if self.inside is not None else self.probability.array > 0.5
            sigma_kji = SURFACE_SIGMA / self.probability.grid.spacing[::-1]
            potential = _smoothed(bone.astype(np.float32), sigma_kji)
        report(progress, 0.3, "Placing the bone map")
        to_reference = np.linalg.inv(self.probability.ijk_to_reference[:3, :3]).T.astype(np.float32)
        directions = np.zeros((*probability.shape, 3), dtype=np.float32)
        for axis in range(3):
            begun = 0.3 + 0.2 * axis
            slope = sample(self._slope(potential, axis), part(progress, begun, begun + 0.1))

            def turn(k: int, axis: int = axis, slope: Singles = slope) -> None:
                rows = _not_empty(slope[k])
                for component in range(3):
                    directions[k, rows, :, component] += to_reference[component, axis] * slope[k, rows]

            in_parts(turn, stop - first, usable_cores(), part(progress, begun + 0.1, begun + 0.2), "Placing the bone map")
        _normalize(directions, part(progress, 0.9, 1.0))
        report(progress, 1.0, "Placed the bone map")
        ijk_to_map = self.probability.grid.reference_to_ijk @ grid.ijk_to_reference
        return BoneOnGrid(probability, directions, np.asarray(self.probability.array, np.float32), ijk_to_map)


def _smoothed(array: Singles, sigma_kji: Floats) -> Singles:
    """A float32 array after a Gaussian, in place; axis by axis in parts, which share no line along it."""
    for axis, sigma in enumerate(sigma_kji):
        across = 1 if axis == 0 else 0
        edges = np.linspace(0, array.shape[across], min(PARTS, array.shape[across]) + 1).astype(int)

        def smooth(part: int, axis: int = axis, sigma: float = sigma, across: int = across, edges: Integers = edges) -> None:
            lines = array[(slice(None),) * across + (slice(edges[part], edges[part + 1]),)]
            ndimage.gaussian_filter1d(lines, sigma, axis=axis, output=lines, mode="nearest", truncate=GAUSSIAN_REACH)

        in_parts(smooth, len(edges) - 1, usable_cores())
    return array


def _sobel_magnitude(array: Singles) -> Singles:
    squared = np.zeros_like(array)
    for axis in range(3):
        slope = ndimage.sobel(array, axis=axis, mode="nearest")
        slope *= slope
        squared += slope
    np.sqrt(squared, out=squared)
    return squared


def _normalize(vectors: Singles, progress: Progress | None = None) -> None:
    """Scale vectors [k, j, i, 3] to unit length in place, slab by slab; vectors too short to have a direction become zero."""

    def normalize(k: int) -> None:
        slab = vectors[k, _not_empty(vectors[k].reshape(vectors.shape[1], -1))]
        length = np.sqrt(np.einsum("jic,jic->ji", slab, slab, dtype=np.float64))
        too_short = length < SHORTEST
        length[too_short] = 1.0
        slab /= length[..., None].astype(np.float32)
        slab[too_short] = 0.0

    in_parts(normalize, len(vectors), usable_cores(), progress, "Placing the bone map")


def _not_empty(plane: Singles) -> slice:
    """The rows of a plane from the first to the last that is not all 0: what was never written stays so, and takes no memory."""
    rows = np.flatnonzero(plane.any(axis=1))
    return slice(int(rows[0]), int(rows[-1]) + 1) if rows.size else slice(0, 0)


def _matrix_of_box(volume: Volume, box: Box) -> Matrix:
    """ijk_to_reference of the part `box` [k, j, i] of a volume."""
    shift = np.eye(4)
    shift[:3, 3] = [s.start for s in box[::-1]]
    return volume.ijk_to_reference @ shift


def _sampler(source: Volume, grid: VoxelGrid, first_plane: int, stop_plane: int) -> Callable[[Numbers, Progress | None], Singles]:
    """A function that brings arrays [k, j, i] on the source's voxels onto some planes of the grid by linear interpolation, as float32.

    Notes
    -----
    Around the source lie voxels of 0, so that values fall to 0 within one voxel of its border.
    """
    if source.grid.matches(grid):
        return lambda array, _progress: array[first_plane:stop_plane].astype(np.float32)
    to_source = source.grid.reference_to_ijk @ grid.ijk_to_reference
    box = _overlap(to_source, grid, source.grid)
    # The same voxels with and without it
    fast = optional_module("AIFReconLib.bone.numba_map")

    def sample(array: Numbers, progress: Progress | None) -> Singles:
        result = np.zeros((stop_plane - first_plane, *grid.shape[1:]), dtype=np.float32)
        if box is not None:
            matrix = np.ascontiguousarray(to_source[2::-1, 2::-1])
            offset = to_source[2::-1, 3] + matrix @ [s.start for s in box]
            planes = box[0].stop - box[0].start
            edges = np.linspace(0, planes, min(PARTS, planes) + 1).astype(int)

            def sample_slab(part: int) -> None:
                # The places of voxels are counted from the first of their slab, whichever planes are wanted: so they round alike
                low, high = (box[0].start + int(edges[n]) for n in (part, part + 1))
                first, stop = max(low, first_plane), min(high, stop_plane)
                if first >= stop:
                    return
                start = offset + matrix[:, 0] * edges[part]
                if fast is not None and array.dtype == np.float32 and array.flags.c_contiguous:
                    begins = (first - first_plane, box[1].start, box[2].start)
                    ends = (stop - first_plane, box[1].stop, box[2].stop)
                    fast.sample_linearly(array, matrix, start, result, begins, ends, first - low)
                    return
                slab = np.empty((high - low, box[1].stop - box[1].start, box[2].stop - box[2].start), np.float32)
                ndimage.affine_transform(
                    array,
                    matrix,
                    start,
                    output=slab,
                    output_shape=slab.shape,
                    order=1,
                    # "constant" would drop voxels on the very border, which rounding puts a hair outside
                    mode="grid-constant",
                    prefilter=False,
                )
                result[first - first_plane : stop - first_plane, box[1], box[2]] = slab[first - low : stop - low]

            in_parts(sample_slab, len(edges) - 1, usable_cores(), progress, "Placing the bone map")
        return result

    return sample


def _overlap(to_source: Matrix, grid: VoxelGrid, source: VoxelGrid) -> Box | None:
    """The box [k, j, i] of the grid outside of which the source and its rim of zeros have no voxel; None when they do not meet."""
    to_grid = np.linalg.inv(to_source)
    near, far = (-1, -1, -1), source.size
    corners = np.array([(i, j, k) for k in (near[2], far[2]) for j in (near[1], far[1]) for i in (near[0], far[0])], dtype=np.float64)
    ijk = corners @ to_grid[:3, :3].T + to_grid[:3, 3]
    first = np.maximum(np.floor(ijk.min(axis=0)).astype(int) - 1, 0)
    stop = np.minimum(np.ceil(ijk.max(axis=0)).astype(int) + 2, grid.size)
    if (first >= stop).any():
        return None
    k, j, i = (slice(int(a), int(b)) for a, b in zip(first[::-1], stop[::-1], strict=True))
    return k, j, i
