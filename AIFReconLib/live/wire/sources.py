"""Where a live session takes its messages from: an OpenIGTLink client, or whoever puts messages into a queue."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from .message_queue import MessageQueue
from .messages import ImageMessage, StreamEvent, StreamMessage

CONNECTED = "connected"
"""The state of a source that can give messages."""

ENDED = "stopped"
"""The state of a source from which nothing more will come once `get` answers None."""


class SourceStatistics(Protocol):
    """What a session asks of a source's counters."""

    @property
    def dropped(self) -> int:
        """Messages that nobody took in time."""
        ...

    @property
    def dropped_images(self) -> int:
        """Images among them."""
        ...


class MessageSource(Protocol):
    """What a `LiveSession` needs of a source; `OpenIGTLinkClient` is one."""

    @property
    def state(self) -> str:
        """``connected``, ``stopped`` when nothing more will come, or another word for the user."""
        ...

    @property
    def statistics(self) -> SourceStatistics:
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


@dataclass(frozen=True)
class QueueStatistics:
    """Counters of a `QueueSource`."""

    dropped: int = 0
    dropped_images: int = 0


class QueueSource:
    """A source that the same program fills, as Slicer's nodes or a test do.

    Parameters
    ----------
    limit : int
        Messages that wait to be taken; beyond it the oldest are dropped and counted.
    byte_limit : int
        Bytes of pixels that wait to be taken.
    """

    def __init__(self, limit: int = 512, byte_limit: int = 256 * 2**20):
        self._queue = MessageQueue(limit, byte_limit)
        self._queue.open()
        self._devices: dict[str, tuple[str, ...]] = {}
        self._open = True

    @property
    def state(self) -> str:
        """``connected`` until `stop`."""
        return CONNECTED if self._open else ENDED

    @property
    def statistics(self) -> QueueStatistics:
        """How many messages were dropped, and images among them."""
        return QueueStatistics(self._queue.dropped, self._queue.dropped_images)

    def start(self) -> None:
        """Nothing: a queue takes messages from its making on."""

    def stop(self) -> None:
        """Take no more messages; those that wait can still be taken."""
        self._open = False
        self._queue.close()

    def put(self, message: StreamMessage) -> None:
        """Add a message; does nothing after `stop`."""
        if not isinstance(message, StreamEvent) and message.device not in self._devices:
            self._devices[message.device] = ("IMAGE" if isinstance(message, ImageMessage) else "TRANSFORM",)
        self._queue.put(message)

    def get(self, timeout: float | None = None) -> StreamMessage | None:
        """The oldest message; None if there is none within `timeout` s, or the source is stopped and empty."""
        return self._queue.get(timeout)

    def devices(self) -> dict[str, tuple[str, ...]]:
        """Names of the devices that messages were put for, with their types."""
        return dict(self._devices)
