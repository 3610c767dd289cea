"""Compiled code is kept for the next job."""

from __future__ import annotations

import os
import subprocess
import sys
from unittest import mock

import pytest

pytest.importorskip("numba", reason="numba is not installed")

JOB = """
import numpy as np
from AIFReconLib import LabeledBone, ProbeGeometry, Recipe, TrackedSequence, Volume, VoxelGrid, reconstruct
from AIFReconLib.compounding.compiled import numba_evidence
from AIFReconLib.holes import numba_nearest

if __name__ == "__main__":
    kind = np.uint8
    rng = np.random.default_rng(3)
    images = rng.integers(0, 200, (6, 90, 70)).astype(kind)
    images[:, 40:46] = 250
    images[:, 46:] //= 8
    poses = np.tile(np.diag([0.5, 0.5, 0.5, 1.0]), (6, 1, 1))
    poses[:, :3, 2] = (0.0, 0.0, 0.5)
    poses[:, 2, 3] = 1.5 * np.arange(6)
    poses[:, [1, 2]] = poses[:, [2, 1]]
    labels = np.zeros((60, 10, 40), np.uint8)
    labels[20:30] = 1
    grid = VoxelGrid.from_spacing((0.0, 0.0, 0.0), (40, 10, 60), 1.0)
    recipe = Recipe(method="weighted", probe="linear", hole_limit=2.0, clip_px=(0, 0, 70, 90), bone_sigma_mm=2.0)
    made = reconstruct(TrackedSequence.from_arrays(images, poses), recipe, LabeledBone(Volume(labels, grid.ijk_to_reference)), grid)
    voxels = made.intensity.array
    missed = [sum(kernel.stats.cache_misses.values()) for kernel in (numba_evidence.judge, numba_nearest.fill)]
    print(made.frames_inserted, voxels.any(), hash(voxels.tobytes()), *missed)
"""


def told_by_job(folder) -> list[str]:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder), "PYTHONHASHSEED": "0", "NUMBA_NUM_THREADS": "2"}
    job = subprocess.run([sys.executable, "-c", JOB], env=environment, capture_output=True, text=True, check=False)
    assert job.returncode == 0, job.stderr
    return job.stdout.split()


def test_a_job_finds_what_another_compiled(tmp_path):
    first, second = (told_by_job(tmp_path) for _ in range(2))
    assert first[3:] == ["1", "1"]
    assert second == [*first[:3], "0", "0"]


def test_a_disk_that_is_full_costs_time_and_nothing_else(monkeypatch):
    from AIFReconLib.machine.numba_compile import compiled

    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile.save", mock.Mock(side_effect=OSError(28, "No space left on device")))
    assert compiled(lambda x: 2 * x)(21) == 42
