"""Objects between two processes: a pipe for what is small, and for everything else memory that both see."""

from __future__ import annotations

import mmap
import os
import pickle
import socket
import struct
import sys
import tempfile
import threading
import uuid
import weakref
from collections import deque
from multiprocessing.connection import Connection, Pipe
from typing import Any, cast

import numpy as np
from numpy.typing import DTypeLike

from ..errors import InsufficientMemoryError
from .calls import Message, Returned

LARGE = 1 << 16
"""Bytes from which on something crosses in shared memory: what is smaller is as fast through the pipe."""

ALIGNED = 64
"""Bytes: an array begins at a multiple of it."""

OWN = 8
"""An array that takes this part of all has memory of its own, so that it goes when it is dropped, whatever else is kept."""

KEPT_UNTIL_SEEN = sys.platform != "linux"
"""Whether memory is lost on its way unless its sender keeps it: on Windows it is opened by name, and macOS may close its descriptor."""

CHUNK = 1 << 20


class Memory(mmap.mmap):
    """Memory that another process can be given.

    It has no name, and the system frees it with the last process that sees it, however that ends. On Linux it is no file either, so the
    limit of ``/dev/shm`` does not hold; on macOS it is a file that is deleted already; on Windows a mapping that goes with its last handle.

    Raises InsufficientMemoryError when there is none.

    Parameters
    ----------
    size : int
    handle : int, str or None
        Of memory that another process has made: a file descriptor, which is closed with this, or on Windows the mapping's name.
    """

    handle: int | str

    def __new__(cls, size: int, handle: int | str | None = None) -> Memory:
        try:
            if os.name == "nt":
                handle = handle or f"aifrecon-{uuid.uuid4().hex}"
                memory = super().__new__(cls, -1, size, tagname=handle)  # type: ignore[call-arg]
            else:
                handle = _without_name(size) if handle is None else int(handle)
                try:
                    memory = super().__new__(cls, handle, size)
                except BaseException:
                    os.close(handle)
                    raise
                weakref.finalize(memory, os.close, handle)
        except (OSError, OverflowError, ValueError) as error:
            raise InsufficientMemoryError(f"There is no memory for {size / 1e6:.1f} MB that two processes share ({error}).") from error
        memory.handle = handle
        _known[_address(memory)] = memory
        return memory


_known: weakref.WeakValueDictionary[int, Memory] = weakref.WeakValueDictionary()
"""Memory of this process by its address: an array that lies in it is not copied again to be sent."""


def shared_array(shape: tuple[int, ...], dtype: DTypeLike) -> np.ndarray[Any, Any]:
    """An array of zeros that can be sent without another copy. The receiver sees what is written to it later, too."""
    size = int(np.prod(shape, dtype=np.int64)) * np.dtype(dtype).itemsize
    if size < LARGE:
        return np.zeros(shape, dtype)
    return np.frombuffer(Memory(size), dtype).reshape(shape)


def connected() -> tuple[Connection, Connection]:
    """Two ends of a new connection, in both directions."""
    return Pipe()


