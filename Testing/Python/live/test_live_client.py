"""The OpenIGTLink client against real sockets: what arrives, and everything that can go wrong on the way."""

from __future__ import annotations

import contextlib
import socket
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack
from unittest.mock import Mock

import numpy as np
import pytest
from igtl_streams import Inbox, ScriptedServer, image_bytes, picture, transform_bytes, wait_for, with_size

from AIFReconLib.errors import LiveConnectionError, SettingsError
from AIFReconLib.live.wire.client import OpenIGTLinkClient
from AIFReconLib.live.wire.connection import open_connection
from AIFReconLib.live.wire.encoding import encode_status_request
from AIFReconLib.live.wire.messages import StreamEvent, TransformMessage

QUICK = {"retry_delays": (0.02,), "stall_after": 30.0}


@pytest.fixture
def server() -> Iterator[ScriptedServer]:
    with ScriptedServer() as server:
        yield server


@pytest.fixture
def connect(server):
    """Starts a client of the server, waits for its connection and its request, and gives its inbox."""
    with ExitStack() as clients:

        def start(**options) -> Inbox:
            client = clients.enter_context(OpenIGTLinkClient("127.0.0.1", server.port, **{**QUICK, **options}))
            server.accept()
            # The first thing that is sent on every connection
            assert server.receive(len(encode_status_request())) == encode_status_request()
            return Inbox(client)

        yield start


