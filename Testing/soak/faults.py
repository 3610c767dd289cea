"""The ways in which a server and a network fail, each done to the frames of a scan; the ledger knows what each of them cost."""

from __future__ import annotations

import numpy as np

from AIFReconLib.live.wire.encoding import encode_image, encode_message, encode_status
from AIFReconLib.live.wire.framing import HEADER_SIZE, SIZE_LIMIT

from . import stream
from .ledger import AGAIN, DESTROYED, FOREIGN, UNUSABLE, WHOLE

SHORT, LONG = (0.05, 0.6), (2.2, 3.2)
"""s of a stall below and above the client's limit of 2 s, by the clock on the wall."""

AWAY = (0.2, 2.0)
"""s that a server is gone."""

_SIZE = slice(42, 50)
_SUM = slice(50, 58)


def cut_between(server) -> None:
    """The connection ends cleanly between two messages."""
    server.frame("cut between messages")
    server.line.hang_up()


def cut_in_header(server) -> None:
    """The connection ends cleanly within a header."""
    _cut(server, "cut in a header", lambda size: server.random.integers(1, HEADER_SIZE))


def cut_in_body(server) -> None:
    """The connection ends cleanly within the pixels."""
    _cut(server, "cut in a body", lambda size: server.random.integers(HEADER_SIZE, size))


def reset_between(server) -> None:
    """The connection is reset between two messages."""
    server.frame("reset between messages")
    server.line.reset()


def reset_in_body(server) -> None:
    """The connection is reset within the pixels."""
    number, time = server.next_frame("reset in a body")
    message = stream.image_message(number, time, server.version)
    server.line.send(message[: server.random.integers(1, len(message))])
    server.ledger.note(number, "reset in a body", DESTROYED)
    server.line.reset()


def _cut(server, fault: str, place) -> None:
    number, time = server.next_frame(fault)
    message = stream.image_message(number, time, server.version)
    server.line.send(message[: place(len(message))])
    server.ledger.note(number, fault, DESTROYED)
    server.line.hang_up()


def gone(server) -> None:
    """The server goes, and comes back at the same port."""
    server.frame("server gone")
    server.line.close_port()
    server.pause(AWAY)
    server.line.listen()


def short_stall(server) -> None:
    """Nothing is sent for less than the client's limit, between messages or within one."""
    _stall(server, "stall below the limit", SHORT)


def long_stall(server) -> None:
    """Nothing is sent for longer than the client's limit."""
    _stall(server, "stall beyond the limit", LONG)


def _stall(server, fault: str, seconds: tuple[float, float]) -> None:
    number, time = server.next_frame(fault)
    message = stream.image_message(number, time, server.version)
    place = int(server.random.choice([0, server.random.integers(1, HEADER_SIZE), server.random.integers(HEADER_SIZE, len(message))]))
    server.line.send(message[:place])
    server.pause(seconds)
    server.line.send(message[place:] + b"".join(stream.transform_messages(number, time, server.version)))
    server.ledger.note(number, fault, WHOLE)


def trickle(server) -> None:
    """A frame comes a few bytes at a time."""
    number, time = server.next_frame("slow trickle")
    data = stream.image_message(number, time, server.version)
    pieces = np.sort(server.random.integers(0, len(data), 40))
    for start, end in zip([0, *pieces], [*pieces, len(data)]):
        server.line.send(data[start:end])
        server.sleep(0.01)
    server.line.send(b"".join(stream.transform_messages(number, time, server.version)))
    server.ledger.note(number, "slow trickle", WHOLE)


def garbage(server) -> None:
    """Random bytes after a frame."""
    server.frame("garbage behind")
    server.line.send(server.random.bytes(int(server.random.integers(HEADER_SIZE, 20_000))))
    server.line.await_hang_up()


def wrong_checksum(server) -> None:
    """One bit of the pixels, or of the checksum, is wrong."""
    number, time = server.next_frame("wrong checksum")
    data = bytearray(stream.image_message(number, time, server.version))
    place = int(server.random.integers(_SUM.start, len(data)))
    data[place] ^= 1 << int(server.random.integers(8))
    server.line.send(bytes(data) + b"".join(stream.transform_messages(number, time, server.version)))
    server.ledger.note(number, "wrong checksum", DESTROYED)


def wrong_size(server) -> None:
    """A header declares a few bytes more or fewer than there are."""
    number, time = server.next_frame("wrong size")
    data = stream.image_message(number, time, server.version)
    size = len(data) - HEADER_SIZE + int(server.random.choice([-1, 1])) * int(server.random.integers(1, 5000))
    _declare(server, number, time, data, size, "wrong size")


def huge_size(server) -> None:
    """A header declares far more than the client's limit."""
    number, time = server.next_frame("huge size")
    size = (SIZE_LIMIT + 1, 2**31, 2**40, 2**64 - 1)[server.random.integers(4)]
    _declare(server, number, time, stream.image_message(number, time, server.version), size, "huge size")


def _declare(server, number: int, time: float, data: bytes, size: int, fault: str) -> None:
    spoiled = data[: _SIZE.start] + size.to_bytes(8, "big") + data[_SIZE.stop :]
    server.line.send(spoiled + bytes(5000 + HEADER_SIZE))
    server.ledger.note(number, fault, DESTROYED)
    server.line.await_hang_up()


