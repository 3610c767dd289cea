"""Bytes of a stream -> whole messages.

TCP damages no bytes, but a Plus server whose send timed out begins the message anew in the middle of itself. The checksum of such a message
is wrong, and the next header is none. So a message counts only when its checksum is right, and a stream whose next header is none is given
up: the client connects again. (The checksum is that of the body. A wrong bit in a name or a time goes unseen.)
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass, replace

from .crc64 import crc64

HEADER_SIZE = 58
SIZE_LIMIT = 64 * 2**20
"""Bytes in the body of a message at most: an image of 8192 x 8192 bytes."""
NEWEST_VERSION = 3

HEADER = struct.Struct(">H12s20sQQQ")
"""Version, type, device, time, size of the body and its checksum."""

_TYPE = re.compile(rb"([A-Za-z][A-Za-z0-9_]{2,11})[\0 ]*")
_NAME = re.compile(rb"[^\x00-\x1f]*")
TIME_UNIT = 2.0**-32


@dataclass(frozen=True, eq=False)
class RawMessage:
    """A whole message: the 58 bytes in front of it, and its body.

    Parameters
    ----------
    version : int
        1, or 2 with metadata.
    kind : str
        The message type, e.g. ``IMAGE``.
    device : str
        At most 20 bytes of it.
    timestamp : float, s since 1970 (UTC)
    size, crc : int
        Bytes of the body, and its checksum.
    problem : str or None
        Why the body cannot be believed.
    """

    version: int
    kind: str
    device: str
    timestamp: float
    size: int
    crc: int
    body: bytes = b""
    problem: str | None = None

    def __str__(self) -> str:
        return f"{self.kind} of {self.device}" if self.device else self.kind


def parse_header(data: bytes | bytearray) -> RawMessage | None:
    """The message that `data` begin with, still without its body; None where those 58 bytes cannot be a header. Its size is not judged."""
    version, kind, device, timestamp, size, crc = HEADER.unpack_from(data)
    word = _TYPE.fullmatch(kind)
    name = device.partition(b"\0")[0]
    if not 1 <= version <= NEWEST_VERSION or word is None or not _NAME.fullmatch(name):
        return None
    return RawMessage(version, word[1].decode("ascii"), name.decode("utf-8", "replace").strip(), timestamp * TIME_UNIT, size, crc)


class Framer:
    """Cuts a stream into messages.

    Parameters
    ----------
    size_limit : int
        Largest body, in bytes, that is accepted. It is judged before anything is allocated.

    Attributes
    ----------
    problem : str or None
        Why nothing more can be understood of this stream.
    """

    def __init__(self, size_limit: int = SIZE_LIMIT):
        self._limit = size_limit
        self._buffer = bytearray()
        self.problem: str | None = None

    def feed(self, data: bytes | bytearray | memoryview) -> list[RawMessage]:
        """Take bytes as they arrive; returns the messages that they complete, in order. Whether there is a `problem` shows afterwards."""
        if self.problem is None:
            self._buffer += data
        messages = []
        while (message := self._next()) is not None:
            messages.append(message)
        return messages

    @property
    def is_within(self) -> bool:
        """Whether a message has begun to arrive."""
        return bool(self._buffer) and self.problem is None

    def _next(self) -> RawMessage | None:
        if len(self._buffer) < HEADER_SIZE or self.problem is not None:
            return None
        header = parse_header(self._buffer)
        if header is None:
            self.problem = "Bytes arrived that are no OpenIGTLink message"
        elif header.size > self._limit:
            self.problem = f"A message ({header}) declares {header.size} bytes, more than the limit of {self._limit}"
        if header is None or self.problem is not None or len(self._buffer) < (end := HEADER_SIZE + header.size):
            return None
        with memoryview(self._buffer) as view:
            body = bytes(view[HEADER_SIZE:end])
        del self._buffer[:end]
        if crc64(body) == header.crc:
            return replace(header, body=body)
        wrong = "has a wrong checksum" if header.crc else "has no checksum: its sender leaves it at 0"
        return replace(header, body=body, problem=f"A message ({header}) {wrong}. It is left out.")
