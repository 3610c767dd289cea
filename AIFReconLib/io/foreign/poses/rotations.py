"""Poses in the words of whoever recorded them (matrices, quaternions, angles, rotation vectors) as matrices.

What a file cannot say for itself (the order of a quaternion's numbers, the axes of Euler angles, units) is asked for, never guessed.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from ....arrays import Floats, Matrix
from ....errors import AIFReconError, SettingsError
from ....message import listed
from ....remedies import ANGLE_UNIT, NAME_THE_COLUMNS
from .headings import (
    ANGLES,
    AZIMUTH,
    COUNTED_TURN,
    EULER,
    KUKA,
    LENGTHS,
    MATRIX,
    QUATERNION,
    QUATERNION_ORDERS,
    ROTATION_VECTOR,
    TIMES,
    TRANSLATION,
    TURN,
    UNNAMED_EULER,
    UNORDERED_QUATERNION,
)

VECTOR = "vector"
"""In the place of an order of Euler angles: the three numbers are a rotation vector, axis times angle."""

EULER_ORDERS = ("xyz", "zyx", "XYZ", "ZYX", VECTOR)
"""The usual ones."""

QUATERNION_TOLERANCE = 0.02
"""How far a quaternion's length may be from 1; files hold four digits at times."""

ROWS, COLUMNS = "row by row", "column by column"
_FULL_TURN = 2 * np.pi + 0.01
"""Angles beyond it, in rad, are none."""


@dataclass(frozen=True)
class PoseFormat:
    """What the user says of a file of poses.

    Parameters
    ----------
    columns : tuple of str or None
        Names of the columns, for files without a header or with names of their own; ``-`` for one that is not used.
    tool : str or None
        Name of the tool, or its place from 1, where the file holds several.
    quaternion_order : "xyzw", "wxyz" or None
        For quaternions whose numbers have no names.
    euler_order : str or None
        Axes in the order in which the turns are applied: ``xyz`` about fixed axes, ``ZYX`` about the axes that turn along. Angles
        with names belong to the axes of those names; without, they come in the order of the turns. ``vector``: the three numbers are
        a rotation vector, axis times angle.
    angle_unit : "deg", "rad" or None
        None: as the file says.
    length_unit : "mm", "cm", "m" or None
        None: as the file says, else mm.
    time_unit : "s", "ms", "us", "ns" or None
        None: as the file says, else by the size of the numbers.
    good_statuses : tuple of str
        Words of the tracker that mean that a pose is valid, where they are not known here.
    column_major : bool or None
        Matrices are written column by column; None: row by row where that cannot be otherwise.
    """

    columns: tuple[str, ...] | None = None
    tool: str | None = None
    quaternion_order: str | None = None
    euler_order: str | None = None
    angle_unit: str | None = None
    length_unit: str | None = None
    time_unit: str | None = None
    good_statuses: tuple[str, ...] = ()
    column_major: bool | None = None

    def __post_init__(self) -> None:
        if self.quaternion_order not in (None, *QUATERNION_ORDERS):
            raise SettingsError(f"Input quaternion_order must be xyzw or wxyz; got {self.quaternion_order!r}. See the tracker's manual.")
        order = self.euler_order
        if order not in (None, VECTOR) and not (re.fullmatch("[xyz]{3}|[XYZ]{3}", order) and order[0] != order[1] != order[2]):
            raise SettingsError(
                f"Input euler_order must be three axes, as xyz (fixed axes) or ZYX (axes that turn along), or vector; got {order!r}. See "
                "the tracker's manual."
            )
        for name, choices in (("angle_unit", ANGLES), ("length_unit", tuple(LENGTHS)), ("time_unit", tuple(TIMES))):
            if getattr(self, name) not in (None, *choices):
                raise SettingsError(
                    f"Input {name} must be {listed(choices, ' or ')}; got {getattr(self, name)!r}. See the tracker's manual."
                )


class PoseValueError(AIFReconError, ValueError):
    """What is wrong with one pose, as the predicate of its place in the file."""

    number: int = 0
    """Of the pose, from 0."""


def _wrong(number: int, predicate: str, advice: str = "") -> PoseValueError:
    error = PoseValueError(predicate, advice)
    error.number = number
    return error


