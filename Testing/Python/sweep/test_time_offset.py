"""Images and poses out of step: which pose an image gets then, and when it gets none."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from files import IMAGE_TO_PROBE, write_patient
from sweeps import rigid

from AIFReconLib.commands.parser import main
from AIFReconLib.errors import SettingsError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
from AIFReconLib.sweep.pose_tracks import PoseTrack
from AIFReconLib.sweep.poses import sweep_poses
from AIFReconLib.sweep.time_offset import with_time_offset

PROBE_TO_TRACKER, REFERENCE_TO_TRACKER = TransformName("Probe", "Tracker"), TransformName("Reference", "Tracker")


def probe_at(time) -> np.ndarray:
    """A probe that moves at 30 mm/s and turns at 40 degrees/s."""
    return rigid((0.0, 40.0 * time, 0.0), (30.0 * time, -5.0, 2.0))


def sweep(times=None, late=0.0, statuses=None, image_statuses=None) -> TrackedSequence:
    """Frames at these times, whose recorded poses are those of `late` seconds before."""
    times = np.arange(12) * 0.1 if times is None else times
    records = []
    for n, time in enumerate(times):
        status = (statuses or {}).get(n, TransformStatus.OK)
        transforms = {
            PROBE_TO_TRACKER: TransformSample(probe_at(time - late), status),
            REFERENCE_TO_TRACKER: TransformSample(rigid((0, 0, 20.0), (1.0, 2.0, 3.0))),
        }
        records.append(FrameRecord(float(time), image_status=(image_statuses or {}).get(n, TransformStatus.OK), transforms=transforms))
    header = {TransformName("Image", "Probe"): TransformSample(IMAGE_TO_PROBE)}
    return TrackedSequence(np.zeros((len(records), 30, 40), np.uint8), records, transforms=header)


def probe_poses(sequence) -> list[np.ndarray]:
    return [record.transforms[PROBE_TO_TRACKER].matrix for record in sequence.records]


@pytest.mark.parametrize("late", [0.04, 0.1, -0.07])
def test_poses_that_come_late_are_mended_by_that_offset(late):
    mended = with_time_offset(sweep(late=late, image_statuses={6: TransformStatus.INVALID}), late)
    for n in range(2, 10):
        np.testing.assert_allclose(probe_poses(mended)[n], probe_at(0.1 * n), atol=1e-9)
        still = mended.records[n].transforms[REFERENCE_TO_TRACKER].matrix
        np.testing.assert_allclose(still, rigid((0, 0, 20.0), (1.0, 2.0, 3.0)), atol=1e-12)
    # LocalTimeOffsetSec = -0.3 of a frame grabber: its images show what was there 0.3 s before their time stamp
    np.testing.assert_allclose(probe_poses(with_time_offset(sweep(), -0.3))[7], probe_at(0.7 - 0.3), atol=1e-9)


def test_a_whole_number_of_frames_takes_the_very_poses():
    original = sweep()
    shifted = with_time_offset(original, 0.2)
    assert [p.tolist() for p in probe_poses(shifted)[:10]] == [p.tolist() for p in probe_poses(original)[2:]]


@pytest.mark.parametrize(
    ("lost", "offset", "missing", "said"),
    [
        ((), 0.25, [9, 10, 11], "3 frames have no pose then"),
        ((), -0.05, [0], "1 frame has no pose then"),
        ((5,), 0.05, [4, 11], "2 frames have no pose then"),
        ((4, 5, 6), 0.05, [3, 11], "2 frames have no pose then"),
    ],
)
def test_no_pose_is_made_up_beyond_the_ends_nor_where_the_tracker_lost_the_tool(lost, offset, missing, said):
    shifted = with_time_offset(sweep(statuses=dict.fromkeys(lost, TransformStatus.OUT_OF_VIEW)), offset, longest_gap=0.5)
    found = {"ProbeToTracker MISSING": missing, **({"ProbeToTracker OUT_OF_VIEW": [*lost]} if lost else {})}
    assert sweep_poses(shifted).skipped() == found
    assert said in shifted.notes[0]


def test_frames_in_any_order_are_interpolated_in_order_of_time():
    order = [3, 0, 7, 1, 2, 11, 4, 5, 6, 8, 9, 10]
    shifted = with_time_offset(sweep(times=np.array(order) * 0.1), 0.05)
    np.testing.assert_allclose(probe_poses(shifted)[2], probe_at(0.75), atol=1e-9)


@pytest.mark.parametrize("timestamp", [None, 3.0])
def test_an_offset_without_times_is_refused(timestamp):
    sequence = sweep()
    sequence = replace(sequence, records=[replace(record, timestamp=timestamp) for record in sequence.records])
    with pytest.raises(SettingsError, match="a time stamp for every frame, and they must differ"):
        with_time_offset(sequence, 0.1)


def test_poses_that_cannot_be_interpolated_are_a_missing_pose():
    mirrored = np.diag([1.0, 1.0, -1.0, 1.0])
    track = PoseTrack([(1.0, TransformSample(np.eye(4))), (1.2, TransformSample(mirrored))])
    assert "cannot be interpolated" in track.at(1.1)[1]


def test_reconstruct_takes_the_offset(tmp_path, results, capsys):
    patient = write_patient(tmp_path, sweep(late=0.1))
    outputs = ["--output", str(results / "v.nrrd"), "--report", str(results / "r.json")]
    assert main([*patient.reconstruct, "--time-offset", "0.1", *outputs]) == 0
    assert "Poses are those of 0.1 s after each image's time stamp; 1 frame has no pose then." in capsys.readouterr().out
    assert json.loads((results / "r.json").read_text())["tracking"]["frames_used"] == 11
