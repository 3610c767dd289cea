"""Every kind of file that the library writes: small, in two versions that can be told apart."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from files import tracked_sequence
from live_messages import tracked

from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.disk.atomic import named_data_file, write_text
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.transform.files import read_transform, write_transform
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.live.pairing.synchronizer import Synchronizer
from AIFReconLib.live.session.recording import Recorder

from .children import result_of

Digest = Callable[[Path], str]
RECORDED = 12
"""Frames of a recording."""


@dataclass(frozen=True)
class FileKind:
    """One kind of file.

    Parameters
    ----------
    file : str
        Its name.
    write : callable of folder, version
        Writes it, in version 0 or 1.
    digest : callable of path
        Some text that differs between versions; raises when the file is damaged.
    """

    file: str
    write: Callable[[Path, int], object]
    digest: Digest


# ---- what is left in a folder


def digest_of(*parts) -> str:
    """A short text that differs where the parts do."""
    return hashlib.sha256(b"".join(part.tobytes() if isinstance(part, np.ndarray) else repr(part).encode() for part in parts)).hexdigest()


def version_of(path: Path, digests: dict[str, str], digest: Digest) -> str:
    """Which of these versions is there, by its name; ``absent``, ``damaged`` or ``mixed``."""
    if not path.exists():
        return "absent"
    try:
        found = result_of(partial(digest, path))
    except RuntimeError:
        return "damaged"
    return next((name for name, known in digests.items() if known == found), "mixed")


def left_in(folder: Path, *files: str) -> list[str]:
    """What lies in the folder besides these files and their data."""
    own = {name for file in files for name in (file, *(f"{file.rpartition('.')[0]}{end}" for end in (".raw", ".zraw")))}
    return sorted(
        {path.name for path in folder.iterdir()} - own - {named_data_file(header) for header in folder.glob("*.mhd") if header.is_file()}
    )


# ---- files


def _noise(version: int, *shape: int) -> np.ndarray:
    """It does not compress: its file takes time to write. Both versions have the same size, so that mixing them would pass."""
    return np.random.default_rng(version).integers(0, 256, shape, dtype=np.uint8)


def _write_volume(file: str, folder: Path, version: int) -> None:
    Volume(_noise(version, 48, 48, 48), np.diag([0.5, 0.5, 0.5, 1.0])).write(folder / file)


def _write_sequence(file: str, compress: bool, folder: Path, version: int) -> None:
    write_sequence(tracked_sequence(40, images=_noise(version, 40, 48, 64)), folder / file, compress=compress)


def _write_transform(file: str, folder: Path, version: int) -> None:
    write_transform(np.diag([1.0, 1.0, 1.0 + version, 1.0]), folder / file)


def recorded_frames(version: int) -> list:
    """Frames as a live stream gives them."""
    messages = [m for n in range(RECORDED) for m in tracked(1.0 + 0.1 * n + version, pixels=_noise(version, 60, 80) + n)]
    synchronizer = Synchronizer()
    return [frame for message in messages for frame in synchronizer.feed(message)] + synchronizer.flush()


def _write_recording(file: str, folder: Path, version: int) -> None:
    recorder = Recorder(folder / file)
    for frame in recorded_frames(version):
        recorder.append(frame)
    recorder.finish()


def _volume(path: Path) -> str:
    volume = read_volume(path)
    return digest_of(volume.array, volume.ijk_to_reference)


def _sequence(path: Path) -> str:
    sequence = read_sequence(path)
    poses = [(str(name), sample.matrix.tolist(), sample.status) for r in sequence.records for name, sample in r.transforms.items()]
    return digest_of(np.asarray(sequence.images), [r.timestamp for r in sequence.records], poses)


def _bytes(path: Path) -> str:
    return digest_of(path.read_bytes())


WRITTEN = (
    *(FileKind(f"v{end}", partial(_write_volume, f"v{end}"), _volume) for end in (".nrrd", ".mha", ".mhd", ".nii", ".nii.gz")),
    *(FileKind(f"s{end}", partial(_write_sequence, f"s{end}", True), _sequence) for end in (".mha", ".nrrd", ".mhd")),
    *(FileKind(f"plain{end}", partial(_write_sequence, f"plain{end}", False), _sequence) for end in (".mha", ".nrrd", ".mhd")),
    *(FileKind(f"t{end}", partial(_write_transform, f"t{end}"), lambda path: digest_of(read_transform(path))) for end in (".tfm", ".h5")),
    FileKind("r.json", lambda folder, version: write_text(folder / "r.json", json.dumps([version] * 5000)), _bytes),
)
RECORDINGS = tuple(FileKind(f"l{end}", partial(_write_recording, f"l{end}"), _sequence) for end in (".mha", ".mhd", ".nrrd"))
