"""Work for worker processes, in a file that takes them no time to import."""

from __future__ import annotations

import logging
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from AIFReconLib.errors import GeometryError, OperationCanceled
from AIFReconLib.progress import Progress, report


def answered(*arguments: object, **named: object) -> tuple[tuple[object, ...], dict[str, object]]:
    """What came."""
    return arguments, named


def returned(value: object) -> object:
    """The same."""
    return value


def add_one(array: np.ndarray) -> None:
    """To what came."""
    array += 1


def filled(count: int) -> np.ndarray:
    """An array of the worker's."""
    return np.arange(count, dtype=np.float64)


def reporting(seconds: float, file: str = "", progress: Progress | None = None) -> int:
    """So long; how often it has reported. A cancel is noted in the file."""
    end, times = time.monotonic() + seconds, 0
    try:
        while time.monotonic() < end:
            report(progress, 1.0 - (end - time.monotonic()) / seconds, "counting")
            times += 1
            time.sleep(0.002)
    except OperationCanceled:
        if file:
            Path(file).write_text("canceled", "utf-8")
        raise
    return times


def silent(seconds: float) -> str:
    """So long, and no report."""
    time.sleep(seconds)
    return "done"


def computing(seconds: float) -> None:
    """So long, at work."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        np.linalg.norm(np.ones((200, 200)), 2)


def refuse(kind: str) -> object:
    """An error of this kind."""
    if kind == "ours":
        raise GeometryError("The grid has no voxels.", "Recognized: {clip_px:{x} {y} {width} {height}}.", x=1, y=2, width=3, height=4)
    if kind == "file":
        raise FileNotFoundError(2, "No such file", "sweep.mha")
    if kind == "cannot be pickled":
        raise type("LocalError", (ValueError,), {})("of a class that nobody finds")
    if kind == "two arguments":
        raise TwoArguments("one", "two")
    if kind == "exit":
        sys.exit(3)
    if kind == "answer":
        return lambda: None
    if kind == "memory":
        return np.zeros(2**60)
    os.kill(os.getpid(), int(kind))
    time.sleep(60.0)  # another thread may be the one that the signal ends the process by
    return None


class TwoArguments(ValueError):
    """Pickled as if it took one."""

    def __init__(self, first: str, second: str):
        super().__init__(f"{first} and {second}")


def note(text: str) -> None:
    """For the library's log."""
    logging.getLogger("AIFReconLib.noted").warning("%s is noted", text)


class Counter:
    """What is kept in the worker. Its end takes time, and is noted in a file."""

    def __init__(self, file: str, seconds: float = 0.0):
        self.value, self.added, self._file, self._seconds = 0, [0], Path(file), seconds

    def add(self, number: int) -> int:
        """How far it is."""
        self.value += number
        self.added.append(number)
        return self.value

    def all(self) -> list[int]:
        """What was added."""
        return self.added

    def close(self) -> None:
        """The end."""
        time.sleep(self._seconds)
        self._file.write_text(f"closed at {self.value}", "utf-8")


def slowly_kept(file: str, seconds: float) -> Counter:
    """A counter that takes long to make, without a report."""
    time.sleep(seconds)
    return Counter(file)


def started() -> int:
    """The number of a process that this one starts, and that goes on."""
    return subprocess.Popen([sys.executable, "-c", "import time; time.sleep(1000)"], stdin=subprocess.DEVNULL).pid
