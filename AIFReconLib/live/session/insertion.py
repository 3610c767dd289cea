"""The thread that puts frames into the volume, and the volume that others look at meanwhile."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ...arrays import NumberType
from ...bone.map import BoneMap
from ...compounding.methods.table import method_named
from ...compounding.needs import bone_on_grid
from ...compounding.reconstructor import Reconstructor
from ...compounding.state import Reconstruction
from ...effective_settings import BEFORE_FRAMES, Imaging, ReconstructorParts
from ...geometry.volume import VoxelGrid
from ...imaging.beams import LINEAR, ProbeGeometry
from ...imaging.region import ImageRegion
from ...progress import Progress
from ...recipe.recipe import Recipe
from ...sweep.frames import TrackedFrame
from ..pairing.synchronizer import LiveFrame
from .statistics import FrameCounters

logger = logging.getLogger(__name__)

TOO_SLOW = "skipped to keep up"
OTHER_SIZE = "image of another size or type"
AFTER_ERROR = "not inserted after an error"
WHILE_PAUSED = "paused"
LEFT_OUT = "left out, as every N-th frame is used"

MOST_WAITING_BYTES = 512 * 2**20
"""Pixels that wait to be inserted at most, whatever their number."""

WARM_UP = 2
"""Insertions that tell nothing of the speed: engines are compiled and tables built."""


class Inserter:
    """Inserts frames in their order on a thread of its own.

    Parameters
    ----------
    settings : Recipe
        With everything resolved.
    longest_delay : float or None, s
        Leave frames out when those that wait will take longer than this; None: never, and `put` waits instead.
    sign : callable
        What makes a result one whose volumes say where they come from.
    parts : ReconstructorParts
        What else the configuration gives.

    Attributes
    ----------
    counters : FrameCounters
        By which frames are counted; others after a restart.
    """

    def __init__(
        self,
        settings: Recipe,
        bone: BoneMap | None,
        longest_delay: float | None,
        sign: Callable[[Reconstruction, Imaging], Reconstruction],
        parts: ReconstructorParts,
    ):
        self._settings, self._bone, self._sign, self._parts = settings.left_open(*BEFORE_FRAMES), bone, sign, parts
        self.counters = FrameCounters()
        self._imaging = Imaging(ImageRegion(), None)
        self.error: Exception | None = None
        self._longest_delay = longest_delay
        self._changed = threading.Condition()
        self._waiting_frames = self._waiting_bytes = self._rests = 0
        self._closed = False
        self._warm: Future[None] | None = None
        self._volume = threading.Lock()
        self._turnstile = threading.Lock()
        self._reconstructor: Reconstructor | None = None
        self._notes: tuple[str, ...] = ()
        self._begin: Callable[[], None] | None = None
        self._image_like: tuple[tuple[int, ...], NumberType] | None = None
        self._insertions = 0
        self._seconds_per_frame = 0.0
        self._ready = 0.0
        self._thread = ThreadPoolExecutor(1, "aifrecon live insertion")

    def start(self) -> Future[None]:
        """Let the engine load and compile, before all else; when that is done."""
        self._warm = self._warm or self._thread.submit(self._do, self._warm_up)
        return self._warm

    def close(self) -> None:
        """Insert what waits, then end. Returns when that is done."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        self._thread.shutdown()

    def begin(self, grid: VoxelGrid, imaging: Callable[[], Imaging]) -> Future[None] | None:
        """Make an empty volume before any frame that is put from now on; when that is done.

        `imaging` is called on the thread, for every volume that is begun.
        """
        self._begin = partial(self._make, grid, imaging)
        return self._submit(self._begin)

    @property
    def bone_on_grid(self) -> bool:
        """Whether the next volume keeps its bone map on every voxel."""
        bone = self._bone
        return bone_on_grid(self._settings.method_for(bone is not None), self._settings, bone is not None and bone.grows)

    def use_bone(self, bone: BoneMap | None) -> None:
        """The bone map of the next volume that is begun."""
        self._bone = bone

    def restart(self) -> None:
        """Empty the volume, and forget the frames that wait."""
        with self._changed:
            self.counters = FrameCounters()
            self._waiting_frames = self._waiting_bytes = 0
            self._changed.notify_all()
        if self._begin is not None:
            self._submit(self._begin)

    def beside(self) -> Reconstructor | None:
        """An empty volume as the one that grows, to be filled beside it; None where there is none."""
        with self._volume:
            growing, imaging = self._reconstructor, self._imaging
        return None if growing is None else self._empty(growing.grid, growing.settings, imaging)

    def put_in_place(self, filled: Reconstructor, frames: list[LiveFrame], notes: tuple[str, ...]) -> None:
        """Let a volume that was filled beside the one that grows take its place, and these frames enter it, before any that is put from now
        on; the notes are said of it."""
        self._submit(self._replace, filled, frames, notes, self.counters)

    def put(self, frame: LiveFrame, live: bool = True) -> None:
        """Hand over a frame, usable or not.

        One that has not just come (`live`) is never left out, and its latency tells nothing.
        """
        with self._changed:
            if self._longest_delay is None or not live:
                self._changed.wait_for(lambda: self._waiting_bytes < MOST_WAITING_BYTES or self._closed)
            elif frame.status == "OK":
                # One is left out, one inserted: whatever the speed, those that enter lie evenly in time
                delay = self._waiting_frames * self._seconds_per_frame
                if delay > self._longest_delay or self._waiting_bytes + _bytes(frame) > MOST_WAITING_BYTES:
                    frame = replace(frame, status=TOO_SLOW)
            if frame.status != "OK":
                frame = replace(frame, image=None)
            self._waiting_frames += frame.status == "OK"
            self._waiting_bytes += _bytes(frame)
            self._submit(self._insert, frame, live, self.counters)

    def wait_for_rest(self, timeout: float) -> bool:
        """Return when next a frame was inserted and none waits, or after `timeout`, s, with 0 at once; whether none waits."""
        with self._changed:
            rests = self._rests
            if timeout > 0.0:
                self._changed.wait_for(lambda: self._rests != rests, timeout)
            return not self._waiting_frames

    def snapshot(self, progress: Progress | None = None) -> Reconstruction | None:
        """The volume as it is now, holes filled; None before there is one. Frames wait only while the voxels are copied."""
        with self._turnstile, self._volume:
            if self._reconstructor is None:
                return None
            make, imaging = self._reconstructor.capture(), self._imaging
        return self._signed(make(progress), imaging)

    def finish(self, progress: Progress | None = None) -> Reconstruction | None:
        """The final volume, after `close`; it can be asked for once."""
        with self._volume:
            if self._reconstructor is None:
                return None
            reconstructor, self._reconstructor = self._reconstructor, None
        return self._signed(reconstructor.finish(progress), self._imaging)

    def _signed(self, result: Reconstruction, imaging: Imaging) -> Reconstruction:
        result = self._sign(result, imaging)
        return replace(result, messages=(*imaging.notes, *self._parts.notes, *self._notes, *result.messages))

    # ---- the thread

    def _warm_up(self) -> None:
        """Let the engine load and compile on a volume of a few voxels, so that the first frames of the scan need not wait for it."""
        image = np.ones((8, 8), np.uint8)
        # Another engine takes pixels that count unequally
        importance = None if self._parts.importance is None else image.astype(np.float32)
        try:
            grid = VoxelGrid.from_spacing((0.0, 0.0, 0.0), (8, 8, 8), 1.0)
            tiny = Reconstructor(grid, self._settings, self._bone, probe=ProbeGeometry(LINEAR), importance=importance)
            tiny.insert(TrackedFrame(image, np.eye(4)))
            # The first snapshot would compile while frames wait
            tiny.reconstruction()
        except Exception:  # what is wrong shows with the real volume, where it is reported
            logger.debug("The engine could not be warmed up", exc_info=True)

    def _make(self, grid: VoxelGrid, imaging: Callable[[], Imaging]) -> None:
        known = imaging()
        judges = method_named(self._settings.method_for(self._bone is not None)).needs_shadows
        settings = replace(self._settings, gray_levels=known.gray_levels.landmarks) if judges else self._settings
        reconstructor = self._empty(grid, settings, known)
        with self._volume:
            self._reconstructor, self._image_like, self._insertions = reconstructor, None, 0
            self._imaging, self._notes = known, ()
        self.error, self._ready = None, time.monotonic()

    def _empty(self, grid: VoxelGrid, settings: Recipe, imaging: Imaging) -> Reconstructor:
        return Reconstructor(
            grid,
            settings,
            self._bone,
            probe=imaging.probe,
            region=imaging.region,
            threads=self._parts.threads,
            importance=self._parts.importance,
            holes=self._parts.holes,
            fixed_point=self._parts.fixed_point,
        )

    def _replace(self, filled: Reconstructor, frames: list[LiveFrame], notes: tuple[str, ...], counters: FrameCounters) -> None:
        if counters is self.counters:
            filled.insert(frames)
            with self._volume:
                self._reconstructor, self._notes = filled, notes

    def _submit(self, work: Callable[..., None], *arguments: Any) -> Future[None] | None:
        if self._closed:
            return None
        self.start()
        return self._thread.submit(self._do, work, *arguments)

    def _do(self, work: Callable[..., None], *arguments: Any) -> None:
        try:
            work(*arguments)
        except Exception as error:  # kept and reported: the volume so far, and the recording, must survive it
            self.error = error
            logger.exception("The reconstruction of a live scan stopped")

    def _insert(self, frame: LiveFrame, live: bool, counters: FrameCounters) -> None:
        if counters is not self.counters:
            return
        reason: str | None = AFTER_ERROR
        try:
            reason = self._why_not_inserted(frame)
        finally:
            if reason is not None:
                counters.skip(reason)
            else:
                # What waited for the volume to be made tells nothing of the speed
                counters.insert(time.monotonic() - frame.received if live and frame.received >= self._ready else None)
            with self._changed:
                if counters is self.counters:
                    self._waiting_frames -= frame.status == "OK"
                    self._waiting_bytes -= _bytes(frame)
                self._rests += not self._waiting_frames
                self._changed.notify_all()

    def _why_not_inserted(self, frame: LiveFrame) -> str | None:
        """Insert a frame; why it did not enter, None when it did."""
        is_usable = frame.status == "OK"
        if is_usable:
            image, _ = frame.placed()
            self._image_like = self._image_like or (image.shape, image.dtype)
            if self.error is not None or self._reconstructor is None:
                frame = replace(frame, image=None, status=AFTER_ERROR)
            elif self._image_like != (image.shape, image.dtype):
                frame = replace(frame, image=None, status=OTHER_SIZE)
        with self._turnstile:
            # Whoever wants the volume stands here, and comes next
            pass
        started = time.monotonic()
        with self._volume:
            if self._reconstructor is None:
                return frame.status
            counts = self._reconstructor.counts
            before = counts.inserted
            self._reconstructor.insert(frame)
        self._insertions += is_usable
        if self._insertions > WARM_UP and is_usable:
            last = time.monotonic() - started
            self._seconds_per_frame = 0.9 * (self._seconds_per_frame or last) + 0.1 * last
        if counts.inserted > before:
            return None
        return next((reason for reason, numbers in counts.skipped.items() if numbers[-1] == frame.number), frame.status)


def _bytes(frame: TrackedFrame) -> int:
    return 0 if frame.image is None else frame.image.nbytes
