"""The commands that write, as they are run under a fault: with small inputs, in two versions."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from files import tracked_sequence, write_patient

from AIFReconLib.commands.parser import main
from AIFReconLib.io.sequence.writer import write_sequence

from .writers import digest_bytes, digest_of, digest_sequence, digest_volume

FRAMES = 60


@dataclass(frozen=True)
class Command:
    """One command with its inputs and outputs.

    Parameters
    ----------
    name : str
    arguments : callable of inputs, folder, version
        The command line; it writes into the folder.
    outputs : dict of str to callable
        Their names, and how to tell versions apart.
    """

    name: str
    arguments: Callable[[Path, Path, int], list[str]]
    outputs: dict[str, Callable[[Path], str]]

    def prepare(self, folder: Path) -> None:
        """Write the inputs that every command here takes from."""
        folder.mkdir()
        write_patient(folder, tracked_sequence(FRAMES))
        write_sequence(tracked_sequence(FRAMES, seed=5), folder / "raw.mha", compress=False)
        np.save(folder / "images.npy", np.asarray(tracked_sequence(FRAMES).images))
        rows = [",".join(["x", "y", "z", "qw", "qx", "qy", "qz"]), *(f"{n},0,{2 * n},1,0,0,0" for n in range(FRAMES))]
        (folder / "poses.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")

    def digest_inputs(self, folder: Path) -> str:
        """Of every input, byte for byte."""
        return digest_of(*((path.name, path.read_bytes()) for path in sorted(folder.iterdir()) if path.is_file()))


def digest_report(path: Path) -> str:
    """Of a report, but for the place of its files."""
    return digest_of({**json.loads(path.read_text("utf-8")), "files": ""})


def quietly(arguments: list[str]) -> int:
    """Run a command line with its output thrown away; in a child, whose streams it keeps."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    return main(arguments)


def _reconstruct(inputs: Path, folder: Path, version: int) -> list[str]:
    method = ("average", "maximum")[version]
    sides = [word for name in ("score", "hits", "mask") for word in (f"--{name}", str(folder / f"{name}.nrrd"))]
    outputs = ["--output", str(folder / "v.nrrd"), *sides, "--report", str(folder / "r.json")]
    spacing = str((0.5, 0.45)[version])
    return ["reconstruct", str(inputs / "sweep.igs.mha"), *_config(inputs), "--method", method, "--spacing", spacing, *outputs]


def _config(inputs: Path) -> list[str]:
    return ["--config", str(inputs / "PlusDeviceSet.xml")]


def _bone_map(inputs: Path, folder: Path, version: int) -> list[str]:
    return ["bone-map", str(inputs / "labels.nrrd"), "--bone-sigma-mm", str(1 + version), "--output", str(folder / "b.nrrd")]


def _convert(inputs: Path, folder: Path, version: int) -> list[str]:
    return ["convert", str(inputs / "raw.mha"), str(folder / "c.mhd"), "--frames", str(version), "50"]


def _import(inputs: Path, folder: Path, version: int) -> list[str]:
    meaning = ["--transform", "ImageToReference", "--spacing", "0.1", ("0.1", "0.2")[version]]
    return ["import", str(inputs / "images.npy"), "--poses", str(inputs / "poses.csv"), *meaning, "--output", str(folder / "i.mha")]


def _simulate(_inputs: Path, folder: Path, version: int) -> list[str]:
    return ["simulate", "--output", str(folder), "--seed", str(version), "--frames", "9"]


RECONSTRUCT = Command(
    "reconstruct",
    _reconstruct,
    {**dict.fromkeys(("v.nrrd", "score.nrrd", "hits.nrrd", "mask.nrrd"), digest_volume), "r.json": digest_report},
)
BONE_MAP = Command("bone-map", _bone_map, {"b.nrrd": digest_volume})
CONVERT = Command("convert", _convert, {"c.mhd": digest_sequence})
IMPORT = Command("import", _import, {"i.mha": digest_sequence, "i-sweep.svg": digest_bytes})
SIMULATE = Command(
    "simulate",
    _simulate,
    {
        "sweep.igs.mha": digest_sequence,
        "ct.nrrd": digest_volume,
        "lumbar-segmentation.nrrd": digest_volume,
        "CTToReference.tfm": digest_bytes,
        "PlusDeviceSet.xml": digest_bytes,
    },
)
COMMANDS = (RECONSTRUCT, BONE_MAP, CONVERT, IMPORT)
LONG_COMMANDS = (SIMULATE,)
