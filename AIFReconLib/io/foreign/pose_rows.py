"""One pose in the words of whoever recorded it (a matrix, a quaternion, Euler angles) as a matrix.

What a file cannot say for itself (the order of a quaternion's numbers, the axes of Euler angles, units) is asked for, never guessed.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from ...arrays import Matrix
from ...errors import AIFReconError, SettingsError
from ...message import listed
from ...remedies import Remedy

QUATERNION_ORDERS = ("xyzw", "wxyz")
LENGTH_UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0}
ANGLE_UNITS = ("deg", "rad")
QUATERNION_TOLERANCE = 0.02
"""How far a quaternion's length may be from 1; files hold four digits at times."""

TRANSLATION = ("x", "y", "z")
QUATERNION = ("qx", "qy", "qz", "qw")
UNORDERED_QUATERNION = ("q0", "q1", "q2", "q3")
EULER = ("rx", "ry", "rz")
UNNAMED_EULER = ("e0", "e1", "e2")
"""Euler angles in the order of the turns, where they have no names."""

MATRIX = tuple(f"m{row}{column}" for row in range(4) for column in range(4))
TIME, TIME_MS, IMAGE, STATUS = "time", "time_ms", "image", "status"

_SPELLINGS = {
    TIME: "time timestamp t times seconds sec",
    TIME_MS: "timems timestampms ms milliseconds",
    IMAGE: "image file filename imagefile picture",
    STATUS: "status",
    **{axis: f"{axis} t{axis} p{axis} pos{axis} position{axis} translation{axis} trans{axis}" for axis in TRANSLATION},
    **{f"q{axis}": f"q{axis} quat{axis} quaternion{axis} orientation{axis} rot{axis}q" for axis in "xyzw"},
    "rx": "rx roll eulerx anglex rotx",
    "ry": "ry pitch eulery angley roty",
    "rz": "rz yaw eulerz anglez rotz",
    **{name: name for name in (*UNORDERED_QUATERNION, *UNNAMED_EULER)},
}
_CANONICAL = {spelling: name for name, spellings in _SPELLINGS.items() for spelling in spellings.split()}


@dataclass(frozen=True)
class PoseFormat:
    """What the user says of a file of poses.

    Parameters
    ----------
    columns : tuple of str or None
        Names of the columns, for files without a header or with names of their own; ``-`` for one that is not used.
    quaternion_order : "xyzw", "wxyz" or None
        For quaternions whose numbers have no names.
    euler_order : str or None
        Axes in the order in which the turns are applied: ``xyz`` about fixed axes, ``ZYX`` about the axes that turn along. Angles
        with names belong to the axes of those names; without, they come in the order of the turns.
    angle_unit : "deg" or "rad"
    length_unit : "mm", "cm" or "m"
    column_major : bool
        Matrices are written column by column.
    """

    columns: tuple[str, ...] | None = None
    quaternion_order: str | None = None
    euler_order: str | None = None
    angle_unit: str = "deg"
    length_unit: str = "mm"
    column_major: bool = False

    def __post_init__(self) -> None:
        if self.quaternion_order not in (None, *QUATERNION_ORDERS):
            raise SettingsError(f"Input quaternion_order must be xyzw or wxyz; got {self.quaternion_order!r}. See the tracker's manual.")
        order = self.euler_order
        if order is not None and not (re.fullmatch("[xyz]{3}|[XYZ]{3}", order) and order[0] != order[1] != order[2]):
            raise SettingsError(
                f"Input euler_order must be three axes, as xyz (fixed axes) or ZYX (axes that turn along); got {order!r}. See the "
                "tracker's manual."
            )
        if self.angle_unit not in ANGLE_UNITS or self.length_unit not in LENGTH_UNITS:
            raise SettingsError(
                f"Input units must be deg or rad, and mm, cm or m; got {self.angle_unit!r} and {self.length_unit!r}. See the tracker's "
                "manual."
            )


class PoseValueError(AIFReconError, ValueError):
    """What is wrong with one pose, as the predicate of its place in the file."""


def canonical_names(words: Sequence[str]) -> list[str | None]:
    """What each column holds, by its heading; None for one that is not known. Both m00 to m33 and m11 to m44 name a matrix."""
    plain = [re.sub("[^a-z0-9]", "", word.lower()) for word in words]
    from_one = [f"m{row}{column}" for row in range(1, 5) for column in range(1, 5)]
    counted = [f"m{n}" for n in range(16)]
    for names in (MATRIX, from_one, counted):
        if set(names[:12]) <= set(plain):
            known = dict(zip(names, MATRIX))
            return [known.get(word, _CANONICAL.get(word)) for word in plain]
    if {"q1", "q2", "q3", "q4"} <= set(plain):
        plain = [f"q{int(word[1]) - 1}" if re.fullmatch("q[1-4]", word) else word for word in plain]
    return [_CANONICAL.get(word) for word in plain]


