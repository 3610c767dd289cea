"""A session in which nothing is inserted, for watches of guidance: a test shows it one frame after the other."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor

from AIFReconLib.effective_settings import Imaging
from AIFReconLib.guidance.probe import ProbeImages

IMAGES = ProbeImages.simulated()


class IdleSession:
    """What a watch asks of a session: the newest frame, and when to work."""

    latest = grid = None
    in_place: list[object] = []
    pool = ThreadPoolExecutor()

    def imaging(self) -> Imaging:
        """What is known of the images."""
        return Imaging(IMAGES.region, IMAGES.geometry)

    def wait_for_rest(self, timeout: float) -> bool:
        """There is always time."""
        time.sleep(0.001)
        return True
