"""The way to the next move, as steps for a hand: moved that way, the probe stands where it should, also where nobody knows the head."""

from __future__ import annotations

import numpy as np
import pytest
from idle_session import IMAGES

from AIFReconLib.guidance.next_move import DOWN, HERE, IMAGE, PATIENT, TO_LEFT, TO_RIGHT, TURN, UP, directions
from AIFReconLib.guidance.probe import ProbeOnBack, ProbePlacement, Skin

HERE_NOW = ProbePlacement(0.0, 0.0)
PROBE = ProbeOnBack(IMAGES, Skin.through(np.array([[0.0, 0.0, 0.0]])), np.eye(4))


@pytest.mark.parametrize(
    ("now", "there", "arrow", "words"),
    [
        (HERE_NOW, ProbePlacement(0.0, 12.0), UP, "slide 12 mm toward the head"),
        (HERE_NOW, ProbePlacement(0.0, -12.0), DOWN, "slide 12 mm toward the feet"),
        (HERE_NOW, ProbePlacement(9.0, 0.0), TO_RIGHT, "slide 9 mm toward the patient's right"),
        (HERE_NOW, ProbePlacement(-9.0, 0.0), TO_LEFT, "slide 9 mm toward the patient's left"),
        (HERE_NOW, ProbePlacement(0.0, 0.0, 90.0), TURN, "turn the probe to sagittal"),
        (HERE_NOW, HERE_NOW, HERE, "keep sweeping here"),
        # Held the other way round it is tilted the same way
        (ProbePlacement(0.0, 0.0, -90.0, 10.0), ProbePlacement(0.0, 0.0, 90.0, 20.0), UP, "aim the beam 30\u00b0 more toward the head"),
    ],
)
def test_a_step_has_an_arrow_and_words(now, there, arrow, words):
    (step,) = directions(now, there)
    assert (step.arrow, str(step.words)) == (arrow, words)


def moved(steps, pose) -> tuple[np.ndarray, np.ndarray]:
    """Where an image is, by its words, after a turn and slides: its axes (right, into), and how far it went in Reference."""
    right, into = (pose[:3, axis] / np.linalg.norm(pose[:3, axis]) for axis in (0, 2))
    gone = np.zeros(3)
    for step in steps:
        words = str(step.words).split()
        if step.arrow == TURN:
            degrees = float(words[3].rstrip("°")) * (1 if words[4] == "counterclockwise," else -1)
            turn = np.radians(degrees)
            right, into = np.cos(turn) * right + np.sin(turn) * into, np.cos(turn) * into - np.sin(turn) * right
        elif words[0] == "slide":
            way = {"right": right, "left": -right, "away": into, "toward": -into}[words[5] if words[3] == "to" else words[3]]
            gone = gone + float(words[1]) * way
    return np.stack([right, into]), gone


@pytest.mark.parametrize("now_deg", [0.0, 90.0, 180.0, -90.0, 100.0, -20.0])
@pytest.mark.parametrize("there_deg", [0.0, 90.0])
@pytest.mark.parametrize("way", [(10.0, 0.0), (-10.0, 0.0), (0.0, 10.0), (0.0, -10.0), (12.0, -7.0)])
def test_a_hand_that_follows_the_words_for_an_image_gets_there(now_deg, there_deg, way):
    """Both holds of a probe show one plane: what counts is where the image's plane is after turn and slides."""
    now, there = ProbePlacement(3.0, -2.0, now_deg), ProbePlacement(3.0 + way[0], -2.0 + way[1], there_deg)
    axes, gone = moved(directions(now, there, knows_head=False), PROBE.pose(now))
    expected = PROBE.pose(there)
    np.testing.assert_allclose(gone, (way[0], 0.0, way[1]), atol=0.6 + 12 * np.radians(20.0) * (abs(now_deg) in (20.0, 100.0)))
    right = expected[:3, 0] / np.linalg.norm(expected[:3, 0])
    assert abs(axes[0] @ right) > np.cos(np.radians(21.0))


@pytest.mark.parametrize("ways", [PATIENT, IMAGE], ids=["patient", "image"])
@pytest.mark.parametrize("now_deg", [0.0, 90.0, 180.0, -90.0])
@pytest.mark.parametrize("tilt", [(20.0, 0.0), (-20.0, 0.0), (0.0, 20.0), (0.0, -20.0)])
@pytest.mark.parametrize("there_deg", [0.0, 90.0])
def test_a_tilt_is_told_by_where_the_beam_turns_to(now_deg, there_deg, tilt, ways):
    now, there = ProbePlacement(0.0, 0.0, now_deg), ProbePlacement(0.0, 0.0, there_deg, *tilt)
    *turns, last = directions(now, there, knows_head=ways is PATIENT)
    right, up = np.eye(3)[[0, 2]] if ways is PATIENT else moved(turns, PROBE.pose(now))[0]
    beam = PROBE.pose(there)[:3, 1] / IMAGES.spacing[1]
    assert beam @ {TO_RIGHT: right, TO_LEFT: -right, UP: up, DOWN: -up}[last.arrow] > 0.3
    assert str(last.words).endswith(f" more {dict(ways)[last.arrow]}")
