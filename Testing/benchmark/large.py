"""A spine from neck to sacrum in a fresh process: how long it takes, and how much memory at most, with as much of it as is given.

    python Testing/benchmark large --memory 4.5
    python Testing/benchmark large --frames 250 --spacing 0.2 --method weighted --memory 9 --json large.json

Frames of 640 x 480 in four passes over a box of 400 x 300 x 150 mm, tilted to and fro. The numbers are those of the whole process,
libraries and compiled code included. The checksum tells whether two runs made the same voxels.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import zlib
from pathlib import Path

import numpy as np

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.imaging.beams import LINEAR, ProbeGeometry
from AIFReconLib.imaging.region import ImageRegion
from AIFReconLib.io.disk.atomic import write_text
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.settings import AUTOMATIC, BONE_METHODS, METHODS, ReconstructionSettings
from AIFReconLib.sweep.frames import TrackedSequence

BOX = (400.0, 300.0, 150.0)
"""mm along x (the spine), y and z."""

COLUMNS, ROWS, PIXEL = 640, 480, 0.2
PASSES, TILT_DEG = 4, 20.0
ALL_FRAMES = 5000
SHIFTS = 97
"""So many images differ."""


class Speckle:
    """Images that take no memory of their own, as those of a file do not: parts of a larger one."""

    dtype = np.dtype(np.uint8)

    def __init__(self, frames: int):
        self.shape = (frames, ROWS, COLUMNS)
        self._speckle = np.random.default_rng(0).integers(1, 256, (ROWS, COLUMNS + SHIFTS), dtype=np.uint8)

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, number: int) -> np.ndarray:
        shift = int(number) % SHIFTS
        return np.ascontiguousarray(self._speckle[:, shift : shift + COLUMNS])


def passes(frames: int) -> np.ndarray:
    """image_to_reference (frames, 4, 4): image columns across the spine, rows into the body."""
    poses = np.tile(np.eye(4), (frames, 1, 1))
    which, along = np.divmod(np.arange(frames) * PASSES / frames, 1)
    angle = np.deg2rad(TILT_DEG) * np.sin(40 * along)
    zero = np.zeros(frames)
    poses[:, :3, 0] = (0.0, PIXEL, 0.0)
    poses[:, :3, 1] = PIXEL * np.stack([np.sin(angle), zero, np.cos(angle)], axis=1)
    poses[:, :3, 2] = PIXEL * np.stack([np.cos(angle), zero, -np.sin(angle)], axis=1)
    poses[:, :3, 3] = np.stack([BOX[0] * along, (BOX[1] - COLUMNS * PIXEL) / (PASSES - 1) * which, zero + 20.0], axis=1)
    return poses


def plate() -> BoneMap:
    """A plate of bone along the spine."""
    labels = np.zeros((50, 100, 134), np.uint8)
    labels[20:30, 30:70] = 1
    return BoneMap.from_labels(Volume(labels, np.diag([3.0, 3.0, 3.0, 1.0])), sigma_mm=5.0)


def peak_gb() -> float:
    """The most memory that this process has had; NaN where the system does not tell."""
    try:
        import resource
    except ImportError:
        return float("nan")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e9 if sys.platform == "darwin" else peak * 1024 / 1e9


def measure(method: str, spacing: float, frames: int, memory: float | None, hole_limit: float | str) -> dict:
    """Reconstruct, and tell what it took."""
    grid = VoxelGrid.from_spacing((0.0, 0.0, 0.0), [int(mm / spacing) + 1 for mm in BOX], spacing)
    sweep = TrackedSequence.from_arrays(Speckle(frames), passes(frames))
    bone = plate() if method in BONE_METHODS else None
    begun, computed = time.perf_counter(), time.process_time()
    result = reconstruct(
        sweep,
        ReconstructionSettings(method=method, hole_limit=hole_limit),
        bone,
        grid,
        region=ImageRegion(),
        probe=ProbeGeometry(LINEAR),
        beside=(),
        memory=None if memory is None else int(memory * 1e9),
    )
    return {
        "method": method,
        "frames": frames,
        "voxels_million": grid.voxels / 1e6,
        "memory_gb": memory,
        "seconds": time.perf_counter() - begun,
        "processor_seconds": time.process_time() - computed,
        "peak_gb": peak_gb(),
        "measured": float(np.count_nonzero(result.mask.array == 1) / grid.voxels),
        "checksum": zlib.crc32(result.intensity.array.data),
    }


def main(words: list[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        prog="python Testing/benchmark large", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--frames", type=int, default=ALL_FRAMES, metavar="N", help="default: %(default)s")
    parser.add_argument("--spacing", type=float, default=0.3, metavar="MM", help="default: %(default)g")
    parser.add_argument("--method", choices=METHODS, default="average", help="default: %(default)s")
    parser.add_argument("--memory", type=float, metavar="GB", help="as of `aifrecon reconstruct`")
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the numbers here")
    arguments = parser.parse_args(words)
    # Between a few of the frames, gaps are many times as large as between all
    hole_limit = AUTOMATIC if arguments.frames >= ALL_FRAMES else 2 * arguments.spacing
    found = measure(arguments.method, arguments.spacing, arguments.frames, arguments.memory, hole_limit)
    print(*(f"{name}: {value:.2f}" if isinstance(value, float) else f"{name}: {value}" for name, value in found.items()), sep="\n")
    if arguments.json:
        write_text(arguments.json, json.dumps(found, indent=2) + "\n")
