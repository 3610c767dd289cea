"""Recordings larger than memory: images are read one by one, whether compressed or not, while earlier ones are computed."""

from __future__ import annotations

import contextlib
import tracemalloc

import numpy as np
import pytest
from sweeps import image_pose

from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.frames import TrackedSequence

FRAMES, ROWS, COLUMNS = 300, 120, 160
GRID = VoxelGrid.from_spacing((0, 0, 0), (32, 24, 30), 1.0)


def sweep() -> TrackedSequence:
    rng = np.random.default_rng(0)
    images = np.repeat(rng.integers(0, 256, (6, ROWS, COLUMNS), dtype=np.uint8), FRAMES // 6, axis=0)
    poses = [image_pose((0.2, 0.2), translation=(0, 0, 0.1 * number)) for number in range(FRAMES)]
    return TrackedSequence.from_arrays(images, poses, 0.1 * np.arange(FRAMES))


@pytest.fixture(scope="module", params=[False, True], ids=["uncompressed", "compressed"])
def recording(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("long") / "sweep.mha"
    write_sequence(sweep(), path, compress=request.param)
    return path


@contextlib.contextmanager
def at_most(bytes_held: float):
    """What Python holds meanwhile."""
    tracemalloc.start()
    try:
        yield
        assert tracemalloc.get_traced_memory()[1] < bytes_held
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("engine", ["numpy", "auto"])
def test_a_recording_takes_no_more_memory_than_a_few_of_its_images_and_gives_the_volume_of_those_in_memory(recording, engine):
    sequence = read_sequence(recording)
    # Filling takes memory by the size of the volume, not of the recording
    settings = ReconstructionSettings(method="average", engine=engine, hole_limit=0.0, clip_px=(0,) * 4)
    theirs, first = (reconstruct(each, settings, grid=GRID) for each in (sweep(), sequence))
    with at_most(0.6 * FRAMES * ROWS * COLUMNS):
        ours = reconstruct(sequence, settings, grid=GRID)
    for volume in (first, ours):
        np.testing.assert_array_equal(volume.intensity.array, theirs.intensity.array)
