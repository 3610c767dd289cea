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
from dataclasses import dataclass, replace
from functools import partial
from unittest.mock import patch

import numpy as np

from AIFReconLib import reconstruction
from AIFReconLib.bone.map import BoneMap
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
FRAMES, SIZE, SPACING = 60, (640, 480), 0.5
FRAMES_VARIED = (15, 30, 60, 120, 240)
SIZES = ((160, 120), (320, 240), (640, 480), (1280, 960))
SPACINGS = (2.0, 1.4, 1.0, 0.7, 0.5, 0.35, 0.25)
PARTS = (1, 2, 4, 8, 16, 32)


@dataclass(frozen=True)
class Point:
    """Seconds of a job, the least of several, and what was varied.

    Parameters
    ----------
    over : str
        What was varied.
    amount : float
        Of that.
    method : str
    seconds : float
    """

    over: str
    amount: float
    method: str
    seconds: float


@dataclass(frozen=True)
class Job:
    """A sweep and where it goes, and what of it is the `amount` that is varied."""

    over: str
    amount: float
    sweep: TrackedSequence
    grid: VoxelGrid
    bone: BoneMap
    surroundings: Callable[[], AbstractContextManager[object]] = nullcontext

    def run(self, method: str) -> None:
        """Reconstruct."""
        columns_and_rows = self.sweep.frame_size
        with self.surroundings():
            settings = ReconstructionSettings(method=method)
            reconstruction.reconstruct(
                self.sweep, replace(settings, **imaging_fields(probe=sector_probe(*columns_and_rows))), self.bone, self.grid, beside=()
            )


def jobs() -> Iterator[Job]:
    """What is measured, point by point."""
    for frames in FRAMES_VARIED:
        yield _job("frames", frames, frames=frames)
    for size in SIZES:
        yield _job("pixels of a frame", math.prod(size), size=size)
    for spacing in SPACINGS:
        job = _job("voxels of the box", 0, spacing=spacing)
        yield Job(job.over, job.grid.voxels, job.sweep, job.grid, job.bone)
    for threads in sorted({1, 2, *(2**n for n in range(usable_cores().bit_length())), usable_cores()}):
        if threads <= usable_cores():
            yield _job("threads", threads, partial(patch.dict, os.environ, NUMBA_NUM_THREADS=str(threads)))
    for parts in PARTS:
        yield _job("parts", parts, partial(patch.object, reconstruction, "cut_into_parts", partial(_cut, parts)))


def _job(
    over: str,
    amount: float,
    surroundings: Callable[[], AbstractContextManager[object]] = nullcontext,
    frames: int = FRAMES,
    size: tuple[int, int] = SIZE,
    spacing: float = SPACING,
) -> Job:
    fan = fan_sweep(frames, *size)
    poses = np.array([frame.placed()[1] for frame in fan])
    grid = grid_around_sweep(poses, size, ImageRegion(), (spacing,) * 3)
    sweep = TrackedSequence.from_arrays(np.stack([frame.placed()[0] for frame in fan]), poses)
    return Job(over, amount, sweep, grid, slab_of_bone(grid), surroundings)


def _cut(parts: int, grid: VoxelGrid, *_: object) -> list[tuple[int, int]]:
    planes = grid.size[2]
    return [(n * planes // parts, (n + 1) * planes // parts) for n in range(parts)]


def measure(repeats: int) -> list[Point]:
    """Time every job; each is done once before, which compiles."""
    points = []
    with ProgressBar() as progress:
        every = list(jobs())
        for number, job in enumerate(every):
            report(progress, number / len(every), f"Over {job.over}")
            for method in METHODS:
                job.run(method)
                taken = []
                for _ in range(repeats):
                    begun = time.perf_counter()
                    job.run(method)
                    taken.append(time.perf_counter() - begun)
                points.append(Point(job.over, job.amount, method, min(taken)))
    return points


def slopes(points: list[Point]) -> list[tuple[str, ...]]:
    """A table: what a job takes at the least and at the most of each amount, and the exponent of the growth between them."""
    rows: list[tuple[str, ...]] = [("over", "method", "from", "to", "seconds", "to", "exponent at the end")]
    for over in dict.fromkeys(point.over for point in points):
        for method in METHODS:
            some = [point for point in points if (point.over, point.method) == (over, method)]
            first, last = some[0], some[-1]
            before = some[-2] if len(some) > 1 else first
            ratio = math.log(last.amount / before.amount) if last.amount != before.amount else math.nan
            exponent = math.log(last.seconds / before.seconds) / ratio
            ends = f"{first.amount:g}", f"{last.amount:g}", f"{first.seconds:.3f}", f"{last.seconds:.3f}"
            rows.append((over, method, *ends, f"{exponent:.2f}"))
    return rows


def main(words: list[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        prog="python Testing/benchmark growth", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--repeats", type=int, default=3, metavar="N", help="the least of this many counts (default: %(default)s)")
    arguments = parser.parse_args(words)
    busy = busy_share()
    points = measure(arguments.repeats)
    print("\n".join(filter(None, (machine(), busy_warning(busy)))))
    print(columns(slopes(points)))
