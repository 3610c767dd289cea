"""Objects between two processes: a pipe for what is small, and for arrays memory that both see."""

from __future__ import annotations

import mmap
import os
import pickle
import socket
import tempfile
import threading
import uuid
import weakref
from multiprocessing.connection import Connection
from typing import Any

import numpy as np
from numpy.typing import DTypeLike

LARGE = 1 << 16
"""Bytes from which on an array crosses in shared memory: what is smaller is as fast through the pipe."""

ALIGNED = 64
"""Bytes: an array begins at a multiple of it."""


class Memory(mmap.mmap):
    """Memory that another process can be given.

    It has no name, and the system frees it with the last process that sees it, however that ends. On Linux it is no file either, so the
    limit of ``/dev/shm`` does not hold; on macOS it is a file that is deleted already; on Windows a mapping that goes with its last handle.

    Parameters
    ----------
    size : int
    handle : int, str or None
        Of memory that another process has made: a file descriptor, which is closed with this, or on Windows the mapping's name.
    """

    handle: int | str

    def __new__(cls, size: int, handle: int | str | None = None) -> Memory:
        if os.name == "nt":
            handle = handle or f"aifrecon-{uuid.uuid4().hex}"
            memory = super().__new__(cls, -1, size, tagname=handle)  # type: ignore[call-arg]
        else:
            handle = _without_name(size) if handle is None else int(handle)
            memory = super().__new__(cls, handle, size)
            weakref.finalize(memory, os.close, handle)
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


class Channel:
    """One end of a connection. Any thread may send; one receives.

    Parameters
    ----------
    connection : Connection
        Of a `Pipe` in both directions.
    """

    def __init__(self, connection: Connection):
        self._connection = connection
        self._sending = threading.Lock()
        self._kept: list[Memory] = []

    def send(self, what: object) -> None:
        """Send whatever can be pickled.

        Raises
        ------
        OSError
            When the other end is closed, or memory runs out. Nothing was sent then.
        """
        arrays: list[memoryview] = []

        def is_small(buffer: pickle.PickleBuffer) -> bool:
            raw = buffer.raw()
            if raw.nbytes >= LARGE:
                arrays.append(raw)
            return raw.nbytes < LARGE

        text = pickle.dumps(what, protocol=5, buffer_callback=is_small)
        memories, places = _laid_out(arrays)
        names = [memory.handle if os.name == "nt" else None for memory in memories]
        with self._sending:
            self._connection.send_bytes(pickle.dumps((text, places, [len(memory) for memory in memories], names)))
            if os.name == "nt":
                self._kept += memories  # until the other has opened them, which its next message says
            else:
                with socket.socket(fileno=os.dup(self._connection.fileno())) as other:
                    for memory in memories:
                        socket.send_fds(other, [b"."], [int(memory.handle)])

    def poll(self, timeout: float = 0.0) -> bool:
        """Whether something has come, or the other end is closed; waited for so many s."""
        return self._connection.poll(timeout)

    def receive(self) -> Any:
        """What was sent, waited for.

        Raises
        ------
        EOFError, OSError
            When the other end is closed.
        """
        text, places, sizes, names = pickle.loads(self._connection.recv_bytes())
        self._kept.clear()
        memories = [Memory(size, self._descriptor() if name is None else name) for size, name in zip(sizes, names, strict=True)]
        return pickle.loads(text, buffers=[memoryview(memories[number])[start:stop] for number, start, stop in places])

    def _descriptor(self) -> int:
        with socket.socket(fileno=os.dup(self._connection.fileno())) as other:
            _byte, [descriptor], _flags, _address = socket.recv_fds(other, 1, 1)
        return descriptor

    def close(self) -> None:
        """Send and receive no more."""
        self._connection.close()


def _laid_out(arrays: list[memoryview]) -> tuple[list[Memory], list[tuple[int, int, int]]]:
    """Memory that holds these arrays, and of each where it lies: number of the memory, first byte, byte after the last."""
    memories: list[Memory] = []
    places: list[tuple[int, int, int]] = []
    fresh: list[int] = []
    size = 0
    for number, array in enumerate(arrays):
        memory, first = _holding(array)
        if memory is None:
            fresh.append(number)
            places.append((-1, size, size + array.nbytes))
            size += -(-array.nbytes // ALIGNED) * ALIGNED
            continue
        if not any(memory is each for each in memories):
            memories.append(memory)
        place = next(n for n, each in enumerate(memories) if each is memory)
        places.append((place, first, first + array.nbytes))
    if fresh:
        memories.append(made := Memory(size))
        for number in fresh:
            _, start, stop = places[number]
            made[start:stop] = arrays[number]
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
    """The descriptor of a file that no folder knows, so large."""
    if hasattr(os, "memfd_create"):
        descriptor = os.memfd_create("aifrecon")
    else:
        with tempfile.TemporaryFile() as file:
            descriptor = os.dup(file.fileno())
    try:
        if hasattr(os, "posix_fallocate"):
            os.posix_fallocate(descriptor, 0, size)  # not there is an error now, and no crash when it is written to
        else:
            os.ftruncate(descriptor, size)
    except OSError:
        os.close(descriptor)
        raise
    return descriptor
