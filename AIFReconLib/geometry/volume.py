"""Voxel grids and the volumes on them.

Voxels are counted (i, j, k) with centers at integers; arrays are indexed [k, j, i], as Slicer's `arrayFromVolume` gives them.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Floats, Matrix, Numbers
from ..errors import GeometryError
from ..machine.memory import MAXIMUM_VOXELS
from ..message import Described
from .transforms import as_matrix, invert, transform_points

if TYPE_CHECKING:
    from ..evaluation.preview import Picture


@dataclass(frozen=True, eq=False)
class VoxelGrid:
    """Where the voxels are: their number along i, j, k and the matrix that places them in Reference.

    Parameters
    ----------
    size : tuple of 3 int
        Voxels along i, j, k.
    ijk_to_reference : (4, 4) array_like, mm
        Any orientation; the axes must be at right angles, so that distances in voxels are distances in mm.

    Raises
    ------
    GeometryError
        For a size that is not positive or beyond 2^31 voxels, or a matrix that is singular, not finite or sheared.
    """

    size: tuple[int, int, int]
    ijk_to_reference: Matrix

    def __post_init__(self) -> None:
        try:
            size = tuple(operator.index(n) for n in self.size)
        except TypeError:
            size = ()
        if len(size) != 3 or min(size) < 1:
            raise GeometryError("Input grid size must be 3 positive whole numbers of voxels; got {size!r}.", size=self.size)
        if math.prod(size) > MAXIMUM_VOXELS:
            raise GeometryError(
                "Input grid must have at most {maximum} voxels; got {columns} x {rows} x {slices}. Choose a larger spacing.",
                maximum=MAXIMUM_VOXELS,
                columns=size[0],
                rows=size[1],
                slices=size[2],
            )
        matrix = as_matrix(self.ijk_to_reference, "ijk_to_reference")
        axes = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
        if np.abs(axes.T @ axes - np.eye(3)).max() > 1e-3:
            raise GeometryError("Input grid must have its axes at right angles; got a sheared one. Resample the volume first.")
        matrix.setflags(write=False)
        object.__setattr__(self, "size", size)
        object.__setattr__(self, "ijk_to_reference", matrix)

    @classmethod
    def from_spacing(cls, origin_reference: ArrayLike, size: Sequence[int], spacing: ArrayLike) -> VoxelGrid:
        """A grid along the axes of Reference. `origin_reference` (mm) is the center of voxel (0, 0, 0); `spacing` is mm, one or three."""
        matrix = np.eye(4)
        matrix[:3, :3] = np.diag(np.broadcast_to(np.asarray(spacing, dtype=np.float64), 3))
        matrix[:3, 3] = origin_reference
        i, j, k = size
        return cls((i, j, k), matrix)

    @property
    def shape(self) -> tuple[int, int, int]:
        """The shape of an array on this grid: [k, j, i]."""
        i, j, k = self.size
        return k, j, i

    @property
    def voxels(self) -> int:
        """How many there are."""
        return self.size[0] * self.size[1] * self.size[2]

    @property
    def spacing(self) -> Floats:
        """Distance between voxel centers along i, j, k in mm, (3,) float64."""
        spacing: Floats = np.linalg.norm(self.ijk_to_reference[:3, :3], axis=0)
        return spacing

    @property
    def origin(self) -> Floats:
        """Center of voxel (0, 0, 0) in Reference, (3,) float64, mm."""
        return self.ijk_to_reference[:3, 3].copy()

    @cached_property
    def reference_to_ijk(self) -> Matrix:
        """Reference (mm) to voxel numbers (i, j, k), (4, 4) float64."""
        return invert(self.ijk_to_reference)

    def corners(self) -> Floats:
        """The centers of the 8 corner voxels in Reference, (8, 3) float64, mm."""
        last = np.array(self.size) - 1
        ijk = np.array([(i, j, k) for k in (0, last[2]) for j in (0, last[1]) for i in (0, last[0])], dtype=np.float64)
        return transform_points(self.ijk_to_reference, ijk)

    def facts(self) -> list[tuple[str, str]]:
        """Voxels, spacing and origin in words, for whatever shows a volume."""
        numbers = (self.size, np.round(self.spacing, 4), np.round(self.origin, 2))
        size, spacing, origin = (" x ".join(f"{n:g}" for n in three) for three in numbers)
        return [("voxels", size), ("spacing", f"{spacing} mm"), ("origin", f"{origin.replace(' x ', ', ')} mm")]

    def matches(self, other: VoxelGrid) -> bool:
        """Whether both grids have the same voxels, to a thousandth of a voxel over the whole grid."""
        return self.size == other.size and bool(np.allclose(self.corners(), other.corners(), atol=1e-3 * self.spacing.min(), rtol=0))


@dataclass(frozen=True, eq=False, repr=False)
class Volume(Described):
    """Values on a voxel grid.

    Parameters
    ----------
    array : [k, j, i] array
    ijk_to_reference : (4, 4) array_like, mm
    fields : mapping of str to str
        Where it comes from, for the header of its file; see `AIFReconLib.provenance`.
    """

    array: Numbers
    ijk_to_reference: Matrix
    fields: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.array.ndim != 3:
            raise GeometryError("Input volume array must have shape (k, j, i); got {shape}.", shape=self.array.shape)
        object.__setattr__(self, "ijk_to_reference", self.grid.ijk_to_reference)

    @cached_property
    def grid(self) -> VoxelGrid:
        """Where its voxels are."""
        k, j, i = self.array.shape
        return VoxelGrid((i, j, k), self.ijk_to_reference)

    def placed_by(self, volume_to_reference: Matrix) -> Volume:
        """The same voxels moved by a (4, 4) transform, e.g. a CT put into Reference by its registration."""
        return Volume(self.array, as_matrix(volume_to_reference, "volume_to_reference") @ self.ijk_to_reference)

    def _facts(self) -> list[tuple[str, str]]:
        values = f"{self.array.dtype}, {self.array.min():g} to {self.array.max():g}"
        return [*self.grid.facts(), ("values", values)]

    def plot(self, mask: Volume | None = None, labels: Volume | None = None, ct: Volume | None = None, title: str = "") -> Picture:
        """A picture of three cuts through the bone and a projection, which a notebook shows; see `AIFReconLib.evaluation.preview`."""
        from ..evaluation.preview import preview

        return preview(self, mask, labels, ct, title)

    def write(self, path: str | Path) -> None:
        """Write to a volume file (.nrrd, .mha, .mhd, .nii, .nii.gz): LPS in the file, so that it opens in Slicer where it belongs.

        Its `fields` go into the header, where the format has room for them (not NIfTI).

        Raises
        ------
        OutputError
            When it cannot be written; no partial file is left.
        """
        from ..io.volume.files import write_volume

        write_volume(self, path)
