"""A probe that rests, for an hour even: sums stay exact, and how many pixels a voxel can get is foreseen and told."""

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

EDGE, WIDE_EDGE = 10, 64
"""Pixels along the edge of a voxel."""


def resting(images, edge=EDGE):
    """Frames of a probe that rests: the pixels of each voxel are a square of so many by so many."""
    pose = np.diag([1 / edge, 1 / edge, 1.0, 1.0])
    pose[:2, 3] = 0.5 / edge - 0.5
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


def reconstructor_for(engine):
    grid = VoxelGrid.from_spacing((0.0, 0.0, 0.0), (2, 2, 2), 1.0)
    wanted = ReconstructionSettings(method="weighted", engine=engine, hole_limit=0.0, output_type="float32")
    return Reconstructor(grid, wanted, sphere_bone(), probe=ProbeGeometry("linear"))


@pytest.mark.parametrize("engine", ["numpy", "auto"])
def test_ten_million_pixels_of_one_gray_level_leave_that_level(engine):
    image = np.full((WIDE_EDGE, WIDE_EDGE), 77, np.uint8)
    reconstructor, frames = reconstructor_for(engine), resting([image] * 100, WIDE_EDGE)
    for _ in range(25):
        reconstructor.insert(frames)
    seen = reconstructor.finish()
    assert seen.hits.array[0, 0, 0] == 2500 * WIDE_EDGE**2
    assert seen.intensity.array[0, 0, 0] == pytest.approx(77, abs=1e-3)


def test_batches_and_engines_widen_sums_at_the_same_frame():
    images = np.random.default_rng(5).integers(0, 256, (30, WIDE_EDGE, WIDE_EDGE), dtype=np.uint8)
    assert images.size > MOST_IN_SINGLE
    one_by_one, together, other = (reconstructor_for(engine) for engine in ("numpy", "auto", "numpy"))
    for frame in resting(images, WIDE_EDGE):
        one_by_one.insert(frame)
    for reconstructor in (together, other):
        reconstructor.insert(resting(images, WIDE_EDGE))
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
