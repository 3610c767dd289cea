"""Peers that mean no good: servers that a live session connects to, and clients that connect to the replay server.

    python Testing/soak hostile                    each for 20 s
    python Testing/soak hostile --seconds 600

For each it tells how long stopping took, how far the memory of this process rose above that at the start and how far in the second half of
the time alone, and whether a thread was left; for each crowd of clients also how many frames an honest client got meanwhile.
"""

from __future__ import annotations

import argparse
import os
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from itertools import count, islice, repeat

import numpy as np
import psutil

from AIFReconLib.live.pairing.synchronizer import SynchronizerSettings
from AIFReconLib.live.replay.server import ReplayServer
from AIFReconLib.live.session.session import LiveSession
from AIFReconLib.live.wire.client import OpenIGTLinkClient
from AIFReconLib.live.wire.encoding import encode_message, encode_status_request, encode_transform

from . import stream
from .client import imaging

GARBAGE = os.urandom(2**20)
RATE = 20.0


# ---- servers, each what it sends to a client, without end where nothing else is said


def silent() -> Iterator[bytes]:
    """Never sends."""
    while True:
        time.sleep(0.1)
        yield b""


def one_byte_a_second() -> Iterator[bytes]:
    """Sends an image, a byte a second."""
    for byte in stream.image_message(1, 1.0, 2):
        yield from (bytes([byte]), *islice(silent(), 10))


def slowly(message: bytes) -> Iterator[bytes]:
    """Sends the beginning of a message that declares as much as is allowed, and garbage for its body."""
    yield message[:42] + (2**26).to_bytes(8, "big") + bytes(8)
    while True:
        time.sleep(0.05)
        yield GARBAGE[: 2**18]


def ever_new_names() -> Iterator[bytes]:
    """Sends whole messages, each of a device that nobody has seen."""
    for number in count():
        yield encode_transform(f"T{number:x}ToTracker", 1.0, np.eye(4), version=2)


def closes_at_once() -> Iterator[bytes]:
    """Accepts and hangs up."""
    return iter(())


IMAGE = encode_message("IMAGE", "Image_Reference", 1.0, GARBAGE)
TEXT = encode_transform("ProbeToTracker", 1.0, np.eye(4), version=2, metadata={"Note": "x" * 2**22})
TOOLS = encode_message("TDATA", "Tracker", 1.0, bytes(70) * 500_000)
SERVERS: dict[str, Callable[[], Iterator[bytes]]] = {
    "silent": silent,
    "one byte a second": one_byte_a_second,
    "garbage": partial(repeat, GARBAGE),
    "headers, each within the other": partial(repeat, b"junk" + IMAGE[:58] * 2000),
    "a long message that never ends": partial(slowly, IMAGE),
    "ever new names": ever_new_names,
    "megabytes of metadata": partial(repeat, TEXT),
    "half a million tools": partial(repeat, TOOLS),
    "closes at once": closes_at_once,
}


@contextmanager
def hostile_server(behavior: Callable[[], Iterator[bytes]]) -> Iterator[int]:
    """A server that treats every client alike; gives its port."""
    ending = threading.Event()

    def serve() -> None:
        while not ending.is_set():
            with suppress(TimeoutError):
                connection, _ = listener.accept()
                with connection, suppress(OSError):
                    connection.settimeout(0.1)
                    for data in behavior():
                        send(connection, data)
                        if ending.is_set():
                            break

    def send(connection: socket.socket, data: bytes) -> None:
        rest = memoryview(data)
        while rest and not ending.is_set():
            with suppress(TimeoutError):
                rest = rest[connection.send(rest) :]

    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        listener.settimeout(0.1)
        server = threading.Thread(target=serve, name="hostile server", daemon=True)
        server.start()
        try:
            yield listener.getsockname()[1]
        finally:
            ending.set()
            server.join()


@dataclass(frozen=True)
class Endured:
    """What a hostile peer cost.

    Parameters
    ----------
    stopped_after : float, s
    peak_mib : float
        Of the resident memory, above that at the start: what the bounded queues hold.
    grown_mib : float
        In the second half of the time: the largest resident memory above that in the middle.
    threads_left : int
    frames : int
        That an honest client got meanwhile; 0 where there is none.
    expected : int
        Sent by the server meanwhile.
    """

    stopped_after: float
    peak_mib: float
    grown_mib: float
    threads_left: int
    frames: int = 0
    expected: int = 0


