"""Some of the made screens of a scanner, and the judge that tells right from wrong."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from AIFReconLib.imaging.beams import SECTOR, ProbeGeometry
from AIFReconLib.imaging.detection import detect_imaging

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from study.screen_cases import DECOYS, decoy, screen
from study.screens import REFUSED, RIGHT, WRONG, judged, judged_finding

SEEDS = (0, 2, 4, 5, 7, 8, 10, 12, 58, 62, 99, 104, 148, 191, 1084, 30073, 30140, 30187, 40028, 40115, 70177, 80079, 80131, 80473, 80516)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_probe_is_told_from_a_screen(seed):
    assert judged(screen(seed))[0] == RIGHT


@pytest.mark.parametrize("seed", range(len(DECOYS)), ids=DECOYS)
def test_what_shows_no_probe_is_refused(seed):
    assert judged(decoy(seed))[0] == REFUSED


def test_the_middle_of_a_sector_that_the_border_cuts_off_below_is_refused():
    assert judged(decoy(30027))[0] == REFUSED


def test_a_sector_whose_sides_are_covered_is_refused_where_only_a_higher_level_shows_its_arc():
    assert judged(decoy(40015))[0] == REFUSED


def test_a_narrow_middle_of_a_sector_whose_noise_hides_its_arc_at_lower_levels_is_refused():
    assert judged(decoy(50027))[0] == REFUSED


def test_a_clock_beside_the_middle_of_a_sector_is_no_end_of_a_strip():
    assert judged(decoy(30031))[0] == REFUSED


def test_a_moving_picture_that_two_borders_and_a_trace_bound_is_refused():
    assert judged(decoy(80342))[0] == REFUSED


def test_a_box_most_of_which_stands_still_is_refused():
    assert judged(decoy(80260))[0] == REFUSED


def test_a_sector_of_which_a_surer_level_tells_another_apex_is_refused():
    assert judged(screen(110121))[0] == REFUSED


def test_the_judge_sees_an_apex_that_is_off_by_more_than_half_a_millimeter():
    made = screen(4)
    found = detect_imaging(made.images, made.spacing)
    column, row = found.probe.apex
    off = replace(found, probe=ProbeGeometry(SECTOR, (column, row + 0.7 / made.spacing[1])))
    assert (judged_finding(made, found)[0], judged_finding(made, off)[0]) == (RIGHT, WRONG)
