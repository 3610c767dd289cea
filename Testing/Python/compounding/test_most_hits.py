"""A probe that rests for an hour: how often a voxel can have been hit is known, and sums of `weighted` stay exact."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sweeps import oblique_frames, sphere_bone, turned_grid

from AIFReconLib.compounding.layout import MostHits, PixelLayout
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.compounding.state import MOST_IN_SINGLE
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ImageRegion
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import TrackedFrame

EDGE = 64
"""Pixels along the edge of a voxel."""


def resting(images):
    """Frames of a probe that rests, all pixels of each in one voxel."""
    pose = np.diag([1 / EDGE, 1 / EDGE, 1.0, 1.0])
    pose[:2, 3] = 0.5 / EDGE - 0.5
    return [TrackedFrame(image, pose) for image in images]


def reconstructor_for(engine):
    grid = VoxelGrid.from_spacing((0.0, 0.0, 0.0), (2, 2, 2), 1.0)
    wanted = ReconstructionSettings(method="weighted", engine=engine, hole_limit=0.0, output_type="float32")
    return Reconstructor(grid, wanted, sphere_bone(), probe=ProbeGeometry("linear"))


@pytest.mark.parametrize("engine", ["numpy", "auto"])
def test_ten_million_pixels_of_one_gray_level_leave_that_level(engine):
    image = np.full((EDGE, EDGE), 77, np.uint8)
    reconstructor, frames = reconstructor_for(engine), resting([image] * 100)
    for _ in range(25):
        reconstructor.insert(frames)
    seen = reconstructor.finish()
    assert seen.hits.array[0, 0, 0] == 2500 * EDGE**2
    assert seen.intensity.array[0, 0, 0] == pytest.approx(77, abs=1e-3)


def test_batches_and_engines_widen_sums_at_the_same_frame():
    images = np.random.default_rng(5).integers(0, 256, (30, EDGE, EDGE), dtype=np.uint8)
    assert images.size > MOST_IN_SINGLE
    one_by_one, together, other = (reconstructor_for(engine) for engine in ("numpy", "auto", "numpy"))
    for frame in resting(images):
        one_by_one.insert(frame)
    for reconstructor in (together, other):
        reconstructor.insert(resting(images))
    volumes = [reconstructor.finish() for reconstructor in (one_by_one, together, other)]
    for volume in volumes[1:]:
        np.testing.assert_array_equal(volume.intensity.array, volumes[0].intensity.array)
        np.testing.assert_array_equal(volume.score.array, volumes[0].score.array)


@settings(max_examples=30)
@given(seed=st.integers(0, 1000), step=st.floats(0.0, 3.0))
def test_no_voxel_gets_more_than_is_said(seed, step):
    random, grid = np.random.default_rng(seed), turned_grid()
    layout, counted, hits = PixelLayout.build((34, 26), (0.08, 0.14), ImageRegion(), None), MostHits(grid.size), np.zeros(grid.voxels, int)
    for frame in oblique_frames(count=6):
        pose = frame.image_to_reference.copy()
        pose[:3, :2] *= 0.2
        pose[:3, 3] += step * random.normal(size=3)
        place = grid.reference_to_ijk @ pose
        np.add.at(hits, layout.voxels(place, grid.size)[1], 1)
        assert hits.max() <= counted.after(place, layout)


def test_a_probe_that_moves_is_told_from_one_that_rests():
    layout, place = PixelLayout.build((100, 100), (0.2, 0.2), ImageRegion(), None), np.diag([0.2, 0.2, 1.0, 1.0])
    rests, moves = MostHits((20, 20, 500)), MostHits((20, 20, 500))
    for number in range(400):
        place[2, 3] = 0.0
        most_at_rest = rests.after(place, layout)
        place[2, 3] = number
        most_moving = moves.after(place, layout)
    assert most_at_rest > 100 * most_moving
