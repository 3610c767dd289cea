"""OpenIGTLink streams for tests: messages packed by pyigtl, recorded bytes of real servers, and a server that sends what a test says."""

from __future__ import annotations

import lzma
import socket
import time
from collections.abc import Callable
from functools import lru_cache

import numpy as np
import pyigtl
import pytest
from waiting import PATIENCE, until

from AIFReconLib.live.wire.messages import ImageMessage, StreamEvent, TransformMessage

DEADLINE = PATIENCE
"""How long a test waits for something that must happen, s."""

RECORDINGS = {
    "A": "A_spine_image_transform_hv1",
    "B": "B_nwire_image_transform_hv2",
    "C": "C_bone_all_types_hv2",
    "H": "H_spine_slowclient_hv1",
    "J": "J_spine_probe_invalid_hv2",
}

POSE = np.array([[0.0, -0.2, 0.0, 10.0], [0.1, 0.0, 0.0, -20.0], [0.0, 0.0, 1.0, 30.0], [0.0, 0.0, 0.0, 1.0]])


def recorded(data_dir, letter: str) -> bytes:
    """What a real PlusServer sent to one client."""
    path = data_dir / "igtl" / f"{RECORDINGS[letter]}.igtl.bin.xz"
    if not path.is_file():
        pytest.skip(f"{path} is not there")
    return _decompressed(path)


@lru_cache(maxsize=2)
def _decompressed(path) -> bytes:
    return lzma.decompress(path.read_bytes())


def picture(seed: int = 0, rows: int = 5, columns: int = 7, dtype="uint8") -> np.ndarray:
    """Pixels that are all over the range of their type."""
    rng = np.random.default_rng(seed)
    return (rng.random((rows, columns)) * 255).astype(dtype)


def packed(message: pyigtl.MessageBase, version: int = 1, metadata: dict[str, str] | None = None) -> bytes:
    """The bytes of a message, by pyigtl."""
    message.header_version = version
    message.metadata = metadata or {}
    return message.pack()


def image_bytes(image=None, matrix=POSE, device="Image_Reference", timestamp=100.5, version=1, metadata=None, system="ras") -> bytes:
    """An IMAGE message; a 2D array becomes its one slice."""
    image = picture() if image is None else image
    voxels = image[None] if image.ndim == 2 else image
    message = pyigtl.ImageMessage(
        voxels, ijk_to_world_matrix=matrix, world_coordinate_system=system, timestamp=timestamp, device_name=device
    )
    return packed(message, version, metadata)


def transform_bytes(matrix=POSE, device="ProbeToTracker", timestamp=100.5, version=1, metadata=None) -> bytes:
    """A TRANSFORM message."""
    return packed(pyigtl.TransformMessage(matrix, timestamp=timestamp, device_name=device), version, metadata)


def with_size(message: bytes, size: int) -> bytes:
    """The message with another body size in its header."""
    return message[:42] + size.to_bytes(8, "big") + message[50:]


class ScriptedServer:
    """A listening socket on 127.0.0.1; the test says what is sent and when. Use it in a `with` block."""

    def __init__(self, port: int = 0):
        self._listener = socket.socket()
        self._listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._listener.bind(("127.0.0.1", port))
        self._listener.listen()
        self._listener.settimeout(DEADLINE)
        self.port = self._listener.getsockname()[1]
        self._connection: socket.socket | None = None

    def __enter__(self) -> ScriptedServer:
        return self

    def __exit__(self, *_) -> None:
        self.hang_up()
        self._listener.close()

    def accept(self) -> ScriptedServer:
        """Wait for a client; one that was there before is left."""
        self.hang_up()
        self._connection, _ = self._listener.accept()
        self._connection.settimeout(DEADLINE)
        return self

    @property
    def connection(self) -> socket.socket:
        """To the client that was accepted."""
        assert self._connection is not None, "no client was accepted"
        return self._connection

    def send(self, *parts: bytes) -> None:
        """Send bytes."""
        self.connection.sendall(b"".join(parts))

    def receive(self, size: int) -> bytes:
        """So many bytes of what the client sends."""
        data = b""
        while len(data) < size and (chunk := self.connection.recv(size - len(data))):
            data += chunk
        return data

    def hang_up(self) -> None:
        """Close the connection as a server does that ends."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None


def wait_for(condition: Callable[[], object], what: str = "the condition") -> None:
    """Wait until the condition holds; it must."""
    assert until(condition), f"{what} did not come"


class Inbox:
    """Everything that a client hands out, read as it comes."""

    def __init__(self, client) -> None:
        self.client = client
        self.messages: list = []

    def until(self, condition: Callable[[Inbox], object], what: str = "what was awaited") -> Inbox:
        """Read until the condition holds; fails the test after the deadline."""
        end = time.monotonic() + DEADLINE
        while not condition(self):
            message = self.client.get(timeout=0.05)
            if message is not None:
                self.messages.append(message)
            elif time.monotonic() > end:
                pytest.fail(f"{what} did not come within {DEADLINE} s; came: {self.messages}; {self.client.statistics}")
        return self

    def until_event(self, kind: str, count: int = 1) -> StreamEvent:
        """Read until so many events of a kind have come; returns the last."""
        self.until(lambda inbox: len(inbox.events(kind)) >= count, f"event {count} of kind {kind}")
        return self.events(kind)[count - 1]

    def until_transform(self, device: str) -> TransformMessage:
        """Read until a transform has come."""
        self.until(lambda inbox: inbox.transforms(device), f"transform {device}")
        return self.transforms(device)[-1]

    def events(self, kind: str) -> list[StreamEvent]:
        """Events of a kind, so far."""
        return [message for message in self.messages if isinstance(message, StreamEvent) and message.kind == kind]

    def images(self) -> list[ImageMessage]:
        """Images so far."""
        return [message for message in self.messages if isinstance(message, ImageMessage)]

    def transforms(self, device: str | None = None) -> list[TransformMessage]:
        """Transforms so far."""
        return [message for message in self.messages if isinstance(message, TransformMessage) and device in (None, message.device)]