def free_port() -> int:
    """A port on which nobody listens."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.fixture
def silent_port() -> Iterator[int]:
    """A port that neither accepts nor refuses, as behind a firewall: its queue of connections is full."""
    if sys.platform != "linux":
        pytest.skip("elsewhere a full queue of connections refuses instead of keeping silent")
    with socket.socket() as listener, ExitStack() as waiting:
        listener.bind(("127.0.0.1", 0))
        listener.listen(0)
        for _ in range(3):
            probe = waiting.enter_context(socket.socket())
            probe.setblocking(False)
            probe.connect_ex(listener.getsockname())
        yield listener.getsockname()[1]


# ---- what arrives


def test_images_and_transforms_arrive_in_order_and_the_devices_are_known_with_their_types(server, connect):
    inbox = connect()
    server.send(*(image_bytes(picture(n), timestamp=n) + transform_bytes(timestamp=n) for n in range(1, 6)))
    server.send(transform_bytes(device="Image_Reference", timestamp=6))
    inbox.until_transform("Image_Reference")
    assert [type(message).__name__ for message in inbox.messages[1:-1]] == ["ImageMessage", "TransformMessage"] * 5
    assert [image.timestamp for image in inbox.images()] == [1, 2, 3, 4, 5]
    assert inbox.client.devices() == {"Image_Reference": ("IMAGE", "TRANSFORM"), "ProbeToTracker": ("TRANSFORM",)}


# ---- damage, and the end of a connection

NO_MESSAGE = "Bytes arrived that are no OpenIGTLink message. C"


ENDS = {
    "zeros": (b"\0" * 58, NO_MESSAGE),
    "http": (b"HTTP/1.1 400 Bad Request\r\n" * 4, NO_MESSAGE),
    "size": (with_size(transform_bytes(), 2**40), "A message (TRANSFORM of ProbeToTracker) declares 1099511627776"),
    "end": (b"", "The server closed the connection. C"),
    "cut": (image_bytes()[:78], "The server closed the connection in the middle of a message. C"),
}


@pytest.mark.parametrize(("damage", "told"), ENDS.values(), ids=ENDS)
def test_what_ends_a_connection_is_told_and_the_next_one_goes_on(server, connect, damage, told):
    inbox = connect()
    server.send(transform_bytes(device="Before"), damage)
    if "closed" in told:
        server.hang_up()
    else:
        server.send(transform_bytes(device="Behind"))
    assert inbox.until_event("disconnected").detail.startswith(told)
    server.accept().send(transform_bytes(device="After"))
    inbox.until_transform("After")
    assert [message.device for message in inbox.transforms()] == ["Before", "After"]
    assert (inbox.images(), inbox.client.statistics.reconnects) == ([], 1)


SPOILED = image_bytes()[:-1] + bytes([image_bytes()[-1] ^ 1])
UNCHECKED = image_bytes()[:50] + bytes(8) + image_bytes()[58:]
DEEP = image_bytes(np.zeros((3, 4, 5), np.uint8))


UNUSABLE = {
    "damaged": (SPOILED, "A message (IMAGE of Image_Reference) has a wrong checksum. It is left out"),
    "no checksum": (UNCHECKED, "A message (IMAGE of Image_Reference) has no checksum: its sender leaves it at 0. It is left out"),
    "3D": (DEEP, "IMAGE message of 'Image_Reference' holds 5 x 4 x 3 pixels: frames must be 2D"),
}


@pytest.mark.parametrize(("message", "why"), UNUSABLE.values(), ids=UNUSABLE)
def test_what_cannot_be_used_is_counted_and_told_but_not_with_every_message(server, connect, message, why):
    inbox = connect()
    server.send(*[message] * 50, transform_bytes())
    inbox.until_transform("ProbeToTracker")
    told = inbox.events("refused")
    assert told[0].detail.startswith(why)
    counted = inbox.client.statistics
    assert (inbox.images(), counted.refused, counted.damaged) == ([], *((50, 0) if message is DEEP else (0, 50)))
    assert len(told) < 50


@pytest.mark.parametrize("arrived", [0, 30, 78])
def test_a_stall_is_reported_once_and_survived(server, connect, arrived):
    inbox = connect(stall_after=0.1)
    data = image_bytes()
    server.send(transform_bytes(device="Before"), data[:arrived])
    inbox.until_transform("Before")
    # On a busy machine there may have been one before the first message
    told = inbox.until_event("stalled", 1 + len(inbox.events("stalled"))).detail
    assert f"nothing arrived{' in the middle of a message' if arrived else ''}. Waiting; check 127.0.0.1" in told
    time.sleep(0.3)
    while (message := inbox.client.get(0)) is not None:
        assert not isinstance(message, StreamEvent)
    server.send(data[arrived:])
    inbox.until(lambda inbox: inbox.images())
    assert np.array_equal(inbox.images()[0].image, picture())


# ---- no connection


def test_pauses_between_attempts_grow_and_the_last_one_repeats():
    port = free_port()
    with OpenIGTLinkClient("127.0.0.1", port, retry_delays=(0.01, 0.02, 0.03)) as client:
        inbox = Inbox(client)
        inbox.until_event("disconnected", 4)
    told = [event.detail for event in inbox.events("disconnected")[:4]]
    assert [detail.split()[-2] for detail in told] == ["0.01", "0.02", "0.03", "0.03"]
    assert f"127.0.0.1 has no server on port {port}. Start the server there" in told[0]


@pytest.mark.parametrize(
    ("host", "why"),
    [
        ("127.0.0.1", "has no server on port"),
        ("nowhere.invalid", r"Host 'nowhere\.invalid' cannot be found \(Name or service not known\)"),
    ],
)
def test_a_first_attempt_that_fails_is_an_error_where_it_is_waited_for(host, why, monkeypatch):
    client = OpenIGTLinkClient(host, free_port(), **QUICK)
    if host != "127.0.0.1":
        monkeypatch.setattr(socket, "getaddrinfo", Mock(side_effect=socket.gaierror(-2, "Name or service not known")))
    with pytest.raises(LiveConnectionError, match=why):
        client.start(wait=True)
    assert client.state == "stopped"


def test_a_machine_that_does_not_answer_is_given_up_after_the_timeout(silent_port):
    with pytest.raises(LiveConnectionError, match=f"does not answer on port {silent_port} within 0.2 s"):
        open_connection("127.0.0.1", silent_port, 0.2)


def test_a_missing_codec_is_reported_before_anything_is_started(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyigtl", None)
    with pytest.raises(LiveConnectionError, match="pip install pyigtl"):
        OpenIGTLinkClient("localhost", 18944).start()


@pytest.mark.parametrize(
    ("name", "bad", "why"),
    [
        *(("port", port, "Input port must be a whole number from 1 to 65535") for port in (0, -1, 65536, "18944", 18944.0, True)),
        *(("host", host, "Input host must be") for host in ("", "  ", None, 7)),
    ],
)
def test_an_address_that_is_none_is_refused(name, bad, why):
    with pytest.raises(SettingsError, match=why):
        OpenIGTLinkClient(**{"host": "localhost", "port": 18944, name: bad})


# ---- stopping


def stop(client: OpenIGTLinkClient) -> None:
    """Stop a client, twice; its thread ends."""
    client.stop()
    client.stop()
    assert client.state == "stopped"
    wait_for(lambda: not any(thread.name.endswith(f":{client.port}") for thread in threading.enumerate()), "the end of the thread")


@pytest.mark.parametrize("state", ["waiting to reconnect", "connecting"])
def test_it_stops_while_there_is_no_connection(state, silent_port):
    port = silent_port if state == "connecting" else free_port()
    client = OpenIGTLinkClient("127.0.0.1", port, retry_delays=(60.0,), connect_timeout=2.0)
    client.start()
    wait_for(lambda: client.state == state)
    stop(client)


def test_it_stops_in_the_middle_of_a_message_and_what_was_received_can_be_taken(server, connect):
    inbox = connect()
    server.send(transform_bytes(), image_bytes()[:70])
    wait_for(lambda: inbox.client.statistics.count("TRANSFORM") == 1)
    stop(inbox.client)
    inbox.until_transform("ProbeToTracker")


def test_after_a_stop_every_message_was_taken_or_is_counted_as_dropped(server, connect):
    for _ in range(5):
        inbox = connect(queue_size=50)
        stopper = threading.Timer(0.05, stop, (inbox.client,))
        stopper.start()
        with contextlib.suppress(OSError):
            for n in range(20_000):
                server.send(transform_bytes(timestamp=n))
        stopper.join()
        taken = 0
        while (message := inbox.client.get(timeout=0)) is not None:
            taken += isinstance(message, TransformMessage)
        statistics = inbox.client.statistics
        assert statistics.count("TRANSFORM") == taken + statistics.dropped


# ---- a slow reader of the queue


SLOW = {
    # One place in the queue is held by the event of the connection
    "messages": ({"queue_size": 20}, lambda n: transform_bytes(timestamp=n), 19),
    "pixels": ({"queue_bytes": 50_000}, lambda n: image_bytes(picture(rows=100, columns=100), timestamp=n), 5),
}


@pytest.mark.parametrize(("limits", "message", "kept"), SLOW.values(), ids=SLOW)
def test_a_slow_consumer_loses_the_oldest_messages_and_is_told_how_many(server, connect, limits, message, kept):
    inbox = connect(**limits)
    server.send(*map(message, range(40)))
    wait_for(lambda: inbox.client.statistics.dropped == 40 - kept, "the dropped messages")
    inbox.until(lambda inbox: [each for each in inbox.messages if getattr(each, "timestamp", 0) == 39])
    taken = [each.timestamp for each in inbox.messages if not isinstance(each, StreamEvent)]
    assert taken == list(range(40 - kept, 40))
    assert inbox.events("dropped")[0].detail.startswith(f"{40 - kept} messages were left out")
