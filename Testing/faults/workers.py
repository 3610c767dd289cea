"""kill -9 of the process that computes for a program, at random moments: the program lives, no volume is wrong, and nothing is left."""

from __future__ import annotations

import hashlib
import os
import random
import signal
import tempfile
import threading
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from AIFReconLib.errors import WorkerDiedError
from AIFReconLib.worker.worker import Worker

from .ledger import Entry, Ledger

MOMENTS = 1.1
"""Random moments reach this far beyond the time that the work takes."""

FRAMES, SPACING = 96, 0.7

GONE = 5.0
"""s that a killed process may take to be gone."""


def reconstruction(worker: Worker, folder: Path) -> Callable[[], str]:
    """What begins a reconstruction in the worker and tells its voxels in short."""
    from AIFReconLib import Recipe, read_sequence, reconstruct
    from AIFReconLib.commands.simulate import write_simulated_patient

    files = worker.call(write_simulated_patient, folder, frames=FRAMES)
    sweep = worker.call(read_sequence, files.sequence, config=files.configuration)
    return lambda: digest_of(worker.call(reconstruct, sweep, Recipe(spacing=SPACING)).intensity.array)


RUNS = {"a reconstruction": reconstruction}
"""What is killed. A scan has its place here too, with its recording among what it tells."""


def digest_of(array: np.ndarray) -> str:
    return hashlib.sha256(array.tobytes()).hexdigest()


def kill_worker(entry: Entry, run: Callable[[Worker, Path], Callable[[], str]], trials: int, chance: random.Random, folder: Path) -> None:
    """Kill it so often; what comes must be the volume or one error, the next run must give the volume, and nothing may be left."""
    worker = Worker()
    work = run(worker, folder)
    expected = work()
    begun = time.monotonic()
    if work() != expected:
        raise RuntimeError("two runs give two volumes")
    lasts = time.monotonic() - begun
    memory = sorted(os.listdir("/dev/shm"))
    for _trial in range(trials):
        process = worker.pid
        assert process is not None
        timer = threading.Timer(chance.uniform(0.0, MOMENTS * lasts), partial(os.kill, process, signal.SIGKILL))
        timer.start()
        try:
            outcome, came = "finished before", work()
        except WorkerDiedError as error:
            outcome, came = "one sentence", expected if "signal 9" in str(error) else ""
        timer.join()
        left = [] if is_gone(process) else ["its process"]
        again = ""
        # Its end may not be known yet: then that is what the call after it hears
        while not again:
            try:
                again = work()
            except WorkerDiedError:
                outcome = "one sentence, in the next run"
        left += ["shared memory"] if sorted(os.listdir("/dev/shm")) != memory else []
        if came != expected or again != expected or left:
            entry.lost[f"{'' if came == expected else 'another volume, '}{'' if again == expected else 'another next volume, '}{left}"] += 1
        else:
            entry.outcomes[f"{outcome}, then the same voxels"] += 1
    last = worker.pid
    worker.close()
    if last is None or not is_gone(last):
        entry.lost["a process after the end"] += 1


def is_gone(process: int) -> bool:
    """Whether no process of this number runs any more; waited for."""
    end = time.monotonic() + GONE
    while time.monotonic() < end:
        try:
            if Path(f"/proc/{process}/stat").read_text("utf-8").rpartition(")")[2].split()[0] in "ZX":
                return True
        except OSError:
            return True
        time.sleep(0.01)
    return False


def run(ledger: Ledger, trials: int = 20, seed: int = 0) -> None:
    """All of it."""
    chance = random.Random(seed)
    for name, each in RUNS.items():
        if entry := ledger.begin("kill -9", "of the worker, at random moments", name):
            with tempfile.TemporaryDirectory(prefix="faults-") as folder:
                kill_worker(entry, each, trials, chance, Path(folder))
