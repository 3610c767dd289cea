"""How a live session keeps up: a second process serves a made-up scan over OpenIGTLink, this one reconstructs it.

    python Testing/benchmark live --seconds 600
    python Testing/benchmark live --seconds 60 --size 640x480@30 --engine numpy

    python Testing/benchmark live --size 640x480@30 --method weighted --bone-model Testing/models/bone.onnx

For each stream it tells the frames that the server sent, and where they went; the latency from an image's arrival to its voxels (the worst
99th percentile of any 4096 frames in a row); in how many frames a second bone was looked for; and how the memory of the process grew.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
import psutil

from AIFReconLib.bone.echoes.surface import LEAST_A_FRAME
from AIFReconLib.bone.growing_bone import GrowingBone
from AIFReconLib.bone.map import BoneMap
from AIFReconLib.bone.network.model import OnnxModel
from AIFReconLib.bone.predicted_bone import EchoEstimator
from AIFReconLib.compounding.methods.table import METHODS
from AIFReconLib.effective_settings import imaging_fields
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample
from AIFReconLib.geometry.transforms import affine
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.imaging.beams import LINEAR, ProbeGeometry
from AIFReconLib.imaging.extent import grid_around_sweep
from AIFReconLib.imaging.region import ClipRectangle, ImageRegion
from AIFReconLib.live.replay.server import ReplayServer
from AIFReconLib.live.session.bone_watch import BoneWatch
from AIFReconLib.live.session.session import LiveSession
from AIFReconLib.live.wire.client import OpenIGTLinkClient
from AIFReconLib.machine.processes import start_python
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence

DEPTH = 96.0
"""mm that an image is deep."""

BONE = 60.0, 68.0
"""mm below the skin between which a plate of bone lies."""

FRAMES, SPACING = 90, 0.5
FAN_DEG = 30.0
STREAMS = ("640x480@30", "1024x768@20")


def sweep(columns: int, rows: int) -> TrackedSequence:
    """A fan of images of speckle over a plate of bone, about an axis on the skin, as ImageToReference."""
    rng = np.random.default_rng(0)
    spacing = DEPTH / rows
    speckle = rng.integers(0, 256, (rows, columns + FRAMES), dtype=np.uint8)
    images = np.stack([speckle[:, n : n + columns] // 3 for n in range(FRAMES)])
    records = []
    for number in range(FRAMES):
        angle = np.deg2rad(FAN_DEG) * np.sin(2 * np.pi * number / FRAMES) / 2  # there and back, so that a loop does not jump
        pose = np.eye(4)
        pose[:3, 0] = (spacing, 0, 0)
        pose[:3, 1] = (0, spacing * np.cos(angle), spacing * np.sin(angle))
        pose[:3, 2] = (0, -spacing * np.sin(angle), spacing * np.cos(angle))
        pose[:3, 3] = (-spacing * columns / 2, 0, 0)
        behind = spacing * np.cos(angle) * np.arange(rows) - BONE[0]
        images[number, behind > 0] //= 20
        images[number, np.abs(behind) < 0.5] = 230
        records.append(FrameRecord(number / 30, transforms={TransformName("Image", "Reference"): TransformSample(pose)}))
    return TrackedSequence(images, records)


def plate() -> Volume:
    """The labels of a plate of bone across the whole sweep."""
    labels = np.zeros((40, 60, 70), np.uint8)
    labels[:, int(BONE[0]) // 2 : int(BONE[1]) // 2] = 1
    return Volume(labels, affine(2.0 * np.eye(3), (-70.0, 0.0, -40.0)))


def serve(connection, columns: int, rows: int, rate: float) -> None:
    """Serve, in a process of its own, until something is asked; then tell what was sent."""
    with ReplayServer(sweep(columns, rows), port=0, rate=rate, loop=True) as server:
        connection.send(server.port)
        connection.recv()
        connection.send((server.sent, server.dropped))


def measure(stream: str, arguments: argparse.Namespace) -> dict:
    """Reconstruct one stream for the time asked for."""
    size, _, rate = stream.partition("@")
    columns, rows = (int(n) for n in size.split("x"))
    poses = np.stack([r.transforms[TransformName("Image", "Reference")].matrix for r in sweep(columns, rows).records])
    region = ImageRegion(ClipRectangle((0.0, 0.0), (columns - 1.0, rows - 1.0)))
    probe = ProbeGeometry(LINEAR)
    grid = grid_around_sweep(poses, (columns, rows), region, (SPACING,) * 3)
    settings = ReconstructionSettings(method=arguments.method, engine=arguments.engine, **imaging_fields(region, probe))
    model = arguments.bone_model and OnnxModel(arguments.bone_model)
    seen, growing = bool(model or arguments.bone_from_sweep), GrowingBone(least_a_frame=LEAST_A_FRAME * arguments.bone_from_sweep)
    process, server = start_python(serve, columns, rows, float(rate))
    client = OpenIGTLinkClient("127.0.0.1", server.recv())
    session = LiveSession(client, settings, growing if seen else BoneMap.from_labels(plate(), sigma_mm=4.0), grid)
    session.prepare()
    asking = BoneWatch(session, growing, lambda imaging: model or EchoEstimator(imaging)) if seen else None
    session.start()
    began, samples, p99s = time.monotonic(), [], []
    while (elapsed := time.monotonic() - began) < arguments.seconds:
        time.sleep(min(1.0, max(arguments.seconds - elapsed, 0.0)))
        statistics = session.statistics
        samples.append(psutil.Process().memory_info().rss / 2**20)
        p99s.append(statistics.latency_p99)
    looked_at = asking.frames / (time.monotonic() - began) if asking else None
    if asking:
        asking.stop()
    session.stop()
    statistics = session.statistics
    server.send("enough")
    sent, left_out = server.recv()
    process.wait()
    settled = samples[min(len(samples) // 4, 30) :]
    return {
        "stream": stream,
        "sent": sent,
        "left_out_by_server": left_out,
        "received": statistics.frames_received,
        "inserted": statistics.inserted,
        "skipped": statistics.skipped,
        "latency_p50_ms": 1000 * statistics.latency_p50,
        "latency_p99_ms": 1000 * statistics.latency_p99,
        "worst_latency_p99_ms": 1000 * max((p99 for p99 in p99s if np.isfinite(p99)), default=float("nan")),
        "bone_looked_for_per_s": looked_at,
        "memory_growth_mib": samples[-1] - settled[0],
        "error": str(session.error) if session.error else None,
    }


def main(words: list[str] | None = None) -> None:
    """Measure the streams and print what was found."""
    parser = argparse.ArgumentParser(
        prog="python Testing/benchmark live", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seconds", type=float, default=60.0, metavar="S", help="for each stream (default: %(default)g)")
    parser.add_argument("--size", action="append", metavar="WxH@FPS", help=f"a stream; may be repeated (default: {', '.join(STREAMS)})")
    parser.add_argument("--method", choices=METHODS, default="aif-compensated")
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--bone-model", type=Path, metavar="FILE.onnx", help="let a network tell where bone is, in the place of a CT")
    parser.add_argument("--bone-from-sweep", action="store_true", help="let the echoes tell where bone is, in the place of a CT")
    arguments = parser.parse_args(words)
    for stream in arguments.size or STREAMS:
        for key, value in measure(stream, arguments).items():
            print(f"{key:24} {value:.1f}" if isinstance(value, float) else f"{key:24} {value}")
        print(flush=True)
