"""What a live session tells of itself: frames in and where they went, rate, latency, and the tracking in words."""

from __future__ import annotations

import threading
import time
from collections import Counter, deque
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...message import listed
from ..pairing.placement import stream_name
from ..wire.messages import StreamEvent, StreamMessage, TransformMessage

RATE_WINDOW = 2.0
"""s over which the frame rate is counted."""

LATENCIES = 4096
"""Frames over which latency is judged: the last two minutes or more."""

TROUBLE_SHOWN = 10.0
"""s that an event of a stream that goes on is told."""

SILENCE = 1.0
"""s without an image, or without a pose, after which they have stopped."""

TRACKED = "tracked"
NO_IMAGES = "no images"

_NO_TOOLS = ("Tracker", "Image", "World")

Spans = tuple[tuple[int, int | None], ...]
"""Numbers of frames: from each first one until before each second, or all that follow."""

ALL: Spans = ((0, None),)


@dataclass(frozen=True)
class LiveStatistics:
    """A snapshot of a session.

    Parameters
    ----------
    phase : str
        ``scouting``, ``looking`` (at the first images, to recognize the probe), ``reconstructing``, ``paused``, ``failed`` or ``stopped``.
    connection : str
        The state of the source.
    tracking : str
        ``tracked``, or in words what is wrong with the latest frame: ``Reference not visible``.
    frames_received, inserted, waiting : int
        Since the start or the last reset: received = inserted + skipped + waiting.
    skipped : dict of str to int
        Frames that were not inserted, by reason.
    frame_rate : float, frames/s
        Of what is received.
    latency_p50, latency_p99 : float, s
        From the arrival of an image to its voxels; NaN before the first.
    dropped : int
        Messages that the source had to drop.
    dropped_images : int
        Images among them, which no other number counts.
    repeated : int
        Images that the server sent again after a reconnection; they are no frames.
    other_images : int
        Images of other devices; they are no frames either.
    recorded : int
        Frames in the recording.
    trouble : str or None
        One sentence on the last thing that went wrong with the stream; None while all is well.
    note : str or None
        What makes the places of frames doubtful although all is well.
    images_stopped, poses_stopped : float or None, s
        How long ago the last image came, and the last message of a pose, where they have come and do no more.
    """

    phase: str
    connection: str
    tracking: str
    frames_received: int
    inserted: int
    waiting: int
    skipped: dict[str, int] = field(default_factory=dict)
    frame_rate: float = 0.0
    latency_p50: float = float("nan")
    latency_p99: float = float("nan")
    dropped: int = 0
    dropped_images: int = 0
    repeated: int = 0
    other_images: int = 0
    recorded: int = 0
    recording_failure: str | None = None
    trouble: str | None = None
    note: str | None = None
    images_stopped: float | None = None
    poses_stopped: float | None = None

    @property
    def frames_skipped(self) -> int:
        """Frames that were not inserted, for whatever reason."""
        return sum(self.skipped.values())


class FrameCounters:
    """Counts frames since the start or a reset; every method may be called from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._received = self._inserted = 0
        self._skipped: Counter[str] = Counter()
        self._arrivals: deque[float] = deque(maxlen=1024)
        self._latencies: deque[float] = deque(maxlen=LATENCIES)

    def receive(self, received: float) -> None:
        """Count a frame that arrived at `received`, s of `time.monotonic`."""
        with self._lock:
            self._received += 1
            self._arrivals.append(received)

    def insert(self, latency: float | None) -> None:
        """Count an inserted frame; `latency` in s, None where it tells nothing."""
        with self._lock:
            self._inserted += 1
            if latency is not None:
                self._latencies.append(latency)

    def skip(self, reason: str) -> None:
        """Count a frame that was not inserted."""
        with self._lock:
            self._skipped[reason] += 1

    def counts(self, now: float) -> dict[str, Any]:
        """The fields of `LiveStatistics` that are counted here, at the time `now`, s of `time.monotonic`."""
        with self._lock:
            recent = [time for time in self._arrivals if now - time <= RATE_WINDOW]
            span = recent[-1] - recent[0] if len(recent) > 1 else 0.0
            p50, p99 = np.percentile(self._latencies, (50, 99)) if self._latencies else (np.nan, np.nan)
            return {
                "frames_received": self._received,
                "inserted": self._inserted,
                "skipped": dict(self._skipped.most_common()),
                "waiting": self._received - self._inserted - self._skipped.total(),
                "frame_rate": (len(recent) - 1) / span if span > 0 else 0.0,
                "latency_p50": float(p50),
                "latency_p99": float(p99),
            }


def tracking_words(status: str, reference: str) -> str:
    """What a frame's status means to the person at the probe: ``ProbeToTracker OUT_OF_VIEW`` is ``Probe not seen by tracker``."""
    if status == "OK":
        return TRACKED
    word, _, what = status.partition(" ")
    name = stream_name(word)
    if name is None:
        return status
    if what == "stale":
        return f"{name}: too few positions"
    if what not in ("MISSING", "OUT_OF_VIEW", "OUT_OF_VOLUME", "INVALID", "REQ_TIMEOUT", "UNKNOWN"):
        return status
    tools = [frame for frame in (name.source, name.target) if frame not in _NO_TOOLS]
    if name.source == "Image" and tools == [reference]:
        tools = ["Probe", reference]
    return f"{listed(tools, ' or ') or name} not seen by tracker"


class StreamHealth:
    """What a stream last complained of, and when its poses came last."""

    def __init__(self) -> None:
        self._what, self._when = "", 0.0
        self._posed: float | None = None

    def note(self, message: StreamMessage | None) -> None:
        """Remember what a message tells of the stream."""
        if isinstance(message, StreamEvent):
            self._what, self._when = "" if message.kind == "connected" else message.detail, time.monotonic()
        elif isinstance(message, TransformMessage):
            self._posed = message.received

    def trouble(self, now: float, lasts: bool) -> str | None:
        """What it complained of, while that lasts or was a moment ago; `now` in s."""
        return self._what if self._what and (lasts or now - self._when < TROUBLE_SHOWN) else None

    def stopped(self, now: float, imaged: float | None) -> tuple[float | None, float | None]:
        """How long ago the last image and the last pose came, where they come no more; `imaged` is when that image did."""
        images, poses = (None if came is None or now - came <= SILENCE else now - came for came in (imaged, self._posed))
        return images, poses
