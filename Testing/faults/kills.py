"""kill -9 of what writes: before a line of Python that makes or renames files, and at random moments, which fall into compiled code too."""

from __future__ import annotations

import mmap
import os
import random
import shutil
import signal
import threading
import time
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path

import numpy as np
from files import tracked_sequence, write_patient
from live_messages import streamed

from AIFReconLib import Recipe, VoxelGrid, read_sequence
from AIFReconLib.errors import WorkerDiedError
from AIFReconLib.io.disk.workspace import PREFIX
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.live.session.recording import Recorder, growing_files
from AIFReconLib.worker.reconstructing import begin_scan
from AIFReconLib.worker.worker import Worker
from AIFReconLib.workflows.job import ScanJob

from .children import RENAMING, at_line, end_of, killed, result_of, seconds_of, start
from .ledger import Fault, Lost, Trial
from .samples import RECORDED, RECORDINGS, WRITTEN, FileKind, left_in, recorded_frames, version_of

SCANNED, GRID = 40, VoxelGrid.from_spacing((-9.0, -8.0, -6.0), (19, 17, 13), 1.0)
"""Frames and voxels of a scan."""

EACH = 3
"""Messages of a frame: image, Probe, Reference."""


def versions(sample: FileKind, folder: Path) -> tuple[Path, dict[str, str]]:
    """A folder with the older version, and what tells the versions apart."""
    digests = {}
    for version, name in enumerate(("old", "new")):
        (folder / name).mkdir()
        end_of(start(partial(sample.write, folder / name, version)))
        digests[name] = result_of(partial(sample.digest, folder / name / sample.file))
    return folder / "old", digests


def lines_of(work: Callable[[], object]) -> int:
    """How many lines there are before which it may be killed."""
    return result_of(lambda: at_line(RENAMING, None, lambda: None, work)[1])


def kill_write(sample: FileKind, folder: Path, chance: random.Random) -> Trial:
    """Half at lines, half at moments; with an older file there and without. The next write must go through and clear up."""
    old, digests = versions(sample, folder)
    again = partial(sample.write, folder / "new", 1)
    lines, lasts = lines_of(again), seconds_of(again)

    def trial(place: Path, number: int) -> str:
        older = number % 2 == 0
        if older:
            shutil.copytree(old, place, dirs_exist_ok=True)
        work = partial(sample.write, place, 1)
        code = killed(work, chance, lines if number % 4 < 2 else 0, lasts)
        state = version_of(place / sample.file, digests, sample.digest)
        if state not in ("old" if older else "absent", "new") or code not in (0, -signal.SIGKILL):
            raise Lost(f"{state}, exit {code}")
        end_of(start(work))
        after, strangers = version_of(place / sample.file, digests, sample.digest), left_in(place, sample.file)
        if after != "new" or strangers:
            raise Lost(f"next write: {after}, left: {strangers}")
        return "finished before" if code == 0 else state

    return trial


