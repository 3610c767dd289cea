"""4x4 matrices: checking, composing, interpolating, and the one place where RAS becomes LPS.

`a_to_b` maps column vectors: ``p_b = a_to_b @ p_a``. Everything is float64.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Floats, Integers, Matrix
from ..errors import GeometryError

LPS_FROM_RAS = np.diag([-1.0, -1.0, 1.0, 1.0])
"""Left-posterior-superior from right-anterior-superior coordinates. It is its own inverse."""

RIGIDITY_TOLERANCE = 0.02
"""How far rotation^T rotation may be from the identity, per entry, before a pose counts as not rigid. Recordings hold
6 digits, and trackers orthonormalize, so honest poses stay below 1e-4."""

SHEAR_TOLERANCE = 0.1
"""Largest cosine, without its sign, between the two image axes. Fiducial calibrations are affine fits: 0.05 has been seen in use."""

LAST_ROW_TOLERANCE = 1e-9
"""How far from 0 the last row of a transform may be."""

LAST_ONE_TOLERANCE = 1e-5
"""How far from 1 the last number of a transform's last row may be: recordings hold 6 digits."""

LARGEST_NUMBER = 1e12
"""No transform in mm holds more; trackers write such numbers for a pose that they do not have."""

CLOSEST = 1e-4
"""mm and voxels: what lies so close lies in the same place."""


def as_matrix(values: ArrayLike, name: str = "matrix") -> Matrix:
    """`values` as a (4, 4) float64 array.

    `values` are (4, 4), or 16 numbers in row-major order; `name` is what an error calls them.

    Raises GeometryError when there are not 16 numbers, one is not finite, the last row is not 0 0 0 1, or the matrix is singular.

    Returns
    -------
    matrix : (4, 4) float64 array
        A copy: changing it leaves `values` alone, and the other way round.
    """
    try:
        matrix = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise GeometryError(f"Input {name} must have 16 numbers (4 rows of 4); got {values!r}.") from None
    if matrix.shape not in ((4, 4), (16,)):
        raise GeometryError(f"Input {name} must have 16 numbers (4 rows of 4); got shape {matrix.shape}.")
    matrix = matrix.reshape(4, 4)
    if not np.isfinite(matrix).all():
        raise GeometryError(f"Input {name} must hold finite numbers; got NaN or infinity.")
    if np.abs(matrix).max() > LARGEST_NUMBER:
        raise GeometryError(f"Input {name} must hold numbers of at most {LARGEST_NUMBER:g}; got {np.abs(matrix).max():g}.")
    if not _ends_in_0_0_0_1(matrix):
        raise GeometryError(f"Input {name} must have 0 0 0 1 as its last row; got {matrix[3].tolist()}.")
    scale = np.prod(np.linalg.norm(matrix[:3, :3], axis=0))
    if scale == 0.0 or abs(np.linalg.det(matrix[:3, :3])) < 1e-9 * scale:
        raise GeometryError(f"Input {name} must be invertible; got a singular matrix.")
    return matrix


