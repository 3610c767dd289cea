"""kill -9 during every kind of write: at every line of Python that runs, and at random moments, which fall into compiled code too."""

from __future__ import annotations

import mmap
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from AIFReconLib.io.disk.atomic import named_data_file
from AIFReconLib.io.disk.workspace import PREFIX
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.live.session.recording import Recorder

from .children import end_of, result_of, start
from .commands import Command, quietly
from .ledger import Entry, Ledger
from .writers import RECORDED, RECORDINGS, Writer, recorded_frames

RENAMING = ("disk/atomic.py", "disk/header_data_pair.py", "disk/workspace.py", "session/recording.py", "tempfile.py", "shutil.py")
"""Where a line counts: what makes, renames and removes files. All writes share it, so over all of them each line is met several times."""

MOMENTS = 1.1
"""Random moments reach this far beyond the time that the work takes."""


def traced(work: Callable[[], None], line: int | None = None) -> int:
    """How many lines of `RENAMING` the work runs; the process is killed before the given one."""
    count = 0

    def local(frame, event, _):
        nonlocal count
        if event == "line":
            if count == line:
                os.kill(os.getpid(), signal.SIGKILL)
            count += 1
        return local

    def begin(frame, _event, _argument):
        return local if any(name in frame.f_code.co_filename for name in RENAMING) else None

    sys.settrace(begin)
    try:
        work()
    finally:
        sys.settrace(None)
    return count


def duration_of(work: Callable[[], object]) -> float:
    """s from the fork of a child to the end of its work."""
    begun = time.monotonic()
    end_of(start(work))
    return time.monotonic() - begun


def killed_at_line(work: Callable[[], None], line: int) -> int:
    """The child's exit code: -9 when the line was reached."""
    return end_of(start(lambda: traced(work, line)))


def killed_after(work: Callable[[], object], seconds: float) -> int:
    """The child's exit code: -9 when it was still at work."""
    child = start(work)
    time.sleep(seconds)
    os.kill(child, signal.SIGKILL)
    return end_of(child)


def chosen_lines(lines: int, count: int, chance: random.Random) -> list[int]:
    """`count` of so many lines, or all of them."""
    return list(range(lines)) if lines <= count else sorted(chance.sample(range(lines), count))


def left_in(folder: Path, known: set[str]) -> set[str]:
    """What lies in the folder and does not belong there."""
    return {path.name for path in folder.iterdir()} - known - {named_data_file(header) for header in folder.glob("*.mhd")}


def names_of(file: str) -> set[str]:
    """The file and its data file."""
    stem = file.rpartition(".")[0]
    return {file, f"{stem}.raw", f"{stem}.zraw"} if file.endswith(".mhd") else {file}


def version_of(path: Path, digests: list[str], digest: Callable[[Path], str]) -> str:
    """``old`` or ``new``, ``absent``, or what is wrong."""
    if not path.exists():
        return "absent"
    try:
        found = result_of(lambda: digest(path))
    except RuntimeError:
        return "damaged"
    return {digests[0]: "old", digests[1]: "new"}.get(found, "mixed")


