"""Progress: fractions that rise from 0 to 1, and False that stops the work."""

from __future__ import annotations

import pytest

from AIFReconLib.errors import OperationCanceled
from AIFReconLib.progress import part, report


@pytest.mark.parametrize(("told", "heard"), [(0.25, 0.25), (-0.5, 0.0), (1.5, 1.0)])
def test_the_listener_hears_the_message_and_a_fraction_between_0_and_1(told, heard):
    calls = []
    report(lambda *call: calls.append(call), told, "Working")
    assert calls == [(heard, "Working")]


@pytest.mark.parametrize(("inner", "outer"), [(0.0, 0.2), (0.5, 0.3), (1.0, 0.4)])
def test_a_part_fills_its_share_of_the_whole(inner, outer):
    calls = []
    report(part(lambda *call: calls.append(call), 0.2, 0.4), inner, "Working")
    assert calls[0][0] == pytest.approx(outer)


@pytest.mark.parametrize("listener", [lambda *_: False, part(part(lambda *_: False, 0.2, 0.4), 0.5, 1.0)], ids=["whole", "part of a part"])
def test_false_stops_the_work(listener):
    with pytest.raises(OperationCanceled):
        report(listener, 0.5, "Working")
