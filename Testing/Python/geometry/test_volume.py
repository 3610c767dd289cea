"""Voxel grids: what is accepted, and where voxels lie. Files are tested elsewhere."""

from __future__ import annotations

import numpy as np
import pytest
from geometry_strategies import rigid, rigid_poses, scaled, spacings, triples
from hypothesis import given, settings

from AIFReconLib.errors import GeometryError
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.machine.memory import MAXIMUM_VOXELS

OBLIQUE = rigid((0.4, -1.2, 0.8), (10.0, -20.0, 30.0)) @ scaled(0.5, 0.6, 0.7)
SHEAR = np.array([[1, 0.1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


@pytest.mark.parametrize("size", [(0, 1, 1), (1, -1, 1), (1, 1), (1, 1, 1, 1), (1.5, 1, 1), (np.nan, 1, 1), "abc", 5, None])
def test_a_size_that_is_not_three_whole_numbers_is_refused(size):
    with pytest.raises(GeometryError, match="3 positive whole numbers"):
        VoxelGrid(size, np.eye(4))


@pytest.mark.parametrize("size", [(2048, 2048, 512), (2**22, 2**22, 2**22), (2**31, 1, 1), (2**32, 2**32, 1)])
def test_more_voxels_than_can_be_numbered_are_refused(size):
    with pytest.raises(GeometryError, match="Choose a larger spacing"):
        VoxelGrid(size, np.eye(4))


def test_as_many_voxels_as_can_be_numbered_are_accepted():
    assert VoxelGrid((MAXIMUM_VOXELS, 1, 1), np.eye(4)).voxels == MAXIMUM_VOXELS


@pytest.mark.parametrize(
    ("matrix", "words"),
    [
        (OBLIQUE @ SHEAR, "sheared"),
        (SHEAR @ OBLIQUE, "sheared"),
        (OBLIQUE @ scaled(1, 1, 0), "singular"),
        (np.full((4, 4), np.nan), "finite"),
        (np.eye(3), "16 numbers"),
    ],
)
def test_a_matrix_that_is_no_grid_is_refused(matrix, words):
    with pytest.raises(GeometryError, match=words):
        VoxelGrid((2, 2, 2), matrix)


@pytest.mark.parametrize("signs", [(1, 1, 1), (-1, 1, 1), (-1, -1, 1), (1, 1, -1), (-1, -1, -1)])
def test_axes_may_be_flipped(signs):
    np.testing.assert_allclose(VoxelGrid((2, 2, 2), OBLIQUE @ scaled(*signs)).spacing, [0.5, 0.6, 0.7])


def test_the_matrix_that_was_given_stays_the_giver_s_to_change():
    matrix = np.eye(4)
    grid = VoxelGrid((2, 2, 2), matrix)
    matrix[0, 3] = 5.0
    assert grid.origin[0] == 0.0


def test_the_matrix_of_a_grid_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        VoxelGrid((2, 2, 2), np.eye(4)).ijk_to_reference[0, 0] = 2.0


def test_an_array_is_indexed_k_j_i():
    assert VoxelGrid((2, 3, 4), np.eye(4)).shape == (4, 3, 2)


def test_voxels_are_counted():
    assert VoxelGrid((2, 3, 4), np.eye(4)).voxels == 24


def test_a_grid_from_a_spacing_has_its_first_voxel_at_the_origin():
    grid = VoxelGrid.from_spacing((1, 2, 3), (4, 5, 6), (0.1, 0.2, 0.3))
    assert grid.origin.tolist() == [1, 2, 3]
    np.testing.assert_allclose(grid.spacing, [0.1, 0.2, 0.3])


def test_one_spacing_holds_for_all_axes():
    assert VoxelGrid.from_spacing((0, 0, 0), (4, 5, 6), 0.5).spacing.tolist() == [0.5, 0.5, 0.5]


@pytest.mark.parametrize("spacing", [0.0, np.nan, (1.0, 0.0, 1.0)])
def test_a_spacing_that_is_none_is_refused(spacing):
    with pytest.raises(GeometryError):
        VoxelGrid.from_spacing((0, 0, 0), (4, 5, 6), spacing)


@given(rigid_poses, spacings, triples(-20, 20))
@settings(max_examples=40, deadline=None)
def test_to_reference_and_back_is_the_same_voxel(pose, spacing, ijk):
    grid = VoxelGrid((3, 4, 5), pose @ scaled(*spacing))
    there = grid.ijk_to_reference @ [*ijk, 1.0]
    np.testing.assert_allclose((grid.reference_to_ijk @ there)[:3], ijk, atol=1e-7)


def test_corners_are_the_centers_of_the_corner_voxels():
    grid = VoxelGrid((2, 3, 4), OBLIQUE)
    expected = {tuple(np.round((OBLIQUE @ [i, j, k, 1])[:3], 9)) for i in (0, 1) for j in (0, 2) for k in (0, 3)}
    assert {tuple(corner) for corner in np.round(grid.corners(), 9)} == expected


def test_a_grid_matches_its_copy():
    assert VoxelGrid((20, 30, 40), OBLIQUE).matches(VoxelGrid((20, 30, 40), OBLIQUE.copy()))


def test_a_grid_matches_one_that_was_written_with_six_digits():
    assert VoxelGrid((20, 30, 40), OBLIQUE).matches(VoxelGrid((20, 30, 40), np.round(OBLIQUE, 6)))


@pytest.mark.parametrize(
    "other",
    [
        VoxelGrid((20, 30, 41), OBLIQUE),
        VoxelGrid((20, 30, 40), rigid((0, 0, 0), (0.01, 0, 0)) @ OBLIQUE),
        VoxelGrid((20, 30, 40), OBLIQUE @ scaled(1.001, 1, 1)),
        VoxelGrid((20, 30, 40), OBLIQUE @ scaled(-1, 1, 1)),
        VoxelGrid((20, 30, 40), OBLIQUE @ rigid((0, 0, 0.001), (0, 0, 0))),
    ],
    ids=["size", "shift", "spacing", "flip", "turn"],
)
def test_a_grid_does_not_match_another(other):
    assert not VoxelGrid((20, 30, 40), OBLIQUE).matches(other)


@pytest.mark.parametrize("shape", [(2, 2), (2, 2, 2, 3), ()])
def test_a_volume_has_three_axes(shape):
    with pytest.raises(GeometryError, match="shape \\(k, j, i\\)"):
        Volume(np.zeros(shape), np.eye(4))


def test_an_empty_volume_is_refused():
    with pytest.raises(GeometryError, match="positive"):
        Volume(np.zeros((0, 2, 2)), np.eye(4))


def test_a_volume_knows_its_grid():
    assert Volume(np.zeros((4, 3, 2)), OBLIQUE).grid.size == (2, 3, 4)


def test_a_volume_is_moved_by_a_transform_from_the_left():
    move = rigid((0.1, 0.2, 0.3), (1, 2, 3))
    np.testing.assert_allclose(Volume(np.zeros((4, 3, 2)), OBLIQUE).placed_by(move).ijk_to_reference, move @ OBLIQUE)


def test_a_moved_volume_keeps_its_voxels():
    array = np.arange(24.0).reshape(4, 3, 2)
    assert Volume(array, OBLIQUE).placed_by(np.eye(4)).array is array


def test_a_transform_that_shears_a_volume_is_refused():
    with pytest.raises(GeometryError, match="sheared"):
        Volume(np.zeros((4, 3, 2)), OBLIQUE).placed_by(SHEAR)
