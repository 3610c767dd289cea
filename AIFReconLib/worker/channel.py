"""Objects between two processes: a connection for what is small, and memory that both see for arrays."""

from __future__ import annotations

import mmap
import os
import pickle
import socket
import struct
import threading
import weakref
from collections import deque
from contextlib import suppress
from multiprocessing import resource_tracker, set_executable
from multiprocessing.connection import Connection
from multiprocessing.shared_memory import SharedMemory
from typing import Any, cast

import numpy as np
from numpy.typing import DTypeLike

from ..errors import InsufficientMemoryError
from ..machine.processes import python_program
from .calls import ERROR, Message

LARGE = 1 << 20
"""Bytes from which on an array crosses in shared memory: what is smaller is as fast through the connection."""

_ours: weakref.WeakKeyDictionary[mmap.mmap, str] = weakref.WeakKeyDictionary()
"""Memory that was made here, and its name: an array that lies in it is not copied again to be sent."""


class _Memory(SharedMemory):
    """Shared memory that may be closed while arrays lie in it: its mapping goes with the last of them."""

    _fd: int
    _buf: memoryview | None
    _mmap: mmap.mmap | None

    def mapping(self) -> mmap.mmap:
        """What arrays are made of; closes this."""
        mapping, self._buf, self._mmap = self._mmap, None, None
        self.close()
        return cast(mmap.mmap, mapping)


def _made(size: int) -> mmap.mmap | None:
    """Memory for so many bytes, freed when neither side uses it any more; None where there is none."""
    # Python's own process, which frees the memory of a program that was killed
    set_executable(python_program())
    try:
        memory = _Memory(create=True, size=size)
    except (OSError, ValueError):
        return None
    try:
        # Else want of memory would end the process that writes to it
        if hasattr(os, "posix_fallocate"):
            os.posix_fallocate(memory._fd, 0, size)
    except OSError:
        memory.close()
        memory.unlink()
        return None
    mapping = memory.mapping()
    weakref.finalize(mapping, _free, memory)
    _ours[mapping] = memory.name
    return mapping


def _free(memory: SharedMemory) -> None:
    with suppress(FileNotFoundError):
        memory.unlink()


def _seen(name: str, size: int) -> mmap.mmap:
    """Memory that the other side has made; raises InsufficientMemoryError where there is no room for it here."""
    try:
        memory = _Memory(name)
    except FileNotFoundError:
        # It went with the process that had made it
        raise EOFError from None
    except OSError as error:
        what = f"There is no memory for {size / 1e6:.1f} MB that two processes share ({error})."
        raise InsufficientMemoryError(what) from error
    if os.name != "nt":
        # Python 3.13 has `track=False`: only who has made it frees it
        resource_tracker.unregister(memory._name, "shared_memory")  # type: ignore[attr-defined]
    return memory.mapping()


def shared_array(shape: tuple[int, ...], dtype: DTypeLike) -> np.ndarray[Any, Any]:
    """An array of zeros that can be sent without another copy. The receiver sees what is written to it later, too."""
    count = int(np.prod(shape, dtype=np.int64))
    size = count * np.dtype(dtype).itemsize
    mapping = _made(size) if size >= LARGE else None
    return np.zeros(shape, dtype) if mapping is None else np.frombuffer(mapping, dtype, count).reshape(shape)


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
        self._sent = self._received = 0
        self._kept: deque[tuple[int, list[mmap.mmap]]] = deque()
        if os.name != "nt" and patience is not None:
            with socket.socket(fileno=os.dup(connection.fileno())) as same:
                # Whatever another part of the program has made the rule for sockets
                same.setblocking(True)
                for direction in (socket.SO_SNDTIMEO, socket.SO_RCVTIMEO):
                    same.setsockopt(socket.SOL_SOCKET, direction, struct.pack("ll", int(patience), int(patience % 1 * 1e6)))

    def send(self, message: Message) -> None:
        """Send a message; it holds whatever can be pickled.

        Raises
        ------
        ConnectionError
            When the other end is closed, or takes nothing.
        Exception
            When it cannot be pickled. Nothing was sent then.
        """
        mappings: list[mmap.mmap] = []
        places: list[tuple[str, int, int]] = []

        def crosses_within(buffer: pickle.PickleBuffer) -> bool:
            raw = buffer.raw()
            placed = _placed(raw) if raw.nbytes >= LARGE else None
            if placed is None:
                return True
            mappings.append(placed[0])
            places.append((_ours[placed[0]], placed[1], raw.nbytes))
            return False

        text = pickle.dumps(message[1:], protocol=5, buffer_callback=crosses_within)
        with self._sending:
            self._sent += 1
            # Until the other end says that it has it
            self._kept.append((self._sent, mappings))
            try:
                self._connection.send((message.number, self._received, places, text))
            except OSError as error:
                raise BrokenPipeError(*error.args) from error

    def poll(self, timeout: float = 0.0) -> bool:
        """Whether something has come, or the other end is closed; waited for so many s."""
        return self._connection.poll(timeout)

    def receive(self) -> Message:
        """What was sent, waited for; where it cannot be had here (no memory, no such class), an `ERROR`.

        Raises EOFError or OSError when the other end is closed.
        """
        number, heard, places, text = self._connection.recv()
        while self._kept and self._kept[0][0] <= heard:
            self._kept.popleft()
        try:
            seen = {name: _seen(name, first + size) for name, first, size in places}
            buffers = [memoryview(seen[name])[first : first + size] for name, first, size in places]
            message = Message(number, *pickle.loads(text, buffers=buffers))
        except EOFError:
            raise
        except Exception as error:
            return Message(number, ERROR, error)
        finally:
            self._received += 1
        return message

    def close(self) -> None:
        """Send and receive no more."""
        self._connection.close()
        self._kept.clear()


def _placed(array: memoryview) -> tuple[mmap.mmap, int] | None:
    """Memory of ours in which an array lies, or a copy of it, and its first byte there; None where there is none."""
    address = _address(array)
    for reference in _ours.keyrefs():
        mapping = reference()
        first = -1 if mapping is None else address - _address(mapping)
        if mapping is not None and first >= 0 and first + array.nbytes <= len(mapping):
            return mapping, first
    made = _made(array.nbytes)
    if made is None:
        return None
    made[: array.nbytes] = array
    return made, 0


def _address(buffer: memoryview | mmap.mmap) -> int:
    return int(np.frombuffer(buffer, np.uint8).__array_interface__["data"][0])