def kind_of_pose(names: Sequence[str | None], form: PoseFormat) -> str:
    """How these fields give a pose, in words that say every convention.

    Raises
    ------
    SettingsError
        When they give none, or a convention is left open.
    """
    have = set(names)
    length = form.length_unit
    if set(MATRIX[:12]) <= have:
        return f"4x4 matrices, {'column' if form.column_major else 'row'} by {'column' if form.column_major else 'row'}, in {length}"
    if not set(TRANSLATION) <= have:
        raise _what_is_needed(names)
    if set(QUATERNION) <= have:
        return f"translation in {length} and quaternion (x, y, z, w by name)"
    if set(UNORDERED_QUATERNION) <= have:
        if form.quaternion_order is None:
            raise SettingsError("The order of the quaternion's numbers is not known.", Remedy.QUATERNION_ORDER)
        return f"translation in {length} and quaternion in the order {' '.join(form.quaternion_order)}"
    if set(EULER) <= have or set(UNNAMED_EULER) <= have:
        if form.euler_order is None:
            raise SettingsError("The order of the Euler angles is not known.", Remedy.EULER_ORDER)
        if set(EULER) <= have and len(set(form.euler_order)) < 3:
            raise SettingsError(
                f"Angles that are named by axis cannot be turned in the order {form.euler_order}, which has an axis twice. Name "
                "them e0 e1 e2, in the order of the turns.",
                Remedy.NAME_THE_COLUMNS,
            )
        about = "fixed axes" if form.euler_order.islower() else "the axes that turn along"
        return (
            f"translation in {length} and Euler angles in {form.angle_unit}, turns in the order {' '.join(form.euler_order)} about {about}"
        )
    raise _what_is_needed(names)


def pose_of(values: Mapping[str, float], form: PoseFormat) -> Matrix | None:
    """The pose (4, 4) that the numbers of one row give, lengths as written; None where they hold NaN or a quaternion of zeros.

    Raises
    ------
    PoseValueError
        When they give none.
    """
    matrix = np.eye(4)
    if set(MATRIX[:12]) <= set(values):
        matrix.ravel()[:] = [values.get(name, float(name == "m33")) for name in MATRIX]
        if form.column_major:
            matrix = matrix.T.copy()
        if not np.isfinite(matrix).all():
            return None
        if not np.allclose(matrix[3], (0, 0, 0, 1), atol=1e-6):
            row = " ".join(f"{v:g}" for v in matrix[3])
            if np.allclose(matrix[:, 3], (0, 0, 0, 1)):
                raise PoseValueError(
                    f"must have 0 0 0 1 as its last row; got {row}. They seem to be written column by column.", Remedy.COLUMN_MAJOR
                )
            raise PoseValueError(f"must have 0 0 0 1 as its last row; got {row}.")
        matrix[3] = (0.0, 0.0, 0.0, 1.0)
        return matrix
    matrix[:3, 3] = [values[axis] for axis in TRANSLATION]
    # What a row holds besides is not looked at, in the order of `kind_of_pose`
    if set(QUATERNION) <= set(values):
        quaternion = np.array([values[name] for name in QUATERNION])
    elif form.quaternion_order is not None and set(UNORDERED_QUATERNION) <= set(values):
        by_axis = dict(zip(form.quaternion_order, (values[name] for name in UNORDERED_QUATERNION)))
        quaternion = np.array([by_axis[axis] for axis in "xyzw"])
    else:
        return _turned(matrix, values, form)
    if not np.isfinite([*matrix[:3, 3], *quaternion]).all() or not quaternion.any():
        return None
    with np.errstate(over="ignore"):  # then it is infinite, and refused
        length = float(np.linalg.norm(quaternion))
    if abs(length - 1.0) > QUATERNION_TOLERANCE:
        raise PoseValueError(f"must have a quaternion of length 1; got {length:.4g}. Check which columns hold it.")
    matrix[:3, :3] = scipy.spatial.transform.Rotation.from_quat(quaternion / length).as_matrix()
    return matrix


def _turned(matrix: Matrix, values: Mapping[str, float], form: PoseFormat) -> Matrix | None:
    """`matrix`, a translation, with the rotation of the row's Euler angles; None where they hold NaN."""
    if form.euler_order is None:
        raise _what_is_needed(list(values))
    names = [f"r{axis.lower()}" for axis in form.euler_order] if set(EULER) <= set(values) else UNNAMED_EULER
    angles = [values[name] for name in names]
    if not np.isfinite([*matrix[:3, 3], *angles]).all():
        return None
    matrix[:3, :3] = scipy.spatial.transform.Rotation.from_euler(form.euler_order, angles, degrees=form.angle_unit == "deg").as_matrix()
    return matrix


def in_millimeters(matrices: Matrix, form: PoseFormat, takes_pixels: bool) -> Matrix:
    """Poses (n, 4, 4) with lengths in mm. Where they take pixels, their axes are lengths too."""
    scaled = matrices.copy()
    scaled[:, :3, 3] *= LENGTH_UNITS[form.length_unit]
    if takes_pixels:
        scaled[:, :3, :3] *= LENGTH_UNITS[form.length_unit]
    return scaled


def time_of(values: Mapping[str, float]) -> float | None:
    """The time of one row in s; None where it has none, or NaN."""
    time = values.get(TIME, values.get(TIME_MS, math.nan) / 1000.0)
    return time if math.isfinite(time) else None


def _what_is_needed(names: Sequence[str | None]) -> SettingsError:
    return SettingsError(
        "The poses must be 4x4 matrices (m00 to m33), or x y z with qx qy qz qw, or with rx ry rz; "
        f"known columns: {listed(filter(None, names)) or 'none'}.",
        Remedy.NAME_THE_COLUMNS,
    )
