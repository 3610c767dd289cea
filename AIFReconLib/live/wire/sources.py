"""Where a live session takes its messages from: a queue that an OpenIGTLink client fills, Slicer's nodes, or a test."""

from __future__ import annotations

import threading
import time
from collections import Counter, deque
from dataclasses import dataclass, field, replace

from .messages import ImageMessage, StreamEvent, StreamMessage, TransformMessage

CONNECTED = "connected"
"""The state of a source that can give messages."""

ENDED = "stopped"
"""The state of a source from which nothing more will come once `get` answers None."""

DEVICES = 1000
"""Devices that are counted by name; a server that makes up ever new names must not fill the memory."""

REPORT_INTERVAL = 1.0
"""Shortest time between two events that report dropped messages, s."""


@dataclass
class StreamStatistics:
    """What a source has counted since its start.

    Parameters
    ----------
    received : dict of (device, type) to int
        Messages that arrived whole, with a right checksum, used or not. Beyond 1000 devices they are counted as ``(others)``.
    refused : int
        Those among them that cannot be used: 3D images, impossible contents.
    damaged : int
        Messages with a wrong checksum.
    reconnects : int
        Connections after the first one.
    refusals : dict of str to str
        Why messages were left out, in a sentence: the last one by its type.
    dropped : int
        Messages that nobody got: newer ones pushed them out of the queue, or the source was stopped.
    late : int
        Of the dropped: those that came after the end, which nobody waits for.
    dropped_images : int
        Images among them.
    """

    received: Counter[tuple[str, str]] = field(default_factory=Counter)
    refused: int = 0
    damaged: int = 0
    reconnects: int = 0
    refusals: dict[str, str] = field(default_factory=dict)
    dropped: int = 0
    dropped_images: int = 0
    late: int = 0

    def count(self, kind: str, device: str | None = None) -> int:
        """Messages received of a type, of one device or of all."""
        return sum(n for (name, type_), n in self.received.items() if type_ == kind and device in (None, name))


class QueueSource:
    """A source that the same program fills; whoever has a connection of its own derives from it, as `OpenIGTLinkClient` does.

    Bounded in number and in bytes. When full, the oldest message goes: a live view must stay current.

    Parameters
    ----------
    limit : int
        Messages that wait to be taken; beyond it the oldest are dropped and counted.
    byte_limit : int
        Bytes of pixels and of metadata that wait to be taken.

    Attributes
    ----------
    replaced : int
        Images that whoever puts them has replaced by newer ones before they could be put: they were dropped, too.
    """

    def __init__(self, limit: int = 512, byte_limit: int = 256 * 2**20):
        self._limit, self._byte_limit = limit, byte_limit
        self._changed = threading.Condition()
        self._messages: deque[StreamMessage] = deque()
        self._bytes = self._reported = self.replaced = 0
        self._report_time = -REPORT_INTERVAL
        self._counts = StreamStatistics()
        self._open, self._state = True, CONNECTED

    @property
    def state(self) -> str:
        """``connected`` or another word for the user, and ``stopped`` after `stop`."""
        return self._state if self._open else ENDED

    @property
    def statistics(self) -> StreamStatistics:
        """A copy of all counters since the start."""
        with self._changed:
            counts = self._counts
            dropped, images = counts.dropped + self.replaced, counts.dropped_images + self.replaced
            received, refusals = counts.received.copy(), counts.refusals.copy()
            return replace(counts, dropped=dropped, dropped_images=images, received=received, refusals=refusals)

    def devices(self) -> dict[str, tuple[str, ...]]:
        """Names of the devices seen, each with the types of its messages, in order of appearance."""
        seen: dict[str, tuple[str, ...]] = {}
        for device, kind in self.statistics.received:
            seen[device] = (*seen.get(device, ()), kind)
        return seen

    def start(self) -> None:
        """Nothing: a queue takes messages from its making on."""

    def stop(self) -> None:
        """Take no more messages; those that wait can still be taken, and nobody waits any longer."""
        with self._changed:
            self._open = False
            self._changed.notify_all()

    def put(self, message: StreamMessage) -> None:
        """Add a message; one that comes after `stop` is dropped."""
        if self._open and not isinstance(message, StreamEvent):
            self._count(message.device, "IMAGE" if isinstance(message, ImageMessage) else "TRANSFORM")
        self._queue(message)

    def get(self, timeout: float | None = None) -> StreamMessage | None:
        """The oldest message; None if there is none within `timeout` s (None: without limit), or the source is stopped and empty."""
        with self._changed:
            self._changed.wait_for(lambda: self._messages or not self._open, timeout)
            if not self._messages:
                return None
            now = time.monotonic()
            if self._counts.dropped > self._reported and now - self._report_time >= REPORT_INTERVAL:
                count, self._reported, self._report_time = self._counts.dropped - self._reported, self._counts.dropped, now
                detail = f"{count} messages were left out, the oldest first: they arrive faster than they are worked on."
                return StreamEvent("dropped", detail, now)
            message = self._messages.popleft()
            self._bytes -= _size(message)
            return message

    def _count(self, device: str, kind: str) -> None:
        with self._changed:
            received = self._counts.received
            received[(device, kind) if (device, kind) in received or len(received) < DEVICES else ("(others)", "(others)")] += 1

    def _queue(self, message: StreamMessage) -> None:
        with self._changed:
            if not self._open:
                self._counts.late += not isinstance(message, StreamEvent)
                self._count_dropped(message)
                return
            self._messages.append(message)
            self._bytes += _size(message)
            while len(self._messages) > self._limit or (self._bytes > self._byte_limit and len(self._messages) > 1):
                # Events stay as long as there is anything else: they tell what happened to the rest
                number = next((n for n, each in enumerate(self._messages) if not isinstance(each, StreamEvent)), 0)
                oldest = self._messages[number]
                del self._messages[number]
                self._bytes -= _size(oldest)
                self._count_dropped(oldest)
            self._changed.notify()

    def _count_dropped(self, message: StreamMessage) -> None:
        self._counts.dropped += not isinstance(message, StreamEvent)
        self._counts.dropped_images += isinstance(message, ImageMessage)


def _size(message: StreamMessage) -> int:
    """Bytes of pixels and metadata, which may both be large."""
    if not isinstance(message, ImageMessage | TransformMessage):
        return 0
    pixels = message.image.nbytes if isinstance(message, ImageMessage) else 0
    return pixels + sum(len(key) + len(value) for key, value in message.metadata.items())
