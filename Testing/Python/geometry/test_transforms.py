"""4x4 matrices: what is accepted, and what composing, inverting and orthonormalizing give."""

from __future__ import annotations

import numpy as np
import pytest
from geometry_strategies import numbers, rigid, rigid_poses, scaled, spacings, triples
from hypothesis import given, settings

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


def test_a_matrix_is_copied_so_that_its_giver_may_go_on_changing_it():
    given_matrix = TILTED.copy()
    kept = as_matrix(given_matrix)
    given_matrix[0, 3] = 99.0
    assert kept[0, 3] == 10.0


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (np.eye(3), "16 numbers"),
        (np.ones(15), "16 numbers"),
        (np.ones((2, 8)), "16 numbers"),
        ([[1, 0, 0, 0], [0, 1, 0]], "16 numbers"),
        (["one"] * 16, "16 numbers"),
        (None, "16 numbers"),
        (with_entry(1, 2, np.nan), "finite"),
        (with_entry(0, 3, np.inf), "finite"),
        (with_entry(0, 3, -3.697314e28), "at most 1e\\+12"),
        (with_entry(0, 0, 1e300), "at most 1e\\+12"),
        (with_entry(3, 0, 0.5), "last row"),
        (with_entry(3, 3, 2.0), "last row"),
        (scaled(1, 1, 0), "singular"),
        (scaled(1, 0, 1), "singular"),
        (np.diag([0.0, 0.0, 0.0, 1.0]), "singular"),
        ([1, 2, 3, 0, 2, 4, 6, 0, 1, 1, 1, 0, 0, 0, 0, 1], "singular"),
    ],
)
def test_what_is_no_transform_of_points_is_refused(values, words):
    with pytest.raises(GeometryError, match=words):
        as_matrix(values)


@pytest.mark.parametrize(("column", "value", "good"), [(3, 1 + 9e-6, True), (3, 1 - 2e-5, False), (1, 9e-10, True), (1, -2e-9, False)])
def test_the_last_row_may_be_off_by_the_last_recorded_digit(column, value, good):
    assert (why_not_affine(with_entry(3, column, value)) is None) == good


@pytest.mark.parametrize("size", [1e-4, 1e4])
def test_a_matrix_is_not_singular_for_being_small_or_large(size):
    np.testing.assert_array_equal(as_matrix(scaled(size, size, size)), scaled(size, size, size))


@given(rigid_poses, spacings)
@settings(max_examples=30)
def test_a_matrix_times_its_inverse_is_the_identity(pose, spacing):
    matrix = pose @ scaled(*spacing)
    np.testing.assert_allclose(invert(matrix) @ matrix, np.eye(4), atol=1e-9)


def test_the_last_row_of_an_inverse_is_exact():
    assert invert(TILTED @ scaled(0.1, 0.2, 0.3))[3].tolist() == [0.0, 0.0, 0.0, 1.0]


def test_inverting_a_singular_matrix_is_an_error_of_the_library():
    with pytest.raises(GeometryError, match="invertible"):
        invert(np.zeros((4, 4)))


