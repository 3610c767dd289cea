"""Linear transforms in ITK files, as Slicer saves them: .tfm, .txt, .h5.

Slicer stores, in LPS, the transform that takes points of the parent to the node's own frame, because ITK resamples that way.
The matrix of the node is its inverse, in RAS: node = F inv(file) F with F = diag(-1, -1, 1, 1).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import SimpleITK as sitk

from ...arrays import Matrix
from ...errors import GeometryError, OutputError, TransformFileError
from ...geometry.transforms import as_matrix, invert, ras_to_lps
from ...message import shorten
from ..disk.atomic import atomic_output
from ..disk.itk import itk_path, short_cause, without_warnings
from ..disk.regular_files import file_stamp
from ..disk.small_files import local_copy, read_bytes
from ..metafile.text_values import NotANumberError, parse_numbers
from .parts import TransformPart, TransformPartError, composed, matrix_of

TEXT_SUFFIXES = (".tfm", ".txt")
HDF5_SUFFIXES = (".h5", ".hdf5")
TEXT_MAGIC = "#Insight Transform File"
HDF5_MAGIC = b"\x89HDF\r\n\x1a\n"

MAXIMUM_BYTES = 2**24
"""A linear transform takes a few thousand."""


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
    TransformFileError
        When the file is damaged, or the transform is not linear, not 3D or not invertible.
    """
    path = Path(path)
    seen, data = file_stamp(path), _read(path)
    try:
        # SimpleITK finds no names beyond ASCII on Windows
        with local_copy(path, TransformFileError, seen) as copy:
            text = _as_text(copy) if path.suffix.lower() in HDF5_SUFFIXES else data.decode("utf-8", "replace")
            itk = composed(read_transform_text(text), copy.parent)
    except TransformPartError as error:
        raise TransformFileError(f"{path}: the transform {error}") from error
    try:
        return ras_to_lps(invert(as_matrix(itk, "transform")))
    except GeometryError as error:
        raise TransformFileError(f"{path}: the transform cannot be used. {error} Save the transform from Slicer again.") from error


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
            sitk.WriteTransform(transform, itk_path(temporary, OutputError))
        except RuntimeError as error:
            raise _not_written(path, short_cause(error)) from error
        # SimpleITK does not notice that a disk is full
        try:
            written = ras_to_lps(invert(matrix_of(sitk.ReadTransform(itk_path(temporary, OutputError)))))
        except (RuntimeError, GeometryError) as error:
            raise _not_written(path, "the file came out incomplete") from error
        # Inverting twice costs digits of the largest number, here a translation
        if not np.allclose(written, node_to_parent, rtol=0, atol=1e-9 * max(1.0, np.abs(node_to_parent).max())):
            raise _not_written(path, "the file came out different")


def _as_text(path: Path) -> str:
    """What a file of HDF5 is as a .tfm file, which is made beside it."""
    text = path.with_suffix(".tfm")
    try:
        with without_warnings():
            sitk.WriteTransform(sitk.ReadTransform(str(path)), str(text))
    except RuntimeError as error:
        why = short_cause(error)
        raise TransformPartError(f"is damaged, or cannot be read from HDF5: {why}. Save it from Slicer again, or as .tfm.") from error
    return text.read_text("utf-8", "replace")


def _not_written(path: Path, cause: str) -> OutputError:
    return OutputError(f"Cannot write {path}: {cause}. Check that the disk is not full, or choose another path.")


def _read(path: Path) -> bytes:
    """The bytes of a file that begins as one of its suffix must."""
    suffix = path.suffix.lower()
    if suffix not in TEXT_SUFFIXES + HDF5_SUFFIXES:
        raise TransformFileError(
            f"{path}: its suffix must be one of {', '.join(TEXT_SUFFIXES + HDF5_SUFFIXES)}. Save the transform from Slicer as one."
        )
    data = read_bytes(path, MAXIMUM_BYTES + 1, TransformFileError)
    if not data.startswith(TEXT_MAGIC.encode() if suffix in TEXT_SUFFIXES else HDF5_MAGIC):
        raise TransformFileError(f"{path}: this is not an ITK transform file. Save the transform from Slicer as .tfm or .h5.")
    if len(data) > MAXIMUM_BYTES:
        raise TransformFileError(
            f"{path}: the transform must be linear, and the file is longer than {MAXIMUM_BYTES} bytes. Give a rigid or affine registration."
        )
    return data


def read_transform_text(text: str) -> list[TransformPart]:
    """The transforms of a file in text, in its order: blocks of ``Transform:``, ``Parameters:`` and ``FixedParameters:``.

    Raises TransformPartError when a line is none of such a file.
    """
    blocks: list[dict[str, str]] = []
    for line in text.splitlines():
        if line.startswith("#") or not line.strip():
            continue
        key, colon, value = (word.strip() for word in line.partition(":"))
        if key == "Transform" and colon:
            blocks.append({})
        if not blocks or not colon or key not in ("Transform", "Parameters", "FixedParameters") or key in blocks[-1]:
            raise TransformPartError(
                f"has a line that is none of an ITK transform file: {shorten(line)!r}. Save the transform from Slicer again."
            )
        blocks[-1][key] = value
    return [TransformPart(block["Transform"], _numbers(block, "Parameters"), _numbers(block, "FixedParameters")) for block in blocks]


def _numbers(block: dict[str, str], key: str) -> tuple[float, ...]:
    try:
        return tuple(parse_numbers(block.get(key, "")))
    except NotANumberError as error:
        raise TransformPartError(f"has {key} that must be numbers; {error}. Save the transform from Slicer again.") from None
