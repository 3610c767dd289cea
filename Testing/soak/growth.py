"""Memory, threads and open files of this process, minute by minute, and whether they grow."""

from __future__ import annotations

import ctypes
import gc
import os
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

SETTLING = 10
"""Simulated minutes after which nothing may grow any more: engines are compiled and every buffer has reached its size by then."""

MOST_MEMORY, MOST_BLOCKS = 16.0, 50_000.0
"""MiB and blocks of Python's by which a line fitted to them may rise in a simulated hour."""


@dataclass(frozen=True)
class Sample:
    """One look at the process; NaN and -1 where the system does not tell.

    Parameters
    ----------
    minute : int
        Of simulated time.
    wall : float, s
    memory_mib : float
        Resident, once the allocator has given back what it only keeps for later.
    blocks : int
        Of memory that Python's objects take; what leaks shows here first. (To ask for the objects themselves would disturb the other
        threads: a tuple that is still being made must not be seen.)
    threads, files : int
    """

    minute: int
    wall: float
    memory_mib: float
    blocks: int
    threads: int
    files: int


def look(minute: int = 0, wall: float = 0.0) -> Sample:
    """This process now."""
    gc.collect()
    _give_back()
    files = len(os.listdir("/proc/self/fd")) if Path("/proc/self/fd").is_dir() else -1
    # Insertion and snapshots have helpers that live for a moment
    threads = min(_after(0.01 * n, threading.active_count) for n in range(5))
    return Sample(minute, wall, resident_mib(), sys.getallocatedblocks(), threads, files)


def resident_mib() -> float:
    """Resident memory of this process; NaN where the system does not tell."""
    status = Path("/proc/self/status")
    if not status.is_file():
        return float("nan")
    return next(int(line.split()[1]) for line in status.read_text().splitlines() if line.startswith("VmRSS")) / 1024


def _give_back() -> None:
    """Ask the allocator to return free memory, where it is one that can; else its high-water mark looks like growth."""
    with suppress(OSError, AttributeError):
        ctypes.CDLL("libc.so.6").malloc_trim(0)


def _after(seconds: float, ask: Callable[[], int]) -> int:
    time.sleep(seconds)
    return ask()


@dataclass(frozen=True)
class Growth:
    """What the samples after `SETTLING` say.

    Parameters
    ----------
    memory_mib_per_hour : float
        Slope of the line fitted to the resident memory, per simulated hour.
    blocks_per_hour : float
    memory_mib : (float, float)
        Smallest and largest.
    blocks, threads, files : (int, int)
        Fewest and most.
    """

    memory_mib_per_hour: float
    blocks_per_hour: float
    memory_mib: tuple[float, float]
    blocks: tuple[int, int]
    threads: tuple[int, int]
    files: tuple[int, int]

    @property
    def is_flat(self) -> bool:
        """Whether nothing grew. A connection that is being made and a header that is being written are files for a moment."""
        grows = self.memory_mib_per_hour > MOST_MEMORY or self.blocks_per_hour > MOST_BLOCKS
        return not grows and self.threads[1] - self.threads[0] <= 1 and self.files[1] - self.files[0] <= 4


def growth(samples: list[Sample], settling: int = SETTLING) -> Growth | None:
    """The growth after `settling` minutes; None with too few samples for a line."""
    settled = [sample for sample in samples if sample.minute >= settling]
    if len(settled) < 5:
        return None
    hours = [sample.minute / 60.0 for sample in settled]
    columns = {name: [getattr(sample, name) for sample in settled] for name in ("memory_mib", "blocks", "threads", "files")}
    slopes = {name: float(np.polyfit(hours, columns[name], 1)[0]) for name in ("memory_mib", "blocks")}
    ranges = {name: (min(values), max(values)) for name, values in columns.items()}
    return Growth(memory_mib_per_hour=slopes["memory_mib"], blocks_per_hour=slopes["blocks"], **ranges)
