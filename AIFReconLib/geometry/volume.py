"""Voxel grids and the volumes on them.

Voxels are counted (i, j, k) with centers at integers; arrays are indexed [k, j, i], as Slicer's `arrayFromVolume` gives them.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import import_module
from pathlib import Path
from types import EllipsisType
from typing import Any, Protocol, TypeVar, overload

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin
from numpy.typing import ArrayLike, DTypeLike

from ..arrays import Array, Floats, Integers, Mask, Matrix, Numbers, NumberType
from ..errors import GeometryError, InputTypeError, not_of_kind
from ..machine.memory import LARGEST_GRID
from ..message import Described
from .transforms import affine, as_matrix, invert, transform_points

_WAYS_OUT = {
    "preview": "evaluation.preview",
    "to_sitk": "io.volume.itk_images",
    "from_sitk": "io.volume.itk_images",
    "write_volume": "io.volume.files",
}
"""Where the functions live that a volume's last methods hand it to, by name as in the package's own list: nothing here rests on them."""


TOLERANCE = 1e-6
"""Voxels by which a box may be longer than a whole number of them without getting another one."""


def _way_out(name: str) -> Any:
    return getattr(import_module(f"{__package__.rpartition('.')[0]}.{_WAYS_OUT[name]}"), name)


class Picture(Protocol):
    """What `Volume.plot` draws: a notebook shows it."""

    @property
    def png(self) -> bytes:
        """The file."""

    def write(self, path: str | Path) -> None:
        """Write the PNG file; an `OutputError` where it cannot be written."""


@dataclass(frozen=True, eq=False, repr=False)
class VoxelGrid(Described):
    """Where the voxels are: their number along i, j, k and the matrix that places them in Reference.

    Raises
    ------
    GeometryError
        For a size that is not positive or beyond 2^36 voxels, or a matrix that is singular, not finite or sheared.
    """

    size: tuple[int, int, int]  #: Voxels along i, j, k.
    ijk_to_reference: Matrix
    """(4, 4) array_like, mm. Any orientation; the axes must be at right angles, so that distances in voxels are distances in mm."""

    def __post_init__(self) -> None:
        try:
            size = tuple(operator.index(n) for n in self.size)
        except TypeError:
            size = ()
        if len(size) != 3 or min(size) < 1:
            raise GeometryError(f"Input grid size must be 3 positive whole numbers of voxels; got {self.size!r}.")
        if math.prod(size) > LARGEST_GRID:
            raise GeometryError(
                f"Input grid must have at most {LARGEST_GRID} voxels; got {size[0]} x {size[1]} x {size[2]}. Choose a larger spacing."
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
        matrix = affine(np.diag(np.broadcast_to(np.asarray(spacing, dtype=np.float64), 3)), origin_reference)
        i, j, k = size
        return cls((i, j, k), matrix)

    @classmethod
    def covering(cls, box_to_reference: Matrix, size: ArrayLike, spacing: ArrayLike) -> VoxelGrid:
        """The voxels of `spacing`, mm, one or three, that cover a box of this size around the origin of its own axes.

        Along an axis of length L mm there are ceil(L / spacing) voxels, centered on the box: they reach over its faces by less than half a
        voxel.
        """
        lengths = np.linalg.norm(box_to_reference[:3, :3], axis=0)
        steps = np.broadcast_to(np.asarray(spacing, dtype=np.float64), 3)
        count = np.maximum(np.ceil(np.asarray(size, dtype=np.float64) * lengths / steps - TOLERANCE), 1)
        linear = box_to_reference[:3, :3] / lengths * steps
        matrix = affine(linear, box_to_reference[:3, 3] - linear @ ((count - 1) / 2))
        i, j, k = (int(n) for n in count)
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

    def _facts(self) -> list[tuple[str, str]]:
        return self.facts()

    def matches(self, other: VoxelGrid) -> bool:
        """Whether both grids have the same voxels, to a thousandth of a voxel over the whole grid."""
        return self.size == other.size and bool(np.allclose(self.corners(), other.corners(), atol=1e-3 * self.spacing.min(), rtol=0))


AnyVolume = TypeVar("AnyVolume", bound="Volume")


@dataclass(frozen=True, eq=False, repr=False)
class Volume(Described, NDArrayOperatorsMixin):
    """Values on a voxel grid: for numpy an array, which knows where its voxels lie.

    Raises
    ------
    GeometryError
        When the array does not hold numbers along three axes, or the matrix is none of a grid.

    Notes
    -----
    ``np.asarray(volume)`` is its array, without a copy. ``volume[k, j, i]`` of slices is the part of it with the same voxels where they
    were, steps and backward ones included; it shares memory with the whole, as in numpy. Any other index takes numbers from the array:
    ``volume[40]`` is the plane k = 40, ``volume[volume > 100]`` all values above 100. Comparisons are of every voxel.

    Examples
    --------
    >>> volume = Volume(np.arange(24).reshape(2, 3, 4), np.diag([0.5, 0.5, 2.0, 1.0]))
    >>> volume.shape, volume.spacing.tolist(), int(np.max(volume))
    ((2, 3, 4), [0.5, 0.5, 2.0], 23)
    >>> part = volume[1:, :, ::-2]
    >>> part.shape, part.origin.tolist(), part.spacing.tolist()
    ((1, 3, 2), [1.5, 0.0, 2.0], [1.0, 0.5, 2.0])
    >>> volume[1].shape, int((volume > 20).sum()), volume.mean()
    ((3, 4), 3, 11.5)
    """

    array: Numbers  #: [k, j, i] array_like of numbers
    ijk_to_reference: Matrix  #: (4, 4) array_like, mm
    fields: Mapping[str, str] = field(default_factory=dict)
    """Where it comes from, for the header of its file; see `AIFReconLib.provenance`."""

    __iter__ = None
    """Python would ask for one index after the other, which are no parts that keep their place."""

    def __post_init__(self) -> None:
        array = np.asarray(self.array)
        if array.ndim != 3:
            raise GeometryError(f"Input volume array must have shape (k, j, i); got {array.shape}.")
        if array.dtype.kind not in "biuf":
            raise GeometryError(f"Input volume array must hold real numbers; got {array.dtype}.")
        object.__setattr__(self, "array", array)
        object.__setattr__(self, "ijk_to_reference", self.grid.ijk_to_reference)

    @cached_property
    def grid(self) -> VoxelGrid:
        """Where its voxels are."""
        k, j, i = self.array.shape
        return VoxelGrid((i, j, k), self.ijk_to_reference)

    @property
    def shape(self) -> tuple[int, int, int]:
        """The shape of the array: [k, j, i]."""
        return self.grid.shape

    @property
    def affine(self) -> Matrix:
        """`ijk_to_reference` by nibabel's name: voxel (i, j, k) to RAS, (4, 4), mm. The array is [k, j, i], nibabel's is [i, j, k]."""
        return self.ijk_to_reference

    @property
    def dtype(self) -> NumberType:
        """Type of a voxel."""
        return self.array.dtype

    @property
    def spacing(self) -> Floats:
        """Distance between voxel centers along i, j, k in mm, (3,) float64."""
        return self.grid.spacing

    @property
    def origin(self) -> Floats:
        """Center of voxel (0, 0, 0) in Reference, (3,) float64, mm."""
        return self.grid.origin

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> Array:
        """The array, for numpy: itself where its type is the wanted one and no copy is asked for."""
        wanted = self.array.dtype if dtype is None else np.dtype(dtype)
        if copy is False and wanted != self.array.dtype:
            raise ValueError(f"Input copy must be True or None to make {wanted} of {self.array.dtype}; got False.")
        return self.array.astype(wanted, copy=bool(copy))

    @overload
    def __getitem__(self, index: slice | EllipsisType | tuple[slice | EllipsisType, ...]) -> Volume: ...

    @overload
    def __getitem__(self, index: int | Integers | Mask | list[int] | Volume) -> Numbers: ...

    def __getitem__(self, index: Any) -> Volume | Numbers:
        """The part within slices along k, j, i, where it was; those not given are whole, and ``...`` stands for them. Else numpy's answer.

        Raises GeometryError when the index leaves no voxel, or is none of three axes.
        """
        given = index if isinstance(index, tuple) else (index,)
        if not all(isinstance(along, slice | EllipsisType) for along in given):
            try:
                values: Numbers = self.array[np.asarray(index) if isinstance(index, Volume) else index]
            except IndexError as error:
                raise GeometryError(f"Input index must be of {self.shape} voxels along k, j, i: {error}.") from None
            return values
        rest = [at for at, along in enumerate(given) if along is Ellipsis]
        if len(rest) == 1:
            given = (*given[: rest[0]], *(slice(None),) * (4 - len(given)), *given[rest[0] + 1 :])
        slices = [along for along in given if isinstance(along, slice)]
        if len(given) > 3 or len(slices) < len(given):
            raise GeometryError(f"Input index must be up to three slices, in the order k, j, i; got {index!r}.")
        to_whole = np.eye(4)
        for axis, (along, count) in enumerate(zip(slices, self.shape)):
            chosen = range(count)[along]
            if not chosen:
                raise GeometryError(f"Input index must leave voxels; got {index!r} of {self.shape} along k, j, i.")
            to_whole[2 - axis, 2 - axis], to_whole[2 - axis, 3] = chosen.step, chosen.start
        return replace(self, array=self.array[tuple(slices)], ijk_to_reference=self.ijk_to_reference @ to_whole, fields={})

    def __array_ufunc__(self, function: np.ufunc, method: str, *inputs: Any, **named: Any) -> Any:
        """Arithmetic and comparisons are numpy's, of every voxel."""
        return getattr(function, method)(*(each.array if isinstance(each, Volume) else each for each in inputs), **named)

    __hash__ = object.__hash__

    def min(self) -> float:
        """The least value."""
        return float(self.array.min())

    def max(self) -> float:
        """The largest value."""
        return float(self.array.max())

    def mean(self) -> float:
        """The mean of all voxels."""
        return float(self.array.mean(dtype=np.float64))

    @classmethod
    def from_sitk(cls, image: object) -> Volume:
        """A `SimpleITK.Image` of one scalar 3D volume, its voxels copied, in RAS.

        Raises
        ------
        GeometryError
            When it is another thing: a picture, a series, colors, complex numbers.
        """
        volume: Volume = _way_out("from_sitk")(image)
        return volume

    def to_sitk(self) -> Any:
        """A `SimpleITK.Image` with a copy of the voxels, in LPS; truth values become 0 and 1.

        Raises
        ------
        GeometryError
            When SimpleITK has no such voxels: half precision, or numbers of more than 64 bits.
        """
        return _way_out("to_sitk")(self)

    def placed_by(self: AnyVolume, volume_to_reference: Matrix | None) -> AnyVolume:
        """The same voxels moved by a (4, 4) transform, e.g. a CT put into Reference by its registration; None moves nothing."""
        if volume_to_reference is None:
            return self
        placed = as_matrix(volume_to_reference, "volume_to_reference") @ self.ijk_to_reference
        return replace(self, ijk_to_reference=placed, fields={})

    def _facts(self) -> list[tuple[str, str]]:
        values = f"{self.array.dtype}, {self.array.min():g} to {self.array.max():g}"
        return [*self.grid.facts(), ("values", values)]

    def plot(self, mask: Volume | None = None, labels: Volume | None = None, ct: Volume | None = None, title: str = "") -> Picture:
        """A picture of three cuts through the bone and a projection, which a notebook shows; see `AIFReconLib.evaluation.preview`."""
        picture: Picture = _way_out("preview")(self, mask, labels, ct, title)
        return picture

    def write(self, path: str | Path) -> None:
        """Write to a volume file (.nrrd, .mha, .mhd, .nii, .nii.gz, .dcm): LPS in the file, so that it opens in Slicer where it belongs.

        Its `fields` go into the header, of NIfTI into a .json file beside it.

        Raises
        ------
        OutputError
            When it cannot be written; no partial file is left.
        """
        _way_out("write_volume")(self, path)


