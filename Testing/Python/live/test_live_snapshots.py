"""Snapshots that are made beside a user interface: at most one at a time, only when there is something new, and errors are kept."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import pytest

from AIFReconLib.live.session.snapshots import SnapshotMaker


class Session:
    """As much of a session as snapshots need: counts how often one is made."""

    def __init__(self) -> None:
        self.statistics, self.pool = SimpleNamespace(inserted=0), ThreadPoolExecutor()
        self.made = 0
        self.trouble: Exception | None = None

    def snapshot(self):
        self.made += 1
        if self.trouble is not None:
            raise self.trouble
        return f"snapshot {self.made}"


@pytest.fixture
def session():
    return Session()


@pytest.fixture
def maker(session):
    maker = SnapshotMaker(session)
    yield maker
    maker.stop()


def awaited(condition, seconds=60.0):
    """What `condition()` gives once it is true."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if found := condition():
            return found
        time.sleep(0.002)
    raise AssertionError("it did not happen in time")


def test_a_snapshot_is_made_when_it_is_asked_for_and_taken_once_and_not_again_without_new_frames(session, maker):
    assert (maker.take(), session.made) == (None, 0)
    maker.request()
    assert awaited(maker.take) == "snapshot 1"
    assert maker.take() is None
    maker.request()
    maker.stop()
    maker.stop()
    assert session.made == 1


def test_frames_that_came_meanwhile_make_the_next_one(session, maker):
    maker.request()
    awaited(maker.take)
    session.statistics.inserted = 5
    maker.request()
    assert awaited(maker.take) == "snapshot 2"


def test_an_error_is_kept_and_the_next_request_tries_again(session, maker):
    session.trouble = MemoryError("no room")
    maker.request()
    assert awaited(lambda: maker.take() or maker.error) is session.trouble
    session.trouble, session.statistics.inserted = None, 1
    maker.request()
    assert awaited(maker.take) == "snapshot 2"
    assert maker.error is None