def endure_server(behavior: Callable[[], Iterator[bytes]], seconds: float) -> Endured:
    """A live session with a hostile server for a while, then stopped."""
    before = threading.active_count()
    with hostile_server(behavior) as port:
        session = LiveSession(OpenIGTLinkClient("127.0.0.1", port), **imaging(), synchronizer=SynchronizerSettings())
        session.prepare()
        session.start()
        grown = _watch(seconds)
        asked = time.monotonic()
        session.stop()
        stopped = time.monotonic() - asked
    return Endured(stopped, *grown, _threads_above(before))


# ---- clients


def never_reads(connection: socket.socket) -> None:
    """Asks for the stream and takes nothing of it."""
    connection.sendall(encode_status_request())


def says_nothing(connection: socket.socket) -> None:
    """Connects, no more."""


def sends_garbage(connection: socket.socket) -> None:
    """Sends random bytes, as many as are taken."""
    connection.settimeout(0.0)
    with suppress(OSError):
        connection.send(GARBAGE)


CROWDS = ((never_reads, 1), (never_reads, 20), (sends_garbage, 20), (says_nothing, 1000), (never_reads, 1000))


def endure_clients(behavior: Callable[[socket.socket], None], many: int, seconds: float) -> Endured:
    """The replay server with so many hostile clients and an honest one."""
    before = threading.active_count()
    with ExitStack() as crowd:
        server = ReplayServer(stream.scan(), port=0, rate=RATE, loop=True)
        server.start()
        honest = OpenIGTLinkClient("127.0.0.1", server.port, queue_size=100_000)
        honest.start()
        while not honest.statistics.count("IMAGE"):
            time.sleep(0.01)
        for _ in range(many):
            connection = crowd.enter_context(socket.create_connection(("127.0.0.1", server.port), timeout=10.0))
            behavior(connection)
        began, sent = honest.statistics.count("IMAGE"), server.sent
        grown = _watch(seconds)
        while honest.statistics.count("IMAGE") == began:
            time.sleep(0.01)
        frames, expected = honest.statistics.count("IMAGE") - began, server.sent - sent
        honest.stop()
        asked = time.monotonic()
        server.stop()
        stopped = time.monotonic() - asked
    return Endured(stopped, *grown, _threads_above(before), frames, expected)


# ---- what both have in common


def _watch(seconds: float) -> tuple[float, float]:
    """Wait; how far the memory rose in all, and in the second half, MiB."""
    samples = [psutil.Process().memory_info().rss / 2**20]
    began = time.monotonic()
    while (left := began + seconds - time.monotonic()) > 0:
        time.sleep(min(0.1, left))
        samples.append(psutil.Process().memory_info().rss / 2**20)
    late = samples[len(samples) // 2 :]
    return max(samples) - samples[0], max(late) - late[0]


def _threads_above(before: int) -> int:
    end = time.monotonic() + 5.0
    while threading.active_count() > before and time.monotonic() < end:
        time.sleep(0.02)
    return threading.active_count() - before


def main(argv: list[str]) -> int:
    """Endure them all; the exit status is 1 when stopping took 2 s or more, or a thread was left."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=20.0)
    arguments = parser.parse_args(argv)
    rows = [(name, partial(endure_server, behavior, arguments.seconds)) for name, behavior in SERVERS.items()]
    rows += [(f"{behavior.__name__} x {many}", partial(endure_clients, behavior, many, arguments.seconds)) for behavior, many in CROWDS]
    bad = 0
    print(f"{'peer':32} {'stop s':>7} {'peak MiB':>9} {'late MiB':>9} {'threads left':>13} {'frames':>7} {'sent':>7}", flush=True)
    for name, endure in rows:
        cost = endure()
        bad += cost.stopped_after >= 2.0 or cost.threads_left > 0
        memory = f"{cost.peak_mib:9.1f} {cost.grown_mib:9.1f}"
        print(f"{name:32} {cost.stopped_after:7.2f} {memory} {cost.threads_left:13d} {cost.frames:7d} {cost.expected:7d}", flush=True)
    return 1 if bad else 0
