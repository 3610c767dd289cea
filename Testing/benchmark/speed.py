"""How fast this machine reconstructs: every method with every engine, and all that comes before and after.

python Testing/benchmark --quick
python Testing/benchmark
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from measured import keep

from AIFReconLib import __version__
from AIFReconLib.bone.map import BoneMap
from AIFReconLib.compounding.methods.table import BONE_METHODS, METHODS
from AIFReconLib.compounding.needs import bone_on_grid
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.compounding.state import bytes_per_voxel
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.holes.nearest import fill_holes
from AIFReconLib.imaging.extent import grid_around_sweep
from AIFReconLib.imaging.region import ImageRegion
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.machine.threads import optional_module, usable_cores
from AIFReconLib.progress import Progress, part, report
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import TrackedFrame, TrackedSequence
from AIFReconLib.terminal.console import ProgressBar
from AIFReconLib.workflows.benchmark import busy_share, fan_sweep, machine, slab_of_bone

from .cases import COLUMNS, PROBE, ROWS, TURN_DEG, half_empty, labels_of_size, turned
from .table import BenchmarkResult, Timing

NUMPY_SHARE = 8
"""The numpy engine gets every 8th frame of the sweep, so that it does not take most of the time."""

SPACING = 0.5
"""mm. Of voxels."""

VOXELS = 10_000_000
"""For hole filling and bone maps."""

FILE_FRAMES = 60

TURNED_METHODS = ("average", "aif-compensated", "weighted")
"""Methods that are also timed on a sweep that lies across the grid, where caches serve worst."""

Job = tuple[Callable[[], object], Timing, int]
"""What to do, the row to fill in, and how many frames it takes."""


def benchmark(
    frames: int = 120,
    repeats: int = 5,
    spacing: float = SPACING,
    *,
    voxels: int = VOXELS,
    progress: Progress | None = None,
) -> BenchmarkResult:
    """Time everything on a sweep of 640 x 480 frames, turned through 30 degrees about the probe's face.

    Parameters
    ----------
    frames : int
        Frames per repeat.
    repeats : int
    spacing : float, mm
    voxels : int
        Size of the volumes whose holes are filled and bone mapped; 0 leaves these and files out.
    progress : Progress or None

    Notes
    -----
    Everything is timed once per round, one after the other, so that a machine that slows down for a while slows down all.
    """
    timings: list[Timing] = []
    with tempfile.TemporaryDirectory(prefix="aifrecon-") as folder:
        stages: list[tuple[str, Callable[[], list[Job]]]] = [
            ("Along the grid", lambda: _reconstruction_jobs(frames, spacing)),
            ("Across the grid", lambda: _turned_jobs(frames, spacing)),
        ]
        if voxels:
            stages += [("Holes and bone", lambda: _volume_jobs(voxels)), ("Reading files", lambda: _file_jobs(Path(folder)))]
        for number, (name, jobs) in enumerate(stages):
            timings += _measured(jobs(), repeats, part(progress, number / len(stages), (number + 1) / len(stages)), name)
    report(progress, 1.0, "Done")
    return BenchmarkResult(machine(), __version__, frames, repeats, busy_share(), tuple(timings))


def _measured(jobs: list[Job], repeats: int, progress: Progress | None, name: str) -> list[Timing]:
    """The jobs' rows with their medians; each is done once before, which prepares tables and compiles."""
    for work, _, _ in jobs:
        work()
    seconds: list[list[float]] = [[] for _ in jobs]
    for turn in range(repeats):
        report(progress, turn / repeats, name)
        for (work, _, _), taken in zip(jobs, seconds, strict=True):
            started = time.perf_counter()
            work()
            taken.append(time.perf_counter() - started)
    rows, yardsticks = [], {}
    for (_, row, count), taken in zip(jobs, seconds, strict=True):
        median = statistics.median(taken)
        row = replace(row, seconds=median)
        if count:
            ns = 1e9 * median / (count * ROWS * COLUMNS) if row.engine != "file" else None
            row = replace(row, ns_per_pixel=ns, frames_per_second=count / median)
            per_frame = [s / count for s in taken]
            if row.engine == "yardstick":
                yardsticks[row.what] = per_frame
            elif row.what in yardsticks:
                ratios = [theirs / ours for theirs, ours in zip(yardsticks[row.what], per_frame, strict=True)]
                row = replace(row, times_yardstick=statistics.median(ratios))
        rows.append(row)
    return rows


def _reconstruction_jobs(frames: int, spacing: float) -> list[Job]:
    """The yardsticks, then every method with every engine, on a sweep along the grid."""
    sweep = fan_sweep(frames, COLUMNS, ROWS)
    grid, bone = around(sweep, spacing)
    jobs = _yardstick_jobs(METHODS, sweep, grid, bone)
    few = sweep[::NUMPY_SHARE]
    for method, linear in [*((method, False) for method in METHODS), ("average", True)]:
        jobs.append(_method_job(method, "numpy", 1, few, grid, bone, linear))
        for threads in _numba_threads():
            jobs.append(_method_job(method, "numba", threads, sweep, grid, bone, linear))
    return jobs


