"""Images that stand still while the probe moves: in files, while scanning, and where nothing is wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.inspection.diagnosis import diagnose
from AIFReconLib.live.pairing.synchronizer import SynchronizerSettings
from AIFReconLib.live.session.session import LiveSession
from AIFReconLib.live.wire.messages import ImageMessage
from AIFReconLib.live.wire.sources import QueueSource
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses, without_still_images
from AIFReconLib.sweep.still_images import MOVED, STILL

FRAMES = 60
IMAGES = np.random.default_rng(0).integers(1, 255, (FRAMES, 24, 24), dtype=np.uint8)
GRID = VoxelGrid.from_spacing((0.0, 0.0, 0.0), (13, 13, 61), 1.0)
RECIPE = Recipe(method="average", probe="linear")
SLOW, FROZEN = np.arange(FRAMES) // 6 * 6, np.minimum(np.arange(FRAMES), 35)


def sweep(shown, step=1.0, images=IMAGES) -> TrackedSequence:
    """Frames `step` mm from one to the next, each with the image whose number is `shown`."""
    poses = np.tile(np.diag([0.5, 0.5, 0.5, 1.0]), (FRAMES, 1, 1))
    poses[:, 2, 3] = step * np.arange(FRAMES)
    return TrackedSequence.from_arrays(images[shown], poses, np.arange(FRAMES) / 20)


ONE_LEVEL = np.full((FRAMES, 24, 24), 7, np.uint8)
WITH_GAPS = np.where(IMAGES < 100, np.nan, IMAGES.astype(np.float32))

CASES = {
    "an image of its own in each frame": (sweep(np.arange(FRAMES)), FRAMES),
    "a frame grabber that is slower than the tracker": (sweep(SLOW), 10),
    "a scanner that was frozen before the end": (sweep(FROZEN), 36),
    "a slow hand": (sweep(SLOW, step=0.9 * MOVED), 20),
    "floating point with gaps": (sweep(SLOW, images=WITH_GAPS), 10),
    "a probe at rest": (sweep(SLOW, step=0.0), FRAMES),
    "two images in turn": (sweep(np.arange(FRAMES) % 2), FRAMES),
    "images of one level in between": (sweep(SLOW, images=np.where(np.arange(FRAMES)[:, None, None] < 30, IMAGES, ONE_LEVEL)), 5 + 30),
    "a pattern for a test": (sweep(np.zeros(FRAMES, int)), FRAMES),
}


@pytest.mark.parametrize("memory", [None, 200_000])
@pytest.mark.parametrize(("made", "count"), CASES.values(), ids=CASES)
def test_of_equal_images_at_moving_poses_the_first_counts(made, count, memory):
    result = reconstruct(made, RECIPE, grid=GRID, memory=memory)
    still = result.skipped.get(STILL, [])
    assert (result.frames_inserted, len(still)) == (count, FRAMES - count)
    # The volume of those frames alone
    moving = np.setdiff1d(np.arange(FRAMES), still)
    alone = replace(made, images=made.images[moving], records=[made.records[n] for n in moving])
    np.testing.assert_array_equal(result.intensity.array, reconstruct(alone, RECIPE, grid=GRID).intensity.array)


@pytest.mark.parametrize("case", CASES)
def test_info_says_what_reconstruct_leaves_out(case):
    made, count = CASES[case]
    report = diagnose(made)
    assert f"Ready: {count} of {FRAMES} frames can be placed" in report.findings[0]
    told = f"{FRAMES - count} of {FRAMES} images equal the one before although the probe moved meanwhile"
    assert any(told in sentence for sentence in report.findings) == (count < FRAMES)
    equal = "All images are equal although the probe moved"
    for said in (report.findings, reconstruct(made, RECIPE, grid=GRID).messages):
        assert any(equal in sentence for sentence in said) == (case == "a pattern for a test")


@pytest.mark.parametrize("case", [case for case in CASES if case != "a pattern for a test"])
def test_a_live_scan_leaves_out_what_reconstruct_does(case):
    """A stream cannot know that all its images will be equal."""
    made, count = CASES[case]
    if made.images.dtype != np.uint8:
        made = replace(made, images=np.nan_to_num(made.images).astype(np.uint8))
    source = QueueSource()
    trusted = SynchronizerSettings(trust_image_pose=True)
    with LiveSession(source, RECIPE, grid=GRID, synchronizer=trusted, longest_delay=None) as session:
        session.start()
        for number, pose in enumerate(sweep_poses(made).image_to_reference):
            source.put(ImageMessage("Image_Reference", 1.0 + number / 20, made.images[number], pose))
        result = session.finish()
    assert session.statistics.inserted == count
    assert session.statistics.skipped.get(STILL, 0) == FRAMES - count
    np.testing.assert_array_equal(result.intensity.array, reconstruct(made, RECIPE, grid=GRID).intensity.array)


def test_a_frame_without_a_pose_says_nothing_of_the_images_around_it():
    made = sweep(np.zeros(FRAMES, int))
    images = np.concatenate([made.images[:30], IMAGES[30:]])
    lost = replace(made, images=images, records=[replace(r, transforms={}) if n == 3 else r for n, r in enumerate(made.records)])
    problems = without_still_images(lost, sweep_poses(lost)).problems
    assert [n for n, problem in enumerate(problems) if problem == STILL] == [n for n in range(1, 30) if n != 3]