@pytest.mark.parametrize(
    ("matrix", "words"),
    [
        (with_entry(0, 0, np.nan), "not finite"),
        (with_entry(2, 3, np.inf), "not finite"),
        (with_entry(3, 3, 0.0), "last row"),
        (with_entry(0, 3, 1e28), "too large"),
        (with_entry(0, 0, 1e300), "too large"),
        (TILTED @ scaled(1.05, 1.05, 1.05), "scaled"),
        (TILTED @ scaled(0.1, 0.1, 0.1), "scaled"),
        (np.zeros((4, 4)) + np.diag([0, 0, 0, 1]), "scaled"),
        (TILTED @ np.array([[1, 0.1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]), "sheared"),
        (TILTED @ scaled(1, 1, -1), "mirrored"),
        (TILTED @ scaled(-1, -1, -1), "mirrored"),
    ],
)
def test_a_pose_that_is_not_rigid_says_why(matrix, words):
    assert words in why_not_rigid(matrix)


def test_a_pose_of_six_digits_is_rigid_and_an_image_pose_may_be_mirrored():
    assert why_not_rigid(np.round(TILTED, 6)) is None
    assert why_not_an_image_pose(TILTED @ scaled(-0.2, 0.3, 1.0)) is None


@pytest.mark.parametrize(
    ("matrix", "words"),
    [
        (with_entry(1, 1, np.nan), "not finite"),
        (with_entry(3, 1, 1.0), "last row"),
        (TILTED @ scaled(0.0, 0.2, 1.0), "singular"),
        (TILTED @ scaled(0.2, 0.2e-5, 1.0), "singular"),
        (TILTED @ np.array([[1, 1, 0, 0], [0, 1e-9, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]), "sheared"),
        (TILTED @ np.array([[1, 0.12, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]), "sheared"),
    ],
)
def test_an_image_pose_that_cannot_place_pixels_says_why(matrix, words):
    assert words in why_not_an_image_pose(matrix)


@given(rigid_poses, triples(-100, 100))
@settings(max_examples=30)
def test_points_are_transformed_like_homogeneous_columns(pose, point):
    np.testing.assert_allclose(transform_points(pose, [point])[0], (pose @ [*point, 1.0])[:3], atol=1e-9)


@given(rigid_poses, numbers(0.01, 5), numbers(0.01, 5))
@settings(max_examples=30)
def test_pixel_spacing_does_not_depend_on_the_pose(pose, x, y):
    np.testing.assert_allclose(pixel_spacing(pose @ scaled(x, y, 1.0)), (x, y), rtol=1e-12)


@given(rigid_poses, numbers(0.01, 5), numbers(0.01, 5))
@settings(max_examples=30)
def test_the_axes_of_a_rigid_image_are_its_normalized_columns(pose, x, y):
    axes = image_plane_axes(pose @ scaled(x, y, 1.0))
    np.testing.assert_allclose(np.stack(axes, axis=1), pose[:3, :2], atol=1e-12)


@given(rigid_poses, numbers(0.01, 5), numbers(0.01, 5), numbers(-0.3, 0.3))
@settings(max_examples=30)
def test_the_axes_of_a_sheared_image_are_orthonormal(pose, x, y, shear):
    sheared = np.array([[1, shear, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    axes = np.stack(image_plane_axes(pose @ sheared @ scaled(x, y, 1.0)))
    np.testing.assert_allclose(axes @ axes.T, np.eye(2), atol=1e-12)


def test_both_axes_of_a_sheared_image_turn_by_the_same_angle_in_its_plane():
    shear = np.array([[1, 0.09, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    pose = TILTED @ shear @ scaled(0.2, 0.3, 1.0)
    x, y = image_plane_axes(pose)
    columns = pose[:3, :2] / np.linalg.norm(pose[:3, :2], axis=0)
    assert x @ columns[:, 0] == pytest.approx(y @ columns[:, 1], abs=1e-12)
    assert np.abs(np.stack([x, y]) @ TILTED[:3, 2]).max() < 1e-12


def test_the_axes_of_a_mirrored_image_are_mirrored():
    x, y = image_plane_axes(TILTED @ scaled(-0.2, 0.3, 1.0))
    np.testing.assert_allclose(np.cross(x, y), -TILTED[:3, 2], atol=1e-12)


def test_right_becomes_left_and_anterior_becomes_posterior():
    np.testing.assert_array_equal(LPS_FROM_RAS @ [1.0, 2.0, 3.0, 1.0], [-1.0, -2.0, 3.0, 1.0])


def test_a_transform_between_lps_frames_does_the_same_to_the_same_place():
    point_ras = np.array([5.0, -7.0, 11.0, 1.0])
    np.testing.assert_allclose(ras_to_lps(TILTED) @ LPS_FROM_RAS @ point_ras, LPS_FROM_RAS @ TILTED @ point_ras)