@dataclass(frozen=True)
class RotationKind:
    """How rotations are written: the fields that hold them, the order of the turns, and the unit of angles where there are any."""

    fields: tuple[str, ...]
    order: str = ""
    unit: str = ""

    def told(self, length: str, form: PoseFormat) -> str:
        """In words that say every convention."""
        if self.fields == MATRIX:
            return f"4x4 matrices, {COLUMNS if form.column_major else ROWS}, in {length}"
        how = {
            TURN: f"3x3 rotation, {self.order}",
            COUNTED_TURN: f"3x3 rotation, {self.order}",
            QUATERNION: "quaternion (x, y, z, w by name)",
            UNORDERED_QUATERNION: f"quaternion in the order {' '.join(self.order)}",
        }.get(self.fields)
        if how is None and self.order == VECTOR:
            how = f"rotation vector in {self.unit}"
        elif how is None:
            about = "fixed axes" if self.order.islower() else "the axes that turn along"
            how = f"Euler angles in {self.unit}, turns in the order {' '.join(self.order)} about {about}"
        return f"translation in {length} and {how}"


def rotation_kind(values: Mapping[str, Floats], form: PoseFormat, unit: str | None) -> RotationKind:
    """How the fields of a table, numbers (n,) by name, give a rotation; `unit` is that of angles, as the table says it.

    Raises SettingsError when they give none, a convention is left open, or angles are beyond two turns.
    """
    return _plausible(_rotation_kind(values, form, unit), values)


def _rotation_kind(values: Mapping[str, Floats], form: PoseFormat, unit: str | None) -> RotationKind:
    have = set(values)
    if set(MATRIX[:12]) <= have:
        return RotationKind(MATRIX)
    if not set(TRANSLATION) <= have:
        raise _what_is_needed(values)
    if set(TURN) <= have:
        return RotationKind(TURN, COLUMNS if form.column_major else ROWS)
    if set(COUNTED_TURN) <= have:
        return RotationKind(COUNTED_TURN, _order_of_nine(form))
    if set(QUATERNION) <= have:
        return RotationKind(QUATERNION)
    if set(UNORDERED_QUATERNION) <= have:
        if form.quaternion_order is None:
            raise SettingsError("The order of the quaternion's numbers is not known.", "Give {quaternion_order}: xyzw or wxyz.")
        return RotationKind(UNORDERED_QUATERNION, form.quaternion_order)
    if set(ROTATION_VECTOR) <= have:
        return RotationKind(ROTATION_VECTOR, VECTOR, _angle_unit(ROTATION_VECTOR, form, unit or "rad", values))
    for fields in (KUKA, AZIMUTH):  # these makers have one convention
        if set(fields) <= have and not set(EULER) <= have:
            return RotationKind(fields, form.euler_order or "ZYX", form.angle_unit or unit or "deg")
    for fields in (EULER, UNNAMED_EULER):
        if set(fields) <= have:
            if form.euler_order is None:
                raise SettingsError(
                    "The order of the Euler angles is not known.",
                    "Give {euler_order} with the axes in the order in which the turns are applied: xyz about fixed axes, "
                    "ZYX about axes that turn along; or vector, for a rotation vector (axis times angle), as robots of UR "
                    "and Vicon write.",
                    choices=EULER_ORDERS,
                )
            if fields == EULER and form.euler_order != VECTOR and len(set(form.euler_order)) < 3:
                raise SettingsError(
                    f"Angles that are named by axis cannot be turned in the order {form.euler_order}, which has an axis twice. Name "
                    "them e0 e1 e2, in the order of the turns.",
                    NAME_THE_COLUMNS,
                )
            order = form.euler_order
            turns = tuple(f"r{axis.lower()}" for axis in order) if fields == EULER and order != VECTOR else fields
            return RotationKind(turns, order, _angle_unit(turns, form, unit, values))
    raise _what_is_needed(values)


def _angle_unit(fields: Sequence[str], form: PoseFormat, unit: str | None, values: Mapping[str, Floats]) -> str:
    """The unit of angles: as said, else by their size where that tells it."""
    unit = form.angle_unit or unit
    if unit is None:
        if np.nanmax([0.0, *(np.abs(values[name]).max(initial=0.0, where=np.isfinite(values[name])) for name in fields)]) <= _FULL_TURN:
            raise SettingsError(
                "The unit of the angles is not known: all are within a full turn in radians, and can be degrees as well.", ANGLE_UNIT
            )
        return "deg"
    return unit


