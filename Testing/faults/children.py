"""Work in a forked process, so that its end is not ours. The parent must not have used SimpleITK or threads before: no fork has them."""

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


def result_of(work: Callable[[], object], timeout: float = LONGEST):
    """What `work` returns in a child of its own; raises RuntimeError when it fails or takes too long."""
    reader, writer = os.pipe()

    def answer() -> None:
        os.close(reader)
        with os.fdopen(writer, "wb") as pipe:
            pickle.dump(work(), pipe)

    child = start(answer)
    os.close(writer)
    data, until = b"", time.monotonic() + timeout
    with os.fdopen(reader, "rb", buffering=0) as pipe:
        while select.select([pipe], [], [], max(until - time.monotonic(), 0))[0]:
            piece = pipe.read(2**16)
            if not piece:
                break
            data += piece
        else:
            os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    if status != 0:
        raise RuntimeError(f"the child ended with status {status}")
    return pickle.loads(data)


def end_of(child: int, timeout: float = LONGEST) -> int:
    """The child's exit code, negative for a signal; -1000 when it had to be ended after `timeout` s."""
    until = time.monotonic() + timeout
    while time.monotonic() < until:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.001)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return -1000
