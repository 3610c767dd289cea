"""kill -9 of what records and writes sequences, and what becomes of the files: `make faults`. docs/reliability.md has the results.

    python -m faults --seconds 3600
    python -m faults --seconds 60 "recording scan.mhd"

A child is killed before a line of Python that makes or renames files, or at a random moment, which falls into compiled code too. Words
choose cases by their names. Linux, best as root. The exit code is 1 when anything was lost.
"""

from __future__ import annotations

import argparse
import mmap
import multiprocessing
import os
import random
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

TESTING = Path(__file__).resolve().parent
sys.path[:0] = [str(TESTING.parent), str(TESTING / "Python")]

from files import tracked_sequence  # noqa: E402
from live_messages import tracked  # noqa: E402
from measured import keep  # noqa: E402

from AIFReconLib import read_sequence  # noqa: E402
from AIFReconLib.io.disk.atomic import named_data_file  # noqa: E402
from AIFReconLib.io.disk.workspace import PREFIX  # noqa: E402
from AIFReconLib.io.sequence.writer import write_sequence  # noqa: E402
from AIFReconLib.live.pairing.synchronizer import Synchronizer  # noqa: E402
from AIFReconLib.live.session.recording import Recorder  # noqa: E402

FORK = multiprocessing.get_context("fork")
"""A child's end is not ours. Reading may start threads, which no fork has: that is done in a child, too."""

LONGEST = 1200.0
"""s that a child may take."""

RENAMING = ("disk/atomic.py", "disk/workspace.py", "session/recording.py", "tempfile.py", "shutil.py")
"""Where a line counts: what makes, renames and removes files. All writes share it."""

FILES = ("scan.mhd", "scan.mha", "scan.nrrd")
FRAMES = 12
LISTED = mmap.mmap(-1, 1)
"""How many frames a child has recorded."""

Work = Callable[[Path], object]


class Lost(Exception):
    """What must not be: a file that is neither version, a stray one, a listed frame that cannot be read."""


# ---- children


def begun(work: Callable[[], object]):
    """A child that does this."""
    child = FORK.Process(target=work)
    child.start()
    return child


def end_of(child) -> int:
    """The child's exit code, negative for a signal."""
    child.join(LONGEST)
    child.kill()
    child.join()
    return child.exitcode


def result_of(work: Callable[[], object]):
    """What `work` returns in a child."""
    ours, theirs = FORK.Pipe(duplex=False)
    child = begun(lambda: theirs.send(work()))
    theirs.close()
    try:
        return ours.recv() if ours.poll(LONGEST) else None
    except EOFError:
        raise Lost("what is there cannot be read") from None
    finally:
        end_of(child)


def lines_of(work: Callable[[], object], due: int | None = None) -> int:
    """How many lines of `RENAMING` it runs; before line number `due` its process is killed."""
    lines = 0

    def count(_frame, event, _argument):
        nonlocal lines
        lines += event == "line"
        if lines == due:
            os.kill(os.getpid(), signal.SIGKILL)
        return count

    sys.settrace(lambda frame, *_: count if frame.f_code.co_filename.endswith(RENAMING) else None)
    work()
    sys.settrace(None)
    return lines


class Killer:
    """Runs work in a child that is killed, half of the times before a line and half at a moment."""

    def __init__(self, work: Work, place: Path, chance: random.Random):
        self.chance = chance
        self.lines = result_of(partial(lines_of, partial(work, place / "lines")))
        begin = time.monotonic()
        if end_of(begun(partial(work, place / "moments"))):
            raise RuntimeError("it fails without a fault")
        # Random moments may come after the end
        self.seconds = 1.1 * (time.monotonic() - begin)

    def __call__(self, work: Callable[[], object], at_line: bool) -> int:
        """The exit code."""
        if at_line:
            return end_of(begun(partial(lines_of, work, self.chance.randrange(1, self.lines + 1))))
        child = begun(work)
        time.sleep(self.chance.uniform(0.0, self.seconds))
        child.kill()
        return end_of(child)


# ---- what is killed


def pixels(version: int) -> np.ndarray:
    """They take time to write. Both versions have the same size, so that mixing them would pass."""
    return np.random.default_rng(version).integers(0, 256, (FRAMES, 60, 80), dtype=np.uint8)


def write(file: str, place: Path, version: int = 1) -> None:
    """Write a sequence."""
    place.mkdir(exist_ok=True)
    write_sequence(tracked_sequence(FRAMES, images=pixels(version)), place / file, compress=False)


def record(file: str, place: Path) -> None:
    """Record the newer version, or take its recording up."""
    place.mkdir(exist_ok=True)
    growing = next(place.glob("*.recording.mhd"), None)
    name = file if growing is None else growing.name.replace(".recording.mhd", Path(file).suffix)
    recorder, synchronizer = Recorder(place / name, takes_up=True), Synchronizer()
    messages = [message for n, image in enumerate(pixels(1)) for message in tracked(1.0 + 0.1 * n, pixels=image)]
    frames = [frame for message in messages for frame in synchronizer.feed(message)] + synchronizer.flush()
    for number, frame in enumerate(frames[recorder.frames :], recorder.frames):
        recorder.append(frame)
        LISTED[0] = number + 1
    recorder.finish()


