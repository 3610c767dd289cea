"""4x4 matrices: what is accepted, and what composing, inverting and orthonormalizing give."""

from __future__ import annotations

import numpy as np
import pytest
from geometry_strategies import numbers, rigid, rigid_poses, scaled, spacings, triples
from hypothesis import given, settings
from hypothesis import strategies as st

from AIFReconLib.errors import GeometryError
from AIFReconLib.geometry.transforms import (
    LPS_FROM_RAS,
    as_matrix,
    image_plane_axes,
    invert,
    pixel_spacing,
    ras_to_lps,
    transform_points,
    why_not_affine,
    why_not_an_image_pose,
    why_not_rigid,
)

TILTED = rigid((0.3, -1.1, 0.7), (10.0, -20.0, 30.0))


def with_entry(row: int, column: int, value: float) -> np.ndarray:
    """A good pose with one entry replaced."""
    matrix = TILTED.copy()
    matrix[row, column] = value
    return matrix


NO_NUMBERS = (np.eye(3), np.ones(15), np.ones((2, 8)), [[1, 0, 0, 0], [0, 1, 0]], ["one"] * 16, None)
FLAT = [1, 2, 3, 0, 2, 4, 6, 0, 1, 1, 1, 0, 0, 0, 0, 1]


@pytest.mark.parametrize(
    ("values", "words"),
    [
        *((values, "16 numbers") for values in NO_NUMBERS),
        (with_entry(1, 2, np.nan), "finite"),
        (with_entry(0, 3, np.inf), "finite"),
        (with_entry(0, 3, -3.697314e28), "at most 1e\\+12"),
        (with_entry(0, 0, 1e300), "at most 1e\\+12"),
        (with_entry(3, 0, 0.5), "last row"),
        (with_entry(3, 3, 2.0), "last row"),
        (scaled(1, 1, 0), "singular"),
        (scaled(1, 0, 1), "singular"),
        (FLAT, "singular"),
    ],
)
def test_what_is_no_transform_of_points_is_refused(values, words):
    with pytest.raises(GeometryError, match=words):
        as_matrix(values)


@pytest.mark.parametrize("size", [1e-4, 1, 1e4])
def test_a_matrix_that_is_small_or_large_is_copied(size):
    given_matrix = scaled(size, size, size)
    kept = as_matrix(given_matrix)
    given_matrix[0, 3] = 99.0
    np.testing.assert_array_equal(kept, scaled(size, size, size))


@pytest.mark.parametrize(("column", "value", "good"), [(3, 1 + 9e-6, True), (3, 1 - 2e-5, False), (1, 9e-10, True), (1, -2e-9, False)])
def test_the_last_row_may_be_off_by_the_last_recorded_digit(column, value, good):
    assert (why_not_affine(with_entry(3, column, value)) is None) == good


@given(rigid_poses, spacings)
@settings(max_examples=30)
def test_a_matrix_times_its_inverse_is_the_identity(pose, spacing):
    matrix = pose @ scaled(*spacing)
    np.testing.assert_allclose(invert(matrix) @ matrix, np.eye(4), atol=1e-9)
    assert invert(matrix)[3].tolist() == [0.0, 0.0, 0.0, 1.0]
    np.testing.assert_allclose(pixel_spacing(matrix), spacing[:2], rtol=1e-12)
    with pytest.raises(GeometryError, match="invertible"):
        invert(0 * matrix)


def sheared(shear: float, height: float = 1.0) -> np.ndarray:
    return TILTED @ np.array([[1, shear, 0, 0], [0, height, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


@pytest.mark.parametrize(
    ("why", "matrix", "words"),
    [
        (why_not_rigid, with_entry(0, 0, np.nan), "not finite"),
        (why_not_rigid, with_entry(2, 3, np.inf), "not finite"),
        (why_not_rigid, with_entry(3, 3, 0.0), "last row"),
        (why_not_rigid, with_entry(0, 3, 1e28), "too large"),
        (why_not_rigid, with_entry(0, 0, 1e300), "too large"),
        (why_not_rigid, TILTED @ scaled(1.05, 1.05, 1.05), "scaled"),
        (why_not_rigid, np.diag([0.0, 0.0, 0.0, 1.0]), "scaled"),
        (why_not_rigid, sheared(0.1), "sheared"),
        (why_not_rigid, TILTED @ scaled(1, 1, -1), "mirrored"),
        (why_not_rigid, TILTED @ scaled(-1, -1, -1), "mirrored"),
        (why_not_rigid, np.round(TILTED, 6), None),
        (why_not_an_image_pose, with_entry(1, 1, np.nan), "not finite"),
        (why_not_an_image_pose, with_entry(3, 1, 1.0), "last row"),
        (why_not_an_image_pose, TILTED @ scaled(0.0, 0.2, 1.0), "singular"),
        (why_not_an_image_pose, TILTED @ scaled(0.2, 0.2e-5, 1.0), "singular"),
        (why_not_an_image_pose, sheared(1, 1e-9), "sheared"),
        (why_not_an_image_pose, sheared(0.12), "sheared"),
        (why_not_an_image_pose, TILTED @ scaled(-0.2, 0.3, 1.0), None),
    ],
)
def test_a_pose_that_is_not_rigid_or_places_no_pixels_says_why(why, matrix, words):
    assert why(matrix) is None if words is None else words in why(matrix)


@given(rigid_poses, triples(-100, 100))
@settings(max_examples=30)
def test_points_are_transformed_like_homogeneous_columns(pose, point):
    np.testing.assert_allclose(transform_points(pose, [point])[0], (pose @ [*point, 1.0])[:3], atol=1e-9)


@given(rigid_poses, numbers(0.01, 5), numbers(0.01, 5), numbers(-0.3, 0.3), st.sampled_from([1.0, -1.0]))
@settings(max_examples=30)
def test_the_axes_of_an_image_are_its_normalized_columns_made_orthonormal(pose, x, y, shear, mirror):
    sheared = np.array([[1, shear, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    axes = np.stack(image_plane_axes(pose @ sheared @ scaled(mirror * x, y, 1.0)))
    np.testing.assert_allclose(axes @ axes.T, np.eye(2), atol=1e-12)
    np.testing.assert_allclose(np.cross(*axes), mirror * pose[:3, 2], atol=1e-9)
    axes = image_plane_axes(pose @ scaled(mirror * x, y, 1.0))
    np.testing.assert_allclose(np.stack(axes, axis=1), pose[:3, :2] * (mirror, 1.0), atol=1e-12)


def test_both_axes_of_a_sheared_image_turn_by_the_same_angle_in_its_plane():
    pose = sheared(0.09) @ scaled(0.2, 0.3, 1.0)
    x, y = image_plane_axes(pose)
    columns = pose[:3, :2] / np.linalg.norm(pose[:3, :2], axis=0)
    assert x @ columns[:, 0] == pytest.approx(y @ columns[:, 1], abs=1e-12)
    assert np.abs(np.stack([x, y]) @ TILTED[:3, 2]).max() < 1e-12


def test_a_transform_between_lps_frames_does_the_same_to_the_same_place():
    point_ras = np.array([5.0, -7.0, 11.0, 1.0])
    np.testing.assert_array_equal(LPS_FROM_RAS @ point_ras, [-5.0, 7.0, 11.0, 1.0])
    np.testing.assert_allclose(ras_to_lps(TILTED) @ LPS_FROM_RAS @ point_ras, LPS_FROM_RAS @ TILTED @ point_ras)
