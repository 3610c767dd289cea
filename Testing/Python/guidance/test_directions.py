"""The way to the next move, as steps for a hand: moved that way, the probe stands where it should."""

from __future__ import annotations

import pytest

from AIFReconLib.guidance.next_move import DOWN, HERE, TO_LEFT, TO_RIGHT, TURN, UP, directions
from AIFReconLib.guidance.probe import ProbeImages, ProbeOnBack, ProbePlacement, Skin


def arrows(now, there):
    return "".join(step.arrow for step in directions(now, there))


@pytest.mark.parametrize(
    ("there", "arrow", "words"),
    [
        (ProbePlacement(0.0, 12.0), UP, "slide 12 mm toward the head"),
        (ProbePlacement(0.0, -12.0), DOWN, "slide 12 mm toward the feet"),
        (ProbePlacement(9.0, 0.0), TO_RIGHT, "slide 9 mm toward the patient's right"),
        (ProbePlacement(-9.0, 0.0), TO_LEFT, "slide 9 mm toward the patient's left"),
        (ProbePlacement(0.0, 0.0, 90.0), TURN, "turn the probe to sagittal"),
        (ProbePlacement(0.0, 0.0), HERE, "keep sweeping here"),
    ],
)
def test_a_step_has_an_arrow_and_words(there, arrow, words):
    (step,) = directions(ProbePlacement(0.0, 0.0), there)
    assert (step.arrow, str(step.words)) == (arrow, words)


@pytest.mark.parametrize("turn", [0.0, 90.0])
@pytest.mark.parametrize("tilts", [(20.0, 0.0), (-20.0, 0.0), (0.0, 20.0), (0.0, -20.0)])
def test_a_tilt_points_where_the_middle_beam_turns_to(bone, turn, tilts):
    probe = ProbeOnBack(ProbeImages.simulated(), Skin.over(bone), bone.patient_to_reference)
    there = ProbePlacement(0.0, 0.0, turn, *tilts)
    beam = probe.pose(there)[:3, 1] / probe.images.spacing[1]
    expected = {
        UP: beam @ bone.patient_to_reference[:3, 2],
        DOWN: -beam @ bone.patient_to_reference[:3, 2],
        TO_RIGHT: beam @ bone.patient_to_reference[:3, 0],
        TO_LEFT: -beam @ bone.patient_to_reference[:3, 0],
    }
    assert expected[arrows(ProbePlacement(0.0, 0.0, turn), there)] > 0.3


def test_a_probe_that_is_held_the_other_way_round_is_tilted_the_same_way():
    there = ProbePlacement(0.0, 0.0, 90.0, 20.0, 0.0)
    assert arrows(ProbePlacement(0.0, 0.0, -90.0, 10.0, 0.0), there) == UP
    assert str(directions(ProbePlacement(0.0, 0.0, -90.0, 10.0, 0.0), there)[0].words) == "aim the beam 30\u00b0 more toward the head"
