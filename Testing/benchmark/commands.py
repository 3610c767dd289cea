"""How long whole commands take, by the clock and of the processor: at first use, with nothing compiled, and after.

    python Testing/benchmark commands
    python Testing/benchmark commands --pages

Each is a process of its own, on a simulated patient and, where it is there, on the recorded sweep of real bone.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from measured import keep, table

from AIFReconLib.message import columns
from AIFReconLib.workflows.benchmark import busy_share, busy_warning, machine
from AIFReconLib.workflows.simulate import write_simulated_patient

FRAMES = 144

LEAST_OF = 3
"""Runs after the first, of which the least counts."""

HEADING = ("", "first use, s", "its processor time", "after, s", "its processor time")
LIBRARY = Path(__file__).resolve().parents[2]

Row = tuple[str, float, float, float, float]


def commands(folder: Path, data: Path | None) -> dict[str, list[str]]:
    """The words of each command by what is said of it. A simulated patient is made in the folder."""
    made = write_simulated_patient(folder, frames=FRAMES)
    sweep = [str(made.sequence), "--config", str(made.configuration)]
    bone = ["--bone-labels", str(made.labels), "--bone-transform", str(made.ct_to_reference)]
    result = {
        "`--help`": ["--help"],
        "`info`": ["info", *sweep],
        "`reconstruct`, average": ["reconstruct", *sweep, "--method", "average", "-o", str(folder / "average.nrrd")],
        "`reconstruct` with a CT": ["reconstruct", *sweep, *bone, "-o", str(folder / "weighted.nrrd")],
        "`register`": ["register", *sweep, *bone, "-o", str(folder / "placed.tfm")],
        "`coverage`": ["coverage", *sweep, *bone],
        "`plan`": ["plan", *bone, "-o", str(folder / "plan.json")],
        "`calibrate --check`": ["calibrate", *sweep, *bone, "--check"],
    }
    if data is not None and (fibula := data / "fibula").is_dir():
        bone = ["--bone-labels", str(fibula / "fibula-labels.nrrd"), "--probe", "linear", "--spacing", "0.5"]
        words = ["reconstruct", str(fibula / "fibula-distal.igs.mha"), *bone, "-o", str(folder / "fibula.nrrd")]
        result["`reconstruct` with a CT, fibula"] = words
    return result


def timed(words: list[str], kept: Path) -> tuple[float, float]:
    """Seconds of one command by the clock and of the processor, with compiled code in the folder `kept`.

    Raises CalledProcessError where it fails; that it refuses a result, which is 1, is none.
    """
    path = os.pathsep.join(filter(None, (str(LIBRARY), os.environ.get("PYTHONPATH"))))
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(kept), "PYTHONPATH": path}
    before, started = os.times(), time.perf_counter()
    done = subprocess.run([sys.executable, "-m", "AIFReconLib", *words], env=environment, capture_output=True, check=False)
    clock, after = time.perf_counter() - started, os.times()
    if done.returncode > 1:
        raise subprocess.CalledProcessError(done.returncode, words, done.stdout, done.stderr)
    return clock, after.children_user + after.children_system - before.children_user - before.children_system


def measure(data: Path | None, names: tuple[str, ...] = ()) -> list[Row]:
    """A row for each command, or for those whose names begin with one of these words."""
    rows = []
    with tempfile.TemporaryDirectory(prefix="aifrecon-") as folder:
        for name, words in commands(Path(folder) / "patient", data).items():
            if names and words[0] not in names:
                continue
            with tempfile.TemporaryDirectory(prefix="aifrecon-") as kept:
                first = timed(words, Path(kept))
                later = [timed(words, Path(kept)) for _ in range(LEAST_OF)]
            rows.append((name, *first, min(clock for clock, _ in later), min(processor for _, processor in later)))
    return rows


def markdown(rows: list[Row]) -> str:
    """The table for the pages."""
    return table(HEADING, ([name, *(f"{second:.1f}" for second in seconds)] for name, *seconds in rows))


def main(words: list[str] | None = None) -> int:
    """Measure and print; the answer is the exit status."""
    parser = argparse.ArgumentParser(prog="python Testing/benchmark commands", description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="only these commands, as they are called (default: all)")
    parser.add_argument("--data", type=Path, default=os.environ.get("AIFRECON_DATA_DIR"), metavar="DIR", help="where fibula/ is")
    parser.add_argument("--pages", action="store_true", help="also renew docs/measured, and the pages that show it")
    arguments = parser.parse_args(words)
    if arguments.names and arguments.pages:
        parser.error("the pages are of all commands: leave out their names or --pages")
    rows = measure(arguments.data and Path(arguments.data), tuple(arguments.names))
    print(columns([HEADING, *((name, *(f"{second:.2f}" for second in seconds)) for name, *seconds in rows)]))
    print(busy_warning(busy_share()))
    if arguments.pages:
        keep({"speed-commands": markdown(rows)}, "make bench", machine().replace("\n", "; "))
    return 0
