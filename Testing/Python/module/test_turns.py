"""While a scan is shown, its threads have the interpreter as long as Slicer's windows, whose event loop does not let go of it."""

from __future__ import annotations

import ctypes
import sys
import threading
import time
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "AIFRecon"))

from AIFReconScene.live.turns import HELD_BACK, LEAST, LET_GO, LONGEST, MOST_OWED, Turns

MOST_EVENTS = 200
"""Events of the windows within which a thread must have got on."""

STEPS = 1500
"""Of a thread that asks for the interpreter again after each; without turns it has two for every event, with them some sixty."""


class Clock:
    """Time that passes only where it is told to."""

    def __init__(self):
        self.now, self.slept = 0.0, []

    def __call__(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds
        self.slept.append(seconds)


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def turns(clock):
    one = Turns(clock, clock.sleep)
    one.give()
    return one


def hold_interpreter(seconds: float) -> None:
    """What Slicer's event loop does while it draws: C++ that keeps the interpreter's lock."""
    if sys.platform == "win32":
        ctypes.PyDLL("kernel32").Sleep(round(1000 * seconds))
    else:
        ctypes.PyDLL(None).usleep(round(1e6 * seconds))


def test_windows_that_do_nothing_give_short_turns(turns, clock):
    for _ in range(5):
        turns.give()
    assert clock.slept == pytest.approx([LEAST] * 6)
    assert not turns.isOwing


def test_what_drawing_has_taken_is_given_back_in_turns_between_which_events_are_handled(turns, clock):
    clock.slept.clear()
    clock.now += 0.1
    turns.give()
    assert turns.isOwing
    while turns.isOwing:
        turns.give()
    assert max(clock.slept) <= LONGEST
    assert sum(clock.slept) == pytest.approx(0.1, abs=2 * LONGEST)


def test_windows_that_stood_still_for_long_do_not_owe_for_ever(turns, clock):
    clock.now += 60.0
    clock.slept.clear()
    turns.give()
    while turns.isOwing:
        turns.give()
    assert sum(clock.slept) == pytest.approx(MOST_OWED, abs=2 * LONGEST)


def test_something_is_drawn_beside_windows_that_owe_for_ever(turns, clock):
    owed = []
    for _ in range(200):
        clock.now += 0.1
        turns.give()
        owed.append(turns.isOwing)
    drawn = 1.0 - sum(owed) / len(owed)
    assert drawn == pytest.approx(LET_GO / (HELD_BACK + LET_GO), abs=0.1)
    spells = "".join("x" if each else " " for each in owed).split()
    assert max(map(len, spells)) * (0.1 + LONGEST) <= HELD_BACK + 0.1 + LONGEST


def test_a_new_scan_owes_nothing(turns, clock):
    clock.now += 60.0
    turns.give()
    turns.forget()
    assert not turns.isOwing
    clock.now += 60.0
    turns.give()
    assert clock.slept[-1] == pytest.approx(LEAST)


def test_a_thread_gets_on_beside_windows_that_hold_the_interpreter():
    left = threading.Semaphore(0)

    def work() -> None:
        for _ in range(STEPS):
            time.sleep(0)  # lets go of the interpreter and asks for it again
        left.release()

    thread = threading.Thread(target=work, daemon=True)
    turns = Turns()
    thread.start()
    for _ in range(MOST_EVENTS):
        hold_interpreter(0.002)
        turns.give()
        if left.acquire(blocking=False):
            return
    pytest.fail("the thread had no turn")
