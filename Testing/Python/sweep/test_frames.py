"""Sequences in memory: their size, names and statuses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sweeps import oblique_frames, rigid, turned_grid

from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.errors import GeometryError
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

# ---- a sweep of arrays


FRAMES = oblique_frames(count=4)
IMAGES = np.stack([frame.placed()[0] for frame in FRAMES])
POSES = np.stack([frame.placed()[1] for frame in FRAMES])


def test_arrays_give_the_voxels_of_the_frames_one_by_one():
    settings = ReconstructionSettings(method="latest", hole_limit=0.0)
    one_by_one = Reconstructor(turned_grid(), settings)
    one_by_one.insert(FRAMES)
    # Their times say another order than the one they come in
    order = [2, 0, 3, 1]
    sequence = TrackedSequence.from_arrays(IMAGES[order], POSES[order], np.array(order) * 0.05)
    result = reconstruct(sequence, replace(settings, clip_px=(0,) * 4), grid=turned_grid())
    np.testing.assert_array_equal(result.intensity, one_by_one.reconstruction().intensity)


def test_poses_in_mm_and_the_size_of_a_pixel_are_poses_of_pixels():
    poses = np.stack([rigid((10.0, 20.0, 30.0 * n), (1.0, 2.0, 3.0)) for n in range(4)])
    sequence = TrackedSequence.from_arrays(IMAGES, poses, spacing=(0.4, 0.7))
    column, row = 5.0, 11.0
    found = sweep_poses(sequence).image_to_reference @ (column, row, 0.0, 1.0)
    np.testing.assert_allclose(found, poses @ (0.4 * column, 0.7 * row, 0.0, 1.0), atol=1e-12)


def test_the_arrays_stay_the_giver_s_and_a_frame_without_a_pose_is_skipped_with_its_reason():
    sequence, before = TrackedSequence.from_arrays(IMAGES, poses := POSES.copy()), POSES[0, 0, 3]
    poses[0, 0, 3], poses[2] = 1000.0, np.nan
    assert sweep_poses(sequence).image_to_reference[0, 0, 3] == before
    assert sequence.images is IMAGES
    result = reconstruct(TrackedSequence.from_arrays(IMAGES, poses), ReconstructionSettings(clip_px=(0,) * 4), grid=turned_grid())
    assert result.skipped["ImageToReference not finite"] == [2]


def test_whole_numbers_of_8_bit_images_are_8_bit_images():
    for given in (IMAGES.astype(np.int64), IMAGES.astype(np.uint16), IMAGES.tolist()):
        sequence = TrackedSequence.from_arrays(given, POSES)
        assert sequence.images.dtype == np.uint8
        np.testing.assert_array_equal(sequence.images, IMAGES)
    assert TrackedSequence.from_arrays(IMAGES.astype(np.int16) + 200, POSES).images.dtype == np.int16


RIGID = np.stack([rigid(translation=(0.0, 0.0, n)) for n in range(4)])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((IMAGES[0], POSES[:1]), r"gray, \(frames, rows, columns\)"),
        ((np.zeros((4, 5, 6, 3), np.uint8), POSES), r"gray, \(frames, rows, columns\)"),
        (("sweep.igs.mha", POSES), r"gray, \(frames, rows, columns\)"),
        ((IMAGES.astype(complex), POSES), "complex"),
        (([np.zeros((4, 5)), np.zeros((4, 6))], POSES[:2]), "one size"),
        ((IMAGES, POSES[:3]), r"image_to_reference must have shape \(4, 4, 4\), one for each image; got \(3, 4, 4\)"),
        ((IMAGES, POSES[0]), r"got \(4, 4\)"),
        ((IMAGES, "poses.csv"), "image_to_reference must be numbers"),
        ((IMAGES, POSES, [0.0, 1.0]), "timestamps must have shape"),
        ((IMAGES, POSES, [0.0, 1.0, 2.0, np.nan]), "timestamps must be finite"),
        ((IMAGES, RIGID), r"Give spacing=\(x, y\)"),
    ],
)
def test_arrays_that_do_not_fit_are_refused_with_what_would(arguments, words):
    with pytest.raises(GeometryError, match=words):
        TrackedSequence.from_arrays(*arguments)
