"""The box that scouting finds, whatever single poses say."""

from __future__ import annotations

import numpy as np
import pytest
from live_messages import image, transform
from sweeps import image_pose

from AIFReconLib.effective_settings import Imaging
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.region import ClipRectangle, ImageRegion
from AIFReconLib.live.pairing.synchronizer import LiveFrame
from AIFReconLib.live.session.scouting import ScoutedFrames
from AIFReconLib.live.session.session import LiveSession
from AIFReconLib.live.wire.sources import QueueSource
from AIFReconLib.recipe.recipe import ReconstructionSettings

PIXELS = np.full((30, 40), 100, np.uint8)
WHOLE = ImageRegion(ClipRectangle((0.0, 0.0), (39.0, 29.0)))


def box(places: list[float], times: list[float] | None = None) -> tuple[VoxelGrid, ScoutedFrames]:
    """Around frames at these places along z, mm, 20 a second."""
    scouted = ScoutedFrames()
    for number, z in enumerate(places):
        time = number / 20 if times is None else times[number]
        scouted.add(LiveFrame(PIXELS, image_pose(translation=(0.0, 0.0, z)), time, number=number, received=number / 20))
    return scouted.grid(Imaging(WHOLE, None), ReconstructionSettings(spacing=1.0), 16), scouted


SWEEP = [0.5 * number for number in range(60)]


@pytest.mark.parametrize("far", [1_000.0, -3_000.0, 200_000.0])
@pytest.mark.parametrize("wrong", [[0], [30], [59], [0, 1, 2], [10, 11, 12, 13, 14], list(range(1, 60, 3))], ids=str)
def test_a_place_that_no_hand_reaches_between_two_frames_does_not_count(far, wrong):
    places = [far if number in wrong else z for number, z in enumerate(SWEEP)]
    grid, scouted = box(places)
    expected, _ = box([z for number, z in enumerate(SWEEP) if number not in wrong])
    assert (grid.size, len(scouted.notes)) == (expected.size, 1)
    assert scouted.notes[0].startswith(f"{len(wrong)} of 60 frames")


def test_of_poses_that_can_all_be_reached_nothing_is_said():
    assert box(SWEEP)[1].notes == ()


@pytest.mark.parametrize("times", [None, [float(number // 20) for number in range(120)]], ids=["fractions", "whole seconds"])
def test_a_recording_that_begins_anew_keeps_the_box_of_its_whole_length(times):
    places = [5.0 * number for number in range(60)]
    assert box(places * 2, times)[0].size == box(places)[0].size


def test_a_probe_that_was_away_and_comes_back_elsewhere_counts():
    times = [number / 20 + (10.0 if number >= 30 else 0.0) for number in range(60)]
    assert box([0.0] * 30 + [400.0] * 30, times)[0].size[2] > 400


def test_a_scan_with_one_wrong_pose_is_saved_and_says_so_once():
    """The pose is wrong in the middle of what was scouted."""
    source = QueueSource(limit=1000)
    for number, z in enumerate([*SWEEP[:30], 200_000.0, *SWEEP[30:]]):
        pose = image_pose(translation=(0.0, 0.0, z))
        source.put(image(1.0 + number / 20, pixels=PIXELS, pose=pose))
        source.put(transform(1.0 + number / 20, "ImageToReference", pose))
    source.stop()
    session = LiveSession(source, ReconstructionSettings(spacing=1.0, clip_px=(0,) * 4), longest_delay=None)
    session.start()
    session.finished.wait(60.0)
    session.use_grid(session.grid_from_scout())
    result = session.finish()
    assert (result.frames_inserted, session.statistics.skipped) == (60, {"outside the volume": 1})
    told = [note.split(":")[0] for note in result.messages if "no hand reaches" in note]
    assert told == ["1 of 61 frames seen while scouting lie where no hand reaches between two frames"]
