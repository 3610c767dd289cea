"""What may go wrong in the process that works for Slicer, brought about for a test."""

import contextlib
import os
from typing import Any

from AIFReconLib.machine import memory

_before = memory.available_memory


def _pretend(free) -> None:
    memory.available_memory = _before if free is None else lambda: free


@contextlib.contextmanager
def littleMemory(free: int):
    """Within, the worker believes that so many bytes are free."""
    from AIFReconScene.work import inWorker

    inWorker(_pretend, free)
    try:
        yield
    finally:
        inWorker(_pretend, None)


def _end() -> None:
    os._exit(9)


def killWorker() -> None:
    """End the worker at once, as a crash would."""
    from AIFReconScene.work import worker

    worker.begin(_end)


_messages: list[Any] = []


def receiveWhatIsPut() -> None:
    """Have the next scan receive what is `put`, whatever server it asks for."""
    from AIFReconLib.live.wire.sources import QueueSource
    from AIFReconLib.worker import scan

    _messages[:] = [QueueSource()]
    setattr(scan, "OpenIGTLinkClient", lambda *server: _messages[0])  # noqa: B010


def put(message) -> None:
    """Send a message to that scan."""
    _messages[0].put(message)
