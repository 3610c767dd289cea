"""Commands that are told to end, or whose surroundings are not as they should be: signals, streams, locales, folders, limits."""

from __future__ import annotations

import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from unittest import mock

from AIFReconLib.io.disk.workspace import remove_left_behind

from .children import end_of, result_of, start
from .commands import COMMANDS, Command, quietly
from .killing import duration_of, left_in, names_of, version_of
from .ledger import Entry, Ledger

REPOSITORY = Path(__file__).resolve().parents[2]
PATIENCE = 500.0
"""s that a command may take to end after it was told to."""


def signals(ledger: Ledger, commands: tuple[Command, ...], trials: int, seed: int = 0) -> None:
    """Each command, told to end at random moments: it says so in one line, with the signal's exit code, and leaves whole files only."""
    chance = random.Random(seed)
    for command in commands:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            entry = ledger.begin(number.name, "at random moments of the whole command", f"aifrecon {command.name}")
            if entry is None:
                return
            with tempfile.TemporaryDirectory(prefix="faults-") as made:
                _signal_often(entry, command, Path(made), number, trials, chance)


def _signal_often(entry: Entry, command: Command, folder: Path, number: signal.Signals, trials: int, chance: random.Random) -> None:
    inputs, clean = folder / "inputs", folder / "new"
    end_of(start(partial(command.prepare, inputs)))
    clean.mkdir()
    lasts = duration_of(lambda: sys.exit(quietly(command.arguments(inputs, clean, 1))))
    digests = {name: result_of(partial(digest, clean / name)) for name, digest in command.outputs.items()}
    for trial in range(trials):
        place = folder / f"trial-{trial}"
        place.mkdir()
        lines, code = _told_to_end(command, inputs, place, number, chance.uniform(0.0, lasts))
        states = {version_of(place / name, ["", digests[name]], digest) for name, digest in command.outputs.items()}
        # An interrupt at the very moment at which a temporary folder is made or removed leaves it for the next write to clear
        left = bool(left_in(place, set().union(*map(names_of, command.outputs))))
        remove_left_behind(place)
        strangers = left_in(place, set().union(*map(names_of, command.outputs)))
        entry.cleared += left and not strangers
        if states - {"absent", "new"} or strangers or code not in (0, 128 + number):
            entry.lost[f"exit {code}, {sorted(states)}, left {sorted(strangers)}: {' / '.join(lines)[-160:]}"] += 1
        elif code == 0:
            entry.outcomes["finished before"] += 1
        elif len(lines) == 1 and lines[0].startswith("aifrecon: Interrupted."):
            entry.outcomes["one line, its exit code, whole files or none"] += 1
        else:
            entry.lost[f"says {' / '.join(lines)[-160:]}"] += 1
        shutil.rmtree(place)


def _told_to_end(command: Command, inputs: Path, place: Path, number: int, after: float) -> tuple[list[str], int]:
    """What the command says, and its exit code. The signal comes when the command line has begun, or later."""
    with tempfile.TemporaryFile() as said:
        ready, tell = os.pipe()

        def work() -> None:
            signal.signal(signal.SIGINT, signal.default_int_handler)  # which a shell's background job has not
            os.dup2(said.fileno(), 2)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            from AIFReconLib.__main__ import main as entry
            from AIFReconLib.commands import parser as cli
            from AIFReconLib.terminal.signals import orderly_end

            arguments = command.arguments(inputs, place, 1)

            def begun(end):
                manager = orderly_end(end)
                os.write(tell, b"x")
                return manager

            sys.argv[1:] = arguments
            # For good: what would undo it might be where the signal comes, which is none of the command's
            mock.patch.object(cli, "orderly_end", begun).start()
            sys.exit(entry())

        child = start(work)
        os.read(ready, 1)
        os.close(ready)
        os.close(tell)
        time.sleep(after)
        os.kill(child, number)
        code = end_of(child, PATIENCE)
        said.seek(0)
        return [line for line in said.read().decode("utf-8", "replace").splitlines() if line.strip()], code


@dataclass(frozen=True)
class Surrounding:
    """What is wrong around a command.

    Parameters
    ----------
    how : str
    shell : str
        How the command, `$AIFRECON`, is called.
    expected : set of int
        Exit codes that are right.
    limits : dict of resource to value
    environment : dict
        Added to ours.
    """

    how: str
    shell: str = "$AIFRECON"
    expected: frozenset[int] = frozenset({0})
    limits: dict[int, int] = field(default_factory=dict)
    environment: dict[str, str] = field(default_factory=dict)


OK_OR_REFUSED = frozenset({0, 2})
MIB = 2**20

