"""The server of the soak test, in a process of its own: it streams an hour of a scan and fails at random, by a seed."""

from __future__ import annotations

import socket
import struct
import time
from collections import Counter, deque
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache

import numpy as np
from benchmark.live import sweep
from igtl_streams import ScriptedServer, with_size

from AIFReconLib.geometry.transform_graph import TransformName
from AIFReconLib.live.wire.encoding import encode_image, encode_message, encode_status, encode_status_request, encode_transform
from AIFReconLib.live.wire.framing import HEADER_SIZE, SIZE_LIMIT
from AIFReconLib.sweep.frames import TrackedSequence

COLUMNS, ROWS = 128, 96
RATE = 20.0
"""frames/s of simulated time."""

DEVICE, OTHER_DEVICE, POSE = "Image_Reference", "Second_Reference", "ImageToReference"
TOOLS = ("ProbeToTracker", "ReferenceToTracker")

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

# ---- the scan


@lru_cache(maxsize=1)
def scan() -> TrackedSequence:
    """The fan of speckle that the live benchmark streams, at a size that lets an hour pass in minutes."""
    return sweep(COLUMNS, ROWS)


def image_to_reference(number: int) -> np.ndarray:
    """Where image `number` lies."""
    records = scan().records
    return records[number % len(records)].transforms[TransformName.parse(POSE)].matrix


def pixels(number: int) -> np.ndarray:
    """Image `number`, (ROWS, COLUMNS) uint8; its first eight pixels hold its number, twice."""
    image = scan().images[number % len(scan().images)].copy()
    image[0, :8].view(np.uint32)[:] = number, number ^ 0xA5A5A5A5
    return image


def number_of(image: np.ndarray) -> int | None:
    """The number that an image tells; None if it is not one of the scan, in every pixel."""
    if image.shape != (ROWS, COLUMNS) or image.dtype != np.uint8:
        return None
    number = int(image[0, :4].copy().view(np.uint32)[0])
    return number if np.array_equal(image, pixels(number)) else None


