"""How far the kernels are from what this machine can do: each beside the loads and stores that it cannot do without, on one thread.

    python Testing/benchmark limits --repeats 5

The limit of a method is a loop that adds to the same voxels in the same order (frames by 16, slab by slab, row by row), with their
numbers known beforehand and no other arithmetic: it loads a pixel and a number, and loads, adds to and stores what the method keeps of a
voxel. Beside it, a copy of the images, which is all that any of them must read.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial

import numpy as np

from AIFReconLib.compounding.batch import BATCH_FRAMES
from AIFReconLib.compounding.compiled.slabs import cut_into_slabs
from AIFReconLib.compounding.layout import PixelLayout
from AIFReconLib.compounding.methods.table import BONE_METHODS
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.geometry.transforms import pixel_spacing
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.region import ImageRegion
from AIFReconLib.machine.threads import optional_module
from AIFReconLib.message import columns
from AIFReconLib.progress import report
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import TrackedFrame
from AIFReconLib.terminal.console import ProgressBar
from AIFReconLib.workflows.benchmark import busy_share, busy_warning, fan_sweep, machine

from .cases import COLUMNS, PROBE, ROWS, TURN_DEG, turned
from .speed import around

METHODS = ("average", "latest", "aif-compensated", "weighted")
FRAMES = 2 * BATCH_FRAMES
SPACINGS = (0.5, 0.3)
HEADING = ("sweep", "voxel", "", "ns/pixel", "limit", "times the limit")


def in_order(sweep: list[TrackedFrame], grid: VoxelGrid) -> tuple[np.ndarray, np.ndarray]:
    """The voxel of every pixel, and the pixel, in the order in which the engine goes through them: (n,) uint32 and (n,) uint8."""
    spacing = pixel_spacing(sweep[0].placed()[1])
    layout = PixelLayout.build((COLUMNS, ROWS), spacing, ImageRegion(), None)
    bounds = np.array([(0, 0, 0), grid.size], dtype=np.float64)
    strides = 1, grid.size[0], grid.size[0] * grid.size[1]
    numbers, pixels = [], []
    for first in range(0, len(sweep), BATCH_FRAMES):
        some = sweep[first : first + BATCH_FRAMES]
        matrices = np.array([grid.reference_to_ijk @ frame.placed()[1] for frame in some])
        axis, edges = cut_into_slabs(matrices, layout, bounds)
        found = [layout.voxels(matrix, grid.size) for matrix in matrices]
        voxels = np.concatenate([there for _, there in found])
        values = np.concatenate([frame.placed()[0].reshape(-1)[which] for frame, (which, _) in zip(some, found, strict=True)])
        slab = np.searchsorted(edges, voxels // strides[axis] % grid.size[axis], side="right")
        order = np.argsort(slab, kind="stable")
        numbers.append(voxels[order].astype(np.uint32))
        pixels.append(values[order])
    return np.concatenate(numbers), np.concatenate(pixels)


def _least(works: dict[str, Callable[[], object]], repeats: int) -> dict[str, float]:
    """Processor time of each, the least of several, in turns; each is done once before."""
    least = dict.fromkeys(works, float("inf"))
    for turn in range(repeats + 1):
        for name, work in works.items():
            begun = time.thread_time()
            work()
            if turn:
                least[name] = min(least[name], time.thread_time() - begun)
    return least


def measure(repeats: int) -> list[tuple[str, ...]]:
    """Every method beside its limit, on sweeps along the grid and across it: rows under `HEADING`."""
    loops = optional_module("benchmark.numba_yardstick")
    if loops is None:
        raise SystemExit("The limits are those of compiled loops: install numba.")
    found: list[tuple[str, ...]] = []
    cases = [(turn, spacing) for turn in (0.0, TURN_DEG) for spacing in SPACINGS]
    with ProgressBar() as progress:
        for number, (turn, spacing) in enumerate(cases):
            report(progress, number / len(cases), "Measuring")
            sweep = turned(fan_sweep(FRAMES, COLUMNS, ROWS), turn)
            grid, bone = around(sweep, spacing)
            voxels, pixels = in_order(sweep, grid)
            value, weight, hits = np.zeros((3, grid.voxels), np.float32)
            counts, latest = hits.view(np.uint32), np.zeros(grid.voxels, np.uint8)
            images, room = np.stack([frame.placed()[0] for frame in sweep]), np.empty((FRAMES, ROWS, COLUMNS), np.uint8)
            works: dict[str, Callable[[], object]] = {
                "copy of the images": partial(np.copyto, room, images),
                "hit": partial(loops.hit, voxels, pixels, latest, counts),
                "weighed": partial(loops.add_weighed, voxels, pixels, value, weight, counts),
            }
            for method in METHODS:
                settings = ReconstructionSettings(method=method, engine="numba")
                known = bone if method in BONE_METHODS else None
                reconstructor = Reconstructor(grid, settings, known, probe=PROBE, threads=1)
                works[method] = partial(reconstructor.insert, sweep)
            ns = {name: 1e9 * seconds / (FRAMES * ROWS * COLUMNS) for name, seconds in _least(works, repeats).items()}
            where = f"turned {turn:g} degrees" if turn else "along the grid", f"{spacing:g} mm"
            found.append((*where, "copy of the images", f"{ns['copy of the images']:.2f}", "", ""))
            for method in METHODS:
                limit = ns["hit" if method in ("average", "latest") else "weighed"]
                found.append((*where, method, f"{ns[method]:.2f}", f"{limit:.2f}", f"{ns[method] / limit:.1f}"))
    return found


def main(words: list[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        prog="python Testing/benchmark limits", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--repeats", type=int, default=5, metavar="N", help="the least of this many counts (default: %(default)s)")
    arguments = parser.parse_args(words)
    busy = busy_share()
    found = measure(arguments.repeats)
    print("\n".join(filter(None, (machine(), busy_warning(busy)))))
    print(columns([HEADING, *found]))
