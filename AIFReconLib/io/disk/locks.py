"""Who holds a file or a folder: a lock that ends with its program, however that ends."""

from __future__ import annotations

import os
import time

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]  # a module elsewhere
try:
    import msvcrt
except ImportError:
    msvcrt = None  # type: ignore[assignment]  # a module on Windows

_POLL = 0.05
"""s between two tries."""

_BEYOND = 2**62
"""Where the one byte lies that is locked on Windows: behind the end of any file, for nobody else may read what is locked there."""


def hold(descriptor: int, patience: float = 0.0) -> bool:
    """Lock an open file, or on other systems than Windows a folder, until it is closed or the program ends; False where that cannot be.

    Raises BlockingIOError when it is locked already, through whatever other descriptor, and stays so for `patience`, s.
    """
    end = time.monotonic() + patience
    while True:
        try:
            _lock(descriptor)
            return True
        except (BlockingIOError, PermissionError) as error:  # the second is Windows' word for it
            if time.monotonic() >= end:
                raise BlockingIOError(*error.args) from None
            time.sleep(_POLL)
        except OSError:  # a disk that knows no locks
            return False


def _lock(descriptor: int) -> None:
    if fcntl is not None:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    elif msvcrt is None:
        raise OSError("no locks here")
    else:
        here = os.lseek(descriptor, 0, os.SEEK_CUR)
        os.lseek(descriptor, _BEYOND, os.SEEK_SET)
        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        finally:
            os.lseek(descriptor, here, os.SEEK_SET)
