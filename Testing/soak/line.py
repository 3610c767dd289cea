"""The server's end of a connection that can be cut, stalled and spoiled on purpose."""

from __future__ import annotations

import socket
import struct
import sys
import time
from contextlib import suppress

from AIFReconLib.live.wire.framing import Framer

PATIENCE = 600.0
"""s that a client may take to connect, or to take what was sent."""


class Line:
    """Listens on a port of this machine for one client at a time."""

    def __init__(self, port: int = 0):
        self.port = port
        self.connections = 0
        self._connection: socket.socket | None = None
        self.listen()

    def listen(self) -> None:
        """Open the port, the same as before."""
        self._listener = socket.socket()
        self._listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._listener.bind(("127.0.0.1", self.port))
        self._listener.listen()
        self._listener.settimeout(PATIENCE)
        self.port = self._listener.getsockname()[1]

    def close_port(self) -> None:
        """Be gone: nobody can connect until `listen`."""
        self.hang_up()
        self._listener.close()

    @property
    def is_open(self) -> bool:
        """Whether a client is connected."""
        return self._connection is not None

    def accept(self) -> None:
        """Wait for the client and read its request, so that closing is a clean end and no reset."""
        self._connection, _ = self._listener.accept()
        self._connection.settimeout(PATIENCE)
        self.connections += 1
        framer, asked = Framer(), False
        while not asked and (data := self._connection.recv(4096)):
            asked = bool(framer.feed(data))

    def send(self, data: bytes) -> None:
        """Hand bytes to the operating system, waiting while the client has no room for them."""
        assert self._connection is not None, "nobody is connected"
        self._connection.sendall(data)

    def hang_up(self) -> None:
        """The clean end of a connection: the client gets everything that was sent, then the end of the stream."""
        if self._connection is not None:
            with suppress(OSError):
                self._connection.shutdown(socket.SHUT_WR)
            # What the client has sent meanwhile must be read, else its operating system is told of a reset
            self._connection.settimeout(0.0)
            with suppress(OSError):
                self._connection.recv(4096)
            self._connection.close()
            self._connection = None

    def await_hang_up(self) -> None:
        """Wait until the client gives up the connection, as it does when bytes come that are no message."""
        assert self._connection is not None, "nobody is connected"
        with suppress(ConnectionError):
            while self._connection.recv(4096):
                pass
        self._connection.close()
        self._connection = None

    def reset(self) -> None:
        """The rude end: a reset. First everything sent reaches the client's machine, else nobody could tell which frames were destroyed."""
        assert self._connection is not None, "nobody is connected"
        end = time.monotonic() + PATIENCE
        while _unacknowledged(self._connection) and time.monotonic() < end:
            time.sleep(0.002)
        self._connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self._connection.close()
        self._connection = None


def _unacknowledged(connection: socket.socket) -> int:
    """Bytes sent that the other machine has not confirmed; only Linux tells."""
    if sys.platform != "linux":
        time.sleep(0.2)
        return 0
    import fcntl
    import termios

    return struct.unpack("i", fcntl.ioctl(connection, termios.TIOCOUTQ, b"\0" * 4))[0]
