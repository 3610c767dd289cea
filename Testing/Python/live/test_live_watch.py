"""Work beside a live scan begins when the insertion rests, and what goes wrong in it is told once."""

from __future__ import annotations

import logging
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.live.pairing.synchronizer import LiveFrame, SynchronizerSettings
from AIFReconLib.live.session.session import LiveSession
from AIFReconLib.live.session.watch import Watch
from AIFReconLib.live.wire.messages import ImageMessage
from AIFReconLib.live.wire.sources import QueueSource
from AIFReconLib.recipe.recipe import ReconstructionSettings

LONG = 60.0


@pytest.fixture
def session():
    grid = VoxelGrid.from_spacing((-500.0, -500.0, -500.0), (50, 50, 50), 20.0)
    trusted = SynchronizerSettings(trust_image_pose=True)
    one = LiveSession(
        QueueSource(), ReconstructionSettings(probe="linear", clip_px=(0,) * 4), grid=grid, synchronizer=trusted, longest_delay=None
    )
    yield one
    one.stop()


def test_whoever_waits_for_a_rest_wakes_when_no_frame_waits_any_more(session, monkeypatch):
    opened, insert, seen = threading.Event(), Reconstructor.insert, []
    session.prepare(LONG)
    assert session.wait_for_rest(0.001)  # nothing has come yet
    monkeypatch.setattr(Reconstructor, "insert", lambda self, frame: (opened.wait(LONG), insert(self, frame)))

    def wait() -> None:
        session.wait_for_rest(LONG)
        seen.append(session.statistics)

    waiting = threading.Thread(target=wait)
    waiting.start()
    session.start()
    for number in range(6):
        session._source.put(ImageMessage("Image_Reference", 0.05 * number, np.ones((8, 8), np.uint8), np.eye(4)))
    end = time.monotonic() + LONG
    while session.statistics.frames_received < 5 and time.monotonic() < end:
        time.sleep(0.005)
    assert not seen
    assert not session.wait_for_rest(0.0)
    opened.set()
    waiting.join(LONG)
    assert seen[0].waiting == 0
    assert seen[0].inserted >= 5


class Session:
    latest, pool = None, ThreadPoolExecutor()

    def wait_for_rest(self, timeout):
        time.sleep(0.001)
        return True


class Failing(Watch):
    """Fails at every frame."""

    def __init__(self, session):
        super().__init__(session)
        self.told = []
        self._start()

    def _look(self, frame):
        if frame is not None:
            raise ValueError("this frame cannot be looked at")
        return ()

    def _tell_problem(self, problem):
        self.told.append(problem)


def test_what_fails_at_every_frame_is_told_each_time_and_logged_once(caplog):
    session = Session()
    with caplog.at_level(logging.ERROR):
        watch = Failing(session)
        for number in range(3):
            session.latest = LiveFrame(np.zeros((2, 2), np.uint8), np.eye(4), number=number)
            end = time.monotonic() + LONG
            while len(watch.told) <= number and time.monotonic() < end:
                time.sleep(0.002)
        watch.stop()
    assert watch.told == ["this frame cannot be looked at"] * 3
    assert len([record for record in caplog.records if "beside a live scan" in record.message]) == 1
