"""Linear transforms in ITK files, as Slicer saves them: .tfm, .txt, .h5.

Slicer stores, in LPS, the transform that takes points of the parent to the node's own frame, because ITK resamples that way.
The matrix of the node is its inverse, in RAS: node = F inv(file) F with F = diag(-1, -1, 1, 1).
"""

from __future__ import annotations

import re
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

TEXT_SUFFIXES = (".tfm", ".txt")
HDF5_SUFFIXES = (".h5", ".hdf5")
_SUFFIXES = TEXT_SUFFIXES + HDF5_SUFFIXES
_MAGIC = {**dict.fromkeys(TEXT_SUFFIXES, b"#Insight Transform File"), **dict.fromkeys(HDF5_SUFFIXES, b"\x89HDF\r\n\x1a\n")}

MAXIMUM_BYTES = 2**24
"""A linear transform takes a few thousand."""

_COMPOSITE = "CompositeTransform"
_HEAD = f"#Insight Transform File V1.0\nTransform: {_COMPOSITE}_double_3_3\nParameters:\nFixedParameters:\n"
"""Alone, SimpleITK takes some kinds only; within a composite it leaves all to ITK."""

_KINDS: dict[str, tuple[int, tuple[int, ...]]] = {
    "AffineTransform": (12, (3,)),
    "MatrixOffsetTransformBase": (12, (3,)),
    "Rigid3DTransform": (12, (3,)),
    # Older files do not say whether the turns are about z, y, x
    "Euler3DTransform": (6, (3, 4)),
    "VersorTransform": (3, (3,)),
    "VersorRigid3DTransform": (6, (3,)),
    "Similarity3DTransform": (7, (3,)),
    "ScaleTransform": (3, (3,)),
    "ScaleVersor3DTransform": (9, (3,)),
    "ScaleSkewVersor3DTransform": (15, (3,)),
    "ComposeScaleSkewVersor3DTransform": (12, (3,)),
    "TranslationTransform": (3, (0,)),
    "IdentityTransform": (0, (0,)),
    "FixedCenterOfRotationAffineTransform": (12, (3,)),
    "ScalableAffineTransform": (12, (3,)),
    "CenteredAffineTransform": (15, (3,)),
    "CenteredEuler3DTransform": (9, (3, 4)),
    "QuaternionRigidTransform": (7, (3,)),
    "ScaleLogarithmicTransform": (3, (3,)),
}
"""By ITK's name: how many parameters it has, and how many fixed ones. ITK crashes where there are fewer."""

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
    TransformFileError
        When the file is damaged, or the transform is not linear, not 3D or not invertible.
    """
    path = Path(path)
    seen, data = file_stamp(path), _read(path)
    # SimpleITK finds no names beyond ASCII on Windows
    with local_copy(path, TransformFileError, seen) as copy:
        text = data.decode("utf-8", "replace") if path.suffix.lower() in TEXT_SUFFIXES else _as_text(path, copy)
        checked = copy.with_name("checked.tfm")
        checked.write_text(_HEAD + _linear_parts(path, text), "ascii")
        try:
            itk = _matrix_of(sitk.ReadTransform(str(checked)))
        except RuntimeError:
            raise _refusal(path, "has numbers that ITK does not take. Save the transform from Slicer again.") from None
    try:
        return ras_to_lps(invert(as_matrix(itk, "transform")))
    except GeometryError as error:
        raise _refusal(path, f"cannot be used. {error} Save the transform from Slicer again.") from error


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
        cause = ""
        try:
            sitk.WriteTransform(transform, itk_path(temporary, OutputError))
            # SimpleITK does not notice that a disk is full
            cause = "the file came out incomplete"
            written = ras_to_lps(invert(_matrix_of(sitk.ReadTransform(itk_path(temporary, OutputError)))))
            cause = "the file came out different"
        except (RuntimeError, GeometryError) as error:
            written, cause = np.full((4, 4), np.nan), cause or short_cause(error)
        # Inverting twice costs digits of the largest number, here a translation
        if not np.allclose(written, node_to_parent, rtol=0, atol=1e-9 * max(1.0, np.abs(node_to_parent).max())):
            raise OutputError(f"Cannot write {path}: {cause}. Check that the disk is not full, or choose another path.")


def _refusal(path: Path, problem: str) -> TransformFileError:
    return TransformFileError(f"{path}: the transform {problem}")


def _matrix_of(transform: sitk.Transform) -> Matrix:
    """The matrix of a linear transform of any kind, (4, 4), known from the images of the origin and a point on each axis."""
    matrix = np.eye(4)
    with np.errstate(all="ignore"):  # whatever overflows is refused by who takes the matrix
        origin, *ends = map(transform.TransformPoint, ((0.0, 0.0, 0.0), *(_FAR * np.eye(3)).tolist()))
        matrix[:3, 3] = origin
        matrix[:3, :3] = np.subtract(ends, origin).T / _FAR
    return matrix


def _read(path: Path) -> bytes:
    """The bytes of a file that begins as one of its suffix must."""
    suffix = path.suffix.lower()
    if suffix not in _SUFFIXES:
        raise TransformFileError(f"{path}: its suffix must be one of {', '.join(_SUFFIXES)}. Save the transform from Slicer as one.")
    data = read_bytes(path, MAXIMUM_BYTES + 1, TransformFileError)
    if not data.startswith(_MAGIC[suffix]):
        raise TransformFileError(f"{path}: this is not an ITK transform file. Save the transform from Slicer as .tfm or .h5.")
    if len(data) > MAXIMUM_BYTES:
        raise _refusal(path, f"must be linear, and the file is longer than {MAXIMUM_BYTES} bytes. Give a rigid or affine registration.")
    return data


def _as_text(path: Path, copy: Path) -> str:
    """What a file of HDF5 is as a .tfm file, which is made beside its copy."""
    text = copy.with_suffix(".tfm")
    try:
        with without_warnings():
            sitk.WriteTransform(sitk.ReadTransform(str(copy)), str(text))
    except RuntimeError as error:
        why = short_cause(error)
        raise _refusal(path, f"is damaged, or cannot be read from HDF5: {why}. Save it from Slicer again, or as .tfm.") from error
    return text.read_text("utf-8", "replace")


def _linear_parts(path: Path, text: str) -> str:
    """The blocks of a file in text, without a CompositeTransform in front, each checked to be linear and to have all its numbers."""
    parts: list[dict[str, str]] = []
    for line in text.splitlines():
        if line.startswith("#") or not line.strip():
            continue
        key, colon, value = (word.strip() for word in line.partition(":"))
        if key == "Transform" and colon:
            parts.append({"Parameters": "", "FixedParameters": ""})
        if not parts or not colon or key not in ("Transform", "Parameters", "FixedParameters") or parts[-1].get(key):
            raise _refusal(
                path, f"has a line that is none of an ITK transform file: {shorten(line)!r}. Save the transform from Slicer again."
            )
        parts[-1][key] = value
    if not parts:
        raise _refusal(path, "is missing: the file holds none. Save the transform from Slicer again.")
    if parts[0]["Transform"].startswith(f"{_COMPOSITE}_"):
        parts = parts[1:]
    elif len(parts) > 1:
        raise _refusal(path, f"must be one, or several in a composite; got {len(parts)}. Save one of them.")
    return "".join(_linear_part(path, part) for part in parts)


def _linear_part(path: Path, part: dict[str, str]) -> str:
    words = re.fullmatch(r"(\w+)_(double|float)_([0-9]+)_([0-9]+)", part["Transform"], re.ASCII)
    if words is None:
        got = f"got {part['Transform'][:60]!r}. Save the transform from Slicer again."
        raise _refusal(path, f"must be of a kind of ITK, as AffineTransform_double_3_3; {got}")
    if (words[3], words[4]) != ("3", "3"):
        raise _refusal(path, f"must be 3D; got {words[3][:9]} dimensions. Give a 3D transform.")
    if words[1] not in _KINDS:
        raise _refusal(path, f"must be linear; got {words[1][:60]}. Give a rigid or affine registration.")
    parameters, fixed = _numbers(path, part, "Parameters"), _numbers(path, part, "FixedParameters")
    count, fixed_counts = _KINDS[words[1]]
    if len(parameters) != count or len(fixed) not in fixed_counts or not np.isfinite([*parameters, *fixed]).all():
        raise _refusal(
            path,
            f"of kind {words[1]} must have {count} finite parameters and {' or '.join(map(str, fixed_counts))} fixed ones; got "
            f"{len(parameters)} and {len(fixed)}. Save the transform from Slicer again.",
        )
    numbers = [" ".join(map(repr, some)) for some in (parameters, fixed)]
    return f"Transform: {words[1]}_double_3_3\nParameters: {numbers[0]}\nFixedParameters: {numbers[1]}\n"


def _numbers(path: Path, part: dict[str, str], key: str) -> list[float]:
    try:
        return parse_numbers(part[key])
    except NotANumberError as error:
        raise _refusal(path, f"has {key} that must be numbers; {error}. Save the transform from Slicer again.") from None
