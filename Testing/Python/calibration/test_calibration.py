"""A calibration from the scan: found, judged, refused; on echoes whose places are known."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from made_echoes import ANGLES, FRAMES, SPACING, field, made_echoes, misplaced, spine, wrongly_calibrated
from sweeps import rigid

from AIFReconLib import check_calibration
from AIFReconLib.calibration import calibration, check
from AIFReconLib.calibration.calibration import Calibration, calibrate_echoes, findings
from AIFReconLib.calibration.check import mirrored, quarter_turns
from AIFReconLib.calibration.crossing import crossing
from AIFReconLib.calibration.echoes import Correction, _PlaneTrack
from AIFReconLib.calibration.solve import ALL, PARAMETERS, Solved, _Cost, as_correction, as_vector, named
from AIFReconLib.geometry.transforms import with_unit_depth
from AIFReconLib.simulation.scan import random_rigid


@pytest.fixture(scope="module")
def true():
    return made_echoes()


@pytest.fixture(scope="module")
def bone():
    return field()


def start(echoes) -> np.ndarray:
    return random_rigid(5.0, 3.0, np.random.default_rng(3), echoes.placed(Correction.none(echoes.center)).points.mean(axis=0))


@pytest.fixture(scope="module")
def found(true, bone) -> Calibration:
    """Of a calibration that is wrong in everything."""
    wrong = wrongly_calibrated(true, 4.0, 2.5, (1.02, 0.98), 0.04)
    return calibrate_echoes(wrong, bone, start(wrong))


def test_echoes_lie_where_they_are_after_a_calibration_that_was_wrong_in_everything(true, found):
    off = misplaced(true, found.echoes, found.correction, found.labels_to_reference)
    assert found.accepted
    assert found.needed
    assert np.median(off) < 0.3
    assert np.quantile(off, 0.95) < 0.5
    assert np.median(off) < found.uncertainty < 0.6
    assert found.correction.scale == pytest.approx([1 / 1.02, 1 / 0.98], rel=0.006)
    assert found.correction.delay == pytest.approx(0.04, abs=0.003)
    assert found.halves.after < 0.5 * found.halves.before
    assert found.halves.apart < 0.4
    assert np.median(misplaced(true, found.echoes, Correction.none(found.echoes.center), found.given.labels_to_reference)) > 1.0


def test_a_right_calibration_is_left_where_it_is(true, bone):
    found = calibrate_echoes(true, bone, start(true))
    before = misplaced(true, true, Correction.none(true.center), found.given.labels_to_reference)
    assert np.median(misplaced(true, true, found.correction, found.labels_to_reference)) < np.median(before) + 0.2
    assert any("no need to change it" in line for line in findings(found))
    assert not found.needed
    assert "accepted True, needed False, determined shift across" in repr(found)


def test_a_ct_that_lies_on_the_sweep_is_not_looked_for_elsewhere(true, bone, monkeypatch):
    """Other bone beside it, which the CT does not hold, would lead the search away."""
    monkeypatch.setattr(calibration, "search", None)
    assert calibrate_echoes(true, bone).accepted


def test_one_angle_is_refused(true, bone):
    one = made_echoes(ANGLES[:1])
    assert "from one angle alone" in (calibrate_echoes(one, bone, np.eye(4)).refusal or "")


def test_what_tilts_within_the_plane_leave_open_is_named_with_the_movement_that_tells_it(bone):
    found = calibrate_echoes(made_echoes(ANGLES[:3]), bone, np.eye(4))
    assert not found.held[PARAMETERS.index("shift out of the image")]
    assert "shift out of the image" in (found.advice or "")
    assert "tilted out of its image plane" in (found.advice or "")


def test_a_robot_that_tilts_about_one_axis_does_not_give_the_image_a_false_turn_of_ten_degrees(bone):
    """Steps along the spine, at each a few tilts within the image plane: a turn of the image there is one of the CT."""
    echoes = made_echoes(ANGLES[:3])
    middle = rigid(translation=echoes.center)
    found = calibrate_echoes(echoes.moved(middle @ rigid((0.0, 0.0, 10.0)) @ np.linalg.inv(middle)), bone, np.eye(4))
    left = [name for name, value in zip(PARAMETERS, found.values, strict=True) if value == 0.0]
    assert "turn in the image" in left
    assert left == named(~found.held)
    assert any(line.startswith("This sweep does not show these, and they stay as they were: ") for line in findings(found))


def test_the_ct_of_another_patient_is_refused():
    found = calibrate_echoes(made_echoes(ANGLES[::2]), field(1), np.eye(4))
    assert "No calibration near this one" in (found.refusal or "")


# ---- geometry


def test_a_pose_with_the_correction_of_pixels_places_a_pixel_where_the_correction_places_its_echo(true):
    vector = np.array([1.0, -2.0, 3.0, 0.02, -0.03, 0.04, 0.03, -0.02, 0.0])
    correction = as_correction(vector, true.center)
    pose = true.planes[20] @ np.diag([*SPACING, 7.0, 1.0])  # whatever the third column is
    mended = with_unit_depth(pose) @ correction.of_pixels(SPACING)
    mine = true.frames == 20
    pixels = true.points[mine, :2] / SPACING
    placed = pixels @ mended[:3, :2].T + mended[:3, 3]
    assert placed == pytest.approx(true.placed(correction).points[mine], abs=1e-9)
    assert as_vector(correction) == pytest.approx(vector)


def test_between_frames_and_beyond_the_end_of_a_pass_planes_go_on_as_they_moved(true):
    track, times = true.tracks[0], true.times
    assert track.at(times) == pytest.approx(true.planes)
    half = track.at(times[[3]] + 0.025)[0]
    assert half[:3, 3] == pytest.approx((true.planes[3, :3, 3] + true.planes[4, :3, 3]) / 2)
    last = FRAMES - 1  # of the first pass; the next frame comes 2 s later
    beyond = track.at(times[[last]] + 0.05)[0]
    assert beyond[:3, 3] == pytest.approx(2 * true.planes[last, :3, 3] - true.planes[last - 1, :3, 3])


def test_a_frame_alone_in_its_pass_stays_where_it_is():
    planes = np.array([np.eye(4), np.eye(4), np.eye(4)])
    planes[:, 0, 3] = (0.0, 10.0, 11.0)
    track = _PlaneTrack(np.array([0.0, 5.0, 5.05]), planes)
    assert track.at(np.array([0.05]))[0] == pytest.approx(planes[0])


def test_angles_lie_nearer_to_each_other_as_they_are_than_mirrored(true):
    wrong = wrongly_calibrated(true, 3.0, 2.0)
    assert crossing(true) < 0.8 * crossing(mirrored(true))
    assert crossing(wrong) < 0.8 * crossing(mirrored(wrong))


def test_echoes_mended_by_a_correction_lie_where_it_places_them(true):
    correction = as_correction(np.array([1.0, -2.0, 3.0, 0.02, -0.03, 0.04, 0.1, -0.12, 0.0]), true.center)
    mended = true.mended(correction)
    assert mended.placed(Correction.none(true.center)).points == pytest.approx(true.placed(correction).points, abs=1e-9)
    assert mended.placed(Correction.none(true.center)).beams == pytest.approx(true.placed(correction).beams, abs=1e-9)
    assert mended.spacing == pytest.approx(np.array(true.spacing) * correction.scale)


def test_pixels_of_quite_another_size_are_told(true, monkeypatch):
    wide = wrongly_calibrated(true, 0.0, 0.0, (1.2, 1.0))
    monkeypatch.setattr(check, "sweeps_of", lambda sequences, _: list(sequences))
    monkeypatch.setattr(check, "imaged_echoes", lambda *given: wide)
    monkeypatch.setattr(check, "repairs", lambda *given: [])
    finding = check.checked([], spine().labels, start(wide)).finding
    assert finding.split(" wide")[0] in check_calibration([], spine().labels, start(wide))[0]
    assert re.fullmatch(r"pixels look 1(19|20|21)% as wide and (99|100|101)% as high as they are\.", finding), finding


def test_there_are_23_other_ways_to_mount_a_marker():
    turns = [turn for _, turn in quarter_turns()]
    words = [words for words, _ in quarter_turns()]
    assert len({turn.tobytes() for turn in turns}) == len(set(words)) == 23
    assert all(np.linalg.det(turn) == pytest.approx(1.0) for turn in turns)


def test_without_times_the_delay_is_not_asked_for(bone):
    timed = made_echoes(ANGLES[::2])
    found = calibrate_echoes(replace(timed, times=np.full(len(timed.times), np.nan)), bone, np.eye(4))
    assert not found.held[-1]
    assert found.correction.delay == 0.0


def test_slopes_are_those_of_finite_differences(true, bone):
    few = true.spread(300)
    at = Solved(start(true), as_correction(0.3 * np.array([1, 1, 1, 0.03, 0.03, 0.03, 0.02, 0.02, 0.02]), true.center), 0.0)
    _, slopes = _Cost(few, bone, at, ALL)(np.zeros(15))
    for column in range(15):
        step = np.zeros(15)
        step[column] = 2e-3
        # Kinks between voxels are few
        ahead, behind = _Cost(few, bone, at, ALL)(step)[0], _Cost(few, bone, at, ALL)(-step)[0]
        there = (np.abs(ahead) < 100) & (np.abs(behind) < 100)
        differences = (ahead - behind)[there] / 4e-3
        assert np.median(np.abs(differences - slopes[there, column])) < 2e-3 * max(np.abs(slopes[:, column]).max(), 1.0)
