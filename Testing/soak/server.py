"""The server of the soak test, in a process of its own: it streams an hour of a scan and fails at random, by a seed."""

from __future__ import annotations

import time
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from AIFReconLib.live.wire.encoding import encode_image, encode_message, encode_status
from AIFReconLib.live.wire.framing import HEADER_SIZE, SIZE_LIMIT

from . import stream
from .line import Line

WHOLE, DESTROYED, AGAIN = "whole", "destroyed", "again"
"""An image message went out whole; it was cut or spoiled on the wire; a message that had gone out before was sent once more."""

UNUSABLE, FOREIGN = "unusable", "foreign"
"""Whole, and its contents make no sense; whole, and of another device. Neither is a frame of the scan."""

FRAMES_BETWEEN_FAULTS, FEW = 60.0, 10
"""On average, and between the faults of the first round."""

BEGINNING = 1_700_000_000.0
"""s since 1970: the time of the first frame. The stream's clock has nothing to do with that on the wall."""

PACE = 1 / 120
"""s on the wall between two frames: six times as fast as the stream's clock, and what most machines keep up with."""

_SIZE = slice(42, 50)


class FaultyServer:
    """Streams frames, plain ones and spoiled ones, and knows what became of each on the wire."""

    def __init__(self, seed: int, minutes: float, on_minute: Callable[[int], None]):
        self.random = np.random.default_rng(seed)
        self.line = Line()
        self.version = 2
        self.clock_offset = 0.0
        self.recent: deque[tuple[int, float]] = deque(maxlen=20)
        self.notes: list[tuple[int, str, str]] = []
        """Of every image message: its number, the fault that it met (``plain`` without), and what became of it."""
        self.faults: Counter[str] = Counter()
        self._frames, self._elapsed, self._until, self._minute = 0, 0.0, 60.0 * minutes, 0
        self._on_minute = on_minute

    def next_time(self) -> float:
        """The time stamp that the next frame will have, s since 1970."""
        return BEGINNING + self._elapsed + self.clock_offset

    def next_frame(self) -> tuple[int, float]:
        """Number and time stamp of the next frame; the simulated time goes on by a frame."""
        number, time_ = self._frames, self.next_time()
        self._frames += 1
        self._advance(1.0 / stream.RATE)
        return number, time_

    def frame(self, fault: str = "plain", time_: float | None = None) -> None:
        """Send the next frame whole; with another time than its own where one is given."""
        number, its_time = self.next_frame()
        self.send(number, its_time if time_ is None else time_, fault)

    def send(self, number: int, time_: float, fault: str, fate: str = WHOLE, data: bytes | None = None, status: str = "OK") -> None:
        """Send a frame, the image message being `data` where that is given; `status` is that of its transforms, "" for none."""
        data = stream.image_message(number, time_, self.version) if data is None else data
        self.line.send(data + b"".join(stream.transform_messages(number, time_, self.version, status) if status else []))
        self.notes.append((number, fault, fate))
        if fate == WHOLE:
            self.recent.append((number, time_))

    def sleep(self, seconds: float) -> None:
        """Wait so many s, by both clocks."""
        time.sleep(seconds)
        self._advance(seconds)

    def within(self, low: int, high: int) -> int:
        """A whole number at random, below `high`."""
        return int(self.random.integers(low, high))

    def stream(self) -> None:
        """All of it, then the clean end of the connection."""
        weights = np.array([fault.weight for fault in FAULTS])
        # Every fault once, so that each has been seen and every buffer has its size early; then at random
        first = list(FAULTS)
        until_fault = FEW
        while self._elapsed < self._until or first:
            self._connect()
            if until_fault:
                self.frame()
                time.sleep(PACE)
                until_fault -= 1
            else:
                fault = first.pop(0) if first else FAULTS[self.random.choice(len(FAULTS), p=weights / weights.sum())]
                self.faults[fault.name] += 1
                fault.make(self, fault.name)
                if fault.end and self.line.is_open:
                    getattr(self.line, fault.end)()
                until_fault = FEW if first else int(self.random.exponential(FRAMES_BETWEEN_FAULTS))
        # A last frame, so that no message that was begun by a fault stays open
        self._connect()
        self.frame()
        self.line.hang_up()

    def _connect(self) -> None:
        if not self.line.is_open:
            self.version = int(self.random.choice([1, 2, 2]))
            self.line.accept()

    def _advance(self, seconds: float) -> None:
        self._elapsed += seconds
        if self._elapsed >= 60.0 * (self._minute + 1):
            self._minute = int(self._elapsed // 60.0)
            self._on_minute(self._minute)


# ---- faults


def spoiled(spoil: Callable[[FaultyServer, bytes], bytes], fate: str = DESTROYED, status: str = "") -> Callable[[FaultyServer, str], None]:
    """A fault that sends something else in the place of an image message."""

    def make(server: FaultyServer, fault: str) -> None:
        number, time_ = server.next_frame()
        server.send(number, time_, fault, fate, spoil(server, stream.image_message(number, time_, server.version)), status)

    return make


def cut(low: int, high: int | None = None) -> Callable[[FaultyServer, str], None]:
    """Only the beginning of an image message."""
    return spoiled(lambda server, data: data[: server.within(low, high or len(data))])


def whole(server: FaultyServer, fault: str) -> None:
    """A frame to which nothing happens; the end of the connection is the fault."""
    server.frame(fault)


def declared(size: Callable[[FaultyServer, int], int]) -> Callable[[FaultyServer, str], None]:
    """A header declares another size than there is."""

    def spoil(server: FaultyServer, data: bytes) -> bytes:
        told = size(server, len(data) - HEADER_SIZE).to_bytes(8, "big")
        return data[: _SIZE.start] + told + data[_SIZE.stop :] + bytes(5000 + HEADER_SIZE)

    return spoiled(spoil)


def one_bit(server: FaultyServer, data: bytes) -> bytes:
    """One bit of the pixels, or of the checksum, is wrong."""
    place = server.within(_SIZE.stop, len(data))
    return data[:place] + bytes([data[place] ^ 1 << server.within(0, 8)]) + data[place + 1 :]


def stall(pieces: int, low: float, high: float) -> Callable[[FaultyServer, str], None]:
    """A frame comes in pieces, with a pause before each."""

    def make(server: FaultyServer, fault: str) -> None:
        number, time_ = server.next_frame()
        data = stream.image_message(number, time_, server.version)
        places = [*np.sort(server.random.integers(0, len(data), pieces)), len(data)]
        for start, end in zip([0, *places], places):
            server.line.send(data[start:end])
            server.sleep(server.random.uniform(low, high))
        server.send(number, time_, fault, WHOLE, b"")

    return make


def gone(server: FaultyServer, fault: str) -> None:
    """The server goes, and comes back at the same port."""
    server.frame(fault)
    server.line.close_port()
    server.sleep(server.random.uniform(0.2, 2.0))
    server.line.listen()


def garbage(server: FaultyServer, fault: str) -> None:
    """Random bytes after a frame."""
    server.frame(fault)
    server.line.send(server.random.bytes(server.within(HEADER_SIZE, 20_000)))


def same_time(server: FaultyServer, fault: str) -> None:
    """Frames that all carry the time of the first."""
    first = server.next_time()
    for _ in range(server.within(2, 6)):
        server.frame(fault, first)


def reordered(server: FaultyServer, fault: str) -> None:
    """Two frames change places."""
    for number, time_ in [server.next_frame(), server.next_frame()][::-1]:
        server.send(number, time_, fault)


def clock_jump(server: FaultyServer, fault: str) -> None:
    """The server's clock is set, forward or back, by seconds or by years."""
    # Never by whole frames: an image of the very time of another, from before a reconnection, is one that is sent again
    jump = server.random.choice([-3600.0, -10.0, -0.5, 0.5, 10.0, 3600.0, 3e8, -3e8])
    server.clock_offset += float(jump * server.random.uniform(0.9, 1))
    server.frame(fault)


def without_transforms(status: str) -> Callable[[FaultyServer, str], None]:
    """Frames without any transform, or of a tool that is not seen: said so in version 2, an identity in version 1."""

    def make(server: FaultyServer, fault: str) -> None:
        for _ in range(server.within(1, 10)):
            server.send(*server.next_frame(), fault, status=status)

    return make


def other_size(server: FaultyServer, fault: str) -> None:
    """Frames of another size or type of pixel."""
    for _ in range(server.within(1, 4)):
        number, time_ = server.next_frame()
        image = (np.full((50, 70), 7, np.uint8), np.full((stream.ROWS, stream.COLUMNS), 7, np.uint16))[server.within(0, 2)]
        server.send(number, time_, fault, WHOLE, stream.image_message(number, time_, server.version, image=image))


def unusable(server: FaultyServer, fault: str) -> None:
    """A whole message, checksum and all, that holds no image a reconstruction could use."""
    number, time_ = server.next_frame()
    body = stream.image_message(number, time_, 1)[HEADER_SIZE:]
    bodies = [body[: len(body) // 2], body[:2] + b"\xff" + body[3:], body[:3] + b"\x63" + body[4:], b"\0" * 10]
    server.send(number, time_, fault, UNUSABLE, encode_message("IMAGE", stream.DEVICE, time_, bodies[server.within(0, 4)]), "")


def foreign(server: FaultyServer, fault: str) -> None:
    """Messages that are no frame of this scan: another image device, statuses, types that nobody needs."""
    number, time_ = server.next_frame()
    data = (
        encode_image(stream.OTHER_DEVICE, time_, np.zeros((8, 8), np.uint8), np.eye(4), version=server.version)
        + encode_status("", 0.0, text="still here", version=server.version)
        + encode_message("STRING", "Note", time_, b"\0\x03\0\x05hello")
        + encode_message("NEWTYPE", "Whatever", time_, server.random.bytes(300))
    )
    server.send(number, time_, fault, FOREIGN, data, "")


def burst(server: FaultyServer, fault: str) -> None:
    """Frames as fast as they can be sent, far more than the client takes."""
    for _ in range(server.within(200, 700)):
        server.frame(fault)


def sent_again(server: FaultyServer, fault: str) -> None:
    """After a reconnection the server sends its last frames once more, as Plus does with those in its buffer."""
    recent = list(server.recent)
    server.line.hang_up()
    server.line.accept()
    for number, time_ in recent:
        server.send(number, time_, fault, AGAIN)


@dataclass(frozen=True)
class StreamFault:
    """One way in which a server and a network fail: how often it comes against the others, and how the connection ends, if it does."""

    name: str
    weight: float
    make: Callable[[FaultyServer, str], None]
    end: str = ""


CLEAN, RESET, GIVEN_UP = "hang_up", "reset", "await_hang_up"
FAULTS = (
    StreamFault("burst", 1.0, burst),
    StreamFault("cut between messages", 2.0, whole, CLEAN),
    StreamFault("cut in a header", 2.0, cut(1, HEADER_SIZE), CLEAN),
    StreamFault("cut in a body", 2.0, cut(HEADER_SIZE), CLEAN),
    StreamFault("reset between messages", 2.0, whole, RESET),
    StreamFault("reset in a body", 2.0, cut(1), RESET),
    StreamFault("server gone", 1.0, gone),
    StreamFault("sent again after a reconnection", 2.0, sent_again),
    StreamFault("stall below the limit", 4.0, stall(1, 0.05, 0.6)),
    StreamFault("stall beyond the limit", 1.0, stall(1, 2.2, 3.2)),
    StreamFault("slow trickle", 2.0, stall(40, 0.01, 0.01)),
    StreamFault("garbage behind", 4.0, garbage, GIVEN_UP),
    StreamFault("wrong checksum", 4.0, spoiled(one_bit, status="OK")),
    StreamFault("wrong size", 4.0, declared(lambda s, size: size + s.within(1, 5000) * (1, -1)[s.within(0, 2)]), GIVEN_UP),
    StreamFault("huge size", 4.0, declared(lambda s, _: (SIZE_LIMIT + 1, 2**31, 2**40, 2**64 - 1)[s.within(0, 4)]), GIVEN_UP),
    # As Plus does after its send has timed out: a message begins again in the middle of itself
    StreamFault(
        "begins anew within itself",
        4.0,
        spoiled(lambda server, data: data[: server.within(HEADER_SIZE, len(data))] + data + bytes(HEADER_SIZE)),
        GIVEN_UP,
    ),
    StreamFault("repeated time", 4.0, same_time),
    StreamFault("reordered times", 4.0, reordered),
    StreamFault("clock set", 2.0, clock_jump),
    StreamFault("transforms missing", 4.0, without_transforms("")),
    StreamFault("transforms INVALID", 4.0, without_transforms("INVALID")),
    StreamFault("another size", 2.0, other_size),
    StreamFault("unusable contents", 2.0, unusable),
    StreamFault("other devices and types", 4.0, foreign),
)


def serve(connection, seed: int, minutes: float) -> None:
    """Stream, telling the port, every simulated minute, and at the end what was sent; then wait to be ended."""
    server = FaultyServer(seed, minutes, lambda minute: connection.send(minute))
    connection.send(server.line.port)
    server.stream()
    connection.send((server.notes, server.faults, server.line.connections))
    connection.poll(None)
