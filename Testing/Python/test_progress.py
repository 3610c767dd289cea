"""Progress: fractions that rise from 0 to 1, and False that stops the work."""

from __future__ import annotations

import pytest

from AIFReconLib.errors import OperationCanceled
from AIFReconLib.progress import part, report


class Listener:
    """Keeps what it was told, and says stop after so many calls."""

    def __init__(self, stop_after: int | None = None, answer=True):
        self.calls: list[tuple[float, str]] = []
        self.stop_after, self.answer = stop_after, answer

    def __call__(self, fraction: float, message: str):
        self.calls.append((fraction, message))
        return self.answer if self.stop_after is None or len(self.calls) < self.stop_after else False


def test_the_listener_hears_the_fraction_and_the_message():
    listener = Listener()
    report(listener, 0.25, "Working")
    assert listener.calls == [(0.25, "Working")]


@pytest.mark.parametrize(("told", "heard"), [(-0.5, 0.0), (1.5, 1.0)])
def test_a_fraction_stays_between_0_and_1(told, heard):
    listener = Listener()
    report(listener, told, "Working")
    assert listener.calls[0][0] == heard


def test_false_stops_the_work():
    with pytest.raises(OperationCanceled):
        report(Listener(stop_after=1), 0.5, "Working")


@pytest.mark.parametrize(("inner", "outer"), [(0.0, 0.2), (0.5, 0.3), (1.0, 0.4)])
def test_a_part_fills_its_share_of_the_whole(inner, outer):
    listener = Listener()
    report(part(listener, 0.2, 0.4), inner, "Working")
    assert listener.calls[0][0] == pytest.approx(outer)


def test_a_part_of_a_part_passes_the_stop_on():
    with pytest.raises(OperationCanceled):
        report(part(part(Listener(stop_after=1), 0.2, 0.4), 0.5, 1.0), 0.5, "Working")