def begins_anew(server) -> None:
    """As Plus does after its send has timed out: a message begins again in the middle of itself."""
    number, time = server.next_frame("begins anew within itself")
    data = stream.image_message(number, time, server.version)
    server.line.send(data[: server.random.integers(HEADER_SIZE, len(data))] + data)
    server.ledger.note(number, "begins anew within itself", DESTROYED)
    server.line.send(bytes(HEADER_SIZE))
    server.line.await_hang_up()


def same_time(server) -> None:
    """Frames that all carry the time of the first."""
    first = server.next_time()
    for _ in range(int(server.random.integers(2, 6))):
        server.frame("repeated time", first)


def reordered(server) -> None:
    """Two frames change places."""
    earlier = server.next_frame("reordered times")
    later = server.next_frame("reordered times")
    for number, time in (later, earlier):
        server.send_whole(number, time, "reordered times")


def clock_jump(server) -> None:
    """The server's clock is set, forward or back, by seconds or by years."""
    # Never by whole frames: an image of the very time of another, from before a reconnection, is one that is sent again
    server.clock_offset += float(server.random.choice([-3600.0, -10.0, -0.5, 0.5, 10.0, 3600.0, 3e8, -3e8]) * server.random.uniform(0.9, 1))
    server.frame("clock set")


def no_transforms(server) -> None:
    """Frames without any transform."""
    for _ in range(int(server.random.integers(1, 10))):
        number, time = server.next_frame("transforms missing")
        server.line.send(stream.image_message(number, time, server.version))
        server.ledger.note(number, "transforms missing", WHOLE)


def invalid_transforms(server) -> None:
    """Frames of a tool that is not seen: said so in version 2, an identity in version 1."""
    for _ in range(int(server.random.integers(1, 10))):
        number, time = server.next_frame("transforms INVALID")
        messages = stream.transform_messages(number, time, server.version, status="INVALID")
        server.line.send(stream.image_message(number, time, server.version) + b"".join(messages))
        server.ledger.note(number, "transforms INVALID", WHOLE)


def other_size(server) -> None:
    """Frames of another size or type of pixel."""
    for _ in range(int(server.random.integers(1, 4))):
        number, time = server.next_frame("another size")
        others: list[np.ndarray] = [np.full((50, 70), 7, np.uint8), np.full((stream.ROWS, stream.COLUMNS), 7, np.uint16)]
        image = others[int(server.random.integers(2))]
        message = stream.image_message(number, time, server.version, image=image)
        server.line.send(message + b"".join(stream.transform_messages(number, time, server.version)))
        server.ledger.note(number, "another size", WHOLE)


def unusable(server) -> None:
    """Whole messages, checksum and all, that hold no image a reconstruction could use."""
    number, time = server.next_frame("unusable contents")
    message = stream.image_message(number, time, 1)
    body = message[HEADER_SIZE:]
    spoiled = [body[: len(body) // 2], body[:2] + b"\xff" + body[3:], body[:3] + b"\x63" + body[4:], b"\0" * 10]
    server.line.send(encode_message("IMAGE", stream.DEVICE, time, spoiled[int(server.random.integers(len(spoiled)))]))
    server.ledger.note(number, "unusable contents", UNUSABLE)


def foreign(server) -> None:
    """Messages that are no frame of this scan: another image device, statuses, types that nobody needs."""
    number, time = server.next_frame("other devices and types")
    server.line.send(
        encode_image(stream.OTHER_DEVICE, time, np.zeros((8, 8), np.uint8), np.eye(4), version=server.version)
        + encode_status("", 0.0, text="still here", version=server.version)
        + encode_message("STRING", "Note", time, b"\0\x03\0\x05hello")
        + encode_message("NEWTYPE", "Whatever", time, server.random.bytes(300))
    )
    server.ledger.note(number, "other devices and types", FOREIGN)


def burst(server) -> None:
    """Frames as fast as they can be sent, far more than the client takes."""
    server.heeds_client = False
    for _ in range(int(server.random.integers(200, 700))):
        server.frame("burst")
    server.heeds_client = True


def sent_again(server) -> None:
    """After a reconnection the server sends its last frames once more, as Plus does with those in its buffer."""
    recent = list(server.recent)
    server.line.hang_up()
    server.line.accept()
    server.ledger.happened("sent again after a reconnection")
    for number, time in recent:
        server.line.send(stream.image_message(number, time, server.version))
        server.line.send(b"".join(stream.transform_messages(number, time, server.version)))
        server.ledger.note(number, "sent again after a reconnection", AGAIN)


COMMON, RARE = 4.0, 1.0
FAULTS = {
    cut_between: 2.0,
    cut_in_header: 2.0,
    cut_in_body: 2.0,
    reset_between: 2.0,
    reset_in_body: 2.0,
    gone: RARE,
    sent_again: 2.0,
    short_stall: COMMON,
    long_stall: RARE,
    trickle: 2.0,
    garbage: COMMON,
    wrong_checksum: COMMON,
    wrong_size: COMMON,
    huge_size: COMMON,
    begins_anew: COMMON,
    same_time: COMMON,
    reordered: COMMON,
    clock_jump: 2.0,
    no_transforms: COMMON,
    invalid_transforms: COMMON,
    other_size: 2.0,
    unusable: 2.0,
    foreign: COMMON,
    burst: RARE,
}
"""Every fault with how often it comes, against the others. Those that cost time on the wall are rare."""
