"""Work in parts, on as many threads as are useful, by compiled code where there is any."""

from __future__ import annotations

import importlib
import itertools
import logging
import os
import threading
from collections.abc import Callable, Iterable
from importlib.util import find_spec
from types import ModuleType

from ..errors import SettingsError
from ..progress import Progress, report

logger = logging.getLogger(__name__)


def in_parts(
    work: Callable[[int], Iterable[None] | None], parts: int, threads: int, progress: Progress | None = None, step: str = ""
) -> None:
    """Call `work` with 0 to `parts` - 1, each once, on up to `threads` threads of which the caller's is one.

    Each thread takes the next part when it is done with one, so that parts may differ in size. All threads have ended when this
    returns or raises; the first error stops the rest, and is raised here.
    `progress` hears of `step` on the caller's thread before every part of its own, and may cancel the rest. Where a part takes long,
    `work` yields between its steps: there it may be stopped too.
    """
    numbers = itertools.count()
    errors: list[BaseException] = []

    def take_turns(progress: Progress | None = None) -> None:
        try:
            while not errors and (part := next(numbers)) < parts:
                report(progress, part / parts, step)
                for _ in work(part) or ():
                    if errors:
                        return
                    report(progress, part / parts, step)
        except BaseException as error:
            errors.append(error)

    helpers = [threading.Thread(target=take_turns, daemon=True) for _ in range(min(threads, parts) - 1)]
    for helper in helpers:
        helper.start()
    take_turns(progress)
    for helper in helpers:
        helper.join()
    if errors:
        raise errors[0]


def checked_threads(threads: int | None) -> int:
    """How many threads to use: as many as asked for, else `usable_cores`; a SettingsError when it is not at least 1."""
    if threads is not None and threads < 1:
        raise SettingsError(f"Input threads must be at least 1; got {threads!r}.")
    return usable_cores() if threads is None else int(threads)


def usable_cores() -> int:
    """How many threads are useful: the NUMBA_NUM_THREADS of the environment, else the cores that this process may use."""
    given = os.environ.get("NUMBA_NUM_THREADS", "")
    if given.isdigit() and int(given) > 0:
        return int(given)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def optional_module(name: str) -> ModuleType | None:
    """One of the library's modules that import numba; None where numba is not there or does not work."""
    if find_spec("numba") is None:
        return None
    try:
        return importlib.import_module(name)
    # A numba that does not fit its numpy or its Python fails in whatever way it likes
    except Exception:
        logger.warning("numba is installed but %s does not work; numpy and scipy stand in", name, exc_info=True)
        return None
