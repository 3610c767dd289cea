"""How the time of a whole job grows with frames, pixels, voxels, threads and parts, as a table.

    python Testing/benchmark growth --repeats 3

One of these numbers is varied at a time, the others stay as in the benchmark: 60 frames of 640 x 480 in a 30 degree fan, voxels of 0.5 mm,
all threads, one part. A whole job is `reconstruct` from images in memory to the finished volume, bone map and holes included.
"""

from __future__ import annotations

import argparse
import math
import os
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from functools import partial
from unittest.mock import patch

import numpy as np

from AIFReconLib import reconstruction
from AIFReconLib.effective_settings import imaging_fields
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.extent import grid_around_sweep
from AIFReconLib.imaging.region import ImageRegion
from AIFReconLib.machine.threads import usable_cores
from AIFReconLib.message import columns
from AIFReconLib.progress import report
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.terminal.console import ProgressBar
from AIFReconLib.workflows.benchmark import busy_share, busy_warning, fan_sweep, machine, sector_probe, slab_of_bone

METHODS = ("average", "aif-compensated", "weighted")
Around = Callable[[], AbstractContextManager[object]]
"""What surrounds a job."""


def jobs() -> Iterator[tuple[str, float, Callable[[str], None]]]:
    """What is varied, how much of it there is, and the job, a function of the method."""
    for frames in (15, 30, 60, 120, 240):
        yield "frames", frames, _job(frames=frames)[1]
    for size in ((160, 120), (320, 240), (640, 480), (1280, 960)):
        yield "pixels of a frame", math.prod(size), _job(size=size)[1]
    for spacing in (2.0, 1.4, 1.0, 0.7, 0.5, 0.35, 0.25):
        yield "voxels of the box", *_job(spacing=spacing)
    cores = usable_cores()
    for threads in sorted({cores, *(2**n for n in range(cores.bit_length()) if 2**n <= cores)}):
        yield "threads", threads, _job(partial(patch.dict, os.environ, NUMBA_NUM_THREADS=str(threads)))[1]
    for parts in (1, 2, 4, 8, 16, 32):
        yield "parts", parts, _job(partial(patch.object, reconstruction, "cut_into_parts", partial(_cut, parts)))[1]


def _job(
    around: Around = nullcontext, frames: int = 60, size: tuple[int, int] = (640, 480), spacing: float = 0.5
) -> tuple[int, Callable[[str], None]]:
    """The voxels of a job, and the job."""
    fan = fan_sweep(frames, *size)
    poses = np.array([frame.placed()[1] for frame in fan])
    grid = grid_around_sweep(poses, size, ImageRegion(), (spacing,) * 3)
    sweep = TrackedSequence.from_arrays(np.stack([frame.placed()[0] for frame in fan]), poses)
    bone = slab_of_bone(grid)

    def work(method: str) -> None:
        settings = replace(ReconstructionSettings(method=method), **imaging_fields(probe=sector_probe(*size)))
        with around():
            reconstruction.reconstruct(sweep, settings, bone, grid, beside=())

    return grid.voxels, work


def _cut(parts: int, grid: VoxelGrid, *_: object) -> list[tuple[int, int]]:
    planes = grid.size[2]
    return [(n * planes // parts, (n + 1) * planes // parts) for n in range(parts)]


def measure(repeats: int) -> dict[tuple[str, str], list[tuple[float, float]]]:
    """Amount and least seconds of several, by what is varied and method; each job is done once before, which compiles."""
    found: dict[tuple[str, str], list[tuple[float, float]]] = {}
    with ProgressBar() as progress:
        every = list(jobs())
        for number, (over, amount, work) in enumerate(every):
            report(progress, number / len(every), f"Over {over}")
            for method in METHODS:
                taken = []
                for _ in range(repeats + 1):
                    begun = time.perf_counter()
                    work(method)
                    taken.append(time.perf_counter() - begun)
                found.setdefault((over, method), []).append((amount, min(taken[1:])))
    return found


def slopes(found: dict[tuple[str, str], list[tuple[float, float]]]) -> list[tuple[str, ...]]:
    """A table: what a job takes at the least and at the most of each amount, and the exponent of the growth at the end."""
    rows: list[tuple[str, ...]] = [("over", "method", "from", "to", "seconds", "to", "exponent at the end")]
    for (over, method), points in found.items():
        (least, first), (before, near), (most, last) = points[0], points[max(len(points) - 2, 0)], points[-1]
        exponent = math.log(last / near) / math.log(most / before) if most != before else math.nan
        rows.append((over, method, f"{least:g}", f"{most:g}", f"{first:.3f}", f"{last:.3f}", f"{exponent:.2f}"))
    return rows


def main(words: list[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        prog="python Testing/benchmark growth", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--repeats", type=int, default=3, metavar="N", help="the least of this many counts (default: %(default)s)")
    arguments = parser.parse_args(words)
    busy = busy_share()
    found = measure(arguments.repeats)
    print("\n".join(filter(None, (machine(), busy_warning(busy)))))
    print(columns(slopes(found)))
