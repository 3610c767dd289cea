"""The soak test, short: every fault once, and every frame accounted for. `make soak` runs the hour."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from soak import stream
from soak.client import describe, lost, soak
from soak.faults import FAULTS
from soak.growth import Sample, growth


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    """A recorded run of the first round of faults."""
    folder = tmp_path_factory.mktemp("soak")
    return soak(5, 0.1, folder / "ledger.txt", record=folder / "scan.mhd")


def test_every_frame_is_accounted_for_whatever_the_server_does(outcome):
    assert outcome.findings == [], describe(outcome)


def test_every_fault_has_happened(outcome):
    assert len(outcome.told["faults"]) >= len(FAULTS)


def test_frames_are_destroyed_repeated_refused_and_dropped(outcome):
    """Else the accounts add up because nothing went wrong."""
    assert all(outcome.told["fates"].values())
    assert outcome.statistics.inserted
    assert outcome.statistics.skipped


# ---- the checks themselves can fail


def test_an_image_that_differs_in_one_pixel_is_a_stranger():
    image = stream.pixels(3)
    image[50, 60] ^= 1
    assert stream.number_of(image) is None


def test_a_whole_frame_that_came_to_nobody_is_told_with_its_fault():
    assert "2 whole frames came to nobody, and only 1 were dropped" in lost({1: "plain", 2: "burst", 3: "plain"}, {3}, 1)


@pytest.mark.parametrize(
    ("grows", "flat"), [({}, True), ({"memory_mib": 0.5}, False), ({"blocks": 1000}, False), ({"threads": 1}, False)], ids=str
)
def test_what_grows_is_not_flat(grows, flat):
    start = {"memory_mib": 200.0, "blocks": 10_000, "threads": 6, "files": 11}
    samples = [Sample(minute, 0.0, **{name: value + minute * grows.get(name, 0) for name, value in start.items()}) for minute in range(60)]
    assert growth(samples).is_flat is flat
