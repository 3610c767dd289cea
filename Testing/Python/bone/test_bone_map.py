"""Bone maps against the plain recipe in scipy, closed forms and invariants."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from geometry_strategies import rigid, rigid_poses, scaled
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage
from sweeps import places

from AIFReconLib.bone.map import SURFACE_SIGMA, BoneMap
from AIFReconLib.bone.placed import at_voxels as at_voxels_module
from AIFReconLib.errors import GeometryError
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.machine.threads import optional_module

needs_numba = pytest.mark.skipif(optional_module("AIFReconLib.bone.numba_map") is None, reason="numba is not installed")

OBLIQUE = rigid((0.4, -1.2, 0.8), (10.0, -20.0, 30.0))
CT_MATRICES = {
    "plain": np.eye(4),
    "anisotropic": scaled(0.5, 0.7, 1.6),
    "rotated": OBLIQUE,
    "flipped": scaled(-0.8, 0.8, 0.8),
    "rotated, flipped and anisotropic": OBLIQUE @ scaled(0.6, -0.9, 1.3),
}


def recipe(bone: np.ndarray, sigma=10.0) -> np.ndarray:
    """The paper's probability on the whole volume in float64: labels, Sobel magnitude, Gaussian, divided by the maximum."""
    slopes = [ndimage.sobel(bone.astype(np.float64), axis=axis, mode="nearest") for axis in range(3)]
    smooth = ndimage.gaussian_filter(np.sqrt(sum(slope**2 for slope in slopes)), sigma, mode="nearest")
    return smooth / smooth.max()


