"""How long a user waits for the first result: a fresh process, with and without compiled code on disk."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROGRAM = "from AIFReconLib.benchmark_first import first_result; first_result()"


def first_result() -> None:
    """Import, place a bone map and put one frame into a small volume with aif-compensated: what a fresh process does first."""
    from .benchmark_cases import PROBE, fan_sweep, slab_of_bone
    from .compounding.reconstructor import Reconstructor
    from .geometry.volume import VoxelGrid
    from .settings import ReconstructionSettings

    grid = VoxelGrid.from_spacing((-64.0, 0.0, -24.0), (64, 48, 24), 2.0)
    reconstructor = Reconstructor(grid, ReconstructionSettings(method="aif-compensated"), slab_of_bone(grid), probe=PROBE)
    reconstructor.insert(fan_sweep(1))
    reconstructor.reconstruction()


def seconds_to_first_result() -> tuple[float, float]:
    """Seconds from the start of a process to its first result: when everything must be compiled, and when it is on disk."""
    with tempfile.TemporaryDirectory(prefix="aifrecon-") as folder:
        package = str(Path(__file__).resolve().parents[1])
        path = os.pathsep.join(filter(None, (package, os.environ.get("PYTHONPATH"))))
        environment = {**os.environ, "NUMBA_CACHE_DIR": folder, "PYTHONPATH": path}
        seconds = []
        for _ in range(2):
            started = time.perf_counter()
            subprocess.run([sys.executable, "-c", PROGRAM], env=environment, check=True, capture_output=True)
            seconds.append(time.perf_counter() - started)
    return seconds[0], seconds[1]
