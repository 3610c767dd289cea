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


OUT_OF_VIEW = {2: TransformStatus.OUT_OF_VIEW, 3: TransformStatus.OUT_OF_VIEW}
CORNERS = np.sqrt(2 * (40.0**2 + 30.0**2 + 50.0**2) / 4)
"""mm by which a right angle about the first pixel moves the corners: 0, 40, 30 and 50 times the square root of 2."""

REPORTS = {
    "steps": ([0.0, 1.0, 2.0, 5.0], {}, {"median_step": 1.0, "largest_step": 3.0, "median_speed": 10.0, "highest_speed": 30.0}),
    "a turn": ([0.0, 0.0], {"turns": [0.0, 90.0]}, {"largest_step": CORNERS}),
    "a gap between used frames": (np.arange(6), {"statuses": OUT_OF_VIEW}, {"longest_gap": 0.3, "longest_gap_after": 1}),
    "moved on while nothing was recorded": ([0, 1, 2, 90, 91], {"times": [0, 0.1, 0.2, 3.0, 3.1]}, {"jumps": ()}),
    "fast as a whole": (np.arange(0, 300, 25.0), {}, {"jumps": ()}),
    "in any order": ([2.0, 0.0, 1.0], {"times": [0.2, 0.0, 0.1]}, {"largest_step": 1.0}),
    "no times": ([0.0, 1.0], {"times": [None, None]}, {"median_step": 1.0, "median_speed": None, "longest_gap": None}),
    "one frame": ([0.0], {}, {"used": 1}),
    "two frames": ([0.0, 0.0], {}, {"used": 2}),
}


@pytest.mark.parametrize(("positions", "options", "numbers"), REPORTS.values(), ids=REPORTS)
def test_a_sweep_is_told_in_numbers(positions, options, numbers):
    found = report(positions, **options)
    for name, number in numbers.items():
        assert getattr(found, name) == pytest.approx(number), name


def test_a_jump_is_named_with_its_frames_and_distance():
    found = report([0, 1, 2, 3, 63, 64, 65])
    assert [jump.to_text() for jump in found.jumps] == ["frames 3 to 4: 60.0 mm in 0.10 s"]
    assert "jumps faster than a probe can move" in found.findings()[0]


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
