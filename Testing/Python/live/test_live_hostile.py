"""Peers that mean no good: a live session can always be stopped and holds little; the replay server serves the others."""

from __future__ import annotations

import os
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from itertools import count, islice, repeat

import psutil
import pytest
from files import tracked_sequence
from igtl_streams import image_bytes, transform_bytes, wait_for, with_size

from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.live.replay.server import ReplayServer
from AIFReconLib.live.session.session import LiveSession
from AIFReconLib.live.wire.client import OpenIGTLinkClient
from AIFReconLib.live.wire.encoding import encode_message, encode_status_request
from AIFReconLib.recipe.recipe import ReconstructionSettings

PATIENCE = 60.0
"""s. Nobody waits that long for a thread that is stopped, however slow the machine; one that hangs takes longer."""

MOST_MIB = 500.0
"""What the bounded queues of a client hold in the worst case, and then some."""

GARBAGE = os.urandom(2**20)

# ---- servers, each what it sends to a client, without end where nothing else is said


def silent() -> Iterator[bytes]:
    while True:
        time.sleep(0.1)
        yield b""


def one_byte_a_second() -> Iterator[bytes]:
    for byte in image_bytes():
        yield from (bytes([byte]), *islice(silent(), 10))


def a_long_message_that_never_ends() -> Iterator[bytes]:
    """It declares as much as is allowed."""
    yield with_size(image_bytes(), 2**26)[:58]
    while True:
        time.sleep(0.05)
        yield GARBAGE[: 2**18]


SERVERS: dict[str, Callable[[], Iterator[bytes]]] = {
    "silent": silent,
    "one byte a second": one_byte_a_second,
    "garbage": partial(repeat, GARBAGE),
    "headers, each within the other": partial(repeat, b"junk" + image_bytes()[:58] * 2000),
    "a long message that never ends": a_long_message_that_never_ends,
    "ever new names": lambda: (transform_bytes(device=f"T{number:x}ToTracker") for number in count()),
    "megabytes of metadata": partial(repeat, transform_bytes(version=2, metadata={"Note": "x" * 2**22})),
    "half a million tools": partial(repeat, encode_message("TDATA", "Tracker", 1.0, bytes(70) * 500_000)),
    "closes at once": lambda: iter(()),
}


@contextmanager
def hostile_server(behavior: Callable[[], Iterator[bytes]]) -> Iterator[int]:
    """A server that treats every client alike; gives its port."""
    ending = threading.Event()

    def serve() -> None:
        while not ending.is_set():
            # Also when the client leaves, or nobody comes for a while
            with suppress(OSError), listener.accept()[0] as connection:
                connection.settimeout(0.1)
                for data in behavior():
                    rest = memoryview(data)
                    while rest and not ending.is_set():
                        with suppress(TimeoutError):
                            rest = rest[connection.send(rest) :]
                    if ending.is_set():
                        break

    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.settimeout(0.1)
        server = threading.Thread(target=serve, daemon=True)
        server.start()
        yield listener.getsockname()[1]
        ending.set()
        server.join()


@contextmanager
def little_is_held_and_no_thread_left() -> Iterator[None]:
    """What is begun within is looked at for a second, and must be stopped within."""
    threads, before, most = threading.active_count(), psutil.Process().memory_info().rss, [0.0]
    is_over = threading.Event()

    def watch() -> None:
        while not is_over.wait(0.1):
            most[0] = max(most[0], (psutil.Process().memory_info().rss - before) / 2**20)

    watcher = threading.Thread(target=watch)
    watcher.start()
    try:
        yield
    finally:
        is_over.set()
        watcher.join()
    assert most[0] < MOST_MIB
    wait_for(lambda: threading.active_count() <= threads, "the end of all threads")


@pytest.mark.parametrize("behavior", SERVERS.values(), ids=SERVERS)
def test_a_session_with_a_hostile_server_stops_at_once_and_holds_little(behavior):
    grid = VoxelGrid.from_spacing((0.0, 0.0, 0.0), (9, 9, 9), 1.0)
    with hostile_server(behavior) as port, little_is_held_and_no_thread_left():
        session = LiveSession(OpenIGTLinkClient("127.0.0.1", port), ReconstructionSettings(clip_px=(0,) * 4), grid=grid)
        session.start()
        time.sleep(1.0)
        asked = time.monotonic()
        session.stop()
        assert time.monotonic() - asked < PATIENCE


CLIENTS = {"reads nothing": (encode_status_request(), 20), "garbage": (GARBAGE, 20), "silent": (b"", 100)}


@pytest.mark.parametrize(("sent", "many"), CLIENTS.values(), ids=CLIENTS)
def test_hostile_clients_take_nothing_from_an_honest_one(sent, many):
    with little_is_held_and_no_thread_left(), ExitStack() as crowd:
        server = crowd.enter_context(ReplayServer(tracked_sequence(), port=0, rate=20.0, loop=True))
        honest = crowd.enter_context(OpenIGTLinkClient("127.0.0.1", server.port, queue_size=100_000))
        wait_for(lambda: honest.statistics.count("IMAGE"))
        for _ in range(many):
            connection = crowd.enter_context(socket.create_connection(("127.0.0.1", server.port), timeout=10.0))
            connection.settimeout(0.0)
            with suppress(OSError):
                connection.send(sent)
        began = honest.statistics.count("IMAGE")
        wait_for(lambda: honest.statistics.count("IMAGE") > began + 20, "images beside a crowd")
