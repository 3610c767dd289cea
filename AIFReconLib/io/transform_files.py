"""Linear transforms in ITK files, as Slicer saves them: .tfm, .txt, .h5.

Slicer stores, in LPS, the transform that takes points of the parent to the node's own frame, because ITK resamples that way.
The matrix of the node is its inverse, in RAS: node = F inv(file) F with F = diag(-1, -1, 1, 1).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import SimpleITK as sitk

from ..errors import GeometryError, OutputError, TransformFileError
from ..transforms import as_matrix, invert, ras_to_lps
from .atomic import atomic_output
from .itk_errors import short_cause
from .metafile import require_regular_file

TEXT_SUFFIXES = (".tfm", ".txt")
HDF5_SUFFIXES = (".h5", ".hdf5")

_TEXT_MAGIC = b"#Insight Transform File"
_HDF5_MAGIC = b"\x89HDF\r\n\x1a\n"


def read_transform(path: str | Path) -> np.ndarray:
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
    TransformFileError
        When the file is damaged, or the transform is not linear, not 3D or not invertible.
    """
    path = Path(path)
    _check_kind(path)
    try:
        transform = sitk.ReadTransform(str(path))
    except RuntimeError as error:
        raise TransformFileError(
            f"{path}: SimpleITK cannot read it: {short_cause(error)}. Save the transform from Slicer again."
        ) from error
    if transform.GetDimension() != 3:
        raise TransformFileError(f"{path}: the transform must be 3D; got {transform.GetDimension()} dimensions. Give a 3D transform.")
    if not transform.IsLinear():
        raise TransformFileError(f"{path}: the transform must be linear; got {transform.GetName()}. Give a rigid or affine registration.")
    # An affine map is known from the images of the origin and the unit points; this holds for every linear kind and any composition.
    itk = np.eye(4)
    itk[:3, 3] = transform.TransformPoint((0.0, 0.0, 0.0))
    for axis in range(3):
        itk[:3, axis] = np.subtract(transform.TransformPoint(np.eye(3)[axis].tolist()), itk[:3, 3])
    try:
        return ras_to_lps(invert(as_matrix(itk, "transform")))
    except GeometryError as error:
        raise TransformFileError(f"{path}: the transform cannot be used. {error} Save the transform from Slicer again.") from error


def write_transform(node_to_parent: np.ndarray, path: str | Path) -> None:
    """Write a linear transform so that Slicer loads it as a node with this matrix.

    Parameters
    ----------
    node_to_parent : (4, 4) array_like, mm
        In RAS.
    path : str or Path
        .tfm, .txt, .h5 or .hdf5.

    Raises
    ------
    OutputError
        When it cannot be written.
    GeometryError
        When the matrix is not finite or not invertible.
    """
    path = Path(path)
    if path.suffix.lower() not in TEXT_SUFFIXES + HDF5_SUFFIXES:
        raise OutputError(
            f"Cannot write {path}: its suffix must be one of {', '.join(TEXT_SUFFIXES + HDF5_SUFFIXES)}. Choose another name."
        )
    itk = ras_to_lps(invert(as_matrix(node_to_parent, "node_to_parent")))
    transform = sitk.AffineTransform(3)
    transform.SetMatrix(itk[:3, :3].ravel().tolist())
    transform.SetTranslation(itk[:3, 3].tolist())
    with atomic_output(path) as temporary:
        try:
            sitk.WriteTransform(transform, str(temporary))
        except RuntimeError as error:
            raise OutputError(
                f"Cannot write {path}: {short_cause(error)}. Check that the disk is not full, or choose another path."
            ) from error


def _check_kind(path: Path) -> None:
    """Refuse what is no transform file before SimpleITK sees it: its HDF5 reader prints pages of complaints."""
    suffix = path.suffix.lower()
    if suffix not in TEXT_SUFFIXES + HDF5_SUFFIXES:
        raise TransformFileError(
            f"{path}: its suffix must be one of {', '.join(TEXT_SUFFIXES + HDF5_SUFFIXES)}. Save the transform from Slicer as one."
        )
    require_regular_file(path, TransformFileError)
    try:
        with open(path, "rb") as file:
            head = file.read(64)
    except OSError as error:
        raise TransformFileError(f"{path}: the file cannot be read ({error.strerror}). Check its permissions.") from error
    if not head.startswith(_TEXT_MAGIC if suffix in TEXT_SUFFIXES else _HDF5_MAGIC):
        raise TransformFileError(f"{path}: this is not an ITK transform file. Save the transform from Slicer as .tfm or .h5.")
    if suffix in HDF5_SUFFIXES and path.stat().st_size < _hdf5_length(head):
        raise TransformFileError(f"{path}: the file is cut short. Copy it again.")


def _hdf5_length(head: bytes) -> int:
    """The length that an HDF5 superblock declares; its place depends on the version."""
    start = 28 if head[8:9] >= b"\2" else 40
    return int.from_bytes(head[start : start + 8], "little")
