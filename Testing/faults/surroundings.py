"""Commands that are told to end, or whose surroundings are not as they should be: signals, streams, locales, folders, limits."""

from __future__ import annotations

import os
import random
import resource
import shlex
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from AIFReconLib.io.disk.workspace import remove_left_behind

from .children import LONGEST, end_of, result_of, seconds_of, start
from .ledger import Fault, Lost, Trial
from .samples import COMMANDS, Command, left_in, version_of, write_inputs

REPOSITORY = Path(__file__).resolve().parents[2]
SAID = 2 * 10**8
"""ns of the time of a command in which it loads Python and its own first file: no signal is its own affair before."""


@dataclass(frozen=True)
class Surrounding:
    """What is wrong around a command.

    Parameters
    ----------
    how : str
    shell : str
        How the command, `$AIFRECON`, is called.
    expected : tuple of int
        Exit codes that are right.
    limits : dict of resource to value
    environment : dict
        Added to ours.
    """

    how: str
    shell: str = "$AIFRECON"
    expected: tuple[int, ...] = (0,)
    limits: dict[int, int] = field(default_factory=dict)
    environment: dict[str, str] = field(default_factory=dict)


LIMITS = {
    "MiB of address space": (resource.RLIMIT_AS, 2**20, (800, 850, 900, 1000, 1200, 1600, 2400)),
    "open files": (resource.RLIMIT_NOFILE, 1, (6, 8, 10, 12, 16, 24)),
    "bytes of a file": (resource.RLIMIT_FSIZE, 1, (0, 100, 1000, 10_000)),
}
SURROUNDINGS = (
    Surrounding("standard output closed", "$AIFRECON >&-"),
    Surrounding("standard error closed", "$AIFRECON 2>&-"),
    Surrounding("all three streams closed", "$AIFRECON <&- >&- 2>&-"),
    Surrounding("standard output full (/dev/full)", "$AIFRECON >/dev/full", (2,)),
    Surrounding("the reader goes away (| true)", "set -o pipefail; $AIFRECON | true"),
    Surrounding("the reader goes away, unbuffered", "set -o pipefail; PYTHONUNBUFFERED=1 $AIFRECON | true"),
    Surrounding("LC_ALL=C without UTF-8 mode", environment={"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}),
    Surrounding("output stream in ASCII", environment={"PYTHONIOENCODING": "ascii"}),
    Surrounding("HOME and numba's cache cannot be written", environment={"HOME": "/proc", "NUMBA_CACHE_DIR": "/proc/none"}),
    Surrounding("TMPDIR does not exist", environment={"TMPDIR": "/nonexistent"}),
    *(
        Surrounding(f"{number} {what}", expected=(0, 2), limits={which: number * unit})
        for what, (which, unit, numbers) in LIMITS.items()
        for number in numbers
    ),
)


def run_often(command: Command, case: Surrounding, number: int, folder: Path, chance: random.Random) -> Trial:
    """A command in a surrounding, or told to end by a signal: it does its work or says in one line why not, and leaves no half file."""
    inputs, new = folder / "inputs", folder / "new"
    end_of(start(partial(write_inputs, inputs)))
    new.mkdir()
    lasts = seconds_of(partial(command.run, inputs, new, 1))
    digests = {name: {"new": result_of(partial(digest, new / name))} for name, digest in command.outputs.items()}
    environment = {**os.environ, "PYTHONPATH": str(REPOSITORY), **case.environment}

    def limit() -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)  # which a shell's background job has not
        for which, value in case.limits.items():
            resource.setrlimit(which, (value, value))

    def trial(place: Path, _number: int) -> str:
        line = shlex.join([sys.executable, "-m", "AIFReconLib", *command.line(inputs, place, 1).split()])
        call = case.shell.replace("$AIFRECON", f"exec {line}" if number else line)
        with subprocess.Popen(["bash", "-c", call], env=environment, stderr=-1, stdout=-1, preexec_fn=limit) as process:
            if number:
                time.sleep(SAID / 1e9 + chance.uniform(0.0, lasts))
                process.send_signal(number)
            try:
                said = process.communicate(timeout=LONGEST)[1].decode("utf-8", "replace")
            except subprocess.TimeoutExpired:
                process.kill()
                raise Lost("it hangs") from None
        code, lines = process.returncode, [each for each in said.splitlines() if each.strip()]
        states = {version_of(place / name, digests[name], digest) for name, digest in command.outputs.items()}
        # An interrupt at the very moment at which a temporary folder is made or removed leaves it for the next write
        remove_left_behind(place)
        strangers = left_in(place, *command.outputs)
        is_line = code == 0 or "2>&-" in case.shell or (len(lines) == 1 and lines[0].startswith("aifrecon"))
        if code not in case.expected or states - {"absent", "new"} or strangers or not is_line:
            raise Lost(f"exit {code}, {sorted(states)}, {strangers}: {' / '.join(lines)[-200:]}")
        return "finished before" if number and code == 0 else "works" if code == 0 else "one line, its exit code, whole files or none"

    return trial


CASES = (
    *(
        Fault(number.name, f"aifrecon {command.name}", partial(run_often, command, Surrounding("", expected=(0, 128 + number)), number))
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
        for command in COMMANDS[:3]
    ),
    *(
        Fault("surroundings", f"{each.how}, aifrecon {command.name}", partial(run_often, command, each, 0))
        for each in SURROUNDINGS
        for command in COMMANDS[:3]
    ),
)