def version_of(path: Path) -> str:
    """Which version is there, whole."""
    if not path.exists():
        return "absent"
    images = np.asarray(read_sequence(path).images)
    return next((name for version, name in enumerate(("old", "new")) if np.array_equal(images, pixels(version))), "mixed")


def readable(place: Path, older: str | None) -> int:
    """Frames that the file with the most of them has; those of all others must be right, too."""
    most = 0
    for path in place.iterdir():
        if path.suffix in (".mhd", ".mha", ".nrrd") and path.name != older:
            images = np.asarray(read_sequence(path).images)
            if not np.array_equal(images, pixels(1)[: len(images)]):
                raise ValueError("other pixels")
            most = max(most, len(images))
    return most


def writing(file: str, place: Path, older: bool, kill: Callable[[Callable[[], object]], int]) -> str:
    """Either version is there afterwards, and the next write goes through."""
    code = kill(partial(write, file, place))
    state = result_of(partial(version_of, place / file))
    if state not in ("old" if older else "absent", "new") or code not in (0, -signal.SIGKILL):
        raise Lost(f"{state}, exit {code}")
    end_of(begun(partial(write, file, place)))
    if (after := result_of(partial(version_of, place / file))) != "new":
        raise Lost(f"next write: {after}")
    return "finished before" if code == 0 else state


def recording(file: str, place: Path, older: bool, kill: Callable[[Callable[[], object]], int]) -> str:
    """Killed three times and taken up after each: every listed frame is readable each time, and the recording whole at last."""
    LISTED[0], there = 0, {path: path.read_bytes() for path in place.iterdir()}
    work, kept = partial(record, file, place), partial(readable, place, file if older else None)
    for _ in range(3):
        code = kill(work)
        if (found := result_of(kept)) < LISTED[0] or code not in (0, -signal.SIGKILL):
            raise Lost(f"exit {code}, {LISTED[0]} frames listed, {found} readable")
        if code == 0:
            break
    else:
        code = end_of(begun(work))
    if code or (whole := result_of(kept)) != FRAMES:
        raise Lost(f"taken up at last: exit {code}, {whole} of {FRAMES} frames")
    if there != {path: path.read_bytes() for path in there}:
        raise Lost("the older file is another")
    return "every listed frame readable, taken up to the end"


# ---- how often


def run(words: list[str], seconds: float) -> tuple[Counter[str], Counter[str]]:
    """Give each case its share of the time, and one trial at least; what came out, and what was lost."""
    works: dict[Callable[..., str], Callable[..., None]] = {recording: record, writing: write}
    cases = [(trial, file) for trial in works for file in FILES if any(word in f"{trial.__name__} {file}" for word in words)]
    outcomes: Counter[str] = Counter()
    lost: Counter[str] = Counter()
    chance, end = random.Random(0), time.monotonic() + seconds
    for left, (trial, file) in zip(range(len(cases), 0, -1), cases):
        until, number = time.monotonic() + max(end - time.monotonic(), 0) / left, 0
        with tempfile.TemporaryDirectory(prefix="faults-") as made:
            killer = Killer(partial(works[trial], file), Path(made), chance)
            while number == 0 or time.monotonic() < until:
                place, older = Path(made) / str(number), number % 2 == 0
                place.mkdir()
                if older:
                    end_of(begun(partial(write, file, place, 0)))
                try:
                    came = trial(file, place, older, partial(killer, at_line=number % 4 < 2))
                    named = {named_data_file(header) for header in place.glob("*.mhd")}
                    if left_there := {path.name for path in place.iterdir() if PREFIX in path.name} - named:
                        raise Lost(f"left: {left_there}")
                    outcomes[came] += 1
                except Lost as what:
                    lost[f"{trial.__name__} {file}: {what}"] += 1
                number += 1
    return outcomes, lost


def main() -> int:
    """Run, and print the table."""
    parser = argparse.ArgumentParser(prog="python -m faults", description=__doc__.splitlines()[0])
    parser.add_argument("words", nargs="*", metavar="WORDS", help="only cases with one of these in their name (default: all)")
    parser.add_argument("--seconds", type=float, default=3600.0, metavar="S", help="time for all of them (default: %(default)g)")
    parser.add_argument("--pages", action="store_true", help="also renew docs/measured, and the pages that show it")
    arguments = parser.parse_args()
    outcomes, lost = run(arguments.words or [""], arguments.seconds)
    told = "; ".join(f"{count} {what}" for what, count in outcomes.most_common())
    rows = f"| kill -9 | {outcomes.total() + lost.total()} | {told} | {lost.total() or 'nothing'} |"
    page = f"| Fault | times | what came out | lost |\n|---|---|---|---|\n{rows}"
    print(page, *(f"LOST {what} ({count} times)" for what, count in lost.items()), sep="\n")
    if arguments.pages and not arguments.words:
        keep({"faults": page}, "make faults")
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
