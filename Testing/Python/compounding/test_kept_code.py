"""Compiled code is kept for the next job, whatever becomes of the one that compiles it."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from waiting import until

pytest.importorskip("numba", reason="numba is not installed")

JOB = """
import numpy as np
from AIFReconLib import LabeledBone, ProbeGeometry, Recipe, TrackedSequence, Volume, VoxelGrid, reconstruct
from AIFReconLib.compounding.compiled import numba_evidence
from AIFReconLib.holes import numba_nearest

if __name__ == "__main__":
    kind = np.dtype({kind!r})
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


def started_job(folder, kind) -> subprocess.Popen:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder), "PYTHONHASHSEED": "0", "NUMBA_NUM_THREADS": "2"}
    program = JOB.format(kind=kind)
    return subprocess.Popen([sys.executable, "-c", program], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def told_by(job) -> list[str]:
    said, error = job.communicate()
    assert job.returncode == 0, error
    return said.split()


def told_by_job(*asked, **options) -> list[str]:
    return told_by(started_job(*asked, **options))


@pytest.fixture(scope="module")
def told(tmp_path_factory) -> list[str]:
    """What a job tells that finds all of the code."""
    folder = tmp_path_factory.mktemp("kept")
    return [told_by_job(folder, "uint8") for _ in range(2)][1]


def test_a_job_finds_what_another_compiled(tmp_path, told):
    assert told_by_job(tmp_path, "uint8")[3:] == ["1", "1"]
    assert told_by_job(tmp_path, "uint8") == told


def test_two_jobs_at_once_that_find_nothing_kept_are_right(tmp_path, told):
    jobs = [started_job(tmp_path, "uint8") for _ in range(2)]
    assert [told_by(job)[:3] for job in jobs] == [told[:3]] * 2
    assert told_by_job(tmp_path, "uint8") == told


def test_after_a_job_that_was_killed_while_it_compiled_the_next_is_whole(tmp_path, told):
    job = started_job(tmp_path, "uint8")
    assert until(lambda: job.poll() is not None or any(tmp_path.rglob("*.nbc")))
    job.kill()
    job.communicate()
    assert job.returncode < 0  # it was at work
    assert told_by_job(tmp_path, "uint8")[:3] == told[:3]


def test_a_disk_that_is_full_costs_time_and_nothing_else(monkeypatch):
    from AIFReconLib.machine.numba_compile import compiled

    def fail(*_, **_options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile.save", fail)
    assert compiled(lambda x: 2 * x)(21) == 42
