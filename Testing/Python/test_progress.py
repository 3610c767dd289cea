"""Progress: fractions that rise from 0 to 1, and False that stops the work."""

from __future__ import annotations

import pytest

from AIFReconLib.errors import OperationCanceled
from AIFReconLib.progress import part, report


@pytest.mark.parametrize(
    ("share", "told", "heard"), [((0, 1), 0.25, 0.25), ((0, 1), -0.5, 0), ((0, 1), 1.5, 1), ((0.2, 0.4), 0, 0.2), ((0.2, 0.4), 0.5, 0.3)]
)
def test_the_listener_hears_the_message_and_a_fraction_between_0_and_1_of_a_part_within_its_share(share, told, heard):
    calls = []
    report(part(lambda *call: calls.append(call), *share), told, "Working")
    assert calls == [(pytest.approx(heard), "Working")]


@pytest.mark.parametrize("listener", [lambda *_: False, part(part(lambda *_: False, 0.2, 0.4), 0.5, 1.0)], ids=["whole", "part of a part"])
def test_false_stops_the_work(listener):
    with pytest.raises(OperationCanceled):
        report(listener, 0.5, "Working")