def _plausible(kind: RotationKind, values: Mapping[str, Floats]) -> RotationKind:
    """The same; raises SettingsError where angles are beyond two turns."""
    if kind.unit:
        most = max(float(np.abs(values[name]).max(initial=0.0, where=np.isfinite(values[name]))) for name in kind.fields)
        if most > (720.0 if kind.unit == "deg" else 4 * np.pi) + 1e-6:
            raise SettingsError(f"The angles reach {most:.4g} {kind.unit}, more than two turns: is their unit another?", ANGLE_UNIT)
    return kind


def _order_of_nine(form: PoseFormat) -> str:
    """Whether nine numbers without names run along rows or columns."""
    if form.column_major is None:
        raise SettingsError(
            "Nine numbers of a rotation can run along its rows or its columns.", "Say whether they run column by column ({column_major})."
        )
    return COLUMNS if form.column_major else ROWS


def poses_of(values: Mapping[str, Floats], kind: RotationKind, form: PoseFormat) -> Matrix:
    """The poses (n, 4, 4) that fields of n numbers each give, lengths as written; NaN where a row holds none, or a quaternion of zeros.

    Raises PoseValueError, which names the first row whose numbers give none.
    """
    if kind.fields == MATRIX:
        return _matrices(values, form)
    count = len(values["x"])
    places = np.stack([values[axis] for axis in TRANSLATION], axis=1)
    turns = np.stack([values[name] for name in kind.fields], axis=1)
    good = np.isfinite(places).all(axis=1) & np.isfinite(turns).all(axis=1)
    if len(kind.fields) > 3:
        good &= turns.any(axis=1)
    rotation = scipy.spatial.transform.Rotation
    if len(kind.fields) == 4:
        order = kind.order or "xyzw"
        turns = turns[:, [order.index(axis) for axis in "xyzw"]]
        with np.errstate(over="ignore", invalid="ignore"):  # then it is infinite, and refused
            lengths = np.linalg.norm(turns, axis=1)
        wrong = good & ~(np.abs(lengths - 1.0) <= QUATERNION_TOLERANCE)
        if wrong.any():
            first = int(np.argmax(wrong))
            raise _wrong(first, f"must have a quaternion of length 1; got {lengths[first]:.4g}. Check which columns hold it.")
        matrices = rotation.from_quat(turns[good] / lengths[good, None]).as_matrix()
    elif len(kind.fields) == 9:
        matrices = turns[good].reshape(-1, 3, 3)
        matrices = matrices.transpose(0, 2, 1) if kind.order == COLUMNS else matrices
    elif kind.order == VECTOR:
        matrices = rotation.from_rotvec(turns[good], degrees=kind.unit == "deg").as_matrix()
    else:
        matrices = rotation.from_euler(kind.order, turns[good], degrees=kind.unit == "deg").as_matrix()
    poses = np.full((count, 4, 4), np.nan)
    poses[good] = np.eye(4)
    poses[good, :3, :3], poses[good, :3, 3] = matrices, places[good]
    return poses


def _matrices(values: Mapping[str, Floats], form: PoseFormat) -> Matrix:
    count = len(values["m00"])
    columns = [values.get(name, np.full(count, float(name == "m33"))) for name in MATRIX]
    poses = np.stack(columns, axis=1).reshape(-1, 4, 4)
    poses = poses.transpose(0, 2, 1).copy() if form.column_major else poses
    good = np.isfinite(poses).all(axis=(1, 2))
    wrong = good & ~np.isclose(poses[:, 3], (0, 0, 0, 1), atol=1e-6).all(axis=1)
    if wrong.any():
        first = int(np.argmax(wrong))
        row = " ".join(f"{v:g}" for v in poses[first, 3])
        if np.allclose(poses[first, :, 3], (0, 0, 0, 1)):
            raise _wrong(
                first,
                f"must have 0 0 0 1 as its last row; got {row}. They seem to be written column by column.",
                "Where matrices are written column by column, give {column_major}.",
            )
        raise _wrong(first, f"must have 0 0 0 1 as its last row; got {row}.")
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


def _what_is_needed(names: Collection[str]) -> SettingsError:
    return SettingsError(
        "The poses must be 4x4 matrices (m00 to m33), or x y z with a quaternion (qx qy qz qw), angles (rx ry rz) or a 3x3 rotation; "
        f"known columns: {listed(dict.fromkeys(filter(None, names))) or 'none'}.",
        NAME_THE_COLUMNS,
    )
