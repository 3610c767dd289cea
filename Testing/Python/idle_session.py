"""For guidance: lit images of the simulated probe, and a session in which nothing is inserted, shown one frame after the other."""

from __future__ import annotations

import time
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
from waiting import until

from AIFReconLib.effective_settings import Imaging, imaging_fields
from AIFReconLib.guidance.probe import ProbeImages
from AIFReconLib.live.pairing.synchronizer import LiveFrame
from AIFReconLib.live.session.guidance_watch import GuidanceWatch
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.sweep.frames import TrackedSequence

IMAGES = ProbeImages.simulated()
RECIPE = Recipe(**imaging_fields(IMAGES.region, IMAGES.geometry))
LIT = np.full(IMAGES.frame_size[::-1], 120, np.uint8)


def sweep_at(poses, image=LIT) -> TrackedSequence:
    """A recording of one image at these poses."""
    return TrackedSequence.from_arrays(np.stack([image] * len(poses)), np.stack(poses), np.arange(len(poses)) * 0.1)


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
