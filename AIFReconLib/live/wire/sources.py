"""Where a live session takes its messages from: an OpenIGTLink client, or whoever puts messages into a queue."""

from __future__ import annotations

import threading
import time
from collections import deque
from dataclasses import dataclass, field
from typing import Protocol

from .messages import ImageMessage, StreamEvent, StreamMessage, TransformMessage

CONNECTED = "connected"
"""The state of a source that can give messages."""

ENDED = "stopped"
"""The state of a source from which nothing more will come once `get` answers None."""

DEVICES = 1000
"""Devices that are listed by name; a server that makes up ever new names must not fill the memory."""

REPORT_INTERVAL = 1.0
"""Shortest time between two events that report dropped messages, s."""


@dataclass(frozen=True)
class StreamStatistics:
    """What a source has counted since its start. One that has no connection tells only what it dropped.

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

    received: dict[tuple[str, str], int] = field(default_factory=dict)
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


class MessageSource(Protocol):
    """What a `LiveSession` needs of a source; `OpenIGTLinkClient` is one."""

    @property
    def state(self) -> str:
        """``connected``, ``stopped`` when nothing more will come, or another word for the user."""
        ...

    @property
    def statistics(self) -> StreamStatistics:
        """Counters."""
        ...

    def start(self) -> None:
        """Begin to receive."""
        ...

    def stop(self) -> None:
        """Receive no more. What was received can still be taken."""
        ...

    def get(self, timeout: float | None = None) -> StreamMessage | None:
        """The next message in order of arrival; None if there is none within `timeout` s, or the source has ended and is empty."""
        ...

    def devices(self) -> dict[str, tuple[str, ...]]:
        """Names of the devices seen, each with the types of its messages."""
        ...


class QueueSource:
    """A source that the same program fills, as Slicer's nodes or a test do.

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
        self._begin_anew()

    def _begin_anew(self, is_open: bool = True) -> None:
        with self._changed:
            self._messages: deque[StreamMessage] = deque()
            self._devices: dict[str, tuple[str, ...]] = {}
            self._bytes = self._late = self._dropped = self._dropped_images = self._reported = 0
            self._report_time = -REPORT_INTERVAL
            self._open, self.replaced = is_open, 0

    @property
    def state(self) -> str:
        """``connected`` until `stop`."""
        return CONNECTED if self._open else ENDED

    @property
    def statistics(self) -> StreamStatistics:
        """How many messages were dropped, and images among them."""
        with self._changed:
            dropped, images = self._dropped + self.replaced, self._dropped_images + self.replaced
            return StreamStatistics(dropped=dropped, dropped_images=images, late=self._late)

    def start(self) -> None:
        """Nothing: a queue takes messages from its making on."""

    def stop(self) -> None:
        """Take no more messages; those that wait can still be taken, and nobody waits any longer."""
        with self._changed:
            self._open = False
            self._changed.notify_all()

    def put(self, message: StreamMessage) -> None:
        """Add a message; one that comes after `stop` is dropped."""
        with self._changed:
            if not self._open:
                self._late += not isinstance(message, StreamEvent)
                self._count_dropped(message)
                return
            if isinstance(message, ImageMessage | TransformMessage) and len(self._devices) < DEVICES:
                self._devices.setdefault(message.device, ("IMAGE" if isinstance(message, ImageMessage) else "TRANSFORM",))
            self._messages.append(message)
            self._bytes += _size(message)
            while len(self._messages) > self._limit or (self._bytes > self._byte_limit and len(self._messages) > 1):
                self._drop_oldest()
            self._changed.notify()

    def get(self, timeout: float | None = None) -> StreamMessage | None:
        """The oldest message; None if there is none within `timeout` s (None: without limit), or the source is stopped and empty."""
        with self._changed:
            self._changed.wait_for(lambda: self._messages or not self._open, timeout)
            if not self._messages:
                return None
            now = time.monotonic()
            if self._dropped > self._reported and now - self._report_time >= REPORT_INTERVAL:
                count, self._reported, self._report_time = self._dropped - self._reported, self._dropped, now
                detail = f"{count} messages were left out, the oldest first: they arrive faster than they are worked on."
                return StreamEvent("dropped", detail, now)
            message = self._messages.popleft()
            self._bytes -= _size(message)
            return message

    def devices(self) -> dict[str, tuple[str, ...]]:
        """Names of the devices that messages were put for, with their types."""
        return dict(self._devices)

    def _drop_oldest(self) -> None:
        """The oldest message goes; events stay as long as there is anything else, because they tell what happened to the rest."""
        number = next((n for n, message in enumerate(self._messages) if not isinstance(message, StreamEvent)), 0)
        message = self._messages[number]
        self._bytes -= _size(message)
        del self._messages[number]
        self._count_dropped(message)

    def _count_dropped(self, message: StreamMessage) -> None:
        self._dropped += not isinstance(message, StreamEvent)
        self._dropped_images += isinstance(message, ImageMessage)


def _size(message: StreamMessage) -> int:
    """Bytes of pixels and metadata, which may both be large."""
    if not isinstance(message, ImageMessage | TransformMessage):
        return 0
    pixels = message.image.nbytes if isinstance(message, ImageMessage) else 0
    return pixels + sum(len(key) + len(value) for key, value in message.metadata.items())
