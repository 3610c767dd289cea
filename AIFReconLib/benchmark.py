"""How fast this machine reconstructs: a made-up sweep, every method, and whether that keeps up with a probe."""

from __future__ import annotations

import os
import platform
import statistics
import time
from dataclasses import asdict, dataclass

import numpy as np

from . import __version__
from .beams import SECTOR, ProbeGeometry
from .bone import BoneMap
from .compounding.reconstructor import Reconstructor
from .compounding.state import bytes_per_voxel
from .extent import grid_around_sweep
from .frames import TrackedFrame
from .holes import fill_holes
from .progress import Progress, report
from .region import ImageRegion
from .settings import BONE_METHODS, METHODS, ReconstructionSettings
from .volume import Volume, VoxelGrid

COLUMNS, ROWS, PIXEL = 640, 480, 0.2
"""Size of the benchmark's images, and their pixel pitch in mm."""

FAN_DEG = 30.0
LIVE_FRAMES_PER_SECOND = 30.0


@dataclass(frozen=True)
class Timing:
    """One row of the table. Times are medians over the repeats; ns per pixel of the image."""

    what: str
    engine: str
    spacing_mm: float
    seconds: float
    ns_per_pixel: float | None
    frames_per_second: float | None
    bytes_per_voxel: int | None


@dataclass(frozen=True)
class BenchmarkResult:
    """All timings of one run and the machine they were taken on."""

    machine: str
    version: str
    frames: int
    repeats: int
    timings: tuple[Timing, ...]

    def to_dict(self) -> dict:
        """For JSON."""
        return asdict(self)

    def rows(self) -> list[tuple[str, ...]]:
        """The table, heading first."""
        rows = [("", "engine", "voxel", "ns/pixel", "frames/s", "bytes/voxel", "live at 30/s")]
        for t in self.timings:
            if t.frames_per_second is None:
                rows.append((t.what, t.engine, f"{t.spacing_mm:g} mm", f"{t.seconds:.2f} s", "", "", ""))
                continue
            live = "yes" if t.frames_per_second >= LIVE_FRAMES_PER_SECOND else "no"
            rows.append(
                (
                    t.what,
                    t.engine,
                    f"{t.spacing_mm:g} mm",
                    f"{t.ns_per_pixel:.1f}",
                    f"{t.frames_per_second:.0f}",
                    str(t.bytes_per_voxel),
                    live,
                )
            )
        return rows


def benchmark(
    frames: int = 40, repeats: int = 5, spacings: tuple[float, ...] = (0.5,), progress: Progress | None = None
) -> BenchmarkResult:
    """Time every method on a sweep of 640 x 480 frames, turned through 30 degrees about the probe's face.

    Parameters
    ----------
    frames : int
        Frames per repeat. Fewer than the 300 of a real sweep, at the same density of angles per voxel column.
    repeats : int
    spacings : tuple of float, mm
    progress : Progress or None
    """
    sweep = fan_sweep(frames)
    timings: list[Timing] = []
    steps = len(spacings) * (len(METHODS) + 2)
    for spacing in spacings:
        grid = grid_around_sweep(np.array([f.image_to_reference for f in sweep]), (COLUMNS, ROWS), ImageRegion(), (spacing,) * 3)
        bone = slab_of_bone(grid)
        report(progress, len(timings) / steps, f"bone map at {spacing:g} mm")
        timings.append(_time_other("bone map", spacing, repeats, lambda grid=grid, bone=bone: bone.on_grid(grid)))
        for method in METHODS:
            report(progress, len(timings) / steps, f"{method} at {spacing:g} mm")
            timings.append(_time_method(method, sweep, grid, bone, spacing, repeats))
        report(progress, len(timings) / steps, f"hole filling at {spacing:g} mm")
        timings.append(_time_holes(grid, spacing, repeats))
    report(progress, 1.0, "Done")
    return BenchmarkResult(_machine(), __version__, frames, repeats, tuple(timings))


def fan_sweep(frames: int) -> list[TrackedFrame]:
    """Speckle images, turned step by step through 30 degrees about the x axis of Reference."""
    image = np.random.default_rng(1).integers(0, 256, (ROWS, COLUMNS), dtype=np.uint8)
    sweep = []
    for number, angle in enumerate(np.radians(np.linspace(-FAN_DEG / 2, FAN_DEG / 2, frames))):
        pose = np.eye(4)
        pose[:3, 0] = PIXEL, 0.0, 0.0
        pose[:3, 1] = 0.0, PIXEL * np.cos(angle), PIXEL * np.sin(angle)
        pose[:3, 2] = 0.0, -PIXEL * np.sin(angle), PIXEL * np.cos(angle)
        pose[0, 3] = -PIXEL * COLUMNS / 2
        sweep.append(TrackedFrame(image, pose, number / LIVE_FRAMES_PER_SECOND, number=number))
    return sweep


def slab_of_bone(grid: VoxelGrid) -> BoneMap:
    """A block of bone in the middle of the grid, as a CT of 1 mm voxels would show it."""
    span = np.array(grid.size) * grid.spacing
    size = np.maximum(np.ceil(span), 8).astype(int)
    labels = np.zeros(size[::-1], np.uint8)
    labels[tuple(slice(n // 3, 2 * n // 3 + 1) for n in labels.shape)] = 1
    matrix = np.eye(4)
    matrix[:3, 3] = grid.origin
    return BoneMap.from_labels(Volume(labels, matrix), sigma_mm=4.0)


def _time_method(method: str, sweep: list[TrackedFrame], grid: VoxelGrid, bone: BoneMap, spacing: float, repeats: int) -> Timing:
    """Seconds to insert the sweep; setting up and the first frame, which prepares tables, are left out."""
    probe = ProbeGeometry(SECTOR, (COLUMNS / 2, -100.0))
    reconstructor = Reconstructor(grid, ReconstructionSettings(method=method), bone if method in BONE_METHODS else None, probe=probe)
    reconstructor.insert(sweep[0])
    seconds = _median_seconds(lambda: reconstructor.insert(sweep), repeats)
    pixels = len(sweep) * ROWS * COLUMNS
    cost = bytes_per_voxel(method, method in BONE_METHODS, best_cosine=False)
    return Timing(method, "numpy", spacing, seconds, 1e9 * seconds / pixels, len(sweep) / seconds, cost)


def _time_holes(grid: VoxelGrid, spacing: float, repeats: int) -> Timing:
    """Filling to 2 voxels with every second voxel of the grid missing."""
    rng = np.random.default_rng(2)
    mask = (rng.random(grid.shape, dtype=np.float32) < 0.5).astype(np.uint8)
    values = rng.random(grid.shape, dtype=np.float32)
    return _time_other("hole filling", spacing, repeats, lambda: fill_holes(values.copy(), mask.copy(), grid.spacing, 2 * spacing))


def _time_other(what: str, spacing: float, repeats: int, work) -> Timing:
    return Timing(what, "numpy", spacing, _median_seconds(work, repeats), None, None, None)


def _median_seconds(work, repeats: int) -> float:
    seconds = []
    for _ in range(repeats):
        started = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - started)
    return statistics.median(seconds)


def _machine() -> str:
    return f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}, numpy {np.__version__}"
