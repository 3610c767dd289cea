"""What lies between the thread that receives and the one that works: the newest messages, and a count of those that had to go."""

from __future__ import annotations

import threading
import time
from collections import deque

from .messages import ImageMessage, StatusMessage, StreamEvent, StreamMessage, TransformMessage

REPORT_INTERVAL = 1.0
"""Shortest time between two events that report dropped messages, s."""


class MessageQueue:
    """Bounded in number and in bytes. When full, the oldest message goes: a live view must stay current.

    Parameters
    ----------
    limit : int
        Messages.
    byte_limit : int
        Bytes of pixels and of metadata.
    """

    def __init__(self, limit: int, byte_limit: int):
        self._limit = limit
        self._byte_limit = byte_limit
        self._changed = threading.Condition()
        self._messages: deque[StreamMessage] = deque()
        self._bytes = 0
        self._dropped = 0
        self._dropped_images = 0
        self._reported = 0
        self._report_time = -REPORT_INTERVAL
        self._open = False

    @property
    def dropped(self) -> int:
        """Messages that were pushed out since it was opened."""
        with self._changed:
            return self._dropped

    @property
    def dropped_images(self) -> int:
        """Images among them: frames that nobody has seen."""
        with self._changed:
            return self._dropped_images

    def open(self) -> None:
        """Begin anew: empty, nothing dropped."""
        with self._changed:
            self._messages.clear()
            self._bytes = self._dropped = self._dropped_images = self._reported = 0
            self._report_time = -REPORT_INTERVAL
            self._open = True

    def close(self) -> None:
        """Take no more; what is there can still be taken out, and nobody waits any longer."""
        with self._changed:
            self._open = False
            self._changed.notify_all()

    def put(self, message: StreamMessage) -> bool:
        """Add a message; once closed it is not taken, and the answer is False."""
        with self._changed:
            if not self._open:
                return False
            self._messages.append(message)
            self._bytes += _size(message)
            while len(self._messages) > self._limit or (self._bytes > self._byte_limit and len(self._messages) > 1):
                self._drop_oldest()
            self._changed.notify()
            return True

    def get(self, timeout: float | None) -> StreamMessage | None:
        """The oldest message; None if there is none within `timeout` s (None: without limit) or the queue is closed."""
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

    def _drop_oldest(self) -> None:
        """The oldest message goes; events stay as long as there is anything else, because they tell what happened to the rest."""
        place = next((n for n, message in enumerate(self._messages) if not isinstance(message, StreamEvent)), 0)
        message = self._messages[place]
        self._bytes -= _size(message)
        del self._messages[place]
        self._dropped += 1
        self._dropped_images += isinstance(message, ImageMessage)


def _size(message: StreamMessage) -> int:
    """Bytes of pixels and texts, which may both be large."""
    pixels = message.image.nbytes if isinstance(message, ImageMessage) else 0
    if isinstance(message, ImageMessage | TransformMessage):
        return pixels + sum(len(key) + len(value) for key, value in message.metadata.items())
    return pixels + len(message.text) if isinstance(message, StatusMessage) else pixels
