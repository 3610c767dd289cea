"""Work on many processes, by dask.distributed: which task runs where, what is tried again and how much memory a process may take is Dask's.

Notes
-----
A process that is killed, also by Dask for its memory, is started anew, and what it was doing is tried once more. After that the work is
given up as `Lost`; the other work goes on.
"""

from __future__ import annotations

import itertools
import logging
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeVar

from .. import __version__
from ..errors import OutputError, SettingsError
from ..io.disk.workspace import workspace
from ..message import shorten

if TYPE_CHECKING:
    from distributed import Client

Given = TypeVar("Given")
Made = TypeVar("Made")

TRIES = 2
"""How often work is begun whose process ends."""

SCHEDULER_WAIT = 10.0
"""s for a scheduler to answer, and then for its first worker."""

THREADS = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""What tells the engine and the linear algebra behind numpy how many threads to use."""


_SETTINGS = {
    "distributed.scheduler.allowed-failures": TRIES - 1,
    # Nothing is spilled to the disk, and a process whose memory is not all given back between cases is not paused: only what passes the
    # limit is ended
    **dict.fromkeys((f"distributed.worker.memory.{name}" for name in ("target", "spill", "pause")), False),
    # By default a process that a busy computer does not start anew within 15 s is given up, and nobody is left
    "distributed.deploy.lost-worker-timeout": "1 hour",
    "distributed.scheduler.no-workers-timeout": "10 minutes",
    # Looks at what a worker does a hundred times a second
    "distributed.worker.profile.enabled": False,
}
"""Of our own workers; read when their cluster is made, and handed to them."""


@dataclass(frozen=True)
class Lost:
    """Work that its process did not survive, as often as it was tried; `reason` is an end of a sentence."""

    reason: str


def require(name: str) -> ModuleType:
    """One of the packages of the group `batch`.

    Raises OutputError when it is not installed, with how to get it.
    """
    try:
        return import_module(name)
    except ImportError:
        raise OutputError(
            f'Cannot compute many cases: {name} is not installed. Install it with: pip install "dask[distributed]" pyarrow cryptography'
        ) from None


@contextmanager
def local_workers(count: int, threads: int = 1, memory: int | None = None) -> Iterator[Client]:
    """So many processes on this computer, reached on its loopback alone, by who has the key that is made for them.

    Raises OutputError when dask, or what makes keys, is not installed.

    Parameters
    ----------
    count : int
    threads : int
        That each may use.
    memory : int or None
        Bytes that each may take: Dask ends one that takes more. None: no limit.

    Notes
    -----
    A scheduler runs what its clients send. Without a key that would be any user of this computer.
    """
    distributed, config = require("distributed"), require("dask.config")
    require("cryptography")
    with ExitStack() as stack:
        stack.enter_context(config.set(_SETTINGS))
        folder = stack.enter_context(workspace(Path(tempfile.gettempdir())))
        stack.enter_context(_quiet())
        cluster = stack.enter_context(
            distributed.LocalCluster(
                n_workers=count,
                threads_per_worker=1,
                processes=True,
                protocol="tls://",
                security=distributed.Security.temporary(),
                memory_limit=memory or 0,
                host="127.0.0.1",
                dashboard_address="127.0.0.1:0",
                worker_dashboard_address=None,
                local_directory=str(folder),
                silence_logs=logging.CRITICAL,
                preload=["AIFReconLib.batch.worker"],
                env=dict.fromkeys(THREADS, str(threads)),
            )
        )
        yield stack.enter_context(distributed.Client(cluster))


def own_memory() -> int | None:
    """Bytes that this process, a worker, may take beside what it holds; None of any other process, and where nothing limits it."""
    distributed = sys.modules.get("distributed")
    if distributed is None:
        return None
    try:
        worker = distributed.get_worker()
    except ValueError:
        return None
    limit = worker.memory_manager.memory_limit
    return int(limit - worker.monitor.get_process_memory()) if limit else None


@contextmanager
def cluster_at(address: str, folder: Path) -> Iterator[Client]:
    """The cluster whose scheduler is at this address, if its workers can do the work.

    Raises SettingsError when there is no scheduler or no worker, or a worker has another version or does not see the folder; OutputError
    when dask is not installed.

    Parameters
    ----------
    address : str
        As Dask writes it: ``tcp://10.0.0.5:8786``.
    folder : Path
        That every worker must see.
    """
    distributed = require("distributed")
    with ExitStack() as stack:
        stack.enter_context(_quiet())
        try:
            client = stack.enter_context(distributed.Client(address, timeout=SCHEDULER_WAIT, set_as_default=False))
            client.wait_for_workers(1, timeout=SCHEDULER_WAIT)
        except TimeoutError:
            raise SettingsError(
                f"There is no Dask scheduler with workers at {address}. Start one with dask scheduler, and dask worker {address}."
            ) from None
        except (OSError, ValueError, TypeError) as error:  # the last without certificates
            raise SettingsError(
                f"No Dask scheduler answers at {address} ({shorten(str(error))}). Give its address as it prints it, such as "
                "tls://10.0.0.5:8786, and its certificates in Dask's configuration."
            ) from None
        _check_workers(client, folder)
        yield client


def _check_workers(client: Client, folder: Path) -> None:
    try:
        found = client.run(_about, str(folder))
    except Exception as error:  # of whatever kind a worker without the package answers with
        raise SettingsError(
            f"A worker cannot be asked for its version of AIFRecon ({shorten(f'{type(error).__name__}: {error}')}). Install AIFRecon "
            f"{__version__} on every worker."
        ) from None
    for worker, (version, sees) in found.items():
        if version != __version__:
            raise SettingsError(f"Worker {worker} has AIFRecon {version}, and this is {__version__}. Install the same on all.")
        if not sees:
            raise SettingsError(
                f"Worker {worker} does not see the folder {folder}. Choose one on a disk that all workers mount in the same place."
            )


def _about(folder: str) -> tuple[str, bool]:
    """What a worker is asked before it gets work."""
    return __version__, Path(folder).is_dir()


def completed(client: Client, work: Callable[[Given], Made], given: Mapping[str, Given]) -> Iterator[tuple[str, Made | Lost]]:
    """What comes of each piece of work, as it is done.

    Parameters
    ----------
    client : distributed.Client
    work : callable
        A function of a module that the workers have.
    given : mapping of str to object
        What it is called with, by a name each.

    Yields
    ------
    name : str
    made : object
        What `work` returned, or `Lost`. What it raised is raised.

    Notes
    -----
    Dask blames the end of a process on all work that was sent to it. So no more is sent than there are threads, and nothing waits behind
    what may end the process.
    """
    distributed, scheduler = require("distributed"), require("distributed.scheduler")
    left = iter(given.items())
    names: dict[Any, str] = {}
    waiting = distributed.as_completed()

    def send() -> None:
        places = max(sum(client.nthreads().values()), 1)
        for name, one in itertools.islice(left, max(places - len(names), 0)):
            future = client.submit(work, one, pure=False)
            names[future] = name
            waiting.add(future)

    send()
    try:
        while names:
            future = next(waiting)
            name = names.pop(future)
            try:
                made: Made | Lost = future.result()
            except distributed.KilledWorker:
                made = Lost(f"its process was ended {TRIES} times while it ran")
            except scheduler.NoValidWorkerError:
                made = Lost("no process was there to run it")
            # Dask keeps what a future stands for
            future.release()
            send()
            yield name, made
    finally:
        client.cancel(list(names))


def dashboard(client: Client) -> str:
    """How many workers there are, and where Dask shows what they do."""
    what = f"at {client.dashboard_link} needs bokeh (pip install bokeh)" if find_spec("bokeh") is None else f"is at {client.dashboard_link}"
    return f"{len(client.nthreads())} worker(s); Dask's dashboard {what}"


@contextmanager
def _quiet() -> Iterator[None]:
    """Dask's log of workers that come and go is not for a user who gets a table of what happened."""
    logger = logging.getLogger("distributed")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        logger.setLevel(level)
