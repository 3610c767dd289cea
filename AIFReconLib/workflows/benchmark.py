"""Whether this machine keeps up with a live scan: made-up images are received and inserted, by each method."""

from __future__ import annotations

import os
import platform
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..bone.map import BoneMap
from ..compounding.engines import choose_engine
from ..compounding.methods.table import BONE_METHODS, METHODS
from ..compounding.numpy_engine import NumpyEngine
from ..compounding.reconstructor import Reconstructor
from ..geometry.volume import Volume, VoxelGrid
from ..imaging.beams import SECTOR, ProbeGeometry
from ..imaging.extent import grid_around_sweep
from ..imaging.region import ImageRegion
from ..live.wire.decoding import decode
from ..live.wire.encoding import encode_image
from ..live.wire.framing import Framer
from ..machine.threads import optional_module, usable_cores
from ..progress import Progress, part, report
from ..recipe.recipe import Recipe
from ..sweep.frames import TrackedFrame

DEPTH, APEX, FAN_DEG = 96.0, 20.0, 30.0
"""mm that an image is deep and that its beams' apex lies above it, and the angle that the sweep is turned through."""

AMPLE = 0.5
"""Share of a frame's time up to which a method keeps up: what is left is for the display, the tracker's messages and a recording."""

KEEPS_UP, JUST_KEEPS_UP, TOO_SLOW = "keeps up", "just keeps up", "does not keep up"


@dataclass(frozen=True)
class MeasuredSpeed:
    """What was measured, and what it means."""

    size: tuple[int, int]
    rate: float  #: frames/s of the scan
    voxels: int
    engine: str
    seconds: dict[str, float]  #: For a frame, by method
    busy: float  #: See `busy_share`
    warning: str | None  #: Of the engine

    @property
    def shares(self) -> dict[str, float]:
        """Of the time there is, by method."""
        return {method: seconds * self.rate for method, seconds in self.seconds.items()}


def measured_speed(
    size: tuple[int, int], rate: float, spacing: float, frames: int, repeats: int, progress: Progress | None = None
) -> MeasuredSpeed:
    """Receive and insert so many frames of columns and rows into voxels of `spacing` mm, each method so often."""
    engine, warning = choose_engine("auto")
    busy = busy_share()
    sweep = fan_sweep(frames, *size)
    poses = np.array([frame.image_to_reference for frame in sweep])
    grid = grid_around_sweep(poses, size, ImageRegion(), (spacing,) * 3)
    receiving = _seconds_to_receive(sweep[0], repeats)
    seconds = {}
    for number, method in enumerate(METHODS):
        of_method = part(progress, number / len(METHODS), (number + 1) / len(METHODS))
        seconds[method] = receiving + _seconds_to_insert(method, sweep, grid, repeats, of_method)
    return MeasuredSpeed(size, rate, grid.voxels, "numpy" if engine is NumpyEngine else "numba", seconds, busy, warning)


def verdict(share: float) -> str:
    """What it means that frames take this share of the time there is."""
    return KEEPS_UP if share <= AMPLE else JUST_KEEPS_UP if share <= 1 else TOO_SLOW


def _seconds_to_receive(frame: TrackedFrame, repeats: int) -> float:
    """For one frame: its OpenIGTLink message, checksum and all."""
    message = encode_image("Image_Reference", frame.timestamp, *frame.placed())

    def receive() -> None:
        for raw in Framer().feed(message):
            decode(raw)

    return _median_seconds(receive, max(repeats, 5))


def _seconds_to_insert(method: str, sweep: list[TrackedFrame], grid: VoxelGrid, repeats: int, progress: Progress | None) -> float:
    """For one frame, into a volume that is there already, with its bone map."""
    rows, across = np.asarray(sweep[0].image).shape
    bone = slab_of_bone(grid) if method in BONE_METHODS else None
    reconstructor = Reconstructor(grid, Recipe(method=method), bone, probe=sector_probe(across, rows))
    return _median_seconds(lambda: reconstructor.insert(sweep), repeats, progress) / len(sweep)


def _median_seconds(work: Callable[[], object], repeats: int, progress: Progress | None = None) -> float:
    """After it was done once, which prepares tables and compiles."""
    work()
    taken = []
    for turn in range(repeats):
        report(progress, turn / repeats, "Measuring")
        started = time.perf_counter()
        work()
        taken.append(time.perf_counter() - started)
    return statistics.median(taken)


def fan_sweep(frames: int, across: int, rows: int) -> list[TrackedFrame]:
    """Images of speckle, turned step by step through 30 degrees about the x axis of Reference."""
    pixel = DEPTH / rows
    image = np.random.default_rng(1).integers(0, 256, (rows, across), dtype=np.uint8)
    sweep = []
    for number, angle in enumerate(np.radians(np.linspace(-FAN_DEG / 2, FAN_DEG / 2, frames))):
        pose = np.eye(4)
        pose[:3, 0] = pixel, 0.0, 0.0
        pose[:3, 1] = 0.0, pixel * np.cos(angle), pixel * np.sin(angle)
        pose[:3, 2] = 0.0, -pixel * np.sin(angle), pixel * np.cos(angle)
        pose[0, 3] = -pixel * across / 2
        sweep.append(TrackedFrame(image, pose, number / 30.0, number=number))
    return sweep


def sector_probe(across: int, rows: int) -> ProbeGeometry:
    """Beams of the images of `fan_sweep`."""
    return ProbeGeometry(SECTOR, (across / 2, -APEX * rows / DEPTH))


def slab_of_bone(grid: VoxelGrid) -> BoneMap:
    """A block of bone in the middle of the grid, as a CT of 1 mm voxels would show it."""
    span = np.array(grid.size) * grid.spacing
    size = np.maximum(np.ceil(span), 8).astype(int)
    labels = np.zeros(size[::-1], np.uint8)
    labels[tuple(slice(n // 3, 2 * n // 3 + 1) for n in labels.shape)] = 1
    matrix = np.eye(4)
    matrix[:3, 3] = grid.origin
    return BoneMap.from_labels(Volume(labels, matrix), sigma_mm=4.0)


def busy_share() -> float:
    """Share of the processor that others use, by a short stretch of work; 0 where it cannot be told."""
    wall, cpu = time.perf_counter(), time.process_time()
    total = 0
    while time.perf_counter() - wall < 0.5:
        total += 1
    return max(1.0 - (time.process_time() - cpu) / (time.perf_counter() - wall), 0.0)


def busy_warning(busy: float) -> str:
    """That the numbers are too slow, where they are."""
    return f"Other work took {100 * busy:.0f} % of the processor meanwhile: these numbers are too slow." if busy > 0.1 else ""


def machine() -> str:
    """System, cores, processor and versions."""
    names = [platform.system(), platform.machine(), f"{usable_cores()} cores"]
    if model := _processor():
        names.append(model)
    numba = optional_module("AIFReconLib.machine.numba_compile")
    versions = f"Python {platform.python_version()}, numpy {np.__version__}" + (f", numba {numba.VERSION}" if numba else ", no numba")
    return ", ".join(names) + "; " + versions


def _processor() -> str:
    """The processor's model, where the system tells."""
    if os.path.isfile("/proc/cpuinfo"):
        for line in Path("/proc/cpuinfo").read_text("utf-8", "replace").splitlines():
            if line.startswith("model name"):
                return " ".join(line.split(":", 1)[1].split())
    return platform.processor()
