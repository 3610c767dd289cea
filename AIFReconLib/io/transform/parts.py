"""ITK's linear transforms from their kind and numbers, as transform files list them."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy
import SimpleITK as sitk

from ...arrays import Matrix
from ...errors import AIFReconError

COMPOSITE = "CompositeTransform"

_KINDS: dict[str, tuple[Callable[[], sitk.Transform], int, tuple[int, ...]]] = {
    "AffineTransform": (lambda: sitk.AffineTransform(3), 12, (3,)),
    "MatrixOffsetTransformBase": (lambda: sitk.AffineTransform(3), 12, (3,)),
    "Rigid3DTransform": (lambda: sitk.AffineTransform(3), 12, (3,)),
    "Euler3DTransform": (sitk.Euler3DTransform, 6, (3, 4)),
    "VersorTransform": (sitk.VersorTransform, 3, (3,)),
    "VersorRigid3DTransform": (sitk.VersorRigid3DTransform, 6, (3,)),
    "Similarity3DTransform": (sitk.Similarity3DTransform, 7, (3,)),
    "ScaleTransform": (lambda: sitk.ScaleTransform(3), 3, (3,)),
    "ScaleVersor3DTransform": (sitk.ScaleVersor3DTransform, 9, (3,)),
    "ScaleSkewVersor3DTransform": (sitk.ScaleSkewVersor3DTransform, 15, (3,)),
    "ComposeScaleSkewVersor3DTransform": (sitk.ComposeScaleSkewVersor3DTransform, 12, (3,)),
    "TranslationTransform": (lambda: sitk.TranslationTransform(3), 3, (0,)),
    "IdentityTransform": (lambda: sitk.Transform(3, sitk.sitkIdentity), 0, (0,)),
    "FixedCenterOfRotationAffineTransform": (lambda: sitk.AffineTransform(3), 12, (3,)),
    "ScalableAffineTransform": (lambda: sitk.AffineTransform(3), 12, (3,)),
    "CenteredAffineTransform": (lambda: sitk.AffineTransform(3), 15, (3,)),
    "CenteredEuler3DTransform": (sitk.Euler3DTransform, 9, (3, 4)),
    "QuaternionRigidTransform": (lambda: sitk.AffineTransform(3), 7, (3,)),
    "ScaleLogarithmicTransform": (lambda: sitk.ScaleTransform(3), 3, (3,)),
}
"""By ITK's name: an object of that kind, or of one that it can be put as; how many parameters it has, and how many fixed ones."""

_Numbers = tuple[float, ...]

_PUT_OTHERWISE: dict[str, Callable[[_Numbers, _Numbers], tuple[_Numbers, _Numbers]]] = {
    "CenteredAffineTransform": lambda numbers, fixed: (numbers[:9] + numbers[12:], numbers[9:12]),
    # Older files do not say whether the turns are about z, y, x
    "Euler3DTransform": lambda numbers, fixed: (numbers, (*fixed, 0.0)[:4]),
    "CenteredEuler3DTransform": lambda numbers, fixed: (numbers[:3] + numbers[6:], (*numbers[3:6], *fixed[3:], 0.0)[:4]),
    "QuaternionRigidTransform": lambda numbers, fixed: (_turned(*numbers[:4]) + numbers[4:], fixed),
    "ScaleLogarithmicTransform": lambda numbers, fixed: (tuple(np.exp(numbers).tolist()), fixed),
}
"""By ITK's name, for kinds that SimpleITK has no object of, or takes with all numbers alone: parameters and fixed ones for the object."""

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


def _turned(*quaternion: float) -> _Numbers:
    """The nine numbers of a quaternion's matrix, row by row; its length scales it, as in ITK."""
    rotation = scipy.spatial.transform.Rotation.from_quat(quaternion).as_matrix()
    return tuple((rotation * np.dot(quaternion, quaternion)).ravel().tolist())


def composed(parts: list[TransformPart]) -> Matrix:
    """The matrix of a file's transforms, (4, 4), mm: of the only one, or of those behind a CompositeTransform, the last applied first.

    Raises
    ------
    TransformPartError
        When there is none, more than one without a composite, or one that is not linear or not 3D.
    """
    if not parts:
        raise TransformPartError("is missing: the file holds none. Save the transform from Slicer again.")
    if _name(parts[0]) == COMPOSITE:
        parts = parts[1:]
    elif len(parts) > 1:
        raise TransformPartError(f"must be one, or several in a composite; got {len(parts)}. Save one of them.")
    matrix = np.eye(4)
    with np.errstate(all="ignore"):  # whatever overflows is refused by who takes the matrix
        for part in parts:
            matrix = matrix @ _matrix(part)
    return matrix


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


def _matrix(part: TransformPart) -> Matrix:
    name = _name(part)
    if name not in _KINDS:
        raise TransformPartError(f"must be linear; got {name[:60]}. Give a rigid or affine registration.")
    make, count, fixed_counts = _KINDS[name]
    # Only after this check may ITK see the numbers: it trusts their count
    if len(part.parameters) != count or len(part.fixed) not in fixed_counts or not np.isfinite([*part.parameters, *part.fixed]).all():
        raise TransformPartError(
            (
                "of kind {kind} must have {count} finite parameters and {fixed} fixed ones; got {parameters} and {others}. Save the "
                "transform from Slicer again."
            ).format(
                kind=name, count=count, fixed=" or ".join(map(str, fixed_counts)), parameters=len(part.parameters), others=len(part.fixed)
            )
        )
    transform = make()
    parameters, fixed = part.parameters, part.fixed
    try:
        if name in _PUT_OTHERWISE:
            parameters, fixed = _PUT_OTHERWISE[name](parameters, fixed)
        if fixed:
            transform.SetFixedParameters(fixed)
        if parameters:
            transform.SetParameters(parameters)
        # An affine map is known from the images of the origin and a point on each axis; this holds for every linear kind
        origin, *ends = (transform.TransformPoint(point) for point in ((0.0, 0.0, 0.0), *(_FAR * np.eye(3)).tolist()))
    except (RuntimeError, ValueError):
        raise TransformPartError(f"of kind {name} has numbers that ITK does not take. Save the transform from Slicer again.") from None
    matrix = np.eye(4)
    matrix[:3, 3] = origin
    matrix[:3, :3] = np.subtract(ends, origin).T / _FAR
    return matrix
