"""A spine from neck to sacrum, from the file of its sweep to that of its volume: time and peak memory, by the memory given.

    python Testing/benchmark spine
    python Testing/benchmark spine --spacing 0.2 --memory 10

5,000 frames of 640 x 480 (1.5 GB, written once into the folder) in four passes over a back of 400 x 300 x 150 mm, tilted to and fro. What
is measured is the whole program, `aifrecon reconstruct`, in a process of its own, libraries and compiled code included.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from AIFReconLib.compounding.methods.table import BONE_METHODS, METHODS
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.sweep.frames import TrackedSequence

BOX = (400.0, 300.0, 150.0)
"""mm along x (the spine), y and z."""

COLUMNS, ROWS, PIXEL = 640, 480, 0.2
PASSES, TILT_DEG, SWINGS = 4, 20.0, 13
FRAMES = 5000
SHIFTS = 97
"""So many images differ."""

UNLIMITED = "free"
"""The memory of a run that may take three quarters of what is free, as where nobody says."""


class Speckle:
    """Images that take no memory of their own: parts of a larger one."""

    dtype = np.dtype(np.uint8)

    shape = (FRAMES, ROWS, COLUMNS)

    def __init__(self) -> None:
        self._speckle = np.random.default_rng(0).integers(1, 256, (ROWS, COLUMNS + SHIFTS), dtype=np.uint8)

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, number: int) -> np.ndarray:
        shift = int(number) % SHIFTS
        return np.ascontiguousarray(self._speckle[:, shift : shift + COLUMNS])


def passes() -> np.ndarray:
    """image_to_reference (FRAMES, 4, 4): image columns across the spine, rows into a hollow back; the passes reach all sides of the box."""
    poses = np.tile(np.eye(4), (FRAMES, 1, 1))
    which, place = np.divmod(np.arange(FRAMES), -(-FRAMES // PASSES))
    along = place / place.max()
    angle = -np.deg2rad(TILT_DEG) * np.cos(SWINGS * np.pi * along)
    deep, zero = ROWS * PIXEL, np.zeros(FRAMES)
    poses[:, :3, 0] = (0.0, PIXEL, 0.0)
    poses[:, :3, 1] = PIXEL * np.stack([np.sin(angle), zero, np.cos(angle)], axis=1)
    poses[:, :3, 2] = PIXEL * np.stack([np.cos(angle), zero, -np.sin(angle)], axis=1)
    reach = deep * np.sin(np.deg2rad(TILT_DEG))
    x = reach + (BOX[0] - 2 * reach) * along
    poses[:, :3, 3] = np.stack([x, (BOX[1] - COLUMNS * PIXEL) / (PASSES - 1) * which, (BOX[2] - deep) * np.sin(np.pi * along) ** 2], axis=1)
    return poses


def plate() -> Volume:
    """Labels of a plate of bone along the spine."""
    labels = np.zeros((50, 100, 134), np.uint8)
    labels[20:30, 30:70] = 1
    return Volume(labels, np.diag([3.0, 3.0, 3.0, 1.0]))


def inputs(folder: Path) -> tuple[Path, Path]:
    """The sweep and the labels, as files of this folder; made where they are not there."""
    sweep, labels = folder / "spine.igs.mha", folder / "spine-labels.nrrd"
    if not labels.is_file():
        write_sequence(TrackedSequence.from_arrays(Speckle(), passes()), sweep, compress=False)
        plate().write(labels)
    return sweep, labels


def taken_by(command: list[str]) -> dict[str, float]:
    """Run a program to its end: seconds by the clock and of the processor, and the most memory (GB) that it or a process of its took."""
    begun = time.perf_counter()
    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen(command, stdout=said, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
        seconds, process.returncode = time.perf_counter() - begun, os.waitstatus_to_exitcode(status)
        if process.returncode:
            said.seek(0)
            raise SystemExit(f"{' '.join(command)} failed:\n{said.read().decode('utf-8', 'replace')}")
    return {"seconds": seconds, "processor_seconds": usage.ru_utime + usage.ru_stime, "peak_gb": usage.ru_maxrss * 1024 / 1e9}


def measure(folder: Path, spacing: float, method: str, memory: str) -> dict:
    """Reconstruct with so much memory (GB, or `UNLIMITED`), and tell what it took."""
    sweep, labels = inputs(folder)
    output, log = folder / "spine.nrrd", folder / "spine.log"
    for path in (output, log):
        path.unlink(missing_ok=True)
    command = [sys.executable, "-m", "AIFReconLib", "reconstruct", str(sweep), "--method", method, "--spacing", str(spacing)]
    command += ["--probe", "linear", "--output", str(output), "--log", str(log)]
    command += [] if memory == UNLIMITED else ["--memory", memory]
    command += ["--bone-labels", str(labels), "--bone-sigma-mm", "5"] if method in BONE_METHODS else []
    found = taken_by(command)
    parts = re.search(r"worked in (\d+) parts", log.read_text("utf-8"))
    what = {"method": method, "spacing_mm": spacing, "memory": memory, "parts": int(parts[1]) if parts else 1}
    return {**what, **found}


def main(words: list[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        prog="python Testing/benchmark spine", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--spacing", type=float, default=0.3, metavar="MM", help="default: %(default)g")
    parser.add_argument("--method", choices=METHODS, default="average", help="default: %(default)s")
    meaning = f"that each run in turn is given; {UNLIMITED}: three quarters of what is free (default: {UNLIMITED} 6)"
    parser.add_argument("--memory", nargs="+", default=[UNLIMITED, "6"], metavar="GB", help=meaning)
    arguments = parser.parse_args(words)
    with tempfile.TemporaryDirectory(prefix="aifrecon-") as folder:
        for number, memory in enumerate(arguments.memory):
            found = measure(Path(folder), arguments.spacing, arguments.method, memory)
            if number == 0:
                print("  ".join(found))
            print("  ".join(f"{value:.2f}" if isinstance(value, float) else str(value) for value in found.values()), flush=True)