def kill_recording(sample: FileKind, folder: Path, chance: random.Random) -> Trial:
    """Three times, taken up after each; every listed frame must be readable each time, and the recording whole at last."""
    old, digests = versions(sample, folder)
    expected = np.stack([frame.image for frame in recorded_frames(1)])

    def record(place: Path, listed: mmap.mmap) -> None:
        growing = next(place.glob("*.recording.mhd"), None)
        name = sample.file if growing is None else growing.name.replace(".recording.mhd", Path(sample.file).suffix)
        recorder = Recorder(place / name, takes_up=True)
        for number, frame in enumerate(recorded_frames(1)[recorder.frames :], recorder.frames):
            recorder.append(frame)
            listed[0] = number + 1
        recorder.finish()

    def readable(place: Path, older: bool) -> int:
        """Frames that the file with the most of them has; all others must be right, too."""
        most = 0
        for path in place.iterdir():
            if path.suffix in (".mhd", ".mha", ".nrrd") and not (older and path.name == sample.file):
                images = np.asarray(read_sequence(path).images)
                if not np.array_equal(images, expected[: len(images)]):
                    raise ValueError("other pixels")
                most = max(most, len(images))
        return most

    def trial(place: Path, number: int) -> str:
        older = number % 2 == 0
        if older:
            shutil.copytree(old, place, dirs_exist_ok=True)
        with mmap.mmap(-1, 1) as listed:
            work = partial(record, place, listed)
            for _ in range(3):
                code = killed(work, chance, lines if number % 4 < 2 else 0, lasts)
                kept = result_of(partial(readable, place, older))
                state = version_of(place / sample.file, digests, sample.digest) if older else "old"
                if kept < listed[0] or state != "old" or code not in (0, -signal.SIGKILL):
                    raise Lost(f"exit {code}, {state}, {listed[0]} frames listed, {kept} readable")
                if code == 0:
                    break
            else:
                code = end_of(start(work))
            whole = result_of(partial(readable, place, older))
        left = [path.name for path in place.glob(f"{PREFIX}*")]
        if code or whole != RECORDED or left:
            raise Lost(f"taken up at last: exit {code}, {whole} of {RECORDED} frames, left: {left}")
        return "every listed frame readable, taken up to the end"

    with mmap.mmap(-1, 1) as listed:
        probes = [folder / name for name in ("lines", "lasts")]
        for probe in probes:
            probe.mkdir()
        lines, lasts = lines_of(partial(record, probes[0], listed)), seconds_of(partial(record, probes[1], listed))
    return trial


def kill_worker(folder: Path, chance: random.Random) -> Trial:
    """Of the worker during a scan, which another takes up: all frames are recorded, and the volume is the one without a kill."""
    patient = write_patient(folder)
    configuration = read_plus_configuration(patient.config)
    sequence = tracked_sequence(SCANNED)
    images = np.asarray(sequence.images)
    volumes: list[np.ndarray] = []

    def scan(worker: Worker, place: Path) -> None:
        """Frames are sent one by one."""
        record = place / "scan.mhd"
        job = ScanJob(Recipe(), None, configuration, GRID, record=record)
        kept, number = None, 0
        while True:
            try:
                kept = kept or worker.keep(begin_scan, job)
                for at in range(number, SCANNED):
                    for message in islice(streamed(sequence), at * EACH, at * EACH + EACH):
                        worker.call("put", kept, message)
                    while not _is_taken(worker.call("look", kept).statistics, at):
                        time.sleep(0.005)
                volumes.append(worker.call("finish", kept).result.intensity.array)
                break
            except WorkerDiedError:
                if record.exists():
                    break  # it had ended, and nobody heard of that
                growing = growing_files(record)[0]
                number = len(read_sequence(growing)) if growing.exists() else 0
                kept, job = None, replace(job, takes_up=True)
        # One that died between the pixels of its first frame and the header keeps the name, and the next has a number
        finished = [path for path in place.glob("scan*.mhd") if path != growing_files(record)[0]]
        if len(finished) != 1 or not np.array_equal(np.asarray(read_sequence(finished[0]).images), images):
            raise Lost("another recording")
        if volumes and not np.array_equal(volumes[0], volumes[-1]):
            raise Lost("another volume")

    def trial(place: Path, _number: int) -> str:
        with closing(Worker()) as worker:
            process = worker.call(os.getpid)
            timer = threading.Timer(chance.uniform(0.0, lasts), partial(os.kill, process, signal.SIGKILL))
            timer.start()
            scan(worker, place)
            timer.cancel()
            return "finished before" if worker.pid == process else "the scan was taken up, then the same"

    with closing(Worker()) as worker:
        worker.call(os.getpid)
        (folder / "whole").mkdir()
        begun = time.monotonic()
        scan(worker, folder / "whole")
        lasts = 1.1 * (time.monotonic() - begun)
    return trial


def _is_taken(statistics, number: int) -> bool:
    """Whether a frame was recorded, and none waits to be inserted."""
    return statistics.recorded > number and statistics.waiting == 0


CASES = (
    *(Fault("kill -9", f"live recording {each.file}", partial(kill_recording, each)) for each in RECORDINGS),
    *(Fault("kill -9", f"write {each.file}", partial(kill_write, each)) for each in WRITTEN),
    # What forks must not have had threads: this comes last
    Fault("kill -9", "worker of a scan that is recorded", kill_worker),
)
