"""One client of the replay server: what it asks for, and what waits to be sent to it."""

from __future__ import annotations

import socket
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress

from ..wire.connection import POLL
from ..wire.encoding import encode_status
from ..wire.framing import Frame, Framer

QUEUE_BYTES = 64 * 2**20
"""What may wait for a client that reads too slowly; beyond it whole frames are left out, the oldest first."""

REQUEST_LIMIT = 2**20
"""Bytes of a client's message; what Plus understands is far smaller."""

TAKES_NOTHING = 30.0
"""s after which a client that has taken not a byte of what waits for it is given up."""

GREETING = 0.25
"""How long a new client is given to ask for header version 2 before the first frame goes out, s."""


class Peer:
    """Sends in one thread and listens in another, so that a client that reads slowly delays nobody.

    Parameters
    ----------
    connection : socket.socket
        Owned: closed at the end.
    version : int or None
        Header version of everything sent; None: 1 until the client sends a message of version 2, as Plus has it.
    on_gone : function (Peer) -> None
        Called once, when the connection has ended.
    """

    def __init__(self, connection: socket.socket, version: int | None, on_gone: Callable[[Peer], None]):
        self._connection = connection
        self._follows_client = version is None
        self._version = version or 1
        self._on_gone = on_gone
        self._changed = threading.Condition()
        self._waiting: deque[bytes] = deque()
        self._bytes = 0
        self._sending = False
        self._greeted = False
        self._accepted = time.monotonic()
        self._closing = False
        self.dropped = 0

    @property
    def version(self) -> int:
        """Header version of what is sent to it."""
        return self._version

    @property
    def ready(self) -> bool:
        """Whether it has said which version it wants, or has had its time to."""
        return self._greeted or time.monotonic() - self._accepted > GREETING

    def start(self) -> None:
        """Begin to listen and send."""
        self._connection.settimeout(POLL)
        with suppress(OSError):  # it may have left already
            self._connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        for work in (self._listen, self._send):
            threading.Thread(target=work, name=f"replay {work.__name__}", daemon=True).start()

    def offer(self, data: bytes) -> None:
        """Queue whole messages; never waits."""
        with self._changed:
            self._waiting.append(data)
            self._bytes += len(data)
            while self._bytes > QUEUE_BYTES and len(self._waiting) > 1:
                self._bytes -= len(self._waiting.popleft())
                self.dropped += 1
            self._changed.notify_all()

    def drain(self, timeout: float) -> bool:
        """Wait until everything queued is with the operating system; False if it is not after `timeout` s."""
        with self._changed:
            return self._changed.wait_for(lambda: self._closing or not (self._waiting or self._sending), timeout)

    def close(self) -> None:
        """End the connection; both threads end within a moment."""
        with self._changed:
            if self._closing:
                return
            self._closing = True
            self._changed.notify_all()
        self._on_gone(self)

    def _listen(self) -> None:
        framer = Framer(REQUEST_LIMIT)
        while not self._closing:
            try:
                data = self._connection.recv(2**16)
            except TimeoutError as error:
                if error.errno is None:
                    continue
                break
            except OSError:
                break
            if not data:
                break
            for part in framer.feed(data):
                if isinstance(part, Frame):
                    self._answer(part)
        self.close()

    def _answer(self, frame: Frame) -> None:
        if self._follows_client and frame.header.version > 1:
            self._version = 2
        self._greeted = True
        if frame.header.kind == "GET_STATUS":
            self.offer(encode_status("", 0.0, text="\n", version=self._version))

    def _send(self) -> None:
        while (data := self._next()) is not None:
            rest, taken = memoryview(data), time.monotonic()
            while rest and not self._closing:
                try:
                    rest, taken = rest[self._connection.send(rest) :], time.monotonic()
                except TimeoutError as error:
                    if error.errno is not None or time.monotonic() - taken > TAKES_NOTHING:
                        self.close()
                except OSError:
                    self.close()
        self._connection.close()

    def _next(self) -> bytes | None:
        with self._changed:
            self._sending = False
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._waiting or self._closing)
            if self._closing:
                return None
            self._sending = True
            data = self._waiting.popleft()
            self._bytes -= len(data)
            return data