def affine(linear: ArrayLike, shift: ArrayLike = (0.0, 0.0, 0.0)) -> Matrix:
    """The transform of points p to ``linear @ p + shift``, (4, 4)."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = linear, shift
    return matrix


def _ends_in_0_0_0_1(matrix: Matrix) -> bool:
    """Whether the last row of a (4, 4) matrix is 0 0 0 1, as far as recorded digits go."""
    x, y, z, one = matrix[3].tolist()
    return bool(max(abs(x), abs(y), abs(z)) <= LAST_ROW_TOLERANCE and abs(one - 1.0) <= LAST_ONE_TOLERANCE)


def why_not_affine(matrix: Matrix) -> str | None:
    """What keeps a (4, 4) matrix from being a transform of points; None for a usable one."""
    # Asked of every frame: on 16 numbers Python is ten times as fast as numpy
    numbers = matrix.ravel().tolist()
    if not all(map(math.isfinite, numbers)):
        return "not finite"
    if max(map(abs, numbers)) > LARGEST_NUMBER:
        return "not a pose (numbers too large)"
    if not _ends_in_0_0_0_1(matrix):
        return "not a pose (last row is not 0 0 0 1)"
    return None


def why_not_rigid(matrix: Matrix) -> str | None:
    """What keeps a (4, 4) pose from being a rotation and a translation; None for a rigid one."""
    problem = why_not_affine(matrix)
    if problem:
        return problem
    turn = matrix[:3, :3]
    if np.abs(turn.T @ turn - np.eye(3)).max() > RIGIDITY_TOLERANCE:
        return "not rigid (scaled or sheared)"
    if np.linalg.det(turn) < 0:
        return "not rigid (mirrored)"
    return None


def why_not_an_image_pose(image_to_reference: Matrix) -> str | None:
    """What keeps a (4, 4) image-to-reference matrix from placing pixels on a plane; None for a usable one."""
    problem = why_not_affine(image_to_reference)
    if problem:
        return problem
    x, y = image_to_reference[:3, :2].T
    along_x, along_y = pixel_spacing(image_to_reference)
    if min(along_x, along_y) <= 0.0 or max(along_x, along_y) > 1e4 * min(along_x, along_y):
        return "singular (a pixel has no size)"
    if abs(x @ y) > SHEAR_TOLERANCE * along_x * along_y:
        return "sheared (image axes are not at right angles)"
    return None


def invert(matrix: Matrix) -> Matrix:
    """The inverse of an affine (4, 4) matrix, last row exactly 0 0 0 1; raises GeometryError when it is singular."""
    try:
        inverse = np.asarray(np.linalg.inv(matrix), dtype=np.float64)
    except np.linalg.LinAlgError:
        raise GeometryError("Input matrix must be invertible; got a singular matrix.") from None
    inverse[3] = (0.0, 0.0, 0.0, 1.0)
    return inverse


def transform_points(a_to_b: Matrix, points_a: ArrayLike) -> Floats:
    """Points (..., 3) of frame a in frame b."""
    return np.asarray(points_a, dtype=np.float64) @ a_to_b[:3, :3].T + a_to_b[:3, 3]


def unit_vectors(vectors: Floats) -> Floats:
    """Vectors (..., n) of length 1; those of length 0 stay."""
    unit: Floats = vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)
    return unit


def whole_shift(one: Matrix, other: Matrix) -> Integers | None:
    """What makes of voxel numbers those of another grid that mean the same places, (3,); None where voxels do not lie on voxels.

    Both grids are given by the matrices (4, 4) from their voxels to one frame, mm.
    """
    if not np.allclose(one[:3, :3], other[:3, :3], atol=CLOSEST, rtol=0):
        return None
    exact = np.linalg.solve(other[:3, :3], one[:3, 3] - other[:3, 3])
    shift = np.rint(exact)
    return shift.astype(int) if np.abs(exact - shift).max() < CLOSEST else None


def pixel_spacing(image_to_reference: Matrix) -> tuple[float, float]:
    """Column and row pitch (x, y) in mm: the lengths of the first two columns."""
    x, y = image_to_reference[:3, :2].T.tolist()
    return math.hypot(*x), math.hypot(*y)


def with_unit_depth(image_to_any: Matrix) -> Matrix:
    """A copy of a matrix of pixels (4, 4) whose third column is a step of 1 mm out of the image, right-handed with its axes."""
    matrix = np.array(image_to_any, dtype=np.float64)
    normal = np.cross(matrix[:3, 0], matrix[:3, 1])
    matrix[:3, 2] = normal / np.linalg.norm(normal)
    return matrix


def image_plane_axes(image_to_reference: Matrix) -> tuple[Floats, Floats]:
    """Orthonormal unit vectors (3,) in Reference along the image's columns (x) and rows (y).

    A calibration may leave the two axes a few degrees off a right angle. Both are then turned by the same amount toward a
    right angle (Loewdin's symmetric orthonormalization), so that no beam gets longer than 1.
    """
    spacing = pixel_spacing(image_to_reference)
    x = image_to_reference[:3, 0] / spacing[0]
    y = image_to_reference[:3, 1] / spacing[1]
    along, across = x + y, x - y
    along = along / math.hypot(*along.tolist())
    across = across / math.hypot(*across.tolist())
    half = math.sqrt(0.5)
    return half * (along + across), half * (along - across)


def at_right_angles(image_to_reference: Matrix, columns: int, rows: int) -> Matrix:
    """The placement of an image that is nearest to an affine one among those that a volume node can hold, for display.

    `image_to_reference` (4, 4) takes pixels (column, row) to mm. Calibrations are affine fits: axes some degrees off a right angle are
    usual. What comes back has the same plane, pixel sizes and middle of the image.

    Notes
    -----
    The directions are the orthogonal factor of the polar decomposition M = U P of the unit axes and the plane's normal, the orthogonal
    matrix that is nearest to M (Fan and Hoffman 1955): each axis turns by half of what they are off. Where M is orthogonal, U is M.
    """
    linear = np.array(image_to_reference[:3, :3], dtype=np.float64)
    sizes = np.linalg.norm(linear, axis=0)
    normal = np.cross(linear[:, 0], linear[:, 1])
    turned = -1.0 if np.linalg.det(linear) < 0 else 1.0
    sizes[2] = sizes[2] or 1.0
    axes = np.column_stack([linear[:, 0] / sizes[0], linear[:, 1] / sizes[1], turned * normal / np.linalg.norm(normal)])
    left, _stretches, right = np.linalg.svd(axes)
    middle = np.array([(columns - 1) / 2, (rows - 1) / 2, 0.0])
    squared = left @ right * sizes
    return affine(squared, image_to_reference[:3, 3] + (linear - squared) @ middle)


def ras_to_lps(matrix_ras: Matrix) -> Matrix:
    """A transform between RAS frames, expressed between LPS frames. Its own inverse."""
    matrix_lps: Matrix = LPS_FROM_RAS @ matrix_ras @ LPS_FROM_RAS
    return matrix_lps
