"""The next move: it adds what it says, leads somewhere, stays advised, and ends."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from AIFReconLib.guidance.bone_coverage import CoverageAccumulator
from AIFReconLib.guidance.candidates import OFF_TARGET, geometry_of
from AIFReconLib.guidance.next_move import NextMove
from AIFReconLib.guidance.passes import name_of_place
from AIFReconLib.guidance.probe import ProbePlacement


@pytest.fixture(scope="module")
def advisor(bone, probe):
    return NextMove(bone, probe, hand=None)


@pytest.fixture(scope="module")
def followed(bone, probe, advisor):
    """(words, what it said to add, what it added) of moves that were followed, from a transverse image in the middle."""
    met, here = CoverageAccumulator(geometry_of(bone, probe)), probe.pose(ProbePlacement(0.0, 0.0))
    weights, moves, shown = np.where(bone.border, 1.0, OFF_TARGET) * bone.surface.areas, [], 0.0
    for _ in range(8):
        move = advisor.advise(met, here)
        for pose in move.planned.poses(probe, move.frames):
            met.insert(pose)
            here = pose
        now = float(weights @ met.expected) / 100
        moves.append((str(move.words), move.adds_cm2, now - shown))
        shown = now
    return moves, met


def test_a_move_adds_what_it_says(followed):
    said, added = np.array([(one[1], one[2]) for one in followed[0]]).T
    # Candidates are looked at in a third of their frames, and beside the target at every fourth point
    np.testing.assert_allclose(added, said, atol=0.1 + 0.1 * said.max())


def test_moves_that_are_followed_show_most_of_the_borders(followed, bone):
    border = bone.border
    areas = bone.surface.areas[border]
    assert areas @ followed[1].expected[border] / areas.sum() > 0.6


def test_moves_are_said_in_a_sonographers_words(followed):
    steps = (
        r"(turn the probe to (sagittal|transverse)|slide \d+ mm toward the (patient's )?\w+|"
        r"aim the beam \d+\u00b0 more toward the (patient's )?\w+|keep sweeping here)"
    )
    for words, _, _ in followed[0]:
        assert re.fullmatch(rf"{steps}(, {steps})* over (label [12]|labels 2 and 1), adds \d+\.\d cm2", words), words
    assert any("turn the probe to sagittal" in words for words, _, _ in followed[0])


@pytest.mark.parametrize(
    ("names", "said"),
    [
        ({}, "labels 2 and 1"),
        ({1: "L4", 2: "L3"}, "L3 and L4"),
        ({1: "L4"}, "labels 2 and 1"),
        ({1: "bone", 2: "bone"}, "bone (2) and bone (1)"),
    ],
)
def test_places_are_called_as_the_segments_are_from_head_to_feet(bone, names, said):
    bone = replace(bone, names=names)
    centers = np.array([bone.centers[1], bone.centers[2]])
    z = (centers.mean(axis=0) - bone.patient_to_reference[:3, 3]) @ bone.patient_to_reference[:3, 2]
    assert name_of_place(bone, float(z)) == said


def test_a_small_movement_of_the_hand_does_not_change_the_advice(bone, probe, advisor):
    met = CoverageAccumulator(geometry_of(bone, probe))
    rng = np.random.default_rng(0)
    advised = {advisor.advise(met, probe.pose(ProbePlacement(*rng.normal(0, 3, 2), 0.0, *rng.normal(0, 3, 2)))).planned for _ in range(20)}
    assert len(advised) == 1


def test_when_everything_was_met_squarely_nothing_is_advised(bone, probe, advisor):
    met = CoverageAccumulator(geometry_of(bone, probe))
    met.support[:] = 100.0
    assert advisor.advise(met, probe.pose(ProbePlacement(0.0, 0.0))) is None