SURROUNDINGS = (
    Surrounding("standard output closed", "$AIFRECON >&-"),
    Surrounding("standard error closed", "$AIFRECON 2>&-"),
    Surrounding("all three streams closed", "$AIFRECON <&- >&- 2>&-"),
    Surrounding("standard output full (/dev/full)", "$AIFRECON >/dev/full", frozenset({2})),
    Surrounding("the reader goes away (| true)", "set -o pipefail; $AIFRECON | true"),
    Surrounding("the reader goes away, unbuffered", "set -o pipefail; PYTHONUNBUFFERED=1 $AIFRECON | true"),
    Surrounding("LC_ALL=C without UTF-8 mode", environment={"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}),
    Surrounding("LC_ALL=POSIX", environment={"LC_ALL": "POSIX"}),
    Surrounding("output stream in ASCII", environment={"PYTHONIOENCODING": "ascii"}),
    Surrounding("HOME and numba's cache cannot be written", environment={"HOME": "/proc", "NUMBA_CACHE_DIR": "/proc/none"}),
    Surrounding("TMPDIR does not exist", environment={"TMPDIR": "/nonexistent"}),
    Surrounding("TMPDIR is read-only", environment={"TMPDIR": "/proc"}),
    *(
        Surrounding(f"address space of {n} MiB (RLIMIT_AS)", expected=OK_OR_REFUSED, limits={resource.RLIMIT_AS: n * MIB})
        for n in (50, 200, 400, 600, 799, 800, 850, 900, 1000, 1200, 1600, 2400)
    ),
    *(
        Surrounding(f"{n} open files (RLIMIT_NOFILE)", expected=OK_OR_REFUSED, limits={resource.RLIMIT_NOFILE: n})
        for n in (6, 8, 10, 12, 16, 24)
    ),
    *(
        Surrounding(f"files up to {n} bytes (RLIMIT_FSIZE)", expected=OK_OR_REFUSED, limits={resource.RLIMIT_FSIZE: n})
        for n in (0, 100, 1000, 10_000)
    ),
)


def surroundings(ledger: Ledger, commands: tuple[Command, ...], cases: tuple[Surrounding, ...]) -> None:
    """Each command in each surrounding: it does its work, or says in one line why not, and leaves no half file."""
    for case in cases:
        entry = ledger.begin("surroundings", case.how, ", ".join(command.name for command in commands))
        if entry is None:
            return
        for command in commands:
            with tempfile.TemporaryDirectory(prefix="faults-ü-") as made:
                _one_surrounding(entry, command, Path(made), case)


def _one_surrounding(entry: Entry, command: Command, folder: Path, case: Surrounding) -> None:
    inputs, place, clean = folder / "inputs", folder / "ä out", folder / "clean"
    end_of(start(partial(command.prepare, inputs)))
    for made in (place, clean):
        made.mkdir()
    end_of(start(lambda: sys.exit(quietly(command.arguments(inputs, clean, 1)))))
    arguments = command.arguments(inputs, place, 1)
    words = " ".join("'" + word.replace("'", "'\\''") + "'" for word in arguments)
    environment = {**os.environ, "PYTHONPATH": str(REPOSITORY), **case.environment}

    def limit() -> None:
        for which, value in case.limits.items():
            resource.setrlimit(which, (value, value))

    call = case.shell.replace("$AIFRECON", f"'{sys.executable}' -m AIFReconLib {words}")
    try:
        done = subprocess.run(["bash", "-c", call], env=environment, capture_output=True, check=False, preexec_fn=limit, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        entry.lost[f"{command.name}: hangs"] += 1
        return
    lines = [line for line in done.stderr.decode("utf-8", "replace").splitlines() if line.strip()]
    states = set()
    for name, digest in command.outputs.items():
        states.add(version_of(place / name, ["", result_of(partial(digest, clean / name))], digest))
    strangers = left_in(place, set().union(*map(names_of, command.outputs)))
    one_line = done.returncode == 0 or "2>&-" in case.shell or (len(lines) == 1 and lines[0].startswith("aifrecon"))
    if done.returncode in case.expected and states <= {"absent", "new"} and not strangers and one_line:
        entry.outcomes["works" if done.returncode == 0 else f"one line: {_kind(lines)}"] += 1
    else:
        entry.lost[f"{command.name}: exit {done.returncode}, {sorted(states)}, {sorted(strangers)}: {' / '.join(lines)[-200:]}"] += 1


def _kind(lines: list[str]) -> str:
    """The message without its file names."""
    return lines[0].split(": ")[-1][:70] if lines else ""


def run(
    ledger: Ledger,
    commands: tuple[Command, ...] = COMMANDS,
    cases: tuple[Surrounding, ...] = SURROUNDINGS,
    trials: int = 30,
) -> None:
    """All of it."""
    surroundings(ledger, commands, cases)
    signals(ledger, commands, trials)
