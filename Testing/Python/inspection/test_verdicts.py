"""Verdicts on a sweep, each side of every threshold, from reports that are made by hand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from AIFReconLib.calibration.check import CalibrationCheck
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.guidance.bone import guided_bone
from AIFReconLib.guidance.coverage import back_of_labels
from AIFReconLib.inspection.tracking_report import TrackingReport, _PoseJump
from AIFReconLib.inspection.verdicts import Level, Verdict, calibration_verdict, coverage_verdict, registration_verdict, tracking_verdict
from AIFReconLib.message import Sentence, advised
from AIFReconLib.registration.agreement import Agreement, LabelAgreement
from AIFReconLib.remedies import CALIBRATE

JUMP = _PoseJump(11, 12, 34.0, 0.05)


def tracked(used=100, frames=100, jumps=0, speed=14.0) -> Verdict:
    """The verdict on a sweep with these numbers."""
    return tracking_verdict(TrackingReport(frames, used, {}, median_speed=speed, jumps=(JUMP,) * jumps))


@pytest.mark.parametrize(
    ("numbers", "level"),
    [
        ({}, Level.GOOD),
        ({"used": 90}, Level.GOOD),
        ({"used": 89}, Level.LOOK),
        ({"used": 50}, Level.LOOK),
        ({"used": 49}, Level.POOR),
        ({"used": 0}, Level.POOR),
        ({"speed": 60.0}, Level.GOOD),
        ({"speed": 61.0}, Level.LOOK),
        ({"speed": None}, Level.GOOD),
        ({"jumps": 1}, Level.LOOK),
        ({"jumps": 2}, Level.POOR),
        ({"jumps": 3, "used": 200, "frames": 200}, Level.LOOK),
        ({"jumps": 1, "used": 40}, Level.POOR),
    ],
)
def test_tracking_is_as_good_as_its_worst_number(numbers, level):
    assert tracked(**numbers).level == level


def agreeing(share=0.94, median=0.4, echoes=1000, elsewhere=0, labels=None) -> Verdict:
    """The verdict on a CT that agrees so well; `labels` is the share of each, with the name L3 for 1 and L4 for 2."""
    per_label = {label: LabelAgreement(own, median, echoes // 2) for label, own in (labels or {}).items()}
    return registration_verdict(Agreement(share, median, echoes, elsewhere, per_label), {1: "L3", 2: "L4"})


@pytest.mark.parametrize(
    ("numbers", "level"),
    [
        ({}, Level.GOOD),
        ({"share": 0.6, "median": 0.45}, Level.GOOD),
        ({"share": 0.59}, Level.POOR),
        ({"median": 0.46}, Level.POOR),
        ({"echoes": 0, "share": 0.0, "median": float("nan"), "elsewhere": 500}, Level.POOR),
        ({"echoes": 100, "elsewhere": 49}, Level.UNKNOWN),
        ({"labels": {1: 0.95, 2: 0.41}}, Level.GOOD),
        ({"labels": {1: 0.95, 2: 0.39}}, Level.LOOK),
    ],
)
def test_a_registration_is_good_where_it_would_be_accepted(numbers, level):
    assert agreeing(**numbers).level == level


def test_the_vertebra_that_does_not_agree_is_named():
    assert "L4" in agreeing(labels={1: 0.95, 2: 0.2}).finding
    assert agreeing().finding == "CT agrees: 94% of the echoes lie on its bone, 0.4 mm off in the median"


def covered(**shares) -> Verdict:
    """The verdict on vertebrae of which so much shows, and as much was met."""
    return coverage_verdict(shares, shares)


def test_coverage_is_as_good_as_the_worst_vertebra():
    assert [covered(L3=0.91, L4=low).level for low in (0.6, 0.59, 0.3, 0.29)] == [Level.GOOD, Level.LOOK, Level.LOOK, Level.POOR]
    assert covered(L3=0.91, L4=0.62).finding == "share of the bone that should show: L3: 91%, L4: 62%"


def test_a_sweep_that_met_no_bone_is_poor():
    assert covered(L3=0.0).level == covered().level == Level.POOR


def test_bone_that_faces_the_back_is_told_by_label():
    """A slab's near face that every beam meets shows; its far face is not asked for."""
    array = np.zeros((24, 24, 24), np.uint8)
    array[4:12, 8:14, 4:20], array[12:20, 8:14, 4:20] = 1, 2
    bone = guided_bone(Volume(array, np.eye(4)))
    facing = bone.surface.normals_reference[:, 1] < -0.5
    shares = back_of_labels(SimpleNamespace(bone=bone, best_cosine=np.where(facing, 0.9, np.nan), expected=facing.astype(float)))
    assert set(shares) == {"1", "2"}
    assert [share.expected_visibility for share in shares.values()] == pytest.approx([1.0, 1.0])


@pytest.mark.parametrize(("agrees", "level"), [(True, Level.GOOD), (False, Level.LOOK), (None, Level.UNKNOWN)])
def test_a_calibration_is_as_good_as_the_check_says(agrees, level):
    verdict = calibration_verdict(CalibrationCheck(agrees, "as it is."))
    assert (verdict.level, verdict.finding, advised(verdict.advice)) == (level, "as it is.", "")


def test_a_calibration_that_is_off_is_told_with_all_that_was_found_and_what_to_do():
    verdict = calibration_verdict(CalibrationCheck(False, Sentence("points lie off.", CALIBRATE), ("Images are late.",)))
    assert verdict.finding == "points lie off."
    assert advised(verdict.advice) == "Images are late. See calibrate, or repeat the calibration."
