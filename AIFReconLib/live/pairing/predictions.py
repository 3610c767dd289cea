"""Predictions of bone that another program streams while it scans, taken out of the stream before anyone takes them for frames."""

from __future__ import annotations

from collections import deque

from ..wire.messages import ImageMessage, StreamMessage
from ..wire.sources import MessageSource, SourceStatistics

MOST_WAITING = 64
"""Predictions that wait for somebody to look at them; then the oldest are let go and counted."""


class PredictionSource:
    """A source without the images of one device, which are kept aside.

    Parameters
    ----------
    source : MessageSource
    device : str
        Name of the IMAGE device that sends predictions, with the time stamps of the images that they were made of.
    """

    def __init__(self, source: MessageSource, device: str):
        self._source, self._device = source, device
        self._waiting: deque[ImageMessage] = deque()
        self.received = 0
        self.let_go = 0

    def predictions(self) -> list[ImageMessage]:
        """What has come since this was asked last."""
        found = []
        while self._waiting:
            found.append(self._waiting.popleft())
        return found

    @property
    def state(self) -> str:
        """See `MessageSource`."""
        return self._source.state

    @property
    def statistics(self) -> SourceStatistics:
        """See `MessageSource`."""
        return self._source.statistics

    def start(self) -> None:
        """See `MessageSource`."""
        self._source.start()

    def stop(self) -> None:
        """See `MessageSource`."""
        self._source.stop()

    def devices(self) -> dict[str, tuple[str, ...]]:
        """The other devices: this one sends no frames."""
        return {name: types for name, types in self._source.devices().items() if name != self._device}

    def get(self, timeout: float | None = None) -> StreamMessage | None:
        """The next message that is no prediction; None if there is none within `timeout` s."""
        while True:
            message = self._source.get(timeout)
            if not isinstance(message, ImageMessage) or message.device != self._device:
                return message
            self.received += 1
            if len(self._waiting) >= MOST_WAITING:
                self._waiting.popleft()
                self.let_go += 1
            self._waiting.append(message)
            timeout = 0.0
