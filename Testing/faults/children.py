"""Work in a forked process, so that its end is not ours. The parent must not have used SimpleITK or threads: no fork has them."""

from __future__ import annotations

import os
import pickle
import select
import signal
import sys
import time
import traceback
from collections.abc import Callable

LONGEST = 1200.0
"""s that a child may take."""

RENAMING = ("disk/atomic.py", "disk/workspace.py", "session/recording.py", "tempfile.py", "shutil.py")
"""Where a line counts while something is written: what makes, renames and removes files. All writes share it."""


def start(work: Callable[[], object]) -> int:
    """Run `work` in a child; the answer is its process id."""
    sys.stdout.flush()
    sys.stderr.flush()
    child = os.fork()
    if child == 0:
        code = 1
        try:
            work()
            code = 0
        except SystemExit as stop:
            code = int(stop.code or 0)
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)
    return child


def end_of(child: int) -> int:
    """The child's exit code, negative for a signal; -1000 when it had to be ended."""
    until = time.monotonic() + LONGEST
    while time.monotonic() < until:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.001)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return -1000


def result_of(work: Callable[[], object]):
    """What `work` returns in a child of its own; raises RuntimeError when it fails or takes too long."""
    reader, writer = os.pipe()

    def answer() -> None:
        os.close(reader)
        with os.fdopen(writer, "wb") as pipe:
            pickle.dump(work(), pipe)

    child = start(answer)
    os.close(writer)
    data = b""
    with os.fdopen(reader, "rb", buffering=0) as pipe:
        while select.select([pipe], [], [], LONGEST)[0] and (piece := pipe.read(2**16)):
            data += piece
    code = end_of(child)
    if code != 0:
        raise RuntimeError(f"the child ended with {code}")
    return pickle.loads(data)


def at_line(files: tuple[str, ...], due: int | None, meddle: Callable[[], object], work: Callable[[], object]) -> tuple[object, int]:
    """What `work` returns, and how many lines of these files it runs; `meddle` is called once, before line number `due`."""
    lines = 0

    def local(_frame, event, _argument):
        nonlocal lines
        if event == "line":
            lines += 1
            if lines == due:
                meddle()
        return local

    sys.settrace(lambda frame, *_: local if any(name in frame.f_code.co_filename for name in files) else None)
    try:
        return work(), lines
    finally:
        sys.settrace(None)


def killed(work: Callable[[], object], chance, lines: int, seconds: float) -> int:
    """The exit code of `work`, killed before one of so many lines, if there are any, or within so many seconds."""
    if lines:
        line = chance.randrange(1, lines + 1)
        return end_of(start(lambda: at_line(RENAMING, line, lambda: os.kill(os.getpid(), signal.SIGKILL), work)))
    child = start(work)
    time.sleep(chance.uniform(0.0, seconds))
    os.kill(child, signal.SIGKILL)
    return end_of(child)


def seconds_of(work: Callable[[], object]) -> float:
    """From the fork of a child to the end of its work, and a little more: random moments may come after it."""
    begun = time.monotonic()
    code = end_of(start(work))
    if code:
        raise RuntimeError(f"without a fault it ends with {code}")
    return 1.1 * (time.monotonic() - begun)
