"""Which voxel a pixel falls into: what is computed in parts and by shortcuts is what the formula says."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import image_pose, rigid

from AIFReconLib.compounding.layout import PixelLayout
from AIFReconLib.imaging.region import ClipRectangle, Fan, ImageRegion

COLUMNS, ROWS = 60, 148
SIZE = 40, 45, 50
POSES = {
    "along the grid": np.diag([0.5, 0.25, 1.0, 1.0]),
    "mirrored": image_pose((0.5, 0.25), (180.0, 0.0, 0.0)),
    "rows along k": np.array([[0.0, 0.25, 0, 0], [0, 0, 1.0, 0], [0.5, 0, 0, 0], [0, 0, 0, 1.0]]),
    "columns slightly turned": image_pose((0.5, 0.25), (0.0, 0.0, 2.0)),
    "rows slightly turned": image_pose((0.5, 0.25), (0.0, 2.0, 0.0)),
    "turned": image_pose((0.5, 0.25), (25.0, -35.0, 50.0)),
}
REGIONS = {
    "all": ImageRegion(),
    "clipped": ImageRegion(ClipRectangle((7, 11), (41, ROWS - 30))),
    "fan": ImageRegion(fan=Fan((30.0, -10.0), (-30.0, 25.0), (20.0, 120.0))),
}


def plain_voxels(matrix, mask):
    """Numbers of the pixels that count and fall into the grid, and their voxels, one at a time."""
    pixels, voxels = [], []
    for number, (row, column) in enumerate(zip(*np.nonzero(mask), strict=True)):
        i, j, k = (int(np.floor(matrix[a, 1] * row + (matrix[a, 3] + 0.5) + matrix[a, 0] * column)) for a in range(3))
        if 0 <= i < SIZE[0] and 0 <= j < SIZE[1] and 0 <= k < SIZE[2]:
            pixels.append(number)
            voxels.append((k * SIZE[1] + j) * SIZE[0] + i)
    return pixels, voxels


@pytest.mark.parametrize("region", REGIONS)
@pytest.mark.parametrize("middle", [(20.0, 22.0, 25.0), (4.0, 22.0, 25.0), (20.0, 44.0, 3.0)], ids=["within", "beyond i", "beyond j and k"])
@pytest.mark.parametrize("pose", POSES)
def test_voxels_are_those_of_the_formula(pose, middle, region):
    matrix = rigid(translation=middle) @ POSES[pose] @ rigid(translation=(-COLUMNS / 2, -ROWS / 2, 0.0))
    layout = PixelLayout.build((COLUMNS, ROWS), (0.5, 0.25), REGIONS[region], None)
    pixels, voxels = layout.voxels(matrix, SIZE)
    expected = plain_voxels(matrix, REGIONS[region].mask(COLUMNS, ROWS))
    np.testing.assert_array_equal(pixels, expected[0])
    np.testing.assert_array_equal(voxels, expected[1])
    assert len(expected[0]) > 0
