"""A calibration without a CT, on echoes whose places are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from made_echoes import ANGLES, made_echoes, wrongly_calibrated
from scipy.spatial.transform import Rotation
from sweeps import laid_on

from AIFReconLib.calibration import crossing
from AIFReconLib.calibration.crossing import ASKED, calibrate_by_crossing, crossing_findings, crossing_report
from AIFReconLib.calibration.echoes import Correction
from AIFReconLib.calibration.solve import as_vector


@pytest.fixture(scope="module")
def true():
    return made_echoes()


def calibrated(echoes, rough=False):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(crossing, "imaged_echoes", lambda *given: echoes)
        return calibrate_by_crossing([], rough=rough)


@pytest.fixture(scope="module")
def wrong(true):
    return wrongly_calibrated(true, 4.0, 2.5)


@pytest.fixture(scope="module")
def found(wrong):
    return calibrated(wrong)


def misplaced(true, echoes, correction) -> float:
    """mm by which echoes are placed beside where they are, one laid on the other as a whole; the median."""
    here, there = echoes.placed(correction).points, true.placed(Correction.none(true.center)).points
    return float(np.median(np.linalg.norm(laid_on(here, there) - there, axis=1)))


def test_echoes_of_all_angles_lie_as_they_do_on_the_bone(true, wrong, found):
    assert found.accepted, found.refusal
    assert misplaced(true, wrong, Correction.none(wrong.center)) > 1.5
    assert misplaced(true, wrong, found.correction) < 0.2


def test_from_a_ruler_it_is_found_in_one_run(true):
    by_ruler = wrongly_calibrated(true, 18.0, 10.0, seed=3)
    found = calibrated(by_ruler, rough=True)
    assert found.accepted, found.refusal
    assert misplaced(true, by_ruler, found.correction) < 0.3


def test_where_no_start_leads_to_one_that_stands_out_nothing_is_written(true, monkeypatch):
    monkeypatch.setattr(crossing, "ROUGH_SCALES", (1.0,))
    assert "Calibrations that fit nearly as well lie" in (
        calibrated(wrongly_calibrated(true, 18.0, 10.0, seed=3), rough=True).refusal or ""
    )


@pytest.mark.parametrize(("axes", "turn"), [("right points", (0, 180, 0)), ("down points", (180, 0, 0))])
def test_an_axis_that_was_taken_for_its_opposite_is_told(true, axes, turn):
    face = np.array([true.frame_size[0] / 2 * true.spacing[0], 0.0, 0.0])
    other_way = Correction(Rotation.from_euler("xyz", turn, degrees=True).as_matrix(), np.zeros(3), np.ones(2), 0.0, face)
    found = calibrated(true.moved(other_way.plane), rough=True)
    assert f"when {axes} to the opposite side" in (found.refusal or "")
    assert crossing_findings(found) == []


def test_sizes_stay_as_given_and_that_is_said(found):
    assert as_vector(found.correction)[~ASKED] == pytest.approx(0.0)
    assert any("sizes of pixels stay as given" in line for line in crossing_findings(found))


def test_it_is_measured_on_frames_that_it_has_not_seen(found):
    assert found.halves.after < 0.6 * found.halves.before
    report = crossing_report(found)
    assert report["accepted"] is True
    assert report["other_half_mm"] == {"before": round(found.halves.before, 4), "after": round(found.halves.after, 4)}


def test_a_right_calibration_is_left_as_it_is(true):
    assert "No better one is found" in (calibrated(true).refusal or "")


def test_one_angle_is_refused():
    assert "from one angle alone" in (calibrated(made_echoes(ANGLES[:1])).refusal or "")


def test_halves_that_disagree_are_refused(wrong, monkeypatch):
    monkeypatch.setattr(crossing, "_apart", lambda *given: 1.5)
    assert "lie 1.5 mm apart" in (calibrated(wrong).refusal or "")


def test_angles_that_show_nothing_in_common_are_refused():
    echoes = made_echoes(ANGLES[:2])
    apart = echoes.planes.copy()
    apart[echoes.angles == 1, :3, 3] += 500.0
    assert "no bone in common" in (calibrated(replace(echoes, planes=apart, times=np.full(len(apart), np.nan))).refusal or "")


def test_what_tilts_about_one_axis_leave_open_is_said_and_stays_as_given():
    tilted = wrongly_calibrated(made_echoes([angle for angle in ANGLES if angle[1] == 0]), 4.0, 2.5)
    found = calibrated(tilted)
    open_numbers = ASKED & ~found.held
    assert open_numbers.any()
    assert as_vector(found.correction)[open_numbers] == pytest.approx(0.0)
    assert any(
        "This sweep does not show these, and they stay as they were: " in line for line in [*crossing_findings(found), found.refusal or ""]
    )
