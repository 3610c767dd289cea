"""What a client has seen so far: a snapshot, and the counters behind it."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TypeVar

from .messages import ImageMessage, StreamEvent, StreamMessage

DEVICES = 1000
"""Devices that are listed by name; a server that makes up ever new names must not fill the memory."""

OTHERS = "(others)"

Key = TypeVar("Key", str, tuple[str, str])


@dataclass(frozen=True)
class StreamStatistics:
    """A snapshot of a client's counters, from its start on, over all connections.

    Parameters
    ----------
    received : dict of (device, type) to int
        Messages that arrived whole, with a right checksum, used or not. Beyond 1000 devices they are counted as ``(others)``.
    unused : dict of str to int
        Those among them of types that no reconstruction needs, by type.
    refused : int
        Those among them that cannot be used: 3D images, impossible contents.
    refused_sizes : int
        Headers that declared more than the size limit.
    bad_crc : int
        Messages with a wrong checksum.
    resyncs : int
        How often the next message was found again after damage.
    skipped_bytes : int
        Bytes that belong to no message.
    dropped : int
        Messages that nobody got: newer ones pushed them out of the queue, or the client was stopped.
    dropped_images : int
        Images among them.
    reconnects : int
        Connections after the first one.
    received_bytes : int
    last_message_age : float or None, s
        Since the last whole message; None before the first.
    refusals : dict of str to str
        Why messages were left out, in a sentence: the last one by its type, the last damage as ``checksum``, ``size`` or ``header``.
    """

    received: dict[tuple[str, str], int] = field(default_factory=dict)
    unused: dict[str, int] = field(default_factory=dict)
    refused: int = 0
    refused_sizes: int = 0
    bad_crc: int = 0
    resyncs: int = 0
    skipped_bytes: int = 0
    dropped: int = 0
    dropped_images: int = 0
    reconnects: int = 0
    received_bytes: int = 0
    last_message_age: float | None = None
    refusals: dict[str, str] = field(default_factory=dict)

    def count(self, kind: str, device: str | None = None) -> int:
        """Messages received of a type, of one device or of all."""
        return sum(n for (name, type_), n in self.received.items() if type_ == kind and device in (None, name))


class Counters:
    """The changing side of `StreamStatistics`; whoever holds it guards it."""

    def __init__(self) -> None:
        self.received: Counter[tuple[str, str]] = Counter()
        self.unused: Counter[str] = Counter()
        self.refused = 0
        self.refused_sizes = 0
        self.bad_crc = 0
        self.resyncs = 0
        self.skipped_bytes = 0
        self.discarded = 0
        self.discarded_images = 0
        self.connections = 0
        self.received_bytes = 0
        self.last_message: float | None = None
        self.refusals: dict[str, str] = {}

    def count_message(self, device: str, kind: str, now: float, used: bool) -> None:
        """Count a whole message that arrived at `now`, s of `time.monotonic`."""
        self.received[self._key(self.received, (device, kind), (OTHERS, OTHERS))] += 1
        if not used:
            self.unused[self._key(self.unused, kind, OTHERS)] += 1
        self.last_message = now

    def discard(self, message: StreamMessage) -> None:
        """Count a message that came too late to be queued."""
        self.discarded += not isinstance(message, StreamEvent)
        self.discarded_images += isinstance(message, ImageMessage)

    @staticmethod
    def _key(counter: Counter[Key], key: Key, others: Key) -> Key:
        return key if key in counter or len(counter) < DEVICES else others

    def snapshot(self, now: float, dropped: int, dropped_images: int) -> StreamStatistics:
        """What is known at `now`, s of `time.monotonic`; the queue has dropped so many messages."""
        return StreamStatistics(
            received=dict(self.received),
            unused=dict(self.unused),
            refused=self.refused,
            refused_sizes=self.refused_sizes,
            bad_crc=self.bad_crc,
            resyncs=self.resyncs,
            skipped_bytes=self.skipped_bytes,
            dropped=dropped + self.discarded,
            dropped_images=dropped_images + self.discarded_images,
            reconnects=max(0, self.connections - 1),
            received_bytes=self.received_bytes,
            last_message_age=None if self.last_message is None else now - self.last_message,
            refusals=dict(self.refusals),
        )
