"""Distances to bone against spheres, whose distance is known without computing: what lies where, whatever voxels the labels have."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import places

from AIFReconLib.bone.field import BoneField
from AIFReconLib.bone.map import BoneMap
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import Volume, VoxelGrid

RADIUS = 12.0
OFFSETS = ((0.0, 0.0, 0.0), (0.5, 0.5, 0.5), (0.25, 0.1, 0.4), (0.13, 0.37, 0.21))
"""Of a sphere's center from a voxel's, in voxels."""

WAYS = np.random.default_rng(0).normal(size=(2000, 3))
WAYS /= np.linalg.norm(WAYS, axis=1, keepdims=True)


def ball(spacing, offset) -> tuple[Volume, np.ndarray]:
    """A sphere that is labeled where voxels have their centers in it, and its center."""
    spacing = np.array(spacing)
    size = np.ceil((2 * RADIUS + 8) / spacing).astype(int) + 1
    center = ((size - 1) / 2 + offset) * spacing
    grid = VoxelGrid(tuple(size.tolist()), np.diag([*spacing, 1.0]))
    labels = np.linalg.norm(places(grid) - center, axis=-1) < RADIUS
    return Volume(labels.astype(np.uint8), grid.ijk_to_reference), center


def errors(spacing, level: float = 0.0) -> float:
    """Mean error in mm of the distances at `level` mm from spheres, at heights between the first and the last slice with bone."""
    found = []
    for offset in OFFSETS:
        labels, center = ball(spacing, offset)
        points = center + (RADIUS + level) * WAYS
        heights = np.flatnonzero(labels.array.any(axis=(1, 2)))[[0, -1]] * spacing[2]
        known = (points[:, 2] >= heights[0]) & (points[:, 2] <= heights[1])
        found.append(BoneField.from_labels(labels).sample(points[known])[0] - level)
    return float(np.concatenate(found).mean())


EVEN = [(side, side, side) for side in (0.3, 0.4, 0.5, 0.6, 0.8, 1.0)]
IN_SLICES = [(1.0, 1.0, 0.5), (0.5, 0.5, 1.0), (0.4, 0.4, 1.5), (0.5, 0.5, 2.0), (0.5, 0.5, 3.0), (1.0, 1.0, 5.0)]


@pytest.mark.parametrize("spacing", [*EVEN, *IN_SLICES])
def test_the_surface_of_a_sphere_is_where_it_is(spacing):
    assert abs(errors(spacing)) < 0.05


@pytest.mark.parametrize("level", [-4.0, 3.0, 9.0])
def test_distances_are_those_of_the_sphere_away_from_its_surface_too(level):
    assert abs(errors((0.5, 0.5, 0.5), level)) < 0.1


def test_a_block_that_is_half_bone_is_not_taken_for_bone():
    labels = np.zeros((40, 40, 60), np.uint8)
    labels[..., 20:35] = 1  # from 9.75 to 17.25 mm, half a block too much or too little for whole ones
    field = BoneField.from_labels(Volume(labels, np.diag([0.5, 0.5, 0.5, 1.0])))
    before, behind = (float(field.sample(np.array([[x, 10.0, 10.0]]))[0][0]) for x in (9.75 - 2.0, 17.25 + 2.0))
    assert (before, behind) == pytest.approx((2.0, 2.0), abs=0.05)


def test_slices_are_filled_in_as_fine_as_they_are_and_no_finer():
    labels = np.zeros((9, 9, 9), np.uint8)
    labels[4, 4, 4] = 1
    spacings = [
        BoneField.from_labels(Volume(labels, np.diag([*mm, 1.0]))).distance.grid.spacing for mm in ([1, 1, 5], [3, 3, 3], [1, 1, 100])
    ]
    assert np.allclose(spacings, [[1, 1, 1], [3, 3, 3], [1, 1, 12.5]])


@pytest.mark.parametrize("spacing", [(1.0, 1.0, 5.0), (0.4, 0.4, 0.4), (2.0, 2.0, 2.0)])
def test_a_single_voxel_of_bone_is_the_place_nearest_to_bone(spacing):
    labels = np.zeros((40, 40, 40), np.uint8)
    labels[20, 21, 22] = 1
    distance = BoneField.from_labels(Volume(labels, np.diag([*spacing, 1.0]))).distance
    nearest = np.array(np.unravel_index(distance.array.argmin(), distance.array.shape))[::-1]
    place = distance.ijk_to_reference @ [*nearest, 1.0]
    assert (np.abs(place[:3] - np.array([22, 21, 20]) * spacing) <= np.maximum(spacing, 1.0) / 2 + 1e-6).all()


@pytest.mark.parametrize("spacing", [(0.8, 0.8, 0.8), (0.6, 0.9, 1.4)])
def test_a_map_of_distances_is_1_on_the_surface_falls_with_the_distance_and_faces_outward_on_both_sides(spacing):
    labels, center = ball(spacing, OFFSETS[2])
    placed = np.array([[0.0, -1.0, 0.0, 5.0], [1.0, 0.0, 0.0, -3.0], [0.0, 0.0, 1.0, 8.0], [0.0, 0.0, 0.0, 1.0]])
    width = 1.5
    bone = BoneMap.from_field(BoneField.from_labels(labels), width, placed)
    grid = bone.probability.grid
    found = bone.on_grid(grid)
    outward = places(grid) - transform_points(placed, center)
    away = np.linalg.norm(outward, axis=-1)
    off = away - RADIUS
    near = np.abs(off) < 2.0 * width
    wrong = bone.probability.array[near] - np.exp(-0.5 * (off[near] / width) ** 2)
    assert np.abs(wrong).mean() < 0.05
    assert np.abs(wrong).max() < 0.2  # a voxel of labels may lie 0.4 mm off
    assert not bone.probability.array[np.abs(off) > 3.0 * width + 0.5].any()
    into = -(found.directions_reference[near] * outward[near]).sum(axis=1) / away[near]
    assert into.min() > 0.95
    assert (bone.inside.array[near] == (off[near] < 0))[np.abs(off[near]) > 0.4].all()