class FaultyServer:
    """Streams frames, plain ones and spoiled ones, and knows what became of each on the wire."""

    def __init__(self, seed: int, minutes: float, on_minute: Callable[[int], None]):
        self.random = np.random.default_rng(seed)
        self.line = ScriptedServer()
        self.is_open = False
        self.version = 2
        self.clock_offset = 0.0
        self.recent: deque[tuple[int, float]] = deque(maxlen=20)
        self.notes: list[tuple[int, str, str]] = []
        """Of every image message: its number, the fault that it met (``plain`` without), and what became of it."""
        self.faults: Counter[str] = Counter()
        self._frames, self._elapsed, self._until, self._minute = 0, 0.0, 60.0 * minutes, 0
        self._on_minute = on_minute

    def next_frame(self) -> tuple[int, float]:
        """Number and time stamp of the next frame, s since 1970; the simulated time goes on by a frame."""
        frame = self._frames, BEGINNING + self._elapsed + self.clock_offset
        self._frames += 1
        self._advance(1.0 / RATE)
        return frame

    def image(self, number: int, time_: float) -> bytes:
        """IMAGE `number`."""
        return encode_image(DEVICE, time_, pixels(number), image_to_reference(number), version=self.version)

    def send(self, number: int, time_: float, fault: str, fate: str = WHOLE, data: bytes | None = None, status: str = "OK") -> None:
        """Send a frame, the image message being `data` where that is given; `status` is that of its transforms, "" for none."""
        metadata = {"TransformStatus": status, "TransformValid": str(int(status == "OK"))}
        # Without metadata, the identity is how a server says that a tool is not seen
        seen = [np.diag([1.0, -1.0, -1.0, 1.0])] * 2 + [image_to_reference(number)]
        named = zip((*TOOLS, POSE), seen if status == "OK" else [np.eye(4)] * 3) if status else ()
        told = [encode_transform(name, time_, matrix, version=self.version, metadata=metadata) for name, matrix in named]
        self.line.send(self.image(number, time_) if data is None else data, *told)
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

    def connect(self) -> None:
        """Wait for the client and read its request, so that closing is a clean end and no reset."""
        if not self.is_open:
            self.version = int(self.random.choice([1, 2, 2]))
            self.line.accept().receive(len(encode_status_request()))
            self.is_open = True

    def hang_up(self) -> None:
        """The clean end of a connection: the client gets everything that was sent, then the end of the stream."""
        self.line.hang_up()
        self.is_open = False

    def await_hang_up(self) -> None:
        """Wait until the client gives up the connection, as it does when bytes come that are no message."""
        with suppress(ConnectionError):
            self.line.receive(2**20)
        self.hang_up()

    def reset(self) -> None:
        """The rude end: a reset, once what was sent has arrived: else nobody could tell which frames were destroyed."""
        time.sleep(0.2)
        self.line.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.hang_up()

    def stream(self) -> None:
        """All of it, then the clean end of the connection."""
        # Every fault once, so that each has been seen and every buffer has its size early; then at random
        first = list(FAULTS)
        until_fault = FEW
        while self._elapsed < self._until or first:
            self.connect()
            if until_fault:
                self.send(*self.next_frame(), "plain")
                time.sleep(PACE)
                until_fault -= 1
            else:
                name = first.pop(0) if first else str(self.random.choice([*FAULTS]))
                self.faults[name] += 1
                make, end = FAULTS[name]
                make(self, name)
                if end:
                    end(self)
                until_fault = FEW if first else int(self.random.exponential(FRAMES_BETWEEN_FAULTS))
        # A last frame, so that no message that was begun by a fault stays open
        self.connect()
        self.send(*self.next_frame(), "plain")
        self.hang_up()

    def _advance(self, seconds: float) -> None:
        self._elapsed += seconds
        if self._elapsed >= 60.0 * (self._minute + 1):
            self._minute = int(self._elapsed // 60.0)
            self._on_minute(self._minute)


# ---- faults


Make = Callable[[FaultyServer, str], None]


def spoiled(spoil: Callable[[FaultyServer, bytes], bytes], status: str = "") -> Make:
    """A fault that sends something else in the place of an image message."""

    def make(server: FaultyServer, fault: str) -> None:
        number, time_ = server.next_frame()
        server.send(number, time_, fault, DESTROYED, spoil(server, server.image(number, time_)), status)

    return make


def another_size(server: FaultyServer, data: bytes) -> bytes:
    """A header declares another size than there is."""
    true = len(data) - HEADER_SIZE
    sizes = (true - server.within(1, 5000), true + server.within(1, 5000), SIZE_LIMIT + 1, 2**40, 2**64 - 1)
    return with_size(data, sizes[server.within(0, 5)]) + bytes(5000 + HEADER_SIZE)


def one_bit(server: FaultyServer, data: bytes) -> bytes:
    """One bit of the pixels, or of the checksum, is wrong."""
    place = server.within(50, len(data))
    return data[:place] + bytes([data[place] ^ 1 << server.within(0, 8)]) + data[place + 1 :]


def stall(server: FaultyServer, fault: str) -> None:
    """A frame comes in pieces, with pauses below and beyond what the client waits for."""
    number, time_ = server.next_frame()
    data = server.image(number, time_)
    places = sorted(server.within(0, len(data)) for _ in range(2))
    for start, end, pause in zip((0, *places), (*places, len(data)), (0.6, 3.2, 0.01), strict=True):
        server.line.send(data[start:end])
        server.sleep(server.random.uniform(0.0, pause))
    server.send(number, time_, fault, WHOLE, b"")


def gone(server: FaultyServer, fault: str) -> None:
    """The server goes, and comes back at the same port."""
    server.send(*server.next_frame(), fault)
    server.hang_up()
    server.line.__exit__()
    server.sleep(server.random.uniform(0.2, 2.0))
    server.line = ScriptedServer(server.line.port)


def garbage(server: FaultyServer, fault: str) -> None:
    """Random bytes after a frame."""
    server.send(*server.next_frame(), fault)
    server.line.send(server.random.bytes(server.within(HEADER_SIZE, 20_000)))


def times(server: FaultyServer, fault: str) -> None:
    """Frames that change places, or all carry the time of the first."""
    frames = [server.next_frame() for _ in range(server.within(2, 6))]
    same = server.within(0, 2)
    for number, time_ in frames[::-1]:
        server.send(number, frames[0][1] if same else time_, fault)


def clock_set(server: FaultyServer, fault: str) -> None:
    """The server's clock is set, forward or back, by seconds or by years."""
    # Never by whole frames: an image of the very time of another, from before a reconnection, is one that is sent again
    jump = server.random.choice([-3600.0, -10.0, -0.5, 0.5, 10.0, 3600.0, 3e8, -3e8])
    server.clock_offset += float(jump * server.random.uniform(0.9, 1))
    server.send(*server.next_frame(), fault)


def unseen(server: FaultyServer, fault: str) -> None:
    """Frames without any transform, or of a tool that is not seen: said so in version 2, an identity in version 1."""
    status = ("", "INVALID")[server.within(0, 2)]
    for _ in range(server.within(1, 10)):
        server.send(*server.next_frame(), fault, status=status)


def other_image(server: FaultyServer, fault: str) -> None:
    """Frames of another size or type of pixel."""
    for image in (np.full((50, 70), 7, np.uint8), np.full((ROWS, COLUMNS), 7, np.uint16)):
        number, time_ = server.next_frame()
        server.send(number, time_, fault, WHOLE, encode_image(DEVICE, time_, image, image_to_reference(number), version=server.version))


def unusable(server: FaultyServer, fault: str) -> None:
    """A whole message, checksum and all, that holds no image a reconstruction could use."""
    number, time_ = server.next_frame()
    body = server.image(number, time_)[HEADER_SIZE:]
    bodies = [body[: len(body) // 2], body[:2] + b"\xff" + body[3:], body[:3] + b"\x63" + body[4:], b"\0" * 10]
    server.send(number, time_, fault, UNUSABLE, encode_message("IMAGE", DEVICE, time_, bodies[server.within(0, 4)]), "")


def foreign(server: FaultyServer, fault: str) -> None:
    """Messages that are no frame of this scan: another image device, statuses, types that nobody needs."""
    number, time_ = server.next_frame()
    data = (
        encode_image(OTHER_DEVICE, time_, np.zeros((8, 8), np.uint8), np.eye(4), version=server.version)
        + encode_status("", 0.0, text="still here", version=server.version)
        + encode_message("NEWTYPE", "Whatever", time_, server.random.bytes(300))
    )
    server.send(number, time_, fault, FOREIGN, data, "")


def burst(server: FaultyServer, fault: str) -> None:
    """Frames as fast as they can be sent, far more than the client takes."""
    for _ in range(server.within(200, 700)):
        server.send(*server.next_frame(), fault)


def sent_again(server: FaultyServer, fault: str) -> None:
    """After a reconnection the server sends its last frames once more, as Plus does with those in its buffer."""
    recent = list(server.recent)
    server.hang_up()
    server.connect()
    for number, time_ in recent:
        server.send(number, time_, fault, AGAIN)


GIVEN_UP = FaultyServer.await_hang_up
FAULTS: dict[str, tuple[Make, Callable[[FaultyServer], None] | None]] = {
    "burst": (burst, None),
    "cut": (spoiled(lambda server, data: data[: server.within(1, len(data))]), FaultyServer.hang_up),
    "reset": (spoiled(lambda server, data: data[: server.within(1, len(data))]), FaultyServer.reset),
    "server gone": (gone, None),
    "sent again after a reconnection": (sent_again, None),
    "stall": (stall, None),
    "garbage behind": (garbage, GIVEN_UP),
    "one bit wrong": (spoiled(one_bit, status="OK"), None),
    "another size in the header": (spoiled(another_size), GIVEN_UP),
    # As Plus does after its send has timed out: a message begins again in the middle of itself
    "begins anew within itself": (
        spoiled(lambda server, data: data[: server.within(HEADER_SIZE, len(data))] + data + bytes(HEADER_SIZE)),
        GIVEN_UP,
    ),
    "repeated or reordered times": (times, None),
    "clock set": (clock_set, None),
    "transforms missing or invalid": (unseen, None),
    "another size of image": (other_image, None),
    "unusable contents": (unusable, None),
    "other devices and types": (foreign, None),
}
"""Ways in which a server and a network fail, and how the connection ends, if it does."""


def serve(connection, seed: int, minutes: float) -> None:
    """Stream, telling the port, every simulated minute, and at the end what was sent; then wait to be ended."""
    server = FaultyServer(seed, minutes, lambda minute: connection.send(minute))
    connection.send(server.line.port)
    server.stream()
    connection.send((server.notes, server.faults))
    connection.poll(None)
