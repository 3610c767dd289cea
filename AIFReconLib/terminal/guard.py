"""The guard at the door: a command works in a process of its own, so that whatever ends that is one sentence here.

This side loads next to nothing. The other says which file it opens, and may take as much memory as the computer has.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING

from ..machine.processes import start, starter
from .signals import INTERRUPTED, SIGNALS

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from subprocess import Popen

BAD_INPUT = 2

LONGEST_END = 10.0
"""s that a command has to end after it was told to: compiled code hears nothing until it returns."""

LOOK_EVERY = 0.5
"""s between two looks at what the other side does, where it says nothing."""

_OF_PROGRAMS = (sys.prefix, sys.base_prefix, str(Path(__file__).parents[1]), "/proc", "/sys", "/dev", "/etc", "/usr")
"""Where files lie that nobody has given."""

_last = [""]
"""The file that this process has opened last."""


def guarded() -> int | None:
    """Run this program's command line in a process of its own.

    Returns
    -------
    code : int or None
        Its exit code, or 2 with a sentence on standard error where a crash ended it; None where no process can be started.
    """
    open_descriptors()
    with _signals_wait():
        try:
            child, connection = start([sys.executable, *sys.orig_argv[1:]], stdin=0, stdout=1, stderr=2)
        except OSError:
            return None
        told: list[int] = []

        def pass_on(number: int, _frame: FrameType | None) -> None:
            told.append(number)
            # On Windows it comes to both
            if os.name == "posix":
                with contextlib.suppress(OSError):
                    child.send_signal(number)

        for number in (signal.SIGINT, *SIGNALS):
            if signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, pass_on)
    opened = _listen(child, connection, told)
    code = child.wait()
    connection.close()
    if 0 <= code < 256:
        return code
    last = f" The last file that it opened is {opened}." if opened else ""
    if told:
        print(f"aifrecon: {INTERRUPTED}{last if code == -9 else ''}", file=sys.stderr)
        return 128 + told[0]
    how = f"was ended by signal {-code}" if code < 0 else f"ended with code {code:#x}"
    want = ", perhaps for want of memory" if code == -9 else ": a library that it uses has crashed"
    print(
        f"aifrecon: The process that did the work {how}{want}.{last} No file is left half-written. Check that file, or "
        "save it again from the program that made it.",
        file=sys.stderr,
    )
    return BAD_INPUT


def open_descriptors() -> None:
    """Make sure that the standard streams have their numbers: a file that is opened would get that of one that was closed."""
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest free number, which is this one


def _listen(child: Popen[bytes], connection: Connection, told: list[int]) -> str:
    """Wait for the end of the other side, which is ended when it does not hear; the last file that it has opened."""
    opened, end = "", float("inf")
    with contextlib.suppress(EOFError, OSError):
        while True:
            if connection.poll(LOOK_EVERY):
                opened = connection.recv_bytes().decode("utf-8", "replace")
            if told and end == float("inf"):
                end = time.monotonic() + LONGEST_END
            if time.monotonic() > end:
                child.kill()
                break
    return opened


@contextlib.contextmanager
def _signals_wait() -> Iterator[None]:
    """Within, signals to end wait: neither side would end by them as it should. The other goes on when it can hear them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, *SIGNALS))
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


# ---- the other side


def under_guard() -> None:
    """Where a guard has started this process: tell it of files, take no more memory than there is, and end with it."""
    connection = starter()
    if connection is None:
        return
    _limit_memory()
    folder = os.path.join(tempfile.gettempdir(), "aifrecon-")

    def hear(event: str, arguments: tuple[object, ...]) -> None:
        if event != "open" or not isinstance(arguments[0], str) or _writes(arguments[1], arguments[2]):
            return
        path = os.path.abspath(arguments[0])
        if path != _last[0] and not path.startswith((*_OF_PROGRAMS, folder)):
            _last[0] = path
            with contextlib.suppress(OSError):
                connection.send_bytes(path.encode("utf-8", "replace"))

    def end_with_guard() -> None:
        with contextlib.suppress(EOFError, OSError):
            connection.recv_bytes()
        signal.raise_signal(signal.SIGTERM)

    sys.addaudithook(hear)
    # Where the system allows no more threads, the command says so itself
    with contextlib.suppress(RuntimeError):
        threading.Thread(target=end_with_guard, name="aifrecon guard", daemon=True).start()


def last_opened() -> str:
    """Words for the file that was opened last; empty where no guard watches."""
    return f" The last file that was opened is {_last[0]}." if _last[0] else ""


def _writes(mode: object, flags: object) -> bool:
    if isinstance(mode, str):
        return not mode.startswith("r") or "+" in mode
    return isinstance(flags, int) and bool(flags & (os.O_WRONLY | os.O_RDWR))


def _limit_memory() -> None:
    """Let this process take no more memory than the computer, or its container, has: on Linux, which can hold it to that."""
    if sys.platform != "linux":
        return
    import resource

    sizes = []
    with contextlib.suppress(OSError, ValueError):
        lines = Path("/proc/meminfo").read_text("utf-8").splitlines()
        sizes.append(sum(1024 * int(line.split()[1]) for line in lines if line.startswith(("MemTotal:", "SwapTotal:"))))
    with contextlib.suppress(OSError, ValueError):
        sizes.append(int(Path("/sys/fs/cgroup/memory.max").read_text("utf-8")))
    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    allowed = [limit for limit in (*sizes, soft, hard) if limit != resource.RLIM_INFINITY]
    if allowed:
        with contextlib.suppress(OSError, ValueError):
            resource.setrlimit(resource.RLIMIT_DATA, (min(allowed), hard))
