"""The true bone surface: where its points lie, what area they stand for, and which of them bound an interspinous gap."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import places, rigid, turned_grid, two_vertebrae

from AIFReconLib.evaluation.surface import bone_surface, distance_from_labels, interspinous_border
from AIFReconLib.geometry.labels import centers_of_mass
from AIFReconLib.geometry.volume import Volume, VoxelGrid

RADIUS, CENTER = 9.0, np.array([1.3, -2.2, 0.7])


def ball(spacing=(0.9, 1.1, 1.3)) -> Volume:
    """Signed distance to a ball, on a turned, anisotropic grid around it."""
    grid = turned_grid(spacing, tuple(int(30 / s) for s in spacing))
    grid = VoxelGrid(grid.size, rigid(translation=CENTER) @ grid.ijk_to_reference)
    return Volume(np.linalg.norm(places(grid) - CENTER, axis=-1) - RADIUS, grid.ijk_to_reference)


def labels_of(distance: Volume) -> Volume:
    return Volume((distance.array <= 0).astype(np.uint8), distance.ijk_to_reference)


def test_points_of_a_distance_lie_on_the_surface_between_the_voxels():
    surface = bone_surface(ball())
    radii = np.linalg.norm(surface.points_reference - CENTER, axis=1)
    # A straight line over a voxel edge h misses a curve of radius R by h^2 / (8 R) at most
    assert np.abs(radii - RADIUS).max() < 1.3**2 / (8 * RADIUS)


@pytest.mark.parametrize("pitch", [0, 0.7, 2.0])
def test_areas_sum_to_that_of_the_ball_at_any_pitch(pitch):
    surface, area = bone_surface(ball(), pitch=pitch), 4 * np.pi * RADIUS**2
    assert surface.areas.sum() == pytest.approx(area, rel=0.01)
    assert pitch < 2 or len(surface) == pytest.approx(area / pitch**2, rel=0.02)
    side = (surface.points_reference - CENTER) @ [0.36, -0.48, 0.8] > 0
    assert surface.areas[side].sum() == pytest.approx(area / 2, rel=0.05)


def test_a_surface_of_labels_lies_within_a_fraction_of_a_voxel():
    surface = bone_surface(distance_from_labels(labels_of(ball((0.8, 0.8, 0.8)))))
    radii = np.linalg.norm(surface.points_reference - CENTER, axis=1)
    assert abs(radii.mean() - RADIUS) < 0.12
    assert radii.std() < 0.1
    assert surface.areas.sum() == pytest.approx(4 * np.pi * RADIUS**2, rel=0.04)


def test_a_flat_face_of_labels_lies_half_way_between_the_voxels():
    array = np.zeros((12, 20, 20), dtype=np.uint8)
    array[:6] = 1
    surface = bone_surface(distance_from_labels(Volume(array, np.diag([1.0, 1.0, 0.5, 1.0]))))
    np.testing.assert_allclose(surface.points_reference[:, 2], 5.5 * 0.5, atol=1e-5)


# Interspinous border


def border_of(labels: Volume):
    surface = bone_surface(distance_from_labels(labels), labels, pitch=0)
    return surface, interspinous_border(surface, centers_of_mass(labels))


def test_the_border_is_the_faces_of_the_processes_across_the_gap():
    surface, border = border_of(two_vertebrae())
    lower, (_x, y, z) = surface.labels == 1, surface.points_reference.T
    assert (z[lower] < 0).all()
    assert (z[~lower] > 0).all()
    assert not border[y > 4].any(), "bodies face each other, too"
    assert (np.minimum(abs(z[border] + 4.5), abs(z[border] - 7.5)) < 3).all()
    # Two faces 7 mm wide, from the tips to a third of the way behind the centers of mass; their rounded edges add a little
    assert -10 < y[border].max() < 4
    assert surface.areas[border].sum() == pytest.approx(2 * 7 * (y[border].max() + 18.5), rel=0.25)


def test_bone_beside_the_midline_does_not_belong_to_the_border():
    labels = two_vertebrae()
    for label, bottom in ((1, 14), (2, 48)):
        for left in (2, 52):
            labels.array[bottom : bottom + 22, 20:38, left : left + 6] = label
    surface, border = border_of(labels)
    assert border.any()
    assert np.abs(surface.points_reference[border, 0]).max() < 6


def test_a_gap_too_wide_has_no_border():
    labels = two_vertebrae()
    labels.array[:] = np.where(labels.array == 1, 1, 0) + np.roll(np.where(labels.array == 2, 2, 0), 9, axis=0)
    assert not border_of(labels)[1].any()
