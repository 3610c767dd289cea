"""Messages between two processes: what is small is pickled, large arrays follow as they are."""

from __future__ import annotations

import os
import pickle
import socket
import struct
import threading
from multiprocessing.connection import Connection

from ..errors import InsufficientMemoryError
from .calls import ERROR, Message

LARGE = 1 << 16
"""Bytes from which on an array crosses by itself: it is read from where it lies, and received where it stays."""


class Channel:
    """One end of a connection. Any thread may send; one receives.

    Parameters
    ----------
    patience : float or None
        s after which an end that takes nothing, or stops in the middle of something, counts as closed; None: it is
        waited for. Not on Windows, where it is waited for.
    """

    def __init__(self, connection: Connection, patience: float | None = None):
        self._connection = connection
        self._sending = threading.Lock()
        # The same end, which takes and fills memory of ours; Windows has no socket here
        self._socket = None if os.name == "nt" else socket.socket(fileno=os.dup(connection.fileno()))
        if self._socket is not None:
            # Whatever another part of the program has made the rule for sockets
            self._socket.setblocking(True)
            limit = struct.pack("ll", int(patience or 0), int((patience or 0) % 1 * 1e6))
            for direction in (socket.SO_SNDTIMEO, socket.SO_RCVTIMEO):
                self._socket.setsockopt(socket.SOL_SOCKET, direction, limit)

    def send(self, message: Message) -> None:
        """Send a message; it holds whatever can be pickled.

        Raises
        ------
        ConnectionError
            When the other end is closed, or takes nothing.
        Exception
            When it cannot be pickled. Nothing was sent then.
        """
        beside: list[memoryview] = []

        def crosses_within(buffer: pickle.PickleBuffer) -> bool:
            raw = buffer.raw()
            if raw.nbytes >= LARGE:
                beside.append(raw)
            return raw.nbytes < LARGE

        text = pickle.dumps(message[1:], protocol=5, buffer_callback=crosses_within)
        with self._sending:
            try:
                self._connection.send((message.number, text, [raw.nbytes for raw in beside]))
                for raw in beside:
                    (self._connection.send_bytes if self._socket is None else self._socket.sendall)(raw)
            except OSError as error:
                raise BrokenPipeError(*error.args) from error

    def poll(self, timeout: float = 0.0) -> bool:
        """Whether something has come, or the other end is closed; waited for so many s."""
        return self._connection.poll(timeout)

    def receive(self) -> Message:
        """What was sent, waited for; where it cannot be had here (no memory, no such class), an `ERROR`.

        Raises EOFError or OSError when the other end is closed.
        """
        number, text, sizes = self._connection.recv()
        beside = [self._receive(size) for size in sizes]
        try:
            if None in beside:
                raise InsufficientMemoryError(f"There is no memory for {sum(sizes) / 1e6:.1f} MB that another process has sent.")
            return Message(number, *pickle.loads(text, buffers=beside))
        except Exception as error:
            return Message(number, ERROR, error)

    def _receive(self, size: int) -> bytearray | None:
        """So many bytes; None where there is no memory for them, and they are lost."""
        if self._socket is None:
            return bytearray(self._connection.recv_bytes())
        try:
            array = bytearray(size)
            room = memoryview(array)
        except MemoryError:
            array, room = None, memoryview(bytearray(LARGE))
        while size:
            came = self._socket.recv_into(room[:size])
            if not came:
                raise EOFError
            size -= came
            room = room if array is None else room[came:]
        return array

    def close(self) -> None:
        """Send and receive no more."""
        if self._socket is not None:
            self._socket.close()
        self._connection.close()
