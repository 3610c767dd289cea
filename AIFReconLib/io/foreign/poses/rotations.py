"""Poses in the words of whoever recorded them (matrices, quaternions, angles, rotation vectors) as matrices.

What a file cannot say for itself (the order of a quaternion's numbers, the axes of Euler angles, units) is asked for, never guessed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy

from ....arrays import Floats, Mask, Matrix
from ....errors import AIFReconError, SettingsError
from ....message import listed
from ....remedies import ANGLE_UNIT, NAME_THE_COLUMNS
from ..options import ImportOptions
from .headings import (
    AZIMUTH,
    COUNTED_TURN,
    EULER,
    KUKA,
    LENGTHS,
    MATRIX,
    QUATERNION,
    ROTATION_VECTOR,
    TRANSLATION,
    UNORDERED_QUATERNION,
    VECTOR,
    WAYS,
)

EULER_ORDERS = ("xyz", "zyx", "XYZ", "ZYX", VECTOR)
"""The usual ones."""

QUATERNION_TOLERANCE = 0.02
"""How far a quaternion's length may be from 1; files hold four digits at times."""

WHICH_ORDER = (
    "Give {euler_order} with the axes in the order in which the turns are applied: xyz about fixed axes, ZYX about axes that turn along; "
    "or vector, for a rotation vector (axis times angle), as robots of UR and Vicon write."
)

NEEDED = (
    "The poses must be 4x4 matrices (m00 to m33), or x y z with a quaternion (qx qy qz qw), angles (rx ry rz) or a 3x3 rotation; "
    "known columns: {}."
)
ROWS, COLUMNS = "row by row", "column by column"
_FULL_TURN = 2 * np.pi + 0.01
"""Angles beyond it, in rad, are none."""


class PoseValueError(AIFReconError, ValueError):
    """What is wrong with the first of some poses, as the predicate of its place in the file; `number` is that pose's, from 0."""

    def __init__(self, wrong: Mask, predicate: str, advice: str = ""):
        super().__init__(predicate, advice)
        self.number = int(np.argmax(wrong))


@dataclass(frozen=True)
class RotationKind:
    """How rotations are written: the fields that hold them, the order of the turns, and the unit of angles where there are any."""

    fields: tuple[str, ...]
    order: str = ""
    unit: str = ""

    def told(self, length: str) -> str:
        """In words that say every convention."""
        if self.fields == MATRIX:
            return f"4x4 matrices, {self.order}, in {length}"
        if len(self.fields) == 9:
            how = f"3x3 rotation, {self.order}"
        elif len(self.fields) == 4:
            how = "quaternion (x, y, z, w by name)" if self.fields == QUATERNION else f"quaternion in the order {' '.join(self.order)}"
        elif self.order == VECTOR:
            how = f"rotation vector in {self.unit}"
        else:
            about = "fixed axes" if self.order.islower() else "the axes that turn along"
            how = f"Euler angles in {self.unit}, turns in the order {' '.join(self.order)} about {about}"
        return f"translation in {length} and {how}"


def rotation_kind(values: Mapping[str, Floats], form: ImportOptions, unit: str | None) -> RotationKind:
    """How the fields of a table, numbers (n,) by name, give a rotation; `unit` is that of angles, as the table says it.

    Raises SettingsError when they give none, a convention is left open, or angles are beyond two turns.
    """
    lines = COLUMNS if form.column_major else ROWS
    if values.keys() >= set(MATRIX[:12]):
        return RotationKind(MATRIX, lines)
    fields = next((way for way in WAYS if values.keys() >= {*TRANSLATION, *way}), None)
    if fields is None:
        raise SettingsError(NEEDED.format(listed(dict.fromkeys(filter(None, values))) or "none"), NAME_THE_COLUMNS)
    if fields == COUNTED_TURN and form.column_major is None:
        raise SettingsError(
            "Nine numbers of a rotation can run along its rows or its columns.", "Say whether they run column by column ({column_major})."
        )
    if fields == UNORDERED_QUATERNION and form.quaternion_order is None:
        raise SettingsError("The order of the quaternion's numbers is not known.", "Give {quaternion_order}: xyzw or wxyz.")
    if len(fields) != 3:
        return RotationKind(fields, lines if len(fields) == 9 else (form.quaternion_order or "") * (fields != QUATERNION))
    order = VECTOR if fields == ROTATION_VECTOR else form.euler_order
    if fields in (KUKA, AZIMUTH):  # these makers have one convention
        order, unit = order or "ZYX", unit or "deg"
    if order is None:
        raise SettingsError("The order of the Euler angles is not known.", WHICH_ORDER, choices=EULER_ORDERS)
    if fields == EULER and order != VECTOR:
        if len(set(order)) < 3:
            raise SettingsError(
                f"Angles that are named by axis cannot be turned in the order {order}, which has an axis twice. Name "
                "them e0 e1 e2, in the order of the turns.",
                NAME_THE_COLUMNS,
            )
        fields = tuple(f"r{axis.lower()}" for axis in order)
    unit = form.angle_unit or unit or ("rad" if fields == ROTATION_VECTOR else None)
    most = max(float(np.abs(values[name]).max(initial=0.0, where=np.isfinite(values[name]))) for name in fields)
    if unit is None and most <= _FULL_TURN:
        raise SettingsError(
            "The unit of the angles is not known: all are within a full turn in radians, and can be degrees as well.", ANGLE_UNIT
        )
    unit = unit or "deg"
    if most > (720.0 if unit == "deg" else 4 * np.pi) + 1e-6:
        raise SettingsError(f"The angles reach {most:.4g} {unit}, more than two turns: is their unit another?", ANGLE_UNIT)
    return RotationKind(fields, order, unit)


