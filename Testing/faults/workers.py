"""kill -9 of the process that computes for a program, at random moments: the program lives, no volume is wrong, and nothing is left."""

from __future__ import annotations

import contextlib
import hashlib
import os
import random
import re
import signal
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path

import numpy as np
from files import tracked_sequence, write_patient
from live_messages import streamed

from AIFReconLib import Recipe, VoxelGrid, read_sequence, reconstruct
from AIFReconLib.errors import WorkerDiedError
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.live.session.recording import growing_files
from AIFReconLib.live.session.statistics import LiveStatistics
from AIFReconLib.worker.reconstructing import begin_scan
from AIFReconLib.worker.worker import Worker
from AIFReconLib.workflows.job import ScanJob
from AIFReconLib.workflows.simulate import write_simulated_patient

from .ledger import Entry, Ledger

MOMENTS = 1.1
"""Random moments reach this far beyond the time that the work takes."""

FRAMES, SPACING = 96, 0.7
"""Of a reconstruction."""

SCANNED, GRID = 40, VoxelGrid.from_spacing((-9.0, -8.0, -6.0), (19, 17, 13), 1.0)
"""Frames and voxels of a scan."""

EACH = 3
"""Messages of a frame: image, Probe, Reference."""

GONE = 5.0
"""s that a killed process may take to be gone."""


def reconstruction(worker: Worker, folder: Path) -> Callable[[], str]:
    """What reconstructs in the worker, and tells the volume in short."""
    files = worker.call(write_simulated_patient, folder, frames=FRAMES)
    sweep = worker.call(read_sequence, files.sequence, config=files.configuration)
    return lambda: digest_of(worker.call(reconstruct, sweep, Recipe(spacing=SPACING)).intensity.array)


def scan(worker: Worker, folder: Path) -> Callable[[], str]:
    """What scans, is taken up when the worker dies, and tells the volume and the recording in short. Frames are sent one by one."""
    sequence = tracked_sequence(SCANNED)
    patient = write_patient(folder)
    configuration = read_plus_configuration(patient.config)
    images = np.asarray(sequence.images)

    def work() -> str:
        with tempfile.TemporaryDirectory(dir=folder) as place:
            record = Path(place) / "scan.mhd"
            request = ScanJob(Recipe(), None, configuration, GRID, record=record)
            kept = worker.keep(begin_scan, request)
            number = 0
            while True:
                try:
                    while number < SCANNED:
                        for message in islice(streamed(sequence), number * EACH, number * EACH + EACH):
                            worker.call("put", kept, message)
                        while not is_taken(worker.call("look", kept).statistics, number):
                            time.sleep(0.005)
                        number += 1
                    ended = worker.call("finish", kept)
                    break
                except WorkerDiedError:
                    if record.exists():
                        # It had ended, and nobody heard of that
                        return digest_of(images) if same(record, images) else "another recording"
                    growing = growing_files(record)[0]
                    if growing.exists():
                        # One more may be there than was heard of
                        number = len(read_sequence(growing))
                    kept = worker.keep(begin_scan, replace(request, takes_up=True))
            # One that died between the pixels of its first frame and the header keeps the name, and the next has a number
            finished = [path for path in Path(place).glob("scan*.mhd") if path != growing_files(record)[0]]
            if len(finished) != 1 or not same(finished[0], images):
                return "another recording"
            volumes.add(digest_of(ended.result.intensity.array))
            return digest_of(images) if len(volumes) == 1 else "another volume"

    volumes: set[str] = set()
    return work


def same(record: Path, images: np.ndarray) -> bool:
    """Whether these images were recorded, in their order."""
    return np.array_equal(np.asarray(read_sequence(record).images), images)


def is_taken(statistics: LiveStatistics, number: int) -> bool:
    """Whether a frame was recorded, and none waits to be inserted."""
    return statistics.recorded > number and statistics.waiting == 0


RUNS = {"a reconstruction": reconstruction, "a scan that is recorded": scan}


def digest_of(array: np.ndarray) -> str:
    return hashlib.sha256(array.tobytes()).hexdigest()


def kill_worker(entry: Entry, run: Callable[[Worker, Path], Callable[[], str]], trials: int, chance: random.Random, folder: Path) -> None:
    """Kill it so often; what comes must be the volume or one error, the next run must give the volume, and nothing may be left."""
    memory = named_memory()
    worker = Worker()
    work = run(worker, folder)
    expected = work()
    begun = time.monotonic()
    if work() != expected:
        raise RuntimeError("two runs give two volumes")
    lasts = time.monotonic() - begun
    for _trial in range(trials):
        process = worker.pid
        assert process is not None
        timer = threading.Timer(chance.uniform(0.0, MOMENTS * lasts), partial(os.kill, process, signal.SIGKILL))
        timer.start()
        try:
            came = work()
            outcome = "finished before" if worker.pid == process else "taken up"
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
        if came != expected or again != expected or left:
            entry.lost[f"{'' if came == expected else 'another volume, '}{'' if again == expected else 'another next volume, '}{left}"] += 1
        else:
            entry.outcomes[f"{outcome}, then the same"] += 1
    last = worker.pid
    worker.close()
    if last is None or not is_gone(last):
        entry.lost["a process after the end"] += 1
    if not is_freed(memory):
        entry.lost["shared memory after the end"] += 1


def named_memory() -> list[str]:
    """Python's shared memory that has a name and that no other process uses. Browsers' names are others."""
    used = set()
    for maps in Path("/proc").glob("[0-9]*/maps"):
        if maps.parent.name != str(os.getpid()):
            with contextlib.suppress(OSError):
                used.update(re.findall("psm_[0-9a-f]+", maps.read_text("utf-8")))
    return sorted(path.name for path in Path("/dev/shm").glob("psm_*") if path.name not in used)


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


def is_freed(before: list[str]) -> bool:
    """Whether no more shared memory has a name than before; waited for, since Python's helper frees what the killed leave."""
    end = time.monotonic() + GONE
    while set(named_memory()) - set(before):
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


def run(ledger: Ledger, trials: int = 20, seed: int = 0) -> None:
    """All of it."""
    chance = random.Random(seed)
    for name, each in RUNS.items():
        if entry := ledger.begin("kill -9", "of the worker, at random moments", name):
            with tempfile.TemporaryDirectory(prefix="faults-") as folder:
                kill_worker(entry, each, trials, chance, Path(folder))
