"""Voxel grids, volumes and labels: what is accepted, where voxels lie, what other packages make of them. Files are tested elsewhere."""

from __future__ import annotations

import numpy as np
import pytest
import SimpleITK as sitk
from geometry_strategies import rigid, rigid_poses, scaled, spacings, triples
from hypothesis import given, settings
from hypothesis import strategies as st

from AIFReconLib.errors import GeometryError
from AIFReconLib.geometry.labels import Labels
from AIFReconLib.geometry.volume import Volume, VoxelGrid

OBLIQUE = rigid((0.4, -1.2, 0.8), (10.0, -20.0, 30.0)) @ scaled(0.5, 0.6, 0.7)
SHEAR = np.array([[1, 0.1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


NO_SIZES = ((0, 1, 1), (1, -1, 1), (1, 1), (1, 1, 1, 1), (1.5, 1, 1), (np.nan, 1, 1), "abc", 5, None)
TOO_LARGE = ((2**22, 2**22, 2**22), (2**36 + 1, 1, 1), (2**32, 2**32, 1))


@pytest.mark.parametrize(
    ("size", "matrix", "words"),
    [
        *((size, np.eye(4), "3 positive whole numbers") for size in NO_SIZES),
        *((size, np.eye(4), "Choose a larger spacing") for size in TOO_LARGE),
        ((2, 2, 2), OBLIQUE @ SHEAR, "sheared"),
        ((2, 2, 2), SHEAR @ OBLIQUE, "sheared"),
        ((2, 2, 2), OBLIQUE @ scaled(1, 1, 0), "singular"),
        ((2, 2, 2), np.full((4, 4), np.nan), "finite"),
        ((2, 2, 2), np.eye(3), "16 numbers"),
    ],
)
def test_what_is_no_grid_is_refused(size, matrix, words):
    with pytest.raises(GeometryError, match=words):
        VoxelGrid(size, matrix)


@given(rigid_poses, spacings, triples(-20, 20), st.tuples(*[st.sampled_from([1.0, -1.0])] * 3))
@settings(max_examples=40)
def test_to_reference_and_back_is_the_same_voxel_with_axes_flipped_or_not(pose, spacing, ijk, signs):
    matrix = pose @ scaled(*spacing) @ scaled(*signs)
    grid = VoxelGrid((3, 4, 5), matrix)
    np.testing.assert_allclose((grid.reference_to_ijk @ grid.ijk_to_reference @ [*ijk, 1.0])[:3], ijk, atol=1e-7)
    np.testing.assert_allclose(grid.spacing, spacing)
    corners = {tuple(np.round((matrix @ [i, j, k, 1])[:3], 6)) for i in (0, 2) for j in (0, 3) for k in (0, 4)}
    assert {tuple(corner) for corner in np.round(grid.corners(), 6)} == corners
    # Nobody can change it
    before = matrix[0, 3]
    matrix[0, 3] += 5.0
    assert grid.origin[0] == before
    with pytest.raises(ValueError, match="read-only"):
        grid.ijk_to_reference[0, 0] = 2.0


OTHERS = {
    "size": VoxelGrid((20, 30, 41), OBLIQUE),
    "shift": VoxelGrid((20, 30, 40), rigid((0, 0, 0), (0.01, 0, 0)) @ OBLIQUE),
    "spacing": VoxelGrid((20, 30, 40), OBLIQUE @ scaled(1.001, 1, 1)),
    "flip": VoxelGrid((20, 30, 40), OBLIQUE @ scaled(-1, 1, 1)),
    "turn": VoxelGrid((20, 30, 40), OBLIQUE @ rigid((0, 0, 0.001), (0, 0, 0))),
    "six digits": VoxelGrid((20, 30, 40), np.round(OBLIQUE, 6)),
}


def test_a_grid_matches_one_that_was_written_with_six_digits_and_no_other():
    assert [name for name, grid in OTHERS.items() if VoxelGrid((20, 30, 40), OBLIQUE).matches(grid)] == ["six digits"]
    grid = VoxelGrid.from_spacing((1, 2, 3), (4, 5, 6), (0.1, 0.2, 0.3))
    assert (grid.origin.tolist(), grid.size) == ([1, 2, 3], (4, 5, 6))
    np.testing.assert_allclose(grid.spacing, [0.1, 0.2, 0.3])


# ---- a volume is an array


NUMBERED = Volume(np.arange(4 * 5 * 6, dtype=np.int16).reshape(4, 5, 6), OBLIQUE)


def world_of(volume: Volume) -> dict[int, tuple[float, ...]]:
    """Where each value of a volume of different ones lies, mm."""
    return {
        int(value): tuple((volume.ijk_to_reference @ (i, j, k, 1.0)).round(9).tolist()) for (k, j, i), value in np.ndenumerate(volume.array)
    }


def test_numpy_takes_a_volume_for_its_array_and_copies_where_that_is_asked_for():
    assert np.shares_memory(np.asarray(NUMBERED), NUMBERED.array)
    assert not np.shares_memory(np.array(NUMBERED), NUMBERED.array)
    assert NUMBERED.shape == np.asarray(NUMBERED).shape == (4, 5, 6)
    assert (NUMBERED.dtype, np.asarray(NUMBERED, dtype=np.float32).dtype) == (np.int16, np.float32)
    assert (np.percentile(NUMBERED, 100), NUMBERED.mean(), NUMBERED.min(), NUMBERED.max()) == (119, 59.5, 0, 119)
    move = rigid((0.1, 0.2, 0.3), (1, 2, 3))
    np.testing.assert_allclose(NUMBERED.placed_by(move).affine, move @ OBLIQUE)


@pytest.mark.parametrize("array", ["volume.nrrd", [[["a"]]], np.zeros((2, 2, 2), complex), np.zeros((2, 2)), None])
def test_what_is_no_array_of_numbers_along_three_axes_is_refused(array):
    with pytest.raises(GeometryError, match="Input volume array must"):
        Volume(array, np.eye(4))


PARTS = [np.s_[1:3], np.s_[:, 2:4, 1:-1], np.s_[::2, ::3, 1::2], np.s_[::-1], np.s_[3:0:-2, ::-3, -2::-1]]
PARTS += [np.s_[..., 2:4], np.s_[1:, ..., ::-1], np.s_[...], np.s_[-1:, 2:3, 5:6], np.s_[0:99, :, :]]
PLACELESS = [0, np.s_[:, 1], np.s_[1, 2, 3], [1, 0], NUMBERED.array > 3]


@pytest.mark.parametrize("index", PARTS, ids=str)
def test_every_voxel_of_a_part_lies_where_it_lay(index):
    part, whole = NUMBERED[index], world_of(NUMBERED)
    np.testing.assert_array_equal(part.array, NUMBERED.array[index])
    for value, place in world_of(part).items():
        np.testing.assert_allclose(place, whole[value], atol=1e-8)


@pytest.mark.parametrize("index", [np.s_[:, :, :, :], np.s_[..., ...], "k", 99], ids=str)
def test_an_index_that_is_of_no_voxels_is_refused(index):
    with pytest.raises(GeometryError, match="Input index must"):
        NUMBERED[index]


def test_comparisons_choose_voxels_and_an_index_that_keeps_no_place_takes_numbers_as_numpy_does():
    assert all(np.array_equal(NUMBERED[index], NUMBERED.array[index]) for index in PLACELESS)
    assert np.array_equal(NUMBERED > 3, NUMBERED.array > 3)
    assert (NUMBERED == NUMBERED).all()
    assert not (NUMBERED.array != NUMBERED).any()
    assert np.array_equal(NUMBERED[NUMBERED >= 4], NUMBERED.array[NUMBERED.array >= 4])


@given(rigid_poses, spacings, triples(0, 3), st.sampled_from([np.uint8, np.int16, np.float32, np.float64]))
@settings(max_examples=40)
def test_simpleitk_puts_every_voxel_where_the_volume_has_it_and_gives_it_back(pose, spacing, ijk, kind):
    volume = Volume(NUMBERED.array.astype(kind), pose @ scaled(*spacing))[:, ::-1]
    image = volume.to_sitk()
    i, j, k = (int(n) for n in ijk)
    # SimpleITK speaks LPS: x and y run the other way
    x, y, z = image.TransformIndexToPhysicalPoint((i, j, k))
    np.testing.assert_allclose((-x, -y, z), (volume.ijk_to_reference @ (i, j, k, 1.0))[:3], atol=1e-6)
    assert image[i, j, k] == volume.array[k, j, i]
    back = Volume.from_sitk(image)
    np.testing.assert_array_equal(back, volume)
    np.testing.assert_allclose(back.ijk_to_reference, volume.ijk_to_reference, atol=1e-9)
    assert back.dtype == kind


@pytest.mark.parametrize(
    ("image", "words"),
    [
        ("ct.nrrd", "must be a SimpleITK.Image of a 3D volume; got str"),
        (sitk.Image(4, 4, sitk.sitkUInt8), "got 2 dimensions"),
        (sitk.Image([4, 4, 4], sitk.sitkVectorUInt8, 3), "one real number a voxel"),
        (sitk.Image([4, 4, 4], sitk.sitkComplexFloat32), "one real number a voxel"),
    ],
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
