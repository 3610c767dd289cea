"""ITK's linear transforms from their kind and numbers, as transform files list them."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import SimpleITK as sitk

from ...arrays import Matrix
from ...errors import AIFReconError

COMPOSITE = "CompositeTransform"

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
"""By ITK's name: how many parameters it has, and how many fixed ones. ITK trusts that there are so many."""

_FAR = 2.0**20
"""mm from the origin to the points whose images are asked for: not much less than any translation, which would cost digits."""


class TransformPartError(AIFReconError, ValueError):
    """What is wrong with a transform, as the predicate of "the transform ..."."""


@dataclass(frozen=True)
class TransformPart:
    """One transform of a file: ``AffineTransform_double_3_3``, its parameters and fixed parameters."""

    kind: str
    parameters: tuple[float, ...] = ()
    fixed: tuple[float, ...] = ()


def composed(parts: list[TransformPart], folder: Path) -> Matrix:
    """The matrix of a file's transforms, (4, 4), mm: of the only one, or of those behind a CompositeTransform, the last applied first.

    Raises TransformPartError when there is none, more than one without a composite, or one that is not linear or not 3D.

    Parameters
    ----------
    parts : list of TransformPart
    folder : Path
        Where a file can be put for SimpleITK.
    """
    if not parts:
        raise TransformPartError("is missing: the file holds none. Save the transform from Slicer again.")
    if _name(parts[0]) == COMPOSITE:
        parts = parts[1:]
    elif len(parts) > 1:
        raise TransformPartError(f"must be one, or several in a composite; got {len(parts)}. Save one of them.")
    matrix, checked = np.eye(4), folder / "checked.tfm"
    with np.errstate(all="ignore"):  # whatever overflows is refused by who takes the matrix
        for part in parts:
            # Alone, SimpleITK takes some kinds only; within a composite it leaves all to ITK
            lines = ("#Insight Transform File V1.0", *_lines(TransformPart(COMPOSITE)), *_checked(part), "")
            checked.write_text("\n".join(lines), "ascii")
            try:
                matrix = matrix @ matrix_of(sitk.ReadTransform(str(checked)))
            except RuntimeError:
                raise TransformPartError("has numbers that ITK does not take. Save the transform from Slicer again.") from None
    return matrix


def matrix_of(transform: sitk.Transform) -> Matrix:
    """The matrix of a linear transform of any kind, (4, 4), known from the images of the origin and a point on each axis."""
    origin, *ends = map(transform.TransformPoint, ((0.0, 0.0, 0.0), *(_FAR * np.eye(3)).tolist()))
    matrix = np.eye(4)
    matrix[:3, 3] = origin
    matrix[:3, :3] = np.subtract(ends, origin).T / _FAR
    return matrix


def _lines(part: TransformPart) -> tuple[str, ...]:
    numbers = [" ".join(map(repr, some)) for some in (part.parameters, part.fixed)]
    return f"Transform: {part.kind}_double_3_3", f"Parameters: {numbers[0]}", f"FixedParameters: {numbers[1]}"


def _name(part: TransformPart) -> str:
    """The kind without its type of numbers and its dimensions, which must be 3."""
    words = re.fullmatch(r"(\w+)_(double|float)_([0-9]+)_([0-9]+)", part.kind, re.ASCII)
    if words is None:
        raise TransformPartError(
            f"must be of a kind of ITK, as AffineTransform_double_3_3; got {part.kind[:60]!r}. Save the transform from Slicer again."
        )
    if (words[3], words[4]) != ("3", "3"):
        raise TransformPartError(f"must be 3D; got {words[3][:9]} dimensions. Give a 3D transform.")
    return words[1]


def _checked(part: TransformPart) -> tuple[str, ...]:
    """The lines of a linear transform that has all its numbers."""
    name = _name(part)
    if name not in _KINDS:
        raise TransformPartError(f"must be linear; got {name[:60]}. Give a rigid or affine registration.")
    count, fixed_counts = _KINDS[name]
    if len(part.parameters) != count or len(part.fixed) not in fixed_counts or not np.isfinite([*part.parameters, *part.fixed]).all():
        raise TransformPartError(
            f"of kind {name} must have {count} finite parameters and {' or '.join(map(str, fixed_counts))} fixed ones; got "
            f"{len(part.parameters)} and {len(part.fixed)}. Save the transform from Slicer again."
        )
    return _lines(replace(part, kind=name))
