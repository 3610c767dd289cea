"""The box around a sweep: IGSIO's rule, and no pixel outside."""

from __future__ import annotations

import numpy as np
import pytest
from geometry_strategies import numbers, rigid, rigid_poses, scaled, spacings
from hypothesis import given, settings
from hypothesis import strategies as st

from AIFReconLib.errors import GeometryError, InsufficientMemoryError
from AIFReconLib.imaging.extent import grid_around_sweep
from AIFReconLib.imaging.region import ClipRectangle, Fan, ImageRegion

FULL = ImageRegion()
regions = st.sampled_from(
    [
        FULL,
        ImageRegion(ClipRectangle((3, 2), (9, 5))),
        ImageRegion(fan=Fan((12.0, -4.0), (-40, 30), (6, 17))),
        ImageRegion(ClipRectangle((3, 2), (15, 11)), Fan((12.0, -4.0), (-40, 30), (6, 17))),
    ]
)
COLUMNS, ROWS = 25, 16


def pixels_of(region: ImageRegion) -> np.ndarray:
    """Every pixel of a region as homogeneous columns, (4, n)."""
    row, column = np.nonzero(region.mask(COLUMNS, ROWS))
    return np.stack([column, row, np.zeros_like(row), np.ones_like(row)]).astype(np.float64)


@given(st.lists(rigid_poses, min_size=1, max_size=3), numbers(0.05, 1), numbers(0.05, 1), spacings, regions)
@settings(max_examples=80)
def test_every_kept_pixel_of_every_frame_falls_into_the_grid(poses, x, y, spacing, region):
    # Within one scan: hypothesis likes to draw poses 600 mm apart, which is memory and no geometry
    poses = np.array([rigid((0, 0, 0), -0.9 * pose[:3, 3]) @ pose @ scaled(x, y, 1) for pose in poses])
    grid = grid_around_sweep(poses, (COLUMNS, ROWS), region, spacing)
    for pose in poses:
        ijk = np.floor((grid.reference_to_ijk @ pose @ pixels_of(region))[:3] + 0.5)
        assert (ijk >= 0).all()
        assert (ijk < np.array(grid.size)[:, None]).all()


@given(st.integers(2, 900), st.sampled_from([0.05, 0.1, 0.15, 0.2, 0.3]), st.sampled_from([0.1, 0.2, 0.3, 0.4, 0.5, 0.6]))
@settings(max_examples=150)
def test_a_pixel_on_the_border_of_two_voxels_falls_into_the_grid(columns, pixel, spacing):
    pose = rigid((0, 0, 0), (0.1, 0.7, -0.3)) @ scaled(pixel, pixel, 1)
    grid = grid_around_sweep(pose[None], (columns, 2), FULL, (spacing,) * 3)
    last = grid.reference_to_ijk @ pose
    assert np.floor(last[0, 0] * (columns - 1) + last[0, 3] + 0.5) < grid.size[0]


@given(st.lists(rigid_poses, min_size=1, max_size=3), spacings)
@settings(max_examples=30)
def test_origin_and_size_follow_igsio(poses, spacing):
    poses = np.array([rigid((0, 0, 0), -0.9 * pose[:3, 3]) @ pose @ scaled(0.3, 0.4, 1) for pose in poses])
    corners = np.array([[0, 0, 0, 1], [COLUMNS - 1, 0, 0, 1], [0, ROWS - 1, 0, 1], [COLUMNS - 1, ROWS - 1, 0, 1.0]])
    points = np.concatenate([(pose @ corners.T)[:3].T for pose in poses])
    grid = grid_around_sweep(poses, (COLUMNS, ROWS), FULL, spacing)
    np.testing.assert_allclose(grid.origin, points.min(axis=0), atol=1e-9)
    voxels = (points.max(axis=0) - points.min(axis=0)) / spacing
    assert (np.abs(np.array(grid.size) - 1 - voxels) <= 0.5 + 1e-5).all()


def test_a_fitted_spacing_ends_with_the_last_pixel_and_a_box_thinner_than_a_voxel_keeps_it():
    pose = rigid((np.pi / 2, 0, 0), (4, 5, 6)) @ scaled(0.3, 0.3, 1)
    grid, thin = (grid_around_sweep(each[None], (11, 10), FULL, (1.0, 1.0, 0.8), fits_spacing=True) for each in (pose, np.eye(4)))
    # 9 rows of 0.3 mm: 3 whole voxels of 0.8 mm and a bit, so each grows to a third
    np.testing.assert_allclose(grid.spacing, (1.0, 1.0, 0.9))
    assert grid.size[2] == 4
    assert thin.spacing[2] == 0.8


@pytest.mark.parametrize(
    ("far", "spacing", "error", "words"),
    [
        *(((far, 0, 0), 1.0, GeometryError, "which no scan does") for far in (6000.0, 1e9, np.nan)),
        ((400, 400, 400), 0.01, InsufficientMemoryError, "A spacing of"),
    ],
)
def test_poses_that_no_scan_spans_and_a_spacing_that_is_too_fine_are_refused(far, spacing, error, words):
    poses = np.array([np.eye(4), rigid((0, 0, 0), far)])
    with pytest.raises(error, match=words):
        grid_around_sweep(poses, (9, 9), FULL, (spacing,) * 3, bytes_per_voxel=17)
