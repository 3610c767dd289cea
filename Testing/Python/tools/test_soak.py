"""The soak test, short: every fault once, and every frame accounted for. `make soak` runs the hour."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from soak.client import soak, strange
from soak.server import FAULTS


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    """A recorded run of the first round of faults."""
    folder = tmp_path_factory.mktemp("soak")
    return soak(5, 0.1, record=folder / "scan.mhd")


def test_every_frame_is_accounted_for_whatever_the_server_does(outcome):
    assert outcome.findings == [], outcome


def test_every_fault_has_happened(outcome):
    assert set(outcome.faults) == set(FAULTS)


def test_frames_are_destroyed_repeated_refused_and_dropped(outcome):
    """Else the accounts add up because nothing went wrong."""
    assert set(outcome.fates) == {"whole", "destroyed", "again", "unusable", "foreign"}
    assert outcome.statistics.inserted
    assert outcome.statistics.skipped


# ---- the checks themselves can fail


def test_a_frame_that_is_lost_or_came_though_it_was_destroyed_is_told():
    client = SimpleNamespace(seen={3, 4}, strangers=1, statistics=SimpleNamespace(dropped_images=1))
    notes = [(1, "plain", "whole"), (2, "burst", "whole"), (3, "plain", "whole"), (4, "cut", "destroyed")]
    assert [found.split(" ")[0] for found in strange(notes, client)] == ["1", "1", "2"]
