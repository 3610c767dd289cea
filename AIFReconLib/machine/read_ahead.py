"""Reading that goes on while what was read is worked on."""

from __future__ import annotations

import queue
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from .threads import start

Item = TypeVar("Item")

AHEAD = 8
"""Items that wait to be taken, at most: enough to bridge a slow read, few enough to cost no memory."""


@contextmanager
def read_ahead(items: Iterable[Item], ahead: int = AHEAD) -> Iterator[Iterator[Item]]:
    """The same items in the same order, produced on a thread of their own while the caller works on earlier ones.

    An error of the producer is raised where the item would have come. However the block is left, the thread has ended afterwards: it
    is told to stop, and does so when the item that it is at is done. Where the system allows no more threads, nothing is read ahead.
    """
    waiting: queue.Queue[tuple[Item] | BaseException | None] = queue.Queue(maxsize=max(ahead, 1))
    stopped = threading.Event()

    # An item in a tuple of its own, the error that ended them, or None for their end
    def offer(result: tuple[Item] | BaseException | None) -> bool:
        while not stopped.is_set():
            try:
                waiting.put(result, timeout=0.1)
                return True
            except queue.Full:
                continue
        return False

    def produce() -> None:
        try:
            for item in items:
                if not offer((item,)):
                    return
            offer(None)
        except BaseException as error:
            offer(error)

    def take() -> Iterator[Item]:
        while True:
            result = waiting.get()
            if result is None:
                return
            if isinstance(result, BaseException):
                raise result
            yield result[0]

    reader = threading.Thread(target=produce, name="reading ahead", daemon=True)
    if not start(reader):
        yield iter(items)
        return
    try:
        yield take()
    finally:
        stopped.set()
        # A producer that waits for room is let go at once
        while not waiting.empty():
            waiting.get_nowait()
        reader.join()