def directions_by_recipe(potential: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """The gradient of a potential in mm of Reference, [k, j, i, 3] float64: central differences, one voxel at a time."""
    to_reference = np.linalg.inv(matrix[:3, :3]).T
    slope_ijk = np.stack([ndimage.sobel(potential.astype(np.float64), axis=axis, mode="nearest") for axis in (2, 1, 0)], axis=-1)
    gradient = np.zeros_like(slope_ijk)
    for index in np.ndindex(potential.shape):
        gradient[index] = to_reference @ slope_ijk[index]
    length = np.linalg.norm(gradient, axis=-1, keepdims=True)
    return np.divide(gradient, length, out=np.zeros_like(gradient), where=length > 0)


def block(shape=(24, 26, 28), corner=(9, 10, 11), size=(5, 6, 7)) -> np.ndarray:
    """Labels with one box of bone."""
    labels = np.zeros(shape, np.uint8)
    labels[tuple(slice(a, a + n) for a, n in zip(corner, size, strict=True))] = 3
    return labels


def on_own_voxels(array: np.ndarray, bone_map: BoneMap, shape) -> np.ndarray:
    """Put what the map keeps (the box that the Gaussian reaches) back into the whole volume."""
    whole = np.zeros(shape, array.dtype)
    first = np.rint(bone_map.probability.grid.origin / bone_map.probability.grid.spacing).astype(int)[::-1]
    whole[tuple(slice(a, a + n) for a, n in zip(first, array.shape, strict=True))] = array
    return whole


# ---- probability


CORNERS = [(0, 10, 11), (19, 10, 11), (9, 0, 11), (9, 20, 11), (9, 10, 0), (9, 10, 21), (0, 0, 0), (19, 20, 21)]


@pytest.mark.parametrize(
    ("labels", "spacing", "width", "sigma"),
    [
        (block((30, 32, 34)), (1.0, 1.0, 1.0), {}, 10.0),
        (block((60, 64, 40), corner=(40, 20, 3), size=(4, 5, 6)), (1.0, 1.0, 1.0), {"sigma_voxels": 2.0}, 2.0),
        (block(), (0.5, 1.0, 2.0), {"sigma_mm": 2.0}, (1.0, 2.0, 4.0)),
        *((block(corner=corner), (1.0, 1.0, 1.0), {"sigma_voxels": 1.5}, 1.5) for corner in CORNERS),
    ],
)
def test_the_probability_equals_the_recipe_on_the_whole_volume(labels, spacing, width, sigma):
    """Also where it is cropped to the reach of the Gaussian, where bone touches the border, and in mm along every axis."""
    bone_map = BoneMap.from_labels(Volume(labels, scaled(*spacing)), **width)
    whole = on_own_voxels(bone_map.probability.array, bone_map, labels.shape)
    np.testing.assert_allclose(whole, recipe(labels > 0, sigma), atol=2e-6)
    assert bone_map.inside is not None
    np.testing.assert_array_equal(on_own_voxels(bone_map.inside.array, bone_map, labels.shape), labels > 0)


@pytest.mark.parametrize(("value", "words"), [(0, "got none"), (1, "bone everywhere")])
def test_labels_without_a_surface_are_refused(value, words):
    with pytest.raises(GeometryError, match=words):
        BoneMap.from_labels(Volume(np.full((5, 5, 5), value, np.uint8), np.eye(4)))


def test_a_registration_moves_probability_and_inside_together():
    bone_map = BoneMap.from_labels(Volume(block(), scaled(0.5, 0.5, 0.5)), labels_to_reference=OBLIQUE)
    np.testing.assert_allclose(bone_map.probability.ijk_to_reference, OBLIQUE @ scaled(0.5, 0.5, 0.5))
    np.testing.assert_array_equal(bone_map.inside.ijk_to_reference, bone_map.probability.ijk_to_reference)
    ready = BoneMap.from_probability(Volume(np.ones((2, 2, 2)), scaled(2, 2, 2)), OBLIQUE)
    np.testing.assert_allclose(ready.probability.ijk_to_reference, OBLIQUE @ scaled(2, 2, 2))


# ---- directions


@pytest.mark.parametrize("matrix", CT_MATRICES.values(), ids=CT_MATRICES)
def test_directions_equal_the_recipe_on_the_same_voxels(matrix):
    bone_map = BoneMap.from_labels(Volume(block((14, 15, 16), (5, 5, 6), (3, 4, 5)), matrix), sigma_voxels=1.5)
    placed = bone_map.on_grid(bone_map.probability.grid)
    expected = directions_by_recipe(bone_map.probability.array, bone_map.probability.ijk_to_reference)
    slope = np.linalg.norm([ndimage.sobel(bone_map.probability.array.astype(float), axis=a, mode="nearest") for a in range(3)], axis=0)
    clear = slope > 1e-3
    np.testing.assert_allclose(placed.directions_reference[clear], expected[clear], atol=2e-3)


def test_there_is_no_direction_where_the_probability_does_not_change():
    array = np.zeros((7, 7, 9), np.float32)
    array[..., 5:] = 1.0
    placed = BoneMap.from_probability(Volume(array, np.eye(4))).on_grid(VoxelGrid((9, 7, 7), np.eye(4)))
    has_direction = np.linalg.norm(placed.directions_reference, axis=-1) > 0
    np.testing.assert_array_equal(has_direction, np.broadcast_to(np.isin(np.arange(9), [4, 5]), (7, 7, 9)))


@pytest.mark.parametrize("matrix", CT_MATRICES.values(), ids=CT_MATRICES)
def test_surface_is_the_gradient_of_the_smoothed_labels(matrix):
    labels = block((14, 15, 16), (5, 5, 6), (3, 4, 5))
    bone_map = BoneMap.from_labels(Volume(labels, matrix), sigma_voxels=2.0)
    sigma = SURFACE_SIGMA / np.linalg.norm(matrix[:3, 2::-1], axis=0)
    smooth = ndimage.gaussian_filter((labels > 0).astype(np.float64), sigma, mode="nearest")
    slope = np.linalg.norm([ndimage.sobel(smooth, axis=axis, mode="nearest") for axis in range(3)], axis=0)
    clear = slope > 1e-2
    found = bone_map.on_grid(VoxelGrid((16, 15, 14), matrix), "surface").directions_reference
    np.testing.assert_allclose(found[clear], directions_by_recipe(smooth, matrix)[clear], atol=1e-3)


@pytest.mark.parametrize("largest", [100.0, 255.0])
def test_a_probability_in_percent_or_gray_levels_is_refused(largest):
    with pytest.raises(GeometryError, match="must be 0 to 1"):
        BoneMap.from_probability(Volume(np.array([[[0.0, largest]]]), np.eye(4)))


# ---- placing on a grid


FINE = VoxelGrid((18, 17, 16), rigid((0.2, 0.1, -0.3), (3.0, 4.0, 5.0)) @ scaled(0.7, 0.8, 0.9))


def sampled_by_scipy(array: np.ndarray, source: VoxelGrid, grid: VoxelGrid, order: Literal[0, 1]) -> np.ndarray:
    """`map_coordinates` in float64 at every voxel of the grid, zeros around the source."""
    coordinates = np.moveaxis(transform_points(source.reference_to_ijk, places(grid))[..., ::-1], -1, 0)
    return ndimage.map_coordinates(array.astype(np.float64), coordinates, order=order, mode="grid-constant", prefilter=False)


def test_on_a_turned_finer_grid_all_is_interpolated_linearly_and_directions_before_they_are_normalized():
    bone_map = BoneMap.from_labels(Volume(block(), np.eye(4)), sigma_voxels=2.0)
    expected = sampled_by_scipy(bone_map.probability.array, bone_map.probability.grid, FINE, 1)
    np.testing.assert_allclose(bone_map.on_grid(FINE).probability, expected, atol=1e-6)
    slopes = [ndimage.sobel(bone_map.probability.array.astype(np.float64), axis=axis, mode="nearest") for axis in (2, 1, 0)]
    gradient = np.stack([sampled_by_scipy(slope, bone_map.probability.grid, FINE, 1) for slope in slopes], axis=-1)
    length = np.linalg.norm(gradient, axis=-1, keepdims=True)
    clear = length[..., 0] > 1e-2
    found = bone_map.on_grid(FINE).directions_reference
    np.testing.assert_allclose(found[clear], (gradient / np.maximum(length, 1e-12))[clear], atol=1e-3)


WITHOUT_NUMBA = pytest.param(True, id="scipy")


@pytest.mark.parametrize("by_scipy", [pytest.param(False, marks=needs_numba, id="numba"), WITHOUT_NUMBA])
@given(
    turn=rigid_poses,
    spacing=st.tuples(*[st.floats(0.2, 3.0)] * 3),
    shape=st.tuples(*[st.integers(1, 9)] * 3),
    size=st.tuples(*[st.integers(1, 14)] * 3),
    part=st.tuples(st.integers(0, 13), st.integers(1, 14)),
    direction=st.sampled_from(["gradient", "surface"]),
    seed=st.integers(0, 1000),
)
@settings(max_examples=40)
def test_a_map_says_the_same_at_some_voxels_as_on_all_with_and_without_numba(by_scipy, turn, spacing, shape, size, part, direction, seed):
    rng = np.random.default_rng(seed)
    # With voxels where there is no bone
    probability = np.maximum(rng.random(shape, dtype=np.float32) - np.float32(0.3), 0)
    bone_map = BoneMap.from_probability(Volume(probability, scaled(1.0, 0.8, 1.3)))
    placed = turn @ scaled(*spacing)
    placed[:3, 3] = np.remainder(placed[:3, 3], 8.0) - 4.0
    grid = VoxelGrid(size, placed)
    first = min(part[0], size[2] - 1)
    planes = first, min(first + part[1], size[2])
    everywhere = bone_map.on_grid(grid, direction, planes=planes)
    some = bone_map.at_voxels(grid, direction, planes=planes)
    voxels = rng.integers(0, everywhere.probability.size, 200)
    with pytest.MonkeyPatch.context() as patch:
        if by_scipy:
            patch.setattr(at_voxels_module, "optional_module", lambda name: None)
        found, directions = some.at(voxels)
        assert some.overlaps == everywhere.overlaps
        again = bone_map.on_grid(grid, direction, planes=planes)
    np.testing.assert_array_equal(again.probability, everywhere.probability)
    np.testing.assert_array_equal(again.directions_reference, everywhere.directions_reference)
    expected, facing = everywhere.at(voxels)
    np.testing.assert_array_equal(found, expected)
    np.testing.assert_array_equal(directions, np.where(expected[:, None] > 0, facing, 0))


# ---- progress
