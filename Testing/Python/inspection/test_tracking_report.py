"""How well a sweep was tracked: what is counted, and when it is called a jump."""

from __future__ import annotations

import json

import numpy as np
import pytest
from files import tracked_sequence, write_patient
from sweeps import rigid

from AIFReconLib.commands.parser import main
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.inspection.tracking_report import tracking_report
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses


def sweep(positions, times=None, statuses=None, turns=None) -> TrackedSequence:
    """Images of 41 x 31 pixels of 1 mm at these places along z, at 10 frames/s."""
    times = np.arange(len(positions)) * 0.1 if times is None else times
    records = []
    for n, position in enumerate(positions):
        pose = rigid((0, 0, 0 if turns is None else turns[n]), (0.0, 0.0, position))
        sample = TransformSample(pose, (statuses or {}).get(n, TransformStatus.OK))
        records.append(FrameRecord(None if times[n] is None else float(times[n]), transforms={TransformName("Image", "Reference"): sample}))
    return TrackedSequence(np.zeros((len(records), 31, 41), np.uint8), records)


def report(*arguments, **options):
    sequence = sweep(*arguments, **options)
    return tracking_report(sequence, sweep_poses(sequence))


def test_speed_and_steps_are_in_millimeters():
    found = report([0.0, 1.0, 2.0, 5.0])
    assert (found.median_step, found.largest_step) == pytest.approx((1.0, 3.0))
    assert (found.median_speed, found.highest_speed) == pytest.approx((10.0, 30.0))


def test_a_turn_moves_the_corners():
    """A right angle about the first pixel: the four corners move by 0, 40, 30 and 50 mm times the square root of 2."""
    expected = np.sqrt(2 * (40.0**2 + 30.0**2 + 50.0**2) / 4)
    assert report([0.0, 0.0], turns=[0.0, 90.0]).largest_step == pytest.approx(expected)


def test_the_longest_gap_is_between_used_frames():
    found = report(np.arange(6), statuses={2: TransformStatus.OUT_OF_VIEW, 3: TransformStatus.OUT_OF_VIEW})
    assert (found.longest_gap, found.longest_gap_after) == (pytest.approx(0.3), 1)


def test_a_jump_is_named_with_its_frames_and_distance():
    found = report([0, 1, 2, 3, 63, 64, 65])
    assert [jump.to_text() for jump in found.jumps] == ["frames 3 to 4: 60.0 mm in 0.10 s"]
    assert "jumps faster than a probe can move" in found.findings()[0]


def test_moving_on_while_nothing_is_recorded_is_no_jump():
    assert report([0, 1, 2, 90, 91], times=[0, 0.1, 0.2, 3.0, 3.1]).jumps == ()


def test_a_sweep_that_is_fast_as_a_whole_has_no_jumps():
    assert report(np.arange(0, 300, 25.0)).jumps == ()


def test_frames_in_any_order_are_looked_at_in_order_of_time():
    assert report([2.0, 0.0, 1.0], times=[0.2, 0.0, 0.1]).largest_step == pytest.approx(1.0)


def test_without_times_there_are_steps_and_no_speeds():
    found = report([0.0, 1.0], times=[None, None])
    assert (found.median_step, found.median_speed, found.longest_gap) == (1.0, None, None)


@pytest.mark.parametrize("count", [1, 2])
def test_a_sweep_of_few_frames_is_no_error(count):
    assert report(np.zeros(count)).used == count


def test_info_as_json_holds_the_same(tmp_path, capsys):
    patient = write_patient(tmp_path, tracked_sequence(statuses={1: TransformStatus.OUT_OF_VIEW}))
    assert main(["info", str(patient.sweep), "--config", str(patient.config), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["ready"] is True
    assert found["tracking"]["frames_skipped"] == {"ProbeToTracker OUT_OF_VIEW": [1]}
    assert found["time_offset"]["estimate_s"] is None


def test_reconstruct_writes_the_report_with_the_coverage_of_the_grid(patient, results):
    code = main([*patient.reconstruct, "--hole-limit", "3", *("--output", str(results / "v.nrrd")), *("--report", str(results / "r.json"))])
    assert code == 0
    found = json.loads((results / "r.json").read_text())
    coverage = found["tracking"]["coverage"]
    assert coverage["voxels"] == np.prod(found["grid"]["size"])
    assert 0 < coverage["measured"] < coverage["measured"] + coverage["filled"] <= coverage["voxels"]
    assert found["tracking"]["frames_used"] == 6
