"""The library's work is done by a process of its own: whatever it does there, this application's windows stay alive."""

import contextlib

from AIFReconLib.errors import WorkerDiedError
from AIFReconLib.worker.reconstructing import warm_up
from AIFReconLib.worker.worker import Worker

worker = Worker()
"""That of this application. It starts when first asked, and anew when it has died."""


def inWorker(function, *arguments, progress=None, **named):
    """What ``function(*arguments, **named)`` of the library returns, called in the worker, or raises.

    Its name is what the worker is told, and arguments are what can be pickled. `progress` hears of the call
    every 20 ms, and may cancel it; without it nobody waits for events. Raises WorkerDiedError when the process has died.
    """
    return worker.call(function, *arguments, progress=progress, **named)


def warmUp() -> None:
    """Start the worker before it is needed; where that cannot be, the first press tells."""
    with contextlib.suppress(WorkerDiedError):
        worker.begin(warm_up)
