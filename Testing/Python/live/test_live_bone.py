"""Bone that grows while a scan goes on: from an estimator that looks at its frames, and from predictions that are streamed with them."""

from __future__ import annotations

import time

import numpy as np
import pytest
from igtl_streams import wait_for
from seen_planes import IMAGING, PlaneSweep

from AIFReconLib.bone.growing_bone import GrowingBone
from AIFReconLib.bone.predicted_bone import bone_from_frames
from AIFReconLib.bone.predictions import Prediction
from AIFReconLib.bone.recorded_predictions import RecordedPredictions
from AIFReconLib.effective_settings import imaging_fields
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.gray_levels import STANDARD
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.live.pairing.synchronizer import SynchronizerSettings
from AIFReconLib.live.session.bone_watch import BoneWatch
from AIFReconLib.live.session.session import MOST_PREDICTIONS, LiveSession
from AIFReconLib.live.wire.messages import ImageMessage
from AIFReconLib.live.wire.sources import QueueSource
from AIFReconLib.recipe.recipe import ReconstructionSettings

LOOKED = imaging_fields(IMAGING.region, IMAGING.probe)
SWEEP = PlaneSweep(count=6)
SAID = SWEEP.predictions()
GRID = VoxelGrid.from_spacing(SWEEP.point - 18.0, (45, 45, 45), 0.8)


@pytest.fixture
def scan(tmp_path):
    """Starts a session over the plane with what looks for bone; the answer is session, bone, watch and queue."""
    open_ = []

    def start(estimator=None, record=None, grid=GRID):
        queue, bone = QueueSource(), GrowingBone()
        session = LiveSession(
            queue,
            ReconstructionSettings(method="weighted", engine="numpy", gray_levels=STANDARD, **LOOKED),
            bone,
            grid,
            synchronizer=SynchronizerSettings(trust_image_pose=True),
            predictions_device="Bone",
            longest_delay=None,
        )
        watch = BoneWatch(session, bone, estimator, record)
        open_.append((session, watch))
        session.start()
        return session, bone, watch, queue

    yield start
    for session, watch in open_:
        watch.stop()
        session.stop()


class Knowing:
    """An estimator that knows the plane."""

    def estimate(self, frame):
        return Prediction(SAID[round(10 * (frame.timestamp - 1.0))])

    def notes(self):
        return ()


def shown(number) -> ImageMessage:
    return ImageMessage("Image_Reference", 1.0 + 0.1 * number, SWEEP.images[number], SWEEP.poses[number], {}, time.monotonic())


def predicted(number, image=None) -> ImageMessage:
    said = (255 * SAID[number]).astype(np.uint8) if image is None else image
    return ImageMessage("Bone", 1.0 + 0.1 * number, said, np.eye(4), {}, time.monotonic())


def on_plane(bone) -> float:
    """The usual probability of bone where it is, of what the volume knows."""
    if not bone._on_grid or bone._on_grid[0][0] is not GRID:
        return 0.0  # that of a trial, before there is a volume
    return of_plane(bone._on_grid[0][1])


def of_plane(placed) -> float:
    i, j, k = np.rint(transform_points(GRID.reference_to_ijk, SWEEP.on_plane(half=2))).astype(int).T
    return float(np.median(placed.probability[k, j, i]))


def test_what_is_found_while_scouting_is_kept_for_the_volume_and_recorded(scan, tmp_path):
    session, bone, watch, queue = scan(lambda imaging: Knowing(), grid=None, record=tmp_path / "scan-bone.mha")
    for number in range(5):
        queue.put(shown(number))
        wait_for(lambda number=number: watch.frames > number)
    assert session.grid is None
    session.use_grid(GRID)
    queue.put(shown(5))
    wait_for(lambda: on_plane(bone) > 0.5 and watch.frames > 5)
    assert session.finish().frames_inserted == 6
    watch.stop()
    assert len(read_sequence(watch.recorded)) == 6


def test_a_prediction_without_a_frame_is_counted(scan):
    _session, _bone, watch, queue = scan()
    queue.put(shown(0))
    message = predicted(40, SAID[0])
    queue.put(ImageMessage("Bone", 99.0, message.image, message.image_to_sender, {}, time.monotonic() - 60.0))
    wait_for(lambda: watch.unmatched == 1)


def test_a_stream_of_what_is_no_probability_is_told_and_the_scan_goes_on(scan):
    session, _bone, watch, queue = scan()
    for number in range(3):
        queue.put(shown(number))
    queue.put(predicted(0, np.full((8, 8), np.nan, np.float32)))
    wait_for(lambda: watch.problem is not None)
    assert "got NaN" in watch.problem
    assert session.finish().frames_inserted == 3


def test_streamed_predictions_belong_to_the_frames_of_their_times_and_can_be_compounded_again(scan, tmp_path):
    session, bone, watch, queue = scan(record=tmp_path / "scan-bone.mha")
    half = SWEEP.predictions(columns=30, rows=40)
    for number in range(6):
        queue.put(shown(number))
    for number in reversed(range(5)):
        queue.put(predicted(number, half[number]))
    wait_for(lambda: watch.frames == 5 and on_plane(bone) > 0.5)
    assert session.finish().frames_inserted == 6
    assert session.statistics.other_images == 0
    watch.stop()
    sequence = type(SWEEP.sequence).from_arrays(SWEEP.images, SWEEP.poses, 1.0 + 0.1 * np.arange(6))
    again = RecordedPredictions(sequence, read_sequence(watch.recorded))
    assert "5 of 6 frames, matched by time" in again.notes()[0]
    assert of_plane(bone_from_frames(sequence, again, SWEEP.swept, IMAGING).on_grid(GRID)) > 0.5


def test_predictions_are_taken_out_of_the_stream_and_do_not_fill_the_memory():
    queue = QueueSource()
    for number in range(MOST_PREDICTIONS + 3):
        queue.put(predicted(0, np.full((2, 2), number, np.uint8)))
    queue.put(shown(0))
    queue.stop()
    session = LiveSession(
        queue, ReconstructionSettings(**LOOKED), grid=GRID, synchronizer=SynchronizerSettings(), predictions_device="Bone"
    )
    session.start()
    session.stop()
    assert [int(message.image[0, 0]) for message in session.predictions] == list(range(3, MOST_PREDICTIONS + 3))
    assert session.devices() == {"Image_Reference": ("IMAGE",)}
    assert session.statistics.frames_received == 1
