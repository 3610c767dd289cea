"""Poses in the words of whoever recorded them (matrices, quaternions, angles, rotation vectors) as matrices.

What a file cannot say for itself (the order of a quaternion's numbers, the axes of Euler angles, units) is asked for, never guessed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import scipy

from ....arrays import Floats, Mask, Matrix
from ....errors import FileFormatError, SettingsError
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
_FULL_TURN = 2 * np.pi + 0.01
"""Angles beyond it, in rad, are none."""

_Place = Callable[[int], str]
"""Where a pose stands in its file, in words, by its number."""


def poses_of(values: Mapping[str, Floats], form: ImportOptions, length: str, angle: str | None, place: _Place) -> tuple[Matrix, str]:
    """The poses (n, 4, 4) that fields of n numbers each give, NaN where a row holds none, and every convention in words.

    Raises SettingsError when the fields give no pose, or a convention is left open, and FileFormatError when the numbers of one give none.
    Lengths stay as written; `length` and `angle` are units as the table says them.
    """
    if values.keys() >= set(MATRIX[:12]):
        return _matrices(values, form, place), f"4x4 matrices, {_lines(form)}, in {length}"
    fields = next((way for way in WAYS if values.keys() >= {*TRANSLATION, *way}), None)
    if fields is None:
        raise SettingsError(NEEDED.format(listed(dict.fromkeys(filter(None, values))) or "none"), NAME_THE_COLUMNS)
    places = np.stack([values[axis] for axis in TRANSLATION], axis=1)
    turns = np.stack([values[name] for name in fields], axis=1)
    good = np.asarray(np.isfinite(np.hstack([places, turns])).all(axis=1))
    if len(fields) > 3:
        good &= turns.any(axis=1)  # zeros stand for no pose
    if fields == COUNTED_TURN and form.column_major is None:
        told = "Nine numbers of a rotation can run along its rows or its columns."
        raise SettingsError(told, "Say whether they run column by column ({column_major}).")
    if len(fields) == 9:
        rotations = turns[good].reshape(-1, 3, 3)
        rotations, how = rotations.transpose(0, 2, 1) if form.column_major else rotations, f"3x3 rotation, {_lines(form)}"
    elif len(fields) == 4:
        rotations, how = _of_quaternion(fields, turns, good, form, place)
    else:
        rotations, how = _of_angles(fields, values, good, form, angle)
    poses = np.full((len(places), 4, 4), np.nan)
    poses[good] = np.eye(4)
    poses[good, :3, :3], poses[good, :3, 3] = rotations, places[good]
    return poses, f"translation in {length} and {how}"


def _lines(form: ImportOptions) -> str:
    return "column by column" if form.column_major else "row by row"


def _of_quaternion(fields: tuple[str, ...], turns: Floats, good: Mask, form: ImportOptions, place: _Place) -> tuple[Floats, str]:
    order = "xyzw" if fields == QUATERNION else form.quaternion_order
    if order is None:
        raise SettingsError("The order of the quaternion's numbers is not known.", "Give {quaternion_order}: xyzw or wxyz.")
    with np.errstate(over="ignore", invalid="ignore"):  # then it is infinite, and refused
        lengths = np.linalg.norm(turns, axis=1)
    for first in np.flatnonzero(good & ~(np.abs(lengths - 1.0) <= QUATERNION_TOLERANCE)):
        must = f"must have a quaternion of length 1; got {lengths[first]:.4g}. Check which columns hold it."
        raise FileFormatError(f"{place(int(first))} {must}")
    rotations = scipy.spatial.transform.Rotation.from_quat(turns[good][:, [order.index(axis) for axis in "xyzw"]]).as_matrix()
    how = "quaternion (x, y, z, w by name)" if fields == QUATERNION else f"quaternion in the order {' '.join(order)}"
    return rotations, how


def _of_angles(
    fields: tuple[str, ...], values: Mapping[str, Floats], good: Mask, form: ImportOptions, unit: str | None
) -> tuple[Floats, str]:
    """Of three angles, or of a rotation vector."""
    order = VECTOR if fields == ROTATION_VECTOR else form.euler_order
    if fields in (KUKA, AZIMUTH):  # these makers have one convention
        order, unit = order or "ZYX", unit or "deg"
    if order is None:
        raise SettingsError("The order of the Euler angles is not known.", WHICH_ORDER, choices=EULER_ORDERS)
    if fields == EULER and order != VECTOR:
        if len(set(order)) < 3:
            twice = f"Angles that are named by axis cannot be turned in the order {order}, which has an axis twice."
            raise SettingsError(f"{twice} Name them e0 e1 e2, in the order of the turns.", NAME_THE_COLUMNS)
        fields = tuple(f"r{axis.lower()}" for axis in order)
    turns = np.stack([values[name] for name in fields], axis=1)[good]
    unit = form.angle_unit or unit or ("rad" if fields == ROTATION_VECTOR else None)
    most = float(np.abs(turns).max(initial=0.0))
    if unit is None and most <= _FULL_TURN:
        told = "The unit of the angles is not known: all are within a full turn in radians, and can be degrees as well."
        raise SettingsError(told, ANGLE_UNIT)
    unit = unit or "deg"
    if most > (720.0 if unit == "deg" else 4 * np.pi) + 1e-6:
        raise SettingsError(f"The angles reach {most:.4g} {unit}, more than two turns: is their unit another?", ANGLE_UNIT)
    rotation = scipy.spatial.transform.Rotation
    if order == VECTOR:
        return rotation.from_rotvec(turns, degrees=unit == "deg").as_matrix(), f"rotation vector in {unit}"
    about = "fixed axes" if order.islower() else "the axes that turn along"
    how = f"Euler angles in {unit}, turns in the order {' '.join(order)} about {about}"
    return rotation.from_euler(order, turns, degrees=unit == "deg").as_matrix(), how


def _matrices(values: Mapping[str, Floats], form: ImportOptions, place: _Place) -> Matrix:
    unsaid = np.zeros(len(values["m00"]))
    poses = np.stack([values.get(name, unsaid + (name == "m33")) for name in MATRIX], axis=1).reshape(-1, 4, 4)
    poses = poses.transpose(0, 2, 1).copy() if form.column_major else poses
    good = np.isfinite(poses).all(axis=(1, 2))
    for number in np.flatnonzero(good & ~np.isclose(poses[:, 3], (0, 0, 0, 1), atol=1e-6).all(axis=1)):
        told = f"{place(int(number))} must have 0 0 0 1 as its last row; got {' '.join(f'{v:g}' for v in poses[number][3])}."
        if np.allclose(poses[number][:, 3], (0, 0, 0, 1)):
            advice = "Where matrices are written column by column, give {column_major}."
            raise FileFormatError(f"{told} They seem to be written column by column.", advice)
        raise FileFormatError(told)
    poses[:, 3] = (0.0, 0.0, 0.0, 1.0)
    poses[~good] = np.nan
    return poses


def in_millimeters(matrices: Matrix, unit: str, takes_pixels: bool) -> Matrix:
    """Poses (n, 4, 4) whose lengths are in `unit`, in mm. Where they take pixels, their axes are lengths too."""
    scaled = matrices.copy()
    scaled[:, :3, 0 if takes_pixels else 3 :] *= LENGTHS[unit]
    return scaled