def as_volume(values: Volume | ArrayLike, ijk_to_reference: ArrayLike | None, name: str) -> Volume:
    """A volume, or an array with the matrix that places it, as a volume; `name` is what the caller knows it as.

    Raises InputTypeError when it is neither: a path, an array without a matrix, a volume with one.
    """
    if isinstance(values, Volume):
        if ijk_to_reference is not None:
            raise InputTypeError(
                f"Input ijk_to_reference places an array, and {name} is a Volume, which has a place. Leave it out, or give "
                f"{name}_to_reference."
            )
        return values
    if isinstance(values, str | Path):
        raise not_of_kind(name, values, (Volume,), "Read it first: read_volume(path).")
    if ijk_to_reference is not None:
        return Volume(np.asarray(values), as_matrix(ijk_to_reference, "ijk_to_reference"))
    raise not_of_kind(name, values, (Volume,), "Give ijk_to_reference, a (4, 4) matrix in mm, with an array, or Volume.from_sitk(image).")


def nearest(volume: Volume, ijk: Floats, outside: float = 0) -> Numbers:
    """Values of the nearest voxels to points (n, 3) given as (i, j, k); `outside` beyond the volume."""
    numbers = np.floor(ijk + 0.5).astype(np.int64)
    known = ((numbers >= 0) & (numbers < volume.grid.size)).all(axis=1)
    numbers[~known] = 0
    return np.where(known, volume.array[numbers[:, 2], numbers[:, 1], numbers[:, 0]], outside)
