"""Bytes of a stream -> whole messages whose checksum is right, and nothing else.

A stream is damaged in practice: a server whose send timed out begins the message anew in the middle of itself, so a reader that trusts
the size in a header takes one image for another. Here a message counts only when its checksum does. After damage the bytes that have
already arrived are searched, so that the message that follows is not lost. (The checksum is that of the body. The protocol has none for the
header, so a wrong bit in a name or a time goes unseen.)
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from .crc64 import crc64

HEADER_SIZE = 58
SIZE_LIMIT = 64 * 2**20
"""Bytes in a message body beyond which a header is taken for damage: an image of 8192 x 8192 bytes."""
NEWEST_VERSION = 3
CANDIDATES = 64
"""Headers of messages still under way that are kept in mind while searching; random bytes give none in practice."""
EFFORT = 4
"""Bytes of wrong messages whose checksum is taken while searching, for each byte that has arrived: made-up headers must not cost more."""

_HEADER = struct.Struct(">H12s20sQQQ")
_TYPE = re.compile(rb"([A-Za-z][A-Za-z0-9_]{2,11})[\0 ]*")
_NAME = re.compile(rb"[^\x00-\x1f]*")
_START = re.compile(rb"\x00[\x01-\x03][A-Za-z][A-Za-z0-9_]{2}")
_TIME_UNIT = 2.0**-32


@dataclass(frozen=True)
class Header:
    """The 58 bytes in front of a message.

    Parameters
    ----------
    version : int
        1, or 2 with metadata.
    kind : str
        The message type, e.g. ``IMAGE``.
    device : str
        At most 20 bytes of it.
    timestamp : float, s since 1970 (UTC)
    size : int
        Bytes of the body.
    crc : int
        Checksum of the body.
    """

    version: int
    kind: str
    device: str
    timestamp: float
    size: int
    crc: int


@dataclass(frozen=True, eq=False)
class Frame:
    """A whole message: its header and its body, checksum verified."""

    header: Header
    body: bytes


@dataclass(frozen=True)
class Damage:
    """Bytes that are no message; the search for the next one has begun.

    Parameters
    ----------
    kind : str
        ``header`` (no header where one must be), ``size`` (beyond the limit) or ``checksum``.
    detail : str
        What was seen, as the beginning of a sentence.
    """

    kind: Literal["header", "size", "checksum"]
    detail: str


@dataclass(frozen=True)
class Recovery:
    """The next message was found; `skipped` bytes before it belong to none."""

    skipped: int


def parse_header(data: bytes | bytearray, offset: int = 0) -> Header | None:
    """The header at `offset`, or None where those 58 bytes cannot be one; its size is not judged."""
    version, kind, device, timestamp, size, crc = _HEADER.unpack_from(data, offset)
    word = _TYPE.fullmatch(kind)
    name = device.partition(b"\0")[0]
    if not 1 <= version <= NEWEST_VERSION or word is None or not _NAME.fullmatch(name):
        return None
    return Header(version, word[1].decode("ascii"), name.decode("utf-8", "replace").strip(), timestamp * _TIME_UNIT, size, crc)


class Framer:
    """Cuts a stream into messages.

    Parameters
    ----------
    size_limit : int
        Largest body, in bytes, that is accepted. It is judged before anything is allocated.
    """

    def __init__(self, size_limit: int = SIZE_LIMIT):
        self._limit = size_limit
        self._buffer = bytearray()
        self._synchronized = True
        self._candidates: list[int] = []
        self._searched = 0
        self._effort = 0
        self._skipped = 0
        self._skipped_before = 0
        self._found: Frame | None = None

    @property
    def searching(self) -> bool:
        """Whether the place of the next message is unknown."""
        return not self._synchronized

    @property
    def skipped(self) -> int:
        """Bytes so far that belong to no message."""
        return self._skipped

    def feed(self, data: bytes | bytearray | memoryview) -> list[Frame | Damage | Recovery]:
        """Take bytes as they arrive; returns what they complete, in order."""
        self._buffer += data
        self._effort += EFFORT * len(data)
        parts = []
        while (part := self._next()) is not None:
            parts.append(part)
        return parts

    def describe_pending(self) -> str | None:
        """The message that has begun to arrive, in words: ``an IMAGE of Image_Reference (300 of 505192 bytes)``; None without one."""
        have = len(self._buffer)
        if self.searching or have == 0:
            return None
        header = parse_header(self._buffer) if have >= HEADER_SIZE else None
        if header is None:
            return f"a header ({have} of {HEADER_SIZE} bytes)"
        of = {"message": _named(header), "have": have - HEADER_SIZE, "whole": header.size}
        if header.kind[0] in "AEIOU":
            return "an {message} ({have} of {whole} bytes)".format(**of)
        return "a {message} ({have} of {whole} bytes)".format(**of)

    def look_inside(self) -> list[Frame | Damage | Recovery]:
        """Doubt the message that does not become complete, and search the bytes that have arrived of it; returns what is found."""
        if self._synchronized and len(self._buffer) >= HEADER_SIZE:
            self._begin_search([0])
        return self.feed(b"")

    def _next(self) -> Frame | Damage | Recovery | None:
        if self._found is not None:
            frame, self._found = self._found, None
            return frame
        return self._expect() if self._synchronized else self._search()

    def _expect(self) -> Frame | Damage | None:
        """The message that begins where the last one ended."""
        if len(self._buffer) < HEADER_SIZE:
            return None
        header = parse_header(self._buffer)
        if header is None:
            return self._lose("header", "Bytes arrived that are no OpenIGTLink message")
        whose = _named(header)
        if header.size > self._limit:
            detail = f"A message ({whose}) declares {header.size} bytes, more than the limit of {self._limit}"
            return self._lose("size", detail)
        if len(self._buffer) < HEADER_SIZE + header.size:
            return None
        body = self._body(0, header)
        if crc64(body) != header.crc:
            if header.crc == 0:
                return self._lose("checksum", f"A message ({whose}) has no checksum: its sender leaves it at 0")
            return self._lose("checksum", f"A message ({whose}) has a wrong checksum")
        del self._buffer[: HEADER_SIZE + header.size]
        return Frame(header, body)

    def _lose(self, kind: Literal["header", "size", "checksum"], detail: str) -> Damage:
        self._begin_search([])
        return Damage(kind, detail)

    def _begin_search(self, candidates: list[int]) -> None:
        self._synchronized = False
        self._candidates, self._searched = candidates, 1
        self._effort = EFFORT * len(self._buffer)
        self._skipped_before = self._skipped

    def _search(self) -> Frame | Damage | Recovery | None:
        """The first whole message with a right checksum among the bytes that are there."""
        for start in self._possible_starts():
            header = parse_header(self._buffer, start)
            if header is None or len(self._buffer) < start + HEADER_SIZE + header.size:
                continue
            body = self._body(start, header) if header.size <= self._effort else None
            if body is not None and crc64(body) == header.crc:
                del self._buffer[: start + HEADER_SIZE + header.size]
                self._skipped += start
                self._synchronized, self._found = True, Frame(header, body)
                skipped = self._skipped - self._skipped_before
                # Nothing skipped: the message that was doubted was whole after all
                return Recovery(skipped) if skipped else self._next()
            self._effort -= header.size if body is not None else 0
            self._candidates.remove(start)
        # What lies before the first possible message will never be part of one
        useless = self._candidates[0] if self._candidates else min(self._searched, len(self._buffer))
        del self._buffer[:useless]
        self._skipped += useless
        self._searched -= useless
        self._candidates = [start - useless for start in self._candidates]
        return None

    def _possible_starts(self) -> Iterator[int]:
        """Where messages may begin: the headers in mind, then those in the bytes that were not looked at yet, kept in mind too."""
        yield from list(self._candidates)
        last = len(self._buffer) - HEADER_SIZE
        while self._searched <= last:
            match = _START.search(self._buffer, self._searched)
            if match is None or match.start() > last:
                self._searched = last + 1
                break
            self._searched = match.start() + 1
            header = parse_header(self._buffer, match.start())
            # A message without a body proves nothing: its checksum is 0, as so many bytes are
            if header is not None and 0 < header.size <= self._limit:
                self._candidates = [*self._candidates[1 - CANDIDATES :], match.start()]
                yield match.start()

    def _body(self, start: int, header: Header) -> bytes:
        with memoryview(self._buffer) as view:
            return bytes(view[start + HEADER_SIZE : start + HEADER_SIZE + header.size])


def _named(header: Header) -> str:
    """A message in words: ``IMAGE of Image_Reference``."""
    return f"{header.kind} of {header.device}" if header.device else header.kind
