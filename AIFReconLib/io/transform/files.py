"""Linear transforms in ITK files, as Slicer saves them: .tfm, .txt, .h5.

Slicer stores, in LPS, the transform that takes points of the parent to the node's own frame, because ITK resamples that way.
The matrix of the node is its inverse, in RAS: node = F inv(file) F with F = diag(-1, -1, 1, 1).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import SimpleITK as sitk

from ...arrays import Matrix
from ...errors import FileFormatError, GeometryError, OutputError
from ...geometry.transforms import as_matrix, invert, ras_to_lps
from ..disk.atomic import atomic_output
from ..disk.itk import itk_path, itk_reads
from ..disk.small_files import read_bytes

TEXT_SUFFIXES = (".tfm", ".txt")
HDF5_SUFFIXES = (".h5", ".hdf5")
_SUFFIXES = TEXT_SUFFIXES + HDF5_SUFFIXES

_FAR = 2.0**20
"""mm from the origin to the points whose images are asked for: not much less than any translation, which would cost digits."""


def read_transform(path: str | Path) -> Matrix:
    """The matrix of a linear transform node that Slicer saved: from the node's frame to its parent, in RAS.

    Parameters
    ----------
    path : str or Path
        .tfm, .txt, .h5 or .hdf5. Any linear ITK transform, or several composed.

    Returns
    -------
    node_to_parent : (4, 4) float64 array, mm

    Raises
    ------
    FileFormatError
        When the file is damaged, or the transform is not linear, not 3D or not invertible.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in _SUFFIXES:
        raise FileFormatError(f"{path}: its suffix must be one of {', '.join(_SUFFIXES)}. Save the transform from Slicer as one.")
    data = read_bytes(path, None, FileFormatError)
    if not data.startswith(b"#Insight Transform File" if suffix in TEXT_SUFFIXES else b"\x89HDF\r\n\x1a\n"):
        raise FileFormatError(f"{path}: this is not an ITK transform file. Save the transform from Slicer as .tfm or .h5.")
    if suffix in TEXT_SUFFIXES:
        _, *parts = data.split(b"\nTransform:")
        if len(parts) > 1 and b"CompositeTransform" not in data:
            raise FileFormatError(f"{path}: the transform must be one, or several in a composite; got {len(parts)}. Save one of them.")
        if parts and b"\nFixedParameters:" not in parts[-1]:
            raise FileFormatError(f"{path}: the transform is cut short. Save it from Slicer again.")
    with itk_reads(path, FileFormatError, "Save the transform from Slicer again.") as name:
        transform = sitk.ReadTransform(name)
    if transform.GetDimension() != 3 or not transform.IsLinear():
        got = f"{transform.GetName()} of {transform.GetDimension()} dimensions"
        raise FileFormatError(f"{path}: the transform must be linear and 3D; got {got}. Give a rigid or affine registration.")
    try:
        return ras_to_lps(invert(as_matrix(_matrix_of(transform), "transform")))
    except GeometryError as error:
        raise FileFormatError(f"{path}: the transform cannot be used. {error} Save the transform from Slicer again.") from error


def write_transform(node_to_parent: Matrix, path: str | Path) -> None:
    """Write a linear transform so that Slicer loads it as a node with this matrix.

    Raises OutputError when it cannot be written; GeometryError when the matrix is not finite or not invertible.

    Parameters
    ----------
    node_to_parent : (4, 4) array_like, mm
        In RAS.
    path : str or Path
        .tfm, .txt, .h5 or .hdf5.
    """
    path = Path(path)
    if path.suffix.lower() not in _SUFFIXES:
        raise OutputError(f"Cannot write {path}: its suffix must be one of {', '.join(_SUFFIXES)}. Choose another name.")
    itk = ras_to_lps(invert(as_matrix(node_to_parent, "node_to_parent")))
    transform = sitk.AffineTransform(itk[:3, :3].ravel().tolist(), itk[:3, 3].tolist())
    with atomic_output(path) as temporary:
        try:
            sitk.WriteTransform(transform, itk_path(temporary, OutputError))
            read_transform(temporary)
        except (RuntimeError, FileFormatError) as error:  # SimpleITK does not notice that a disk is full
            raise OutputError(f"Cannot write {path}: the file came out incomplete. Check that the disk is not full.") from error


def _matrix_of(transform: sitk.Transform) -> Matrix:
    """The matrix of a linear transform of any kind, (4, 4), known from the images of the origin and a point on each axis."""
    matrix = np.eye(4)
    with np.errstate(all="ignore"):  # whatever overflows is refused by who takes the matrix
        origin, *ends = map(transform.TransformPoint, ((0.0, 0.0, 0.0), *(_FAR * np.eye(3)).tolist()))
        matrix[:3, 3] = origin
        matrix[:3, :3] = np.subtract(ends, origin).T / _FAR
    return matrix