class Channel:
    """One end of a connection. Any thread may send; one receives.

    Parameters
    ----------
    connection : Connection
    patience : float or None
        s after which an end that takes nothing, or stops in the middle of something, counts as closed; None: it is waited for. Not on
        Windows, where it is waited for.
    """

    def __init__(self, connection: Connection, patience: float | None = None):
        self._connection = connection
        self._sending = threading.Lock()
        self._sent = self._received = 0
        self._kept: deque[tuple[int, list[Memory]]] = deque()
        if os.name != "nt":
            self._socket = socket.socket(fileno=os.dup(connection.fileno()))
            # Whatever another part of the program has made the rule for sockets
            self._socket.setblocking(True)
            if patience is not None:
                for direction in (socket.SO_SNDTIMEO, socket.SO_RCVTIMEO):
                    self._socket.setsockopt(socket.SOL_SOCKET, direction, struct.pack("ll", int(patience), int(patience % 1 * 1e6)))

    def send(self, what: Message) -> None:
        """Send a message; it holds whatever can be pickled.

        Raises
        ------
        ConnectionError
            When the other end is closed, or takes nothing.
        InsufficientMemoryError, Exception
            When there is no memory for it, or it cannot be pickled. Nothing was sent then.
        """
        large: list[memoryview] = []

        def is_small(buffer: pickle.PickleBuffer) -> bool:
            raw = buffer.raw()
            if raw.nbytes >= LARGE:
                large.append(raw)
            return raw.nbytes < LARGE

        text: bytes | None = pickle.dumps(what, protocol=5, buffer_callback=is_small)
        if len(text or b"") >= LARGE:
            # Through the pipe the sender would wait for whoever reads it
            large.append(memoryview(text or b""))
            text = None
        memories, places = _laid_out(large)
        sizes, names = [len(memory) for memory in memories], [memory.handle for memory in memories]
        with self._sending:
            self._sent += 1
            if memories and KEPT_UNTIL_SEEN:
                self._kept.append((self._sent, memories))
            header = pickle.dumps((what.number, self._received, text, places, sizes, names))
            try:
                self._connection.send_bytes(header)
                if os.name != "nt":
                    for name in names:
                        socket.send_fds(self._socket, [b"."], [cast(int, name)])
            except OSError as error:
                raise BrokenPipeError(*error.args) from error

    def poll(self, timeout: float = 0.0) -> bool:
        """Whether something has come, or the other end is closed; waited for so many s."""
        return self._connection.poll(timeout)

    def receive(self) -> Message:
        """What was sent, waited for; where it cannot be had here (no memory, no such class), `Returned` with the error.

        Raises EOFError or OSError when the other end is closed.
        """
        number, seen, text, places, sizes, names = pickle.loads(self._connection.recv_bytes())
        if os.name != "nt":
            names = [self._descriptor() for _name in names]
        while self._kept and self._kept[0][0] <= seen:
            self._kept.popleft()
        memories: list[Memory] = []
        try:
            while names:
                memories.append(Memory(sizes[len(memories)], names.pop(0)))
            buffers = [memoryview(memories[place])[start:stop] for place, start, stop in places]
            what: Message = pickle.loads(buffers.pop() if text is None else text, buffers=buffers)
        except Exception as error:
            return Returned(number, error=error)
        finally:
            self._received += 1
            if os.name != "nt":
                for name in names:
                    os.close(name)
        return what

    def _descriptor(self) -> int:
        _byte, descriptors, _flags, _address = socket.recv_fds(self._socket, 1, 1)
        if not descriptors:
            raise OSError("A descriptor of shared memory did not come: too many files are open")
        # No program that is started from here keeps the memory
        os.set_inheritable(descriptors[0], False)
        return descriptors[0]

    def close(self) -> None:
        """Send and receive no more."""
        self._connection.close()
        if os.name != "nt":
            self._socket.close()


def _laid_out(arrays: list[memoryview]) -> tuple[list[Memory], list[tuple[int, int, int]]]:
    """Memory that holds these arrays, and of each where it lies: number of the memory, first byte, byte after the last."""
    held = [_holding(array) for array in arrays]
    total = sum(array.nbytes for array, (memory, _first) in zip(arrays, held) if memory is None)
    memories: list[Memory] = []
    places: list[tuple[int, int, int]] = []
    together: list[int] = []
    size = 0
    for number, (array, (memory, first)) in enumerate(zip(arrays, held)):
        if memory is None and array.nbytes * OWN >= total:
            memory = Memory(array.nbytes)
            memory[:] = array
        if memory is None:
            together.append(number)
            places.append((-1, size, size + array.nbytes))
            size += -(-array.nbytes // ALIGNED) * ALIGNED
            continue
        if not any(memory is each for each in memories):
            memories.append(memory)
        place = next(n for n, each in enumerate(memories) if each is memory)
        places.append((place, first, first + array.nbytes))
    if together:
        memories.append(shared := Memory(size))
        for number in together:
            _, start, stop = places[number]
            shared[start:stop] = arrays[number]
            places[number] = len(memories) - 1, start, stop
    return memories, places


def _holding(array: memoryview) -> tuple[Memory | None, int]:
    """The memory that an array lies in, if any, and its first byte there."""
    address = _address(array)
    for start, memory in tuple(_known.items()):
        if start <= address and address + array.nbytes <= start + len(memory):
            return memory, address - start
    return None, 0


def _address(buffer: memoryview | mmap.mmap) -> int:
    return int(np.frombuffer(buffer, np.uint8).__array_interface__["data"][0])


def _without_name(size: int) -> int:
    """The descriptor of a file that no folder knows, so large. Its bytes are there: none will be missed when it is written to."""
    if hasattr(os, "memfd_create"):
        descriptor = os.memfd_create("aifrecon")
        try:
            os.posix_fallocate(descriptor, 0, size)
        except BaseException:
            os.close(descriptor)
            raise
        return descriptor
    with tempfile.TemporaryFile() as file:
        for start in range(0, size, CHUNK):
            file.write(bytes(min(CHUNK, size - start)))
        file.flush()
        return os.dup(file.fileno())
