"""Every kind of file that the library reads, made once, and what reading it gives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from files import CONFIGURATION, IMAGE_TO_PROBE, tracked_sequence

from AIFReconLib.io.foreign.openers import open_images
from AIFReconLib.io.foreign.options import ImportOptions
from AIFReconLib.io.foreign.poses.files import read_poses
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.sequence.writer import write_sequence

from .writers import OTHERS, VOLUMES, digest_of, digest_sequence, digest_volume

FRAMES = 30
COLUMNS = 64


@dataclass(frozen=True)
class Reader:
    """One kind of file.

    Parameters
    ----------
    name : str
    files : tuple of str
        What lies in the folder; the last is the one that is named.
    make : callable of folder, version
        Writes them.
    read : callable of path
        A digest of what is read, all of it.
    """

    name: str
    files: tuple[str, ...]
    make: Callable[[Path, int], None]
    read: Callable[[Path], str]


def _sequence(name: str, files: tuple[str, ...], compress: bool) -> Reader:
    def make(folder: Path, version: int) -> None:
        images = np.random.default_rng(version).integers(0, 256, (FRAMES, 48, COLUMNS), dtype=np.uint8)
        write_sequence(tracked_sequence(FRAMES, images=images), folder / files[-1], compress=compress)

    return Reader(name, files, make, digest_sequence)


def _pictures(suffix: str) -> Reader:
    def make(folder: Path, version: int) -> None:
        from PIL import Image

        pages = np.random.default_rng(version).integers(0, 256, (FRAMES, 48, COLUMNS), dtype=np.uint8)
        first, *others = (Image.fromarray(page) for page in pages)
        more = {"save_all": True, "append_images": others} if suffix == ".tif" else {}
        first.save(folder / f"p{suffix}", **more)

    return Reader(f"picture {suffix}", (f"p{suffix}",), make, _digest_images)


def _digest_images(path: Path) -> str:
    stack = open_images([path]).stack
    return digest_of(*(stack[n] for n in range(len(stack))))


def _make_array(folder: Path, version: int) -> None:
    np.save(folder / "a.npy", np.random.default_rng(version).integers(0, 256, (FRAMES, 96, COLUMNS), dtype=np.uint8))


def _make_poses(folder: Path, version: int) -> None:
    rows = ["x,y,z,qw,qx,qy,qz", *(f"{n + version},0,{2 * n},1,0,0,0" for n in range(500))]
    (folder / "p.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


def _digest_poses(path: Path) -> str:
    return digest_of(read_poses(path, ImportOptions()).matrices)


def _make_configuration(folder: Path, version: int) -> None:
    matrix = IMAGE_TO_PROBE.copy()
    matrix[2, 3] += version
    (folder / "c.xml").write_text(
        CONFIGURATION.format(matrix=" ".join(map(repr, matrix.ravel().tolist())), spacing="1 1 1"), encoding="utf-8"
    )


def _digest_configuration(path: Path) -> str:
    return digest_of([(str(name), sample.matrix.tolist()) for name, sample in read_plus_configuration(path).transforms.items()])


def _of_writer(writer, files: tuple[str, ...], read) -> Reader:
    return Reader(writer.name, files, writer.write, read)


READERS = (
    _sequence("sequence .mha, not compressed", ("s.mha",), False),
    _sequence("sequence .mha, compressed", ("s.mha",), True),
    _sequence("sequence .mhd and .raw", ("s.raw", "s.mhd"), False),
    _sequence("sequence .nrrd, compressed", ("s.nrrd",), True),
    *(_of_writer(w, ("v.zraw", "v.mhd") if w.file == "v.mhd" else (w.file,), digest_volume) for w in VOLUMES),
    *(_of_writer(w, (w.file,), w.digest) for w in OTHERS[:2]),
    Reader("images .npy", ("a.npy",), _make_array, _digest_images),
    *map(_pictures, (".bmp", ".png", ".tif")),
    Reader("poses .csv", ("p.csv",), _make_poses, _digest_poses),
    Reader("Plus configuration", ("c.xml",), _make_configuration, _digest_configuration),
)