def _turned_jobs(frames: int, spacing: float) -> list[Job]:
    """The same of some methods, with numba on all of its threads, on a sweep across the grid."""
    sweep = turned(fan_sweep(frames, COLUMNS, ROWS), TURN_DEG)
    grid, bone = around(sweep, spacing)
    jobs = _yardstick_jobs(TURNED_METHODS, sweep, grid, bone)
    for threads in _numba_threads()[-1:]:
        jobs += [_method_job(method, "numba", threads, sweep, grid, bone) for method in TURNED_METHODS]
    return [(work, replace(row, what=f"{row.what}, turned {TURN_DEG:g} degrees"), count) for work, row, count in jobs]


def around(sweep: list[TrackedFrame], spacing: float) -> tuple[VoxelGrid, BoneMap]:
    """A grid along the axes of Reference that holds the sweep, and bone in its middle."""
    poses = np.array([f.image_to_reference for f in sweep])
    grid = grid_around_sweep(poses, (COLUMNS, ROWS), ImageRegion(), (spacing,) * 3)
    return grid, slab_of_bone(grid)


def _numba_threads() -> list[int]:
    """Numbers of threads to time numba with, rising; none without numba."""
    return sorted({1, min(2, usable_cores())}) if optional_module("benchmark.numba_yardstick") else []


def _yardstick_jobs(methods: tuple[str, ...], sweep: list[TrackedFrame], grid: VoxelGrid, bone: BoneMap) -> list[Job]:
    loops = optional_module("benchmark.numba_yardstick")
    if loops is None:
        return []
    works = loops.yardsticks(sweep, grid, bone, PROBE)
    return [(works[method], Timing(method, "yardstick", 1, 0.0), len(sweep)) for method in methods]


def _method_job(
    method: str, engine: str, threads: int, sweep: list[TrackedFrame], grid: VoxelGrid, bone: BoneMap, linear: bool = False
) -> Job:
    """Inserting a sweep into a volume that is there already, with its bone map."""
    settings = ReconstructionSettings(method=method, engine=engine, interpolation="linear" if linear else "nearest")
    reconstructor = Reconstructor(grid, settings, bone if method in BONE_METHODS else None, probe=PROBE, threads=threads)
    on_grid = bone_on_grid(method, settings)
    cost = bytes_per_voxel(method, on_grid, best_cosine=False, shares=linear, whole=True, beside=(), output=1)
    what = f"{method}, linear interpolation" if linear else method
    return lambda: reconstructor.insert(sweep), Timing(what, engine, threads, 0.0, bytes_per_voxel=cost), len(sweep)


def _volume_jobs(voxels: int) -> list[Job]:
    values, mask = half_empty(voxels)
    labels = labels_of_size(voxels)
    grid = labels.grid
    # A little off the map's own axes, as a registered CT lies
    turn = np.array([[1.0, 0.02, 0.0, 0.1], [-0.02, 1.0, 0.0, 0.2], [0.0, 0.0, 1.0, 0.3], [0.0, 0.0, 0.0, 1.0]])
    turned = VoxelGrid(grid.size, turn @ grid.ijk_to_reference)
    bone = BoneMap.from_labels(labels)

    def fill(engine: str, threads: int) -> Callable[[], object]:
        return lambda: fill_holes(values.copy(), mask.copy(), np.full(3, 0.5), 1.0, engine=engine, threads=threads)

    million = f"{mask.size / 1e6:.0f} million voxels"
    jobs: list[Job] = [(fill("numpy", 1), Timing(f"hole filling, reach 2, {million}", "numpy", 1, 0.0), 0)]
    for threads in _numba_threads():
        jobs.append((fill("numba", threads), Timing(f"hole filling, reach 2, {million}", "numba", threads, 0.0), 0))
    cores, sampler = usable_cores(), "scipy" if optional_module("AIFReconLib.bone.numba_map") is None else "numba"
    jobs.append((lambda: BoneMap.from_labels(labels), Timing(f"bone map from labels, {million}", "scipy", cores, 0.0), 0))
    jobs.append((lambda: bone.on_grid(turned), Timing(f"bone map onto a grid, {million}", sampler, cores, 0.0), 0))
    return jobs


def _file_jobs(folder: Path) -> list[Job]:
    """Reading every image of a recording."""
    images, poses = (np.stack(each) for each in zip(*(frame.placed() for frame in fan_sweep(FILE_FRAMES, COLUMNS, ROWS)), strict=True))
    sequence = TrackedSequence.from_arrays(images, poses)
    jobs: list[Job] = []
    for name, compress in (("uncompressed", False), ("compressed", True)):
        path = folder / f"{name}.mha"
        write_sequence(sequence, path, compress)

        def read(path: Path = path) -> None:
            images = read_sequence(path).images
            for number in range(len(images)):
                images[number]

        jobs.append((read, Timing(f"reading, {name}", "file", 1, 0.0), FILE_FRAMES))
    return jobs


def main(words: list[str] | None = None) -> int:
    """Measure and print; the answer is the exit status."""
    parser = argparse.ArgumentParser(prog="python Testing/benchmark", description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="only reconstruction, with a third of the frames")
    parser.add_argument("--pages", action="store_true", help="also renew docs/measured, and the pages that show it")
    arguments = parser.parse_args(words)
    if arguments.quick and arguments.pages:
        parser.error("the pages are of whole runs: leave out --quick or --pages")
    with ProgressBar() as progress:
        result = benchmark(40, voxels=0, progress=progress) if arguments.quick else benchmark(progress=progress)
    print(result.text())
    if arguments.pages:
        keep(result.in_the_pages(), "make bench", result.machine.replace("\n", "; "))
    return 0
