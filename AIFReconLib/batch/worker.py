"""What a worker process does before its first task; Dask calls it by name."""

from __future__ import annotations

import signal
import threading


def dask_setup(_worker: object) -> None:
    """Leave Ctrl-C to the process that the user talks to: it ends the workers."""
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)
