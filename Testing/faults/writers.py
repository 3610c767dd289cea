"""Every kind of file that the library writes: how to write it in two versions, and how to tell from the files which one is there."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from files import tracked_sequence
from live_messages import tracked as tracked_messages

from AIFReconLib.evaluation.figures import ComparisonFigure
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.inspection.sweep_drawing import draw_sweep
from AIFReconLib.io.disk.atomic import write_text
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.transform.files import read_transform, write_transform
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.live.pairing.synchronizer import Synchronizer
from AIFReconLib.live.session.recording import Recorder

RECORDED = 12
"""Frames of a recording."""


@dataclass(frozen=True)
class Writer:
    """One kind of write.

    Parameters
    ----------
    name : str
    write : callable of folder, version
        Writes the file that `path` names, in version 0 or 1.
    file : str
        Its name.
    digest : callable of path
        Some text that differs between versions; raises when the file is damaged.
    """

    name: str
    write: Callable[[Path, int], None]
    file: str
    digest: Callable[[Path], str]


def digest_of(*parts) -> str:
    """A short text that differs where the parts do."""
    return hashlib.sha256(b"".join(part.tobytes() if isinstance(part, np.ndarray) else repr(part).encode() for part in parts)).hexdigest()


def digest_volume(path: Path) -> str:
    """Of voxels and place."""
    volume = read_volume(path)
    return digest_of(volume.array, volume.ijk_to_reference)


def digest_sequence(path: Path) -> str:
    """Of pixels, times, poses and statuses."""
    sequence = read_sequence(path)
    poses = [(str(name), sample.matrix.tolist(), sample.status) for r in sequence.records for name, sample in r.transforms.items()]
    return digest_of(np.asarray(sequence.images), [r.timestamp for r in sequence.records], poses)


def digest_bytes(path: Path) -> str:
    """Of the file."""
    return digest_of(path.read_bytes())


def digest_json(path: Path) -> str:
    """Of what it says."""
    return digest_of(json.loads(path.read_text("utf-8")))


def digest_png(path: Path) -> str:
    """Of its pixels."""
    from matplotlib.image import imread

    return digest_of(imread(path))


def volume(version: int, edge: int = 48) -> Volume:
    """Noise, which does not compress: its file takes time to write. Both versions have the same size, so that mixing them would pass."""
    return Volume(np.random.default_rng(version).integers(0, 256, (edge, edge, edge), dtype=np.uint8), np.diag([0.5, 0.5, 0.5, 1.0]))


def _volume_writer(file: str) -> Writer:
    return Writer(f"volume {file[1:]}", lambda folder, version: volume(version).write(folder / file), file, digest_volume)


def _sequence_writer(file: str, compress: bool) -> Writer:
    def write(folder: Path, version: int) -> None:
        write_sequence(tracked_sequence(40, seed=version), folder / file, compress=compress)

    return Writer(f"sequence {file[1:]}, {'' if compress else 'not '}compressed", write, file, digest_sequence)


def recorded_frames(version: int) -> list:
    """Frames as a live stream gives them."""
    pixels = np.random.default_rng(version).integers(0, 256, (60, 80), dtype=np.uint8)
    messages = [m for n in range(RECORDED) for m in tracked_messages(1.0 + 0.1 * n + version, pixels=pixels + n)]
    synchronizer = Synchronizer()
    return [frame for message in messages for frame in synchronizer.feed(message)] + synchronizer.flush()


def _recording_writer(file: str) -> Writer:
    def write(folder: Path, version: int) -> None:
        recorder = Recorder(folder / file)
        for frame in recorded_frames(version):
            recorder.append(frame)
        recorder.finish()

    return Writer(f"live recording {file[1:]}", write, file, digest_sequence)


def _write_figure(folder: Path, version: int) -> None:
    ct, shown = volume(version, 24), {"average": volume(version + 2, 24)}
    ComparisonFigure(shown, np.array([5.0, 5.0, 5.0]), ct).write(folder / "f.png")


def _write_transform(file: str) -> Callable[[Path, int], None]:
    def write(folder: Path, version: int) -> None:
        matrix = np.eye(4)
        matrix[:3, 3] = version + 1.0
        write_transform(matrix, folder / file)

    return write


def _digest_transform(path: Path) -> str:
    return digest_of(read_transform(path))


def _write_json(folder: Path, version: int) -> None:
    write_text(folder / "r.json", json.dumps({"rows": list(range(5000)), "version": version}, indent=1))


def _write_drawing(folder: Path, version: int) -> None:
    poses = np.stack([np.eye(4)] * 200)
    poses[:, 2, 3] = np.arange(200) * (version + 1)
    write_text(folder / "d.svg", draw_sweep(poses, (80, 60), "sweep", "Reference").to_svg())


VOLUMES = tuple(_volume_writer(f"v{suffix}") for suffix in (".nrrd", ".mha", ".mhd", ".nii", ".nii.gz"))
SEQUENCES = (*(_sequence_writer(f"s{suffix}", compress) for suffix in (".mha", ".nrrd", ".mhd") for compress in (True, False)),)
OTHERS = (
    Writer("transform .tfm", _write_transform("t.tfm"), "t.tfm", _digest_transform),
    Writer("transform .h5", _write_transform("t.h5"), "t.h5", _digest_transform),
    Writer("report or result, JSON", _write_json, "r.json", digest_json),
    Writer("drawing, SVG", _write_drawing, "d.svg", digest_bytes),
    Writer("figure, PNG", _write_figure, "f.png", digest_png),
)
RECORDINGS = tuple(_recording_writer(f"l{suffix}") for suffix in (".mha", ".mhd", ".nrrd"))
WRITERS = VOLUMES + SEQUENCES + OTHERS
