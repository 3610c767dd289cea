"""Work on many processes: an executor of concurrent.futures, of this computer or of a Dask cluster.

Notes
-----
Work whose process is ended is tried once more when all other work is done, alone: then nothing else is to blame.
"""

from __future__ import annotations

import logging
import os
import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from contextlib import ExitStack, contextmanager
from importlib import import_module
from multiprocessing import active_children, get_context, parent_process, resource_tracker
from pathlib import Path
from types import ModuleType
from typing import Any, TypeAlias, TypeVar

from .. import __version__
from ..errors import OutputError, SettingsError
from ..message import shorten
from .memory import Shares

Given = TypeVar("Given")
Made = TypeVar("Made")
Workers: TypeAlias = tuple[Executor, int | None, str]
"""An executor, bytes that each of its processes may take, and words for the user."""

SCHEDULER_WAIT = 10.0
"""s for a scheduler to answer, and then for its first worker."""

LOOK_EVERY = 0.1
"""s between two looks of a process at the memory that it holds."""

THREADS = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""What tells the engine and the linear algebra behind numpy how many threads to use."""


def require(name: str) -> ModuleType:
    """One of the packages of the group `batch`.

    Raises OutputError when it is not installed, with how to get it.
    """
    try:
        return import_module(name)
    except ImportError:
        raise OutputError(
            f'Cannot compute many cases: {name} is not installed. Install it with: pip install "dask[distributed]" pandas psutil pyarrow'
        ) from None


class LocalExecutor(ThreadPoolExecutor):
    """So many processes of this computer at a time, a new one for each piece of work.

    One that is ended takes no other work with it.

    Parameters
    ----------
    count : int
    threads : int
        That each may use.
    memory : int or None
        Bytes that each may take: one that takes more is ended. None: no limit.

    Notes
    -----
    A thread waits for each process. At the end of a `with` block those that are still at work are ended.
    """

    def __init__(self, count: int, threads: int = 1, memory: int | None = None):
        super().__init__(count, initializer=_leave_interrupts)
        self._shares = threads, memory

    def submit(self, work: Callable[..., Made], /, *given: Any, **named: Any) -> Future[Made]:
        """Have a function of a module called in its own process; BrokenExecutor where that is ended."""
        return super().submit(self._in_a_process, work, *given, **named)

    def _in_a_process(self, work: Callable[..., Made], *given: Any, **named: Any) -> Made:
        with ProcessPoolExecutor(1, get_context("spawn"), _begin, self._shares) as process:
            return process.submit(work, *given, **named).result()

    def __exit__(self, *error: Any) -> bool | None:
        self.shutdown(wait=False, cancel_futures=True)
        for process in active_children():
            process.kill()
        return super().__exit__(*error)


def _leave_interrupts() -> None:
    """Ctrl-C is for the main thread, not for this one nor for the processes that it starts."""
    if hasattr(signal, "pthread_sigmask"):
        # Starting it would undo what follows
        resource_tracker.ensure_running()
        signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])


def _begin(threads: int, memory: int | None) -> None:
    """What a process does first."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ.update(dict.fromkeys(THREADS, str(threads)))
    threading.Thread(target=_watch, args=(memory,), daemon=True).start()


def _watch(memory: int | None) -> None:
    """End this process when it takes more than it may, or the one that started it is no more."""
    parent = parent_process()
    while parent is not None and parent.is_alive() and (memory is None or held_memory() <= memory):
        time.sleep(LOOK_EVERY)
    os._exit(1)


def held_memory() -> int:
    """Bytes that this process holds."""
    return int(require("psutil").Process().memory_info().rss)


@contextmanager
def local_workers(shares: Shares) -> Iterator[Workers]:
    """Processes of this computer, so many as there are shares."""
    with LocalExecutor(shares.workers, shares.threads, shares.memory) as executor:
        yield executor, shares.memory, str(shares)


@contextmanager
def cluster_at(address: str, folder: Path) -> Iterator[Workers]:
    """The executor of the cluster whose scheduler is at this address.

    Raises SettingsError when there is no scheduler or no worker, or a worker has another version or does not
    see the folder; OutputError when dask is not installed.

    Parameters
    ----------
    address : str
        As Dask writes it: ``tcp://10.0.0.5:8786``. Keys are those of Dask's configuration.
    folder : Path
        That every worker must see.
    """
    distributed = require("distributed")
    # Its log of workers that come and go is not for a user who gets a table of what happened
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with ExitStack() as stack:
        try:
            client = stack.enter_context(distributed.Client(address, timeout=SCHEDULER_WAIT, set_as_default=False))
            client.wait_for_workers(1, timeout=SCHEDULER_WAIT)
            found = client.run(_about, str(folder))
        except Exception as error:  # of whatever kind Dask, or a worker without the package, answers with
            raise SettingsError(
                f"No Dask scheduler with workers answers at {address} ({shorten(f'{type(error).__name__}: {error}')}). Give the "
                f"address that it prints, start workers with dask worker {address}, and install AIFRecon {__version__} for each. "
                "Certificates are those of Dask's configuration."
            ) from None
        for worker, (version, sees, _) in found.items():
            if version != __version__:
                raise SettingsError(f"Worker {worker} has AIFRecon {version}, and this is {__version__}. Install the same on all.")
            if not sees:
                raise SettingsError(
                    f"Worker {worker} does not see the folder {folder}. Choose one on a disk that all workers mount in the same place."
                )
        memory = min((limit for *_, limit in found.values() if limit), default=None)
        yield client.get_executor(pure=False), memory, f"{len(found)} worker(s); Dask's dashboard is at {client.dashboard_link}"


def _about(folder: str, dask_worker: Any) -> tuple[str, bool, int | None]:
    """What a worker is asked first: its version, whether it sees the folder, bytes that it may take."""
    return __version__, Path(folder).is_dir(), dask_worker.memory_manager.memory_limit


def completed(executor: Executor, work: Callable[[Given], Made], given: Iterable[Given]) -> Iterator[tuple[Given, Made | Exception]]:
    """What each was given and what comes of it, as it is done.

    Where a process was ended, that is last, after one more try, alone. What nobody waits for is canceled.

    Parameters
    ----------
    executor : Executor
    work : callable
        A function of a module that the workers have.
    given : iterable
        What it is called with.
    """
    futures = {executor.submit(work, one): one for one in given}
    lost = []
    try:
        for future in as_completed(futures):
            made = _outcome(future)
            # Canceled is what a scheduler leaves that is gone: it takes no more work
            if isinstance(made, Exception) and not isinstance(made, CancelledError):
                lost.append(futures[future])
            else:
                yield futures[future], made
        for one in lost:
            again = executor.submit(work, one)
            futures[again] = one
            outcome = _outcome(again)
            yield one, outcome
    finally:
        for future in futures:
            future.cancel()


def _outcome(future: Future[Made]) -> Made | Exception:
    try:
        return future.result()
    except Exception as error:
        return error