def poses_of(values: Mapping[str, Floats], kind: RotationKind) -> Matrix:
    """The poses (n, 4, 4) that fields of n numbers each give, lengths as written; NaN where a row holds none, or a quaternion of zeros.

    Raises PoseValueError, which names the first row whose numbers give none.
    """
    if kind.fields == MATRIX:
        return _matrices(values, kind)
    places = np.stack([values[axis] for axis in TRANSLATION], axis=1)
    turns = np.stack([values[name] for name in kind.fields], axis=1)
    good = np.isfinite(places).all(axis=1) & np.isfinite(turns).all(axis=1)
    if len(kind.fields) > 3:
        good &= turns.any(axis=1)
    rotation = scipy.spatial.transform.Rotation
    if len(kind.fields) == 4:
        turns = turns[:, [(kind.order or "xyzw").index(axis) for axis in "xyzw"]]
        with np.errstate(over="ignore", invalid="ignore"):  # then it is infinite, and refused
            lengths = np.linalg.norm(turns, axis=1)
        wrong = good & ~(np.abs(lengths - 1.0) <= QUATERNION_TOLERANCE)
        if wrong.any():
            length = lengths[np.argmax(wrong)]
            raise PoseValueError(wrong, f"must have a quaternion of length 1; got {length:.4g}. Check which columns hold it.")
        matrices = rotation.from_quat(turns[good] / lengths[good, None]).as_matrix()
    elif len(kind.fields) == 9:
        matrices = turns[good].reshape(-1, 3, 3)
        matrices = matrices.transpose(0, 2, 1) if kind.order == COLUMNS else matrices
    elif kind.order == VECTOR:
        matrices = rotation.from_rotvec(turns[good], degrees=kind.unit == "deg").as_matrix()
    else:
        matrices = rotation.from_euler(kind.order, turns[good], degrees=kind.unit == "deg").as_matrix()
    poses = np.full((len(places), 4, 4), np.nan)
    poses[good] = np.eye(4)
    poses[good, :3, :3], poses[good, :3, 3] = matrices, places[good]
    return poses


def _matrices(values: Mapping[str, Floats], kind: RotationKind) -> Matrix:
    unsaid = np.zeros(len(values["m00"]))
    poses = np.stack([values.get(name, unsaid + (name == "m33")) for name in MATRIX], axis=1).reshape(-1, 4, 4)
    poses = poses.transpose(0, 2, 1).copy() if kind.order == COLUMNS else poses
    good = np.isfinite(poses).all(axis=(1, 2))
    wrong = np.asarray(good & ~np.isclose(poses[:, 3], (0, 0, 0, 1), atol=1e-6).all(axis=1))
    if wrong.any():
        first = poses[np.argmax(wrong)]
        by_column = np.allclose(first[:, 3], (0, 0, 0, 1))
        raise PoseValueError(
            wrong,
            f"must have 0 0 0 1 as its last row; got {' '.join(f'{v:g}' for v in first[3])}."
            + " They seem to be written column by column." * by_column,
            "Where matrices are written column by column, give {column_major}." * by_column,
        )
    poses[:, 3] = (0.0, 0.0, 0.0, 1.0)
    poses[~good] = np.nan
    return poses


def in_millimeters(matrices: Matrix, unit: str, takes_pixels: bool) -> Matrix:
    """Poses (n, 4, 4) whose lengths are in `unit`, in mm. Where they take pixels, their axes are lengths too."""
    scaled = matrices.copy()
    scaled[:, :3, 3] *= LENGTHS[unit]
    if takes_pixels:
        scaled[:, :3, :3] *= LENGTHS[unit]
    return scaled
