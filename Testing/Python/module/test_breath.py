"""Between two things that make windows wait, the event loop lays out and draws what has changed: a turn passes, but never all of them."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "AIFRecon"))

from AIFReconGui.breath import BUSY, MOST, Breath


class Clock:
    """Time that passes only where it is told to."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def breath(clock):
    return Breath(clock)


def test_a_turn_in_which_nothing_was_drawn_is_not_passed(breath, clock):
    for _turn in range(5):
        clock.now += 0.9 * BUSY
        assert not breath.isNeeded()
        breath.isOver()


def test_the_turn_after_a_picture_passes_and_the_next_one_does_not(breath, clock):
    clock.now += 4 * BUSY
    assert breath.isNeeded()
    clock.now += 0.1 * BUSY
    assert not breath.isNeeded()


def test_what_is_done_itself_does_not_make_the_next_turn_pass(breath, clock):
    assert not breath.isNeeded()
    clock.now += 4 * BUSY
    breath.isOver()
    clock.now += 0.1 * BUSY
    assert not breath.isNeeded()


def test_where_every_turn_is_busy_something_is_done_all_the_same(breath, clock):
    passed = []
    for _turn in range(3 * (MOST + 1)):
        clock.now += 4 * BUSY
        passed.append(breath.isNeeded())
        if not passed[-1]:
            breath.isOver()
    assert passed == 3 * [*MOST * [True], False]
