"""A session in which nothing is inserted, for watches of guidance: a test shows it one frame after the other."""

from __future__ import annotations

import time
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from waiting import until

from AIFReconLib.effective_settings import Imaging
from AIFReconLib.guidance.probe import ProbeImages
from AIFReconLib.live.pairing.synchronizer import LiveFrame
from AIFReconLib.live.session.guidance_watch import GuidanceWatch

IMAGES = ProbeImages.simulated()


class IdleSession:
    """What a watch asks of a session: the newest frame, and when to work."""

    latest: LiveFrame | None = None
    grid = None
    in_place: list[object] = []
    pool = ThreadPoolExecutor()

    def imaging(self) -> Imaging:
        """What is known of the images."""
        return Imaging(IMAGES.region, IMAGES.geometry)

    def wait_for_rest(self, timeout: float) -> bool:
        """There is always time."""
        time.sleep(0.001)
        return True


def has_looked_at(watch: GuidanceWatch, number: int) -> bool:
    """Whether the watch has looked at the frame of this number last."""
    return watch.looked_at == number


def show(session: IdleSession, watch: GuidanceWatch, frames: Iterable[LiveFrame]) -> None:
    """These frames, each until the watch has looked at it."""
    for frame in frames:
        session.latest = frame
        assert until(partial(has_looked_at, watch, frame.number))
