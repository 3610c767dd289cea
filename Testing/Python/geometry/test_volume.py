"""Voxel grids, volumes and labels: what is accepted, where voxels lie, what other packages make of them. Files are tested elsewhere."""

from __future__ import annotations

import numpy as np
import pytest
import SimpleITK as sitk
from geometry_strategies import rigid, rigid_poses, scaled, spacings, triples
from hypothesis import given, settings

from AIFReconLib.errors import GeometryError
from AIFReconLib.geometry.labels import Labels
from AIFReconLib.geometry.volume import Volume, VoxelGrid

OBLIQUE = rigid((0.4, -1.2, 0.8), (10.0, -20.0, 30.0)) @ scaled(0.5, 0.6, 0.7)
SHEAR = np.array([[1, 0.1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


@pytest.mark.parametrize("size", [(0, 1, 1), (1, -1, 1), (1, 1), (1, 1, 1, 1), (1.5, 1, 1), (np.nan, 1, 1), "abc", 5, None])
def test_a_size_that_is_not_three_whole_numbers_is_refused(size):
    with pytest.raises(GeometryError, match="3 positive whole numbers"):
        VoxelGrid(size, np.eye(4))


@pytest.mark.parametrize("size", [(2**22, 2**22, 2**22), (2**36 + 1, 1, 1), (2**32, 2**32, 1)])
def test_more_voxels_than_any_memory_holds_are_refused(size):
    with pytest.raises(GeometryError, match="Choose a larger spacing"):
        VoxelGrid(size, np.eye(4))


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


def test_a_grid_from_a_spacing_has_its_first_voxel_at_the_origin():
    grid = VoxelGrid.from_spacing((1, 2, 3), (4, 5, 6), (0.1, 0.2, 0.3))
    assert grid.origin.tolist() == [1, 2, 3]
    np.testing.assert_allclose(grid.spacing, [0.1, 0.2, 0.3])


@given(rigid_poses, spacings, triples(-20, 20))
@settings(max_examples=40)
def test_to_reference_and_back_is_the_same_voxel(pose, spacing, ijk):
    grid = VoxelGrid((3, 4, 5), pose @ scaled(*spacing))
    there = grid.ijk_to_reference @ [*ijk, 1.0]
    np.testing.assert_allclose((grid.reference_to_ijk @ there)[:3], ijk, atol=1e-7)


def test_corners_are_the_centers_of_the_corner_voxels():
    grid = VoxelGrid((2, 3, 4), OBLIQUE)
    expected = {tuple(np.round((OBLIQUE @ [i, j, k, 1])[:3], 9)) for i in (0, 1) for j in (0, 2) for k in (0, 3)}
    assert {tuple(corner) for corner in np.round(grid.corners(), 9)} == expected


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


def test_a_volume_is_moved_by_a_transform_from_the_left():
    move = rigid((0.1, 0.2, 0.3), (1, 2, 3))
    np.testing.assert_allclose(Volume(np.zeros((4, 3, 2)), OBLIQUE).placed_by(move).ijk_to_reference, move @ OBLIQUE)


# ---- a volume is an array


NUMBERED = Volume(np.arange(4 * 5 * 6, dtype=np.int16).reshape(4, 5, 6), OBLIQUE)


def world_of(volume: Volume) -> dict[int, tuple[float, ...]]:
    """Where each value of a volume of different ones lies, mm."""
    return {
        int(value): tuple((volume.ijk_to_reference @ (i, j, k, 1.0)).round(9).tolist()) for (k, j, i), value in np.ndenumerate(volume.array)
    }


def test_numpy_takes_a_volume_for_its_array_without_a_copy():
    assert np.shares_memory(np.asarray(NUMBERED), NUMBERED.array)
    assert NUMBERED.shape == np.asarray(NUMBERED).shape == (4, 5, 6)
    assert NUMBERED.dtype == np.int16
    assert np.percentile(NUMBERED, 100) == 119


def test_numpy_gets_a_copy_or_another_type_where_it_asks_for_one():
    copied = np.array(NUMBERED)
    assert not np.shares_memory(copied, NUMBERED.array)
    converted = np.asarray(NUMBERED, dtype=np.float32)
    assert converted.dtype == np.float32
    np.testing.assert_array_equal(converted, NUMBERED.array)


@pytest.mark.parametrize("array", ["volume.nrrd", [[["a"]]], np.zeros((2, 2, 2), complex), np.zeros((2, 2)), None])
def test_what_is_no_array_of_numbers_along_three_axes_is_refused(array):
    with pytest.raises(GeometryError, match="Input volume array must"):
        Volume(array, np.eye(4))


@pytest.mark.parametrize(
    "index",
    [
        np.s_[1:3],
        np.s_[:, 2:4, 1:-1],
        np.s_[::2, ::3, 1::2],
        np.s_[::-1],
        np.s_[3:0:-2, ::-3, -2::-1],
        np.s_[..., 2:4],
        np.s_[1:, ..., ::-1],
        np.s_[...],
        np.s_[-1:, 2:3, 5:6],
        np.s_[0:99, :, :],
    ],
    ids=str,
)
def test_every_voxel_of_a_part_lies_where_it_lay(index):
    part, whole = NUMBERED[index], world_of(NUMBERED)
    np.testing.assert_array_equal(part.array, NUMBERED.array[index])
    for value, place in world_of(part).items():
        np.testing.assert_allclose(place, whole[value], atol=1e-8)


@pytest.mark.parametrize("index", [np.s_[:, :, :, :], np.s_[..., ...], "k", 99], ids=str)
def test_an_index_that_is_of_no_voxels_is_refused(index):
    with pytest.raises(GeometryError, match="Input index must"):
        NUMBERED[index]


@pytest.mark.parametrize("index", [0, np.s_[:, 1], np.s_[1, 2, 3], [1, 0], NUMBERED.array > 3], ids=str)
def test_an_index_that_keeps_no_place_takes_numbers_as_numpy_does(index):
    assert np.array_equal(NUMBERED[index], NUMBERED.array[index])


def test_comparisons_are_of_every_voxel_and_choose_voxels():
    assert np.array_equal(NUMBERED > 3, NUMBERED.array > 3)
    assert (NUMBERED == NUMBERED).all()
    assert not (NUMBERED.array != NUMBERED).any()
    assert np.array_equal(NUMBERED[NUMBERED >= 4], NUMBERED.array[NUMBERED.array >= 4])


def test_a_volume_knows_its_mean_and_its_affine():
    assert NUMBERED.mean() == NUMBERED.array.mean()
    assert (NUMBERED.min(), NUMBERED.max()) == (NUMBERED.array.min(), NUMBERED.array.max())
    assert np.array_equal(NUMBERED.affine, NUMBERED.ijk_to_reference)


@given(rigid_poses, spacings, triples(0, 3))
@settings(max_examples=40)
def test_simpleitk_puts_every_voxel_where_the_volume_has_it(pose, spacing, ijk):
    volume = Volume(NUMBERED.array, pose @ scaled(*spacing))
    image = volume.to_sitk()
    i, j, k = (int(n) for n in ijk)
    # SimpleITK speaks LPS: x and y run the other way
    x, y, z = image.TransformIndexToPhysicalPoint((i, j, k))
    np.testing.assert_allclose((-x, -y, z), (volume.ijk_to_reference @ (i, j, k, 1.0))[:3], atol=1e-6)
    assert image[i, j, k] == volume.array[k, j, i]


def test_an_image_of_simpleitk_lies_where_it_says_itself():
    image = sitk.GetImageFromArray(np.arange(24, dtype=np.float32).reshape(2, 3, 4))
    turn = sitk.Euler3DTransform((0, 0, 0), 0.3, -0.7, 1.1)
    image.SetDirection(turn.GetMatrix())
    image.SetSpacing((0.4, 0.9, 2.5))
    image.SetOrigin((-12.0, 7.0, 90.0))
    volume = Volume.from_sitk(image)
    for k, j, i in np.ndindex(volume.shape):
        x, y, z = image.TransformIndexToPhysicalPoint((i, j, k))
        np.testing.assert_allclose(volume.ijk_to_reference @ (i, j, k, 1.0), (-x, -y, z, 1.0), atol=1e-5)
        assert volume.array[k, j, i] == image[i, j, k]


@pytest.mark.parametrize("kind", [np.uint8, np.int16, np.float32, np.float64])
def test_a_volume_goes_through_simpleitk_and_comes_back(kind):
    mirrored = Volume(NUMBERED.array.astype(kind), OBLIQUE)[:, ::-1]
    back = Volume.from_sitk(mirrored.to_sitk())
    np.testing.assert_array_equal(back, mirrored)
    np.testing.assert_allclose(back.ijk_to_reference, mirrored.ijk_to_reference, atol=1e-9)
    assert back.dtype == kind


@pytest.mark.parametrize(
    ("image", "words"),
    [
        ("ct.nrrd", "must be a SimpleITK.Image of a 3D volume; got str"),
        (sitk.Image(4, 4, sitk.sitkUInt8), "got 2 dimensions"),
        (sitk.Image([4, 4, 4], sitk.sitkVectorUInt8, 3), "one real number a voxel"),
        (sitk.Image([4, 4, 4], sitk.sitkComplexFloat32), "one real number a voxel"),
    ],
    ids=["path", "picture", "colors", "complex"],
)
def test_an_image_that_is_no_scalar_volume_is_refused(image, words):
    with pytest.raises(GeometryError, match=words):
        Volume.from_sitk(image)


@pytest.mark.parametrize("dtype", ["?", "u1", "i2", "u4", "i8", "f8"])
def test_labels_are_found_in_numbers_of_every_type(dtype):
    boxes = {1: (slice(1, 3), slice(2, 3), slice(3, 5))} | ({} if dtype == "?" else {3: (slice(0, 1), slice(0, 2), slice(0, 1))})
    array = np.zeros((3, 4, 5), dtype)
    for number, box in boxes.items():
        array[box] = number
    labels = Labels(array, np.eye(4))
    assert labels.boxes == boxes
    assert labels.numbers().tolist() == list(boxes)
