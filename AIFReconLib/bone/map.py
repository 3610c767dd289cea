"""Where a registered CT predicts bone, and which way it faces.

The recipe for the probability is the paper's; `surface` directions and the inside of bone are this project's additions.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ..arrays import Floats, Integers, Matrix, Singles
from ..errors import GeometryError
from ..geometry.box import box_around
from ..geometry.volume import Volume, VoxelGrid, as_volume
from ..io.volume.label_files import read_labels
from ..machine.memory import LARGEST_GRID, require_memory
from ..machine.threads import in_parts, usable_cores
from ..message import Described, listed
from ..progress import Progress, part, report
from ..remedies import TAKE_AS_CT, TAKE_AS_PROBABILITY
from .field import BoneField, require_bone
from .placed.at_voxels import BoneAtVoxels
from .placed.coordinates import SLABS, MapCoordinates
from .placed.on_grid import BoneOnGrid
from .widths import SIGMA_VOXELS

SURFACE_SIGMA = 2.0
"""mm. Smoothing of the labels, alike along all axes, before their gradient is taken as the direction of the surface."""

DIRECTIONS = ("gradient", "surface")

BYTES_PER_LABEL = 16
"""Bytes for each voxel around the labels while the map is made."""

GAUSSIAN_REACH = 4.0
"""Where scipy cuts a Gaussian off, in sigmas."""

FIELD_REACH = 3.0
"""Widths from the surface beyond which a map from distances is 0."""


@dataclass(frozen=True, eq=False, repr=False)
class BoneMap(Described):
    """Bone as a CT predicts it, in the CT's own geometry.

    Notes
    -----
    Outside the volume the probability is 0; it falls to it within one voxel.
    """

    probability: Volume  #: float32, 0 to 1. V_prob. Its matrix places it in Reference.
    inside: Volume | None = None
    """uint8. 1 within bone, on the same voxels; None when only a probability is known, then bone is where it exceeds one half."""
    notes: tuple[str, ...] = ()  #: What a user should know of how it was made, one sentence each
    slopes: Singles | None = None
    """(3, k, j, i), along i, j, k of the map: V_dir before it is normalized, into bone, where that is known otherwise than by a gradient of
    the probability, which turns over on the surface. Then `gradient` and `surface` directions are one."""
    made: Mapping[str, object] = field(default_factory=dict)
    """The settings by which it was made, by name: what repeats it from the same labels, sweep or predictions."""
    grows: ClassVar[bool] = False
    """Whether it is told more while it is read, and then has to lie on the grid of the reconstruction."""

    def _facts(self) -> list[tuple[str, str]]:
        known = "probability" if self.inside is None else f"probability and {np.count_nonzero(self.inside.array):,} voxels of bone"
        return [("holds", known), *self.probability.grid.facts()]

    @classmethod
    def from_labels(
        cls,
        labels: Volume | ArrayLike | str | Path,
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
        labels : Volume, path, or [k, j, i] array_like, of integers or bool
            Any label above 0 is bone. A path is read by `read_labels`.
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
        Only the box around the labels that the Gaussian reaches, or that of `surface` directions if it is wider, is computed and kept; the
        rest is 0 in any case.
        """
        report(progress, 0.0, "Making the bone map")
        labels = as_volume(read_labels(labels) if isinstance(labels, str | Path) else labels, ijk_to_reference, "labels")
        if labels.array.dtype.kind == "f" and (labels.array != np.rint(labels.array)).any():
            raise GeometryError("Input labels must be whole numbers; got fractions.", TAKE_AS_PROBABILITY)
        if labels.array.dtype.kind != "b" and labels.array.min() < 0:
            raise GeometryError(f"Input labels must not be negative; got {labels.array.min()}.", TAKE_AS_CT)
        bone = labels.array > 0
        require_bone(bone)
        sigma_kji = np.full(3, float(sigma_voxels)) if sigma_mm is None else float(sigma_mm) / labels.grid.spacing[::-1]
        if not (np.isfinite(sigma_kji).all() and (sigma_kji > 0).all()):
            raise GeometryError(f"Input sigma must be positive; got {sigma_voxels if sigma_mm is None else sigma_mm}.")
        widest = np.maximum(sigma_kji, SURFACE_SIGMA / labels.grid.spacing[::-1])
        margin = np.ceil(GAUSSIAN_REACH * widest).astype(int) + 2
        box = box_around(bone, margin)
        bone = bone[box]
        require_memory(bone.shape[::-1], labels.grid.spacing, BYTES_PER_LABEL, most=LARGEST_GRID)
        report(progress, 0.1, "Making the bone map")
        probability = _sobel_magnitude(bone.astype(np.float32))
        report(progress, 0.4, "Making the bone map")
        probability = _smoothed(probability, sigma_kji)
        probability /= probability.max()
        report(progress, 0.9, "Making the bone map")
        placed = labels.placed_by(labels_to_reference)[box].ijk_to_reference
        made = {"bone_sigma_voxels": float(sigma_voxels)} if sigma_mm is None else {"bone_sigma_mm": float(sigma_mm)}
        bone_map = cls(Volume(probability, placed), Volume(bone.astype(np.uint8), placed), made=made)
        report(progress, 1.0, "Made the bone map")
        return bone_map

    @classmethod
    def from_field(cls, field: BoneField, width: float, labels_to_reference: Matrix | None = None) -> BoneMap:
        """Bone by its distance: exp(-d^2 / 2 w^2), 1 on the surface; V_dir is the slope of the distance, which keeps its side.

        Parameters
        ----------
        width : float, mm
            w: how far from the surface its echoes may lie.
        labels_to_reference : (4, 4) array or None, mm
            The registration of the CT, when its labels do not hold Reference coordinates already.
        """
        distance = field.distance.placed_by(labels_to_reference)
        away = distance.array.astype(np.float32, copy=False)
        probability = np.exp(-0.5 * (away / np.float32(width)) ** 2)
        probability[np.abs(away) > FIELD_REACH * width] = 0.0
        slopes = -np.stack([np.gradient(away, axis=2 - axis) for axis in range(3)])
        inside = Volume((away < 0).astype(np.uint8), distance.ijk_to_reference)
        return cls(Volume(probability, distance.ijk_to_reference), inside, slopes=slopes, made={"bone_sigma_mm": float(width)})

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
                f"Input probability must be 0 to 1; got values up to {np.nanmax(probability.array):g}.",
                "Divide it by its largest possible value, or give labels as {bone_labels}.",
            )
        array = np.clip(np.nan_to_num(probability.array.astype(np.float32), nan=0.0, posinf=0.0, neginf=0.0), 0.0, 1.0)
        return cls(Volume(array, probability.ijk_to_reference).placed_by(probability_to_reference))

    def _gradient(self, direction: str) -> Singles:
        """V_dir before it is normalized, (3, k, j, i), along i, j, k of the map."""
        potential = self.probability.array
        if direction == "surface":
            bone = self.inside.array if self.inside is not None else self.probability.array > 0.5
            potential = _smoothed(bone.astype(np.float32), SURFACE_SIGMA / self.probability.grid.spacing[::-1])
        potential = potential.astype(np.float32, copy=False)
        return np.stack([scipy.ndimage.sobel(potential, axis=2 - axis, mode="nearest") for axis in range(3)])

    def at_voxels(
        self, grid: VoxelGrid, direction: str = "gradient", progress: Progress | None = None, planes: tuple[int, int] | None = None
    ) -> BoneAtVoxels:
        """The map, to be read at some voxels of a reconstruction: what `on_grid` has there, without the work and the memory for all others.

        Arguments as in `on_grid`.
        """
        if direction not in DIRECTIONS:
            raise GeometryError(f"Input direction must be {listed(DIRECTIONS, ' or ')}; got {direction!r}.")
        report(progress, 0.0, "Placing the bone map")
        array = np.ascontiguousarray(self.probability.array, np.float32)
        slopes = self._gradient(direction) if self.slopes is None else self.slopes
        coordinates = MapCoordinates.of(self.probability.grid, grid, planes or (0, grid.shape[0]))
        ijk_to_map = self.probability.grid.reference_to_ijk @ grid.ijk_to_reference
        to_reference = np.linalg.inv(self.probability.ijk_to_reference[:3, :3]).T.astype(np.float32)
        placed = BoneAtVoxels(array, ijk_to_map, slopes, to_reference, coordinates)
        report(progress, 1.0, "Placed the bone map")
        return placed

    def on_grid(
        self, grid: VoxelGrid, direction: str = "gradient", progress: Progress | None = None, planes: tuple[int, int] | None = None
    ) -> BoneOnGrid:
        """Sample the map on the voxels of a reconstruction.

        Parameters
        ----------
        direction : "gradient" or "surface"
            Gradient of the probability (the paper's), which flips its sign at the ridge; or of the smoothed bone itself.
        planes : (first, stop) or None
            Of the grid, planes [k], the part to sample: the values that it has in the whole, to the last bit. By default all of it.

        Notes
        -----
        V_dir is scipy's Sobel (mode "nearest") along x, y, z in the map's own geometry, taken to mm in Reference as a covector
        (the inverse transpose of the matrix), interpolated linearly to the grid and normalized; zero where there is no gradient.
        """
        placed = self.at_voxels(grid, direction, part(progress, 0.0, 0.1), planes)
        within = placed.coordinates
        (first, stop), rows, columns = within.planes, slice(*within.rows), slice(*within.columns)
        line = np.arange(rows.start, rows.stop)[:, None] * within.shape[2] + np.arange(columns.start, columns.stop)
        probability, directions = np.zeros(within.shape, np.float32), np.zeros((*within.shape, 3), np.float32)

        def sample(number: int) -> None:
            k = first + number
            found, facing = placed.at(k * within.shape[1] * within.shape[2] + line.ravel(), everywhere=True)
            found, facing = found.reshape(line.shape), facing.reshape(*line.shape, 3)
            # What is not written takes no memory
            some = np.flatnonzero(found.any(axis=1) | facing.any(axis=(1, 2)))
            if some.size:
                near = slice(int(some[0]), int(some[-1]) + 1)
                probability[k, rows, columns][near], directions[k, rows, columns][near] = found[near], facing[near]

        in_parts(sample, stop - first, usable_cores(), part(progress, 0.1, 1.0), "Placing the bone map")
        report(progress, 1.0, "Placed the bone map")
        return BoneOnGrid(probability, directions, placed.map_probability, placed.ijk_to_map)


def _smoothed(array: Singles, sigma_kji: Floats) -> Singles:
    """A float32 array after a Gaussian, in place; axis by axis in slabs, which share no line along it."""
    for axis, sigma in enumerate(sigma_kji):
        across = 1 if axis == 0 else 0
        count = array.shape[across]
        edges = np.linspace(0, count, min(SLABS, count) + 1).astype(int)

        def smooth(slab: int, axis: int = axis, sigma: float = sigma, across: int = across, edges: Integers = edges) -> None:
            lines = array[(slice(None),) * across + (slice(edges[slab], edges[slab + 1]),)]
            scipy.ndimage.gaussian_filter1d(lines, sigma, axis=axis, output=lines, mode="nearest", truncate=GAUSSIAN_REACH)

        in_parts(smooth, len(edges) - 1, usable_cores())
    return array


def _sobel_magnitude(array: Singles) -> Singles:
    """How long the Sobel gradient [k, j, i] is."""
    squared = np.zeros_like(array)
    for axis in range(3):
        squared += scipy.ndimage.sobel(array, axis=axis, mode="nearest") ** 2
    return np.sqrt(squared, out=squared)
