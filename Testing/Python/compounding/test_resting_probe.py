"""A probe that rests: the sums of an average of 8-bit images stay exact, and how many pixels a voxel can get is foreseen."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sweeps import turned_grid

from AIFReconLib.compounding.layout import PixelLayout, most_in_a_voxel
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.region import ImageRegion
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import TrackedFrame

EDGE = 10
"""Pixels along the edge of a voxel."""


def resting(images):
    """Frames of a probe that rests: the pixels of each voxel are a square of EDGE by EDGE."""
    pose = np.diag([1 / EDGE, 1 / EDGE, 1.0, 1.0])
    pose[:2, 3] = 0.5 / EDGE - 0.5
    return [TrackedFrame(image, pose) for image in images]


@pytest.mark.parametrize("gray", ["speckle", "white"])
@pytest.mark.parametrize("planes", [64, 1], ids=["few voxels run over", "many do"])
@pytest.mark.parametrize("most", [1e4, 1e9], ids=["sums are widened", "they need not be"])
@pytest.mark.parametrize("engine", ["numpy", "auto"])
def test_a_probe_that_rests_leaves_the_exact_mean_and_number_of_its_pixels(engine, most, planes, gray, monkeypatch):
    monkeypatch.setattr("AIFReconLib.compounding.state.MOST_IN_WHOLE", most)
    images = np.random.default_rng(3).integers(0, 256, (120, 3 * EDGE, 3 * EDGE), dtype=np.uint8)
    if gray == "white":
        images[:] = 255
    grid = VoxelGrid.from_spacing((0.0, 0.0, 0.0), (3, 3, planes), 1.0)
    wanted = ReconstructionSettings(method="average", engine=engine, hole_limit=0.0, output_type="float32")
    reconstructor = Reconstructor(grid, wanted)
    for first in range(0, len(images), 40):
        reconstructor.insert(resting(images[first : first + 40]))
        so_far = images[: first + 40].reshape(-1, 3, EDGE, 3, EDGE)
        seen = reconstructor.reconstruction()
        np.testing.assert_array_equal(seen.intensity.array[0], so_far.mean(axis=(0, 2, 4)).astype(np.float32))
        np.testing.assert_array_equal(seen.hits.array[0], len(so_far) * EDGE**2)
        assert not seen.mask.array[1:].any()
    np.testing.assert_array_equal(reconstructor.finish().score.array[0], images.size / 9)


@settings(max_examples=40)
@given(
    turn=st.tuples(*[st.floats(-180, 180)] * 3),
    spacing=st.tuples(*[st.floats(0.3, 2.5)] * 3),
    pixel=st.tuples(st.floats(0.1, 1.2), st.floats(0.1, 1.2)),
    start=st.tuples(*[st.floats(-0.5, 0.5)] * 3),
)
def test_no_voxel_gets_more_pixels_of_an_image_than_foreseen(turn, spacing, pixel, start):
    pose = np.diag([*pixel, 1.0, 1.0])
    pose[:3, 3] = start
    grid = turned_grid(spacing, (12, 12, 12), turn)
    place = grid.reference_to_ijk @ pose
    _, voxels = PixelLayout.build((80, 80), pixel, ImageRegion(), None).voxels(place, grid.size)
    assert np.bincount(voxels, minlength=1).max() <= most_in_a_voxel(place)


def test_what_is_foreseen_is_less_than_twice_what_comes():
    # Voxels of 0.5 mm, pixels of 0.1 mm, along the grid
    place = np.diag([0.2, 0.2, 1.0, 1.0])
    assert 25 <= most_in_a_voxel(place) < 2.1 * 25
