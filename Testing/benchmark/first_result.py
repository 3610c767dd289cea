"""How long a user waits for the first result: a fresh process, with and without compiled code on disk."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROGRAM = "from benchmark.first_result import first_result; first_result()"


def first_result() -> None:
    """Import, place a bone map and put one frame into a small volume with aif-compensated: what a fresh process does first."""
    # Nothing but what is timed may be imported
    import numpy as np

    from AIFReconLib.bone.map import BoneMap
    from AIFReconLib.compounding.reconstructor import Reconstructor
    from AIFReconLib.geometry.volume import Volume, VoxelGrid
    from AIFReconLib.imaging.beams import SECTOR, ProbeGeometry
    from AIFReconLib.recipe.recipe import ReconstructionSettings
    from AIFReconLib.sweep.frames import TrackedFrame

    grid = VoxelGrid.from_spacing((-64.0, 0.0, -24.0), (64, 48, 24), 2.0)
    labels = np.zeros(grid.shape, np.uint8)
    labels[8:16, 16:32, 21:42] = 1
    bone = BoneMap.from_labels(Volume(labels, grid.ijk_to_reference), sigma_mm=4.0)
    pose = np.diag([0.2, 0.2, 0.2, 1.0])
    pose[0, 3] = -64.0
    image = np.random.default_rng(1).integers(0, 256, (480, 640), dtype=np.uint8)
    settings = ReconstructionSettings(method="aif-compensated")
    reconstructor = Reconstructor(grid, settings, bone, probe=ProbeGeometry(SECTOR, (320.0, -100.0)))
    reconstructor.insert(TrackedFrame(image, pose, 0.0))
    reconstructor.reconstruction()


def seconds_to_first_result() -> tuple[float, float]:
    """Seconds from the start of a process to its first result: when everything must be compiled, and when it is on disk."""
    with tempfile.TemporaryDirectory(prefix="aifrecon-") as folder:
        folders = [str(Path(__file__).resolve().parents[level]) for level in (1, 2)]
        path = os.pathsep.join(filter(None, (*folders, os.environ.get("PYTHONPATH"))))
        environment = {**os.environ, "NUMBA_CACHE_DIR": folder, "PYTHONPATH": path}
        seconds = []
        for _ in range(2):
            started = time.perf_counter()
            subprocess.run([sys.executable, "-c", PROGRAM], env=environment, check=True, capture_output=True)
            seconds.append(time.perf_counter() - started)
    return seconds[0], seconds[1]