def kill_write(entry: Entry, writer: Writer, trials: int, chance: random.Random, folder: Path) -> None:
    """Kill one kind of write `trials` times: half at lines, half at moments; with an older file there and without, in turn."""
    clean = [folder / "old", folder / "new"]
    for version, place in enumerate(clean):
        place.mkdir()
        end_of(start(partial(writer.write, place, version)))
    digests = [result_of(partial(writer.digest, place / writer.file)) for place in clean]

    def trial(number: int, older: bool, kill: Callable[[Callable[[], None]], int]) -> None:
        place = folder / f"trial-{number}"
        shutil.copytree(clean[0], place) if older else place.mkdir()
        work = partial(writer.write, place, 1)
        code = kill(work)
        state = version_of(place / writer.file, digests, writer.digest)
        count(entry, code, state, older)
        # The next write must go through, and clear away what the killed one has left
        left = any(name.startswith(PREFIX) for name in left_in(place, set()))
        end_of(start(work))
        after = version_of(place / writer.file, digests, writer.digest)
        strangers = left_in(place, names_of(writer.file))
        if after != "new" or strangers:
            entry.lost[f"next write: {after}, left: {sorted(strangers)}"] += 1
        elif left:
            entry.cleared += 1
        shutil.rmtree(place)

    for older in (True, False):
        probe = folder / "probe"
        shutil.copytree(clean[0], probe) if older else probe.mkdir()
        lines = result_of(partial(traced, partial(writer.write, probe, 1)))
        shutil.rmtree(probe)
        shutil.copytree(clean[0], probe) if older else probe.mkdir()
        lasts = duration_of(partial(writer.write, probe, 1))
        shutil.rmtree(probe)
        each = max(trials // 4, 1)
        for number, line in enumerate(chosen_lines(lines, each, chance)):
            trial(number, older, partial(killed_at_line, line=line))
        for number in range(each):
            trial(number, older, partial(killed_after, seconds=chance.uniform(0, MOMENTS * lasts)))


def count(entry: Entry, code: int, state: str, older: bool) -> None:
    """Book one trial: a file is the old one, the new one, or was never there."""
    good = {"old", "new"} if older else {"absent", "new"}
    if state not in good or code not in (0, -signal.SIGKILL):
        entry.lost[f"{state}, exit {code}"] += 1
    else:
        entry.outcomes["finished before" if code == 0 else state] += 1


def kill_recording(entry: Entry, writer: Writer, trials: int, chance: random.Random, folder: Path) -> None:
    """Kill a recording at lines and moments, and twice more while it is taken up; each time every listed frame must be readable."""
    expected = np.stack([frame.image for frame in recorded_frames(1)])
    clean = folder / "old"
    clean.mkdir()
    end_of(start(partial(writer.write, clean, 0)))
    digests = [result_of(partial(writer.digest, clean / writer.file)), ""]

    def begun(place: Path) -> Path:
        growing = next(place.glob("*.recording.mhd"), None)
        return place / (writer.file if growing is None else growing.name.replace(".recording.mhd", Path(writer.file).suffix))

    def record(place: Path, listed: mmap.mmap) -> None:
        recorder = Recorder(begun(place), takes_up=True)
        for number, frame in enumerate(recorded_frames(1)[recorder.frames :], recorder.frames):
            recorder.append(frame)
            listed[0] = number + 1
        recorder.finish()

    def readable(place: Path, older: bool) -> int:
        """Frames that the file with the most of them has; all others must be right, too."""
        most = 0
        for path in place.iterdir():
            if path.suffix in (".mhd", ".mha", ".nrrd") and not (older and path.name == writer.file):
                images = np.asarray(read_sequence(path).images)
                if not np.array_equal(images, expected[: len(images)]):
                    raise ValueError("other pixels")
                most = max(most, len(images))
        return most

    def kept_by(place: Path, older: bool) -> int:
        try:
            return result_of(partial(readable, place, older))
        except RuntimeError:
            return -1

    def trial(number: int, older: bool, kills) -> None:
        place = folder / f"trial-{number}"
        shutil.copytree(clean, place) if older else place.mkdir()
        with mmap.mmap(-1, 1) as listed:
            for kill in kills:
                code = kill(partial(record, place, listed))
                state, kept = version_of(place / writer.file, digests, writer.digest) if older else "old", kept_by(place, older)
                if kept < listed[0] or state != "old" or code not in (0, -signal.SIGKILL):
                    entry.lost[f"exit {code}, {state}, {listed[0]} frames listed, {kept} readable"] += 1
                    break
                if code == 0:
                    break
            else:
                code = end_of(start(partial(record, place, listed)))
            whole = kept_by(place, older)
        left = {path.name for path in place.glob(f"{PREFIX}*")}
        if code or whole != RECORDED or left:
            entry.lost[f"taken up at last: exit {code}, {whole} of {RECORDED} frames, left: {sorted(left)}"] += 1
        else:
            entry.outcomes["every listed frame readable, taken up to the end"] += 1
        shutil.rmtree(place)

    for older in (True, False):
        probe = folder / "probe"
        shutil.copytree(clean, probe) if older else probe.mkdir()
        with mmap.mmap(-1, 1) as listed:
            lines = result_of(partial(traced, partial(record, probe, listed)))
            shutil.rmtree(probe)
            shutil.copytree(clean, probe) if older else probe.mkdir()
            lasts = duration_of(partial(record, probe, listed))
        shutil.rmtree(probe)
        each = max(trials // 4, 1)
        for number, line in enumerate(chosen_lines(lines, each, chance)):
            # What is taken up has fewer lines left
            at = [line, *(chance.randrange(lines // 2) for _ in range(2))]
            trial(number, older, [partial(killed_at_line, line=line) for line in at])
        for number in range(each):
            trial(number, older, [partial(killed_after, seconds=chance.uniform(0, MOMENTS * lasts)) for _ in range(3)])


def kill_command(entry: Entry, command: Command, trials: int, chance: random.Random, folder: Path) -> None:
    """Kill a whole command at random moments; every output is the older one, the new one or absent, whole, and no input is touched."""
    inputs = folder / "inputs"
    command.prepare(inputs)
    before = result_of(lambda: command.digest_inputs(inputs))
    clean = [folder / "old", folder / "new"]

    def run_to_exit(place: Path, version: int) -> None:
        sys.exit(quietly(command.arguments(inputs, place, version)))

    for version, place in enumerate(clean):
        place.mkdir()
        code = end_of(start(partial(run_to_exit, place, version)))
        if code:
            raise RuntimeError(f"{command.name} ends with {code}")
    digests = {name: [result_of(partial(digest, place / name)) for place in clean] for name, digest in command.outputs.items()}
    lasts = duration_of(partial(quietly, command.arguments(inputs, clean[1], 1)))
    for number in range(trials):
        older = number % 2 == 0
        place = folder / f"trial-{number}"
        shutil.copytree(clean[0], place) if older else place.mkdir()
        code = killed_after(partial(quietly, command.arguments(inputs, place, 1)), chance.uniform(0, MOMENTS * lasts))
        states = {version_of(place / name, digests[name], digest) for name, digest in command.outputs.items()}
        if states - ({"old", "new"} if older else {"absent", "new"}):
            entry.lost[f"{sorted(states)}, exit {code}"] += 1
        else:
            entry.outcomes["finished before" if code == 0 else " and ".join(sorted(states))] += 1
        shutil.rmtree(place)
    if result_of(lambda: command.digest_inputs(inputs)) != before:
        entry.lost["an input was changed"] += 1


def run(
    ledger: Ledger, writers: tuple[Writer, ...], commands: tuple[Command, ...], trials: int = 240, command_trials: int = 60, seed: int = 0
) -> None:
    """All of it."""
    chance = random.Random(seed)
    for writer in writers:
        if entry := ledger.begin("kill -9", "half at lines of Python, half at random moments", f"{writer.name}"):
            with tempfile.TemporaryDirectory(prefix="faults-") as folder:
                (kill_recording if writer in RECORDINGS else kill_write)(entry, writer, trials, chance, Path(folder))
    for command in commands:
        if entry := ledger.begin("kill -9", "at random moments of the whole command", f"aifrecon {command.name}"):
            with tempfile.TemporaryDirectory(prefix="faults-") as folder:
                kill_command(entry, command, command_trials, chance, Path(folder))
