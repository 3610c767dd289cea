"""The pose between two poses: what the tracker would have said at a moment between two of its samples.

Rotations turn at constant speed about one axis (slerp); scale, shear and translation change linearly. So a rigid pose stays rigid, and an
affine one, such as an image with its pixel spacing, keeps its spacing.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Floats, Matrix
from ..errors import GeometryError
from .transforms import affine, invert


def interpolate_pose(first: Matrix, second: Matrix, fraction: float) -> Matrix:
    """The pose at `fraction` of the way from `first` (0) to `second` (1).

    Poses are affine (4, 4), both mirrored or neither. At fractions of 0 and 1 the answer is `first` and `second` to the bit.

    Raises GeometryError when `fraction` is outside 0 to 1, a pose is singular, or one is mirrored and the other is not.

    Returns
    -------
    pose : (4, 4) float64 array

    Notes
    -----
    With the polar decomposition M = R S of each 3x3 part (R a rotation, S symmetric), the answer is
    R_first exp(fraction log(R_first^T R_second)) ((1 - fraction) S_first + fraction S_second); the translation is linear. Of two ways round
    it takes the shorter; half a turn has two that are equally short, and one of them is taken.
    """
    if not 0.0 <= fraction <= 1.0:
        raise GeometryError(f"Input fraction must be from 0 to 1; got {fraction!r}. Poses are not extrapolated.")
    if fraction == 0.0:
        return np.array(first, dtype=np.float64)
    if fraction == 1.0:
        return np.array(second, dtype=np.float64)
    first_rotation, first_stretch = _polar(first)
    second_rotation, second_stretch = _polar(second)
    # Whose windows show poses need no scipy
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_rotvec(fraction * _turn(first_rotation, second_rotation)).as_matrix()
    stretch = (1.0 - fraction) * first_stretch + fraction * second_stretch
    shift = (1.0 - fraction) * np.asarray(first)[:3, 3] + fraction * np.asarray(second)[:3, 3]
    return affine(first_rotation @ turn @ stretch, shift)


def pose_change(first: Matrix, second: Matrix) -> tuple[float, float]:
    """How far apart two poses are: distance of their origins (mm) and angle of the turn between them (radians, 0 to pi)."""
    turn = _turn(_polar(first)[0], _polar(second)[0])
    return float(np.linalg.norm(np.asarray(second)[:3, 3] - np.asarray(first)[:3, 3])), float(np.linalg.norm(turn))


def _turn(first: Matrix, second: Matrix) -> Floats:
    """The rotation vector (3,), radians, in the frame before `first`, with first @ turn = second; both are (3, 3), mirrored or not.

    Raises GeometryError when one is mirrored and the other is not.
    """
    turn = first.T @ second
    if np.linalg.det(turn) < 0.0:
        raise GeometryError("Input poses must both be mirrored, or neither; got one of each. Check the transforms.")
    # Whose windows show poses need no scipy
    from scipy.spatial.transform import Rotation

    vector: Floats = Rotation.from_matrix(turn).as_rotvec()
    return vector


def _polar(matrix: Matrix) -> tuple[Matrix, Matrix]:
    """Rotation (mirrored where the matrix is) and symmetric stretch of the 3x3 part of a pose."""
    linear = np.asarray(matrix, dtype=np.float64)[:3, :3]
    if not np.isfinite(linear).all():
        raise GeometryError("Input pose must hold finite numbers; got NaN or infinity.")
    invert(np.asarray(matrix, dtype=np.float64))
    left, stretches, right = np.linalg.svd(linear)
    return left @ right, right.T @ (stretches[:, None] * right)
