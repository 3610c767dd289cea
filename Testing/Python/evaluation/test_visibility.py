"""What beams could reach: fan, thickness, occlusion and angle, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import image_pose, places, rigid

from AIFReconLib.evaluation.surface import bone_surface
from AIFReconLib.evaluation.visibility import OUTSIDE, REACHED, SHADOWED, BoneRays, SweepBeams, bone_truth, look
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.imaging.beams import LINEAR, SECTOR, ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, ImageRegion

COLUMNS, ROWS, SPACING = 101, 121, (0.4, 0.5)
WIDTH, DEPTH = 40.0, 60.0


def sweep(offsets=(0.0,), probe=None, motion=None, region=None, **options) -> SweepBeams:
    """Frames in the planes z = offset: x from -20 to 20, y (along linear beams) from 0 to 60 mm."""
    poses = np.array([image_pose(SPACING, translation=(-WIDTH / 2, 0, z)) for z in offsets])
    if motion is not None:
        poses = motion @ poses
    return SweepBeams(poses, (COLUMNS, ROWS), probe or ProbeGeometry(LINEAR), region or ImageRegion(), **options)


def bone(distance) -> Volume:
    """A signed distance, given as a function of x, y, z, on 1 mm voxels: x, z -30 to 30 mm, y 0 to 70."""
    grid = VoxelGrid.from_spacing((-30, 0, -30), (61, 71, 61), 1.0)
    return Volume(distance(*np.moveaxis(places(grid), -1, 0)), grid.ijk_to_reference)


def ball(x, y, z):
    return np.sqrt(x**2 + (y - 35) ** 2 + z**2) - 12


def floor(x, y, z):
    return 40.0 - y


def table(x, y, z):
    """A floor at 40 mm, and a plate 4 mm thick at 20 mm over its half x < 0."""
    return np.minimum(40.0 - y, np.maximum(np.abs(y - 22.0) - 2.0, x))


NO_BONE = bone(lambda x, y, z: np.full_like(x, 5.0))


def test_the_near_half_of_a_ball_is_reached_at_the_angle_of_its_normal():
    volume = bone(ball)
    surface = bone_surface(volume)
    status, best = look(surface.points_reference, sweep(np.arange(-20, 21, 1.0)), volume, surface.normals_reference)
    expected = -surface.normals_reference[:, 1]
    sure = np.abs(expected - np.cos(np.radians(85))) > 0.05
    np.testing.assert_array_equal(status[sure] == REACHED, expected[sure] > 0.1)
    np.testing.assert_allclose(best[status == REACHED], expected[status == REACHED], atol=1e-9)
    assert np.isnan(best[expected < 0]).all(), "the far half"


def test_a_surface_does_not_hide_itself_but_is_hidden_by_another():
    volume = bone(table)
    points = np.array([(-10.0, 20.0, 0.0), (-10.0, 40.0, 0.0), (10.0, 40.0, 0.0)])
    status, best = look(points, sweep(), volume, np.tile((0.0, -1.0, 0.0), (3, 1)))
    assert status.tolist() == [REACHED, SHADOWED, REACHED]
    np.testing.assert_allclose(best, [1.0, np.nan, 1.0])


def test_a_beam_from_the_side_sees_under_the_table():
    aside = rigid((0, 0, 45), (20, 5, 0))
    points, normals = np.array([(-2.0, 40.0, 0.0)]), np.array([(0.0, -1.0, 0.0)])
    status, best = look(points, sweep(motion=aside), bone(table), normals)
    assert status.tolist() == [REACHED]
    assert best[0] == pytest.approx(np.sqrt(0.5))


def test_the_best_of_several_angles_counts_in_any_order():
    straight, tilted = sweep().image_to_reference, sweep(motion=rigid((0, 0, 30), (20, 0, 0))).image_to_reference
    for poses in ([straight, tilted], [tilted, straight]):
        both = SweepBeams(np.concatenate(poses), (COLUMNS, ROWS), ProbeGeometry(LINEAR), ImageRegion())
        _, best = look(np.array([(0.0, 40.0, 0.0)]), both, bone(floor), np.array([(0.0, -1.0, 0.0)]))
        assert best[0] == pytest.approx(1.0)


@pytest.mark.parametrize(("z", "status"), [(1.9, REACHED), (2.1, OUTSIDE)])
def test_a_beam_sees_half_its_thickness_to_either_side(z, status):
    assert look(np.array([(0.0, 30.0, z), (0.0, 30.0, -z)]), sweep(thickness=4.0), NO_BONE)[0].tolist() == [status, status]


def test_pixels_outside_the_region_have_no_beam():
    region = ImageRegion(ClipRectangle((50, 0), (40, 100)))
    points = np.array([(-1.0, 30.0, 0.0), (1.0, 30.0, 0.0), (1.0, 51.0, 0.0)])
    assert look(points, sweep(region=region), NO_BONE)[0].tolist() == [OUTSIDE, REACHED, OUTSIDE]


def test_beams_of_a_sector_come_from_its_apex():
    probe = ProbeGeometry(SECTOR, (50.0, -20.0))  # at x = 0, y = -10 mm
    points = np.array([(x, 40.0, 0.0) for x in (-18.0, 0.0, 7.0)])
    _, best = look(points, sweep(probe=probe), bone(floor), np.tile((0.0, -1.0, 0.0), (3, 1)))
    np.testing.assert_allclose(best, 50.0 / np.hypot(50.0, points[:, 0]), atol=1e-9)


def test_beams_farther_than_the_grazing_angle_do_not_reach():
    points = np.array([(0.0, 30.0, 0.0)] * 2)
    normals = np.array([(np.sin(np.radians(a)), -np.cos(np.radians(a)), 0.0) for a in (84.0, 86.0)])
    assert look(points, sweep(), NO_BONE, normals)[0].tolist() == [REACHED, SHADOWED]


def test_bone_is_where_the_labels_are_and_the_map_tells_shadow_from_tissue():
    labels = Volume((bone(table).array <= 0).astype(np.uint8), bone(table).ijk_to_reference)
    truth = bone_truth(labels, sweep(np.arange(-28, 29, 1.0)))
    ijk = transform_points(truth.shadows.grid.reference_to_ijk, np.array([(-10.0, 32.0, 3.0), (10.0, 32.0, 3.0)]))
    i, j, k = np.round(ijk).astype(int).T
    assert truth.shadows.array[k, j, i].tolist() == [SHADOWED, REACHED]


@pytest.mark.parametrize("shape", [ball, table])
def test_a_ray_is_stopped_where_one_of_its_places_lies_in_bone(shape):
    distance, rng = bone(shape), np.random.default_rng(0)
    # From in and around the volume past its middle; some along its axes, some without a way
    starts, lengths = rng.uniform(-40, 60, (2000, 3)), rng.uniform(0.0, 90.0, 2000)
    beams = starts - (0.0, 35.0, 0.0) + rng.normal(0.0, 10.0, (2000, 3))
    beams[:200] = np.eye(3)[rng.integers(0, 3, 200)]
    beams /= np.linalg.norm(beams, axis=1)[:, None]
    lengths[200:220], expected = 0.0, []
    for start, beam, length in zip(starts, beams, lengths):
        places = start - np.arange(np.ceil(length))[:, None] * beam
        i, j, k = np.floor(transform_points(distance.grid.reference_to_ijk, places) + 0.5).astype(int).T
        inside = (np.stack([i, j, k]) >= 0).all(axis=0) & (i < 61) & (j < 71) & (k < 61)
        expected.append((distance.array[k[inside], j[inside], i[inside]] <= 0).any())
    found = BoneRays(distance).blocks(starts, beams, lengths)
    assert 0.1 < np.mean(expected) < 0.9
    assert (found != expected).sum() <= 2  # rounding may put a place into the next voxel
