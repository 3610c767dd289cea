"""The options of a reconstruction, recorded or live, which are the columns of a table of cases too; and the bone that they name."""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from pathlib import Path

from ..compounding.state import BESIDE
from ..errors import SettingsError
from ..geometry.labels import Labels
from ..geometry.volume import VoxelGrid
from ..io.sequence.files import read_sequence
from ..io.volume.files import read_volume
from ..progress import Progress
from ..recipe.recipe import BoneSettings, ImagingSettings, MethodSettings, OutputSettings, ReadingSettings, Recipe, VolumeSettings
from ..sweep.frames import TrackedSequence
from ..workflows.job import BoneSource, ReconstructionJob
from .options import add_labels_options, labels_from, labels_inputs, names_labels, place_from
from .recipe_options import add_imaging_options, add_setting, add_settings

SIDE_OUTPUTS = {
    "score": "sum of weights",
    "hits": "pixels per voxel",
    "mask": "0 empty, 1 measured, 2 filled",
    "cosine": "best cosine of incidence",
}


def add_reconstruction_options(parser: argparse.ArgumentParser, without: Sequence[str] = ()) -> argparse._ArgumentGroup:
    """All that a reconstruction can be asked for, beside what says how a sweep is tracked; the answer is the group of its volumes."""
    add_bone_options(parser)
    add_settings(add_imaging_options(parser), ImagingSettings)
    volume = parser.add_argument_group("volume")
    where = volume.add_mutually_exclusive_group()
    where.add_argument("--grid-like", type=Path, metavar="VOLUME", help="use this volume's voxels (any orientation)")
    add_setting(where, "spacing")
    add_settings(volume, VolumeSettings, OutputSettings)
    for name, meaning in SIDE_OUTPUTS.items():
        volume.add_argument(f"--{name}", type=Path, metavar="FILE", help=f"also write this volume: {meaning}")
    add_settings(parser.add_argument_group("tuning"), MethodSettings, ReadingSettings, without=without)
    return volume


def add_memory_option(group: argparse._ArgumentGroup) -> None:
    """How much memory the volumes may take."""
    meaning = "that volumes may take; larger ones are worked in parts, with the same voxels (default: three quarters of what is free)"
    group.add_argument("--memory", type=gigabytes, metavar="GB", help=meaning)


def gigabytes(text: str) -> int:
    """GB, or the unit that is named, as bytes."""
    number, unit = re.fullmatch(r"\s*(.*?)\s*([kmgt]?i?b|[mgt])?\s*", text, re.IGNORECASE | re.DOTALL).groups()  # type: ignore[union-attr]
    try:
        size = float(number) * UNITS[(unit or "GB").upper().removesuffix("B")]
    except (ValueError, KeyError):
        size = 0.0
    if not 0 < size < float("inf"):
        raise argparse.ArgumentTypeError(f"must be a positive size such as 1.5GB, got {text!r}")
    return int(size)


UNITS = {"M": 1e6, "G": 1e9, "T": 1e12, "MI": 2.0**20, "GI": 2.0**30, "TI": 2.0**40}
"""Bytes of each, without the B."""


def grid_from(arguments: argparse.Namespace) -> VoxelGrid | None:
    """The voxels of --grid-like; None where the recipe says which."""
    return read_volume(arguments.grid_like).grid if arguments.grid_like else None


# ---- bone

SOURCES = ("bone_from_sweep", "bone_frames", "bone_model", "bone_image")
"""Options by which the frames themselves say where bone is."""


def add_bone_options(parser: argparse.ArgumentParser) -> None:
    """Where bone is, and how it becomes a map."""
    bone = parser.add_argument_group(
        "bone", "a registered CT's segmentation, or a bone probability; methods that weight by incidence need one"
    )
    source = bone.add_mutually_exclusive_group()
    add_labels_options(bone, source)
    source.add_argument("--bone-probability", type=Path, metavar="VOLUME", help="ready bone probability, 0 to 1")
    add_setting(source, "bone_from_sweep")
    source.add_argument(
        "--bone-frames",
        type=Path,
        action="append",
        metavar="SEQUENCE",
        help="no CT: a sequence of a network's predictions for the frames, 8 bit or 0 to 1; of several sweeps once for each",
    )
    source.add_argument(
        "--bone-model", type=Path, metavar="FILE.onnx", help="no CT: a network that tells bone in a frame (needs onnxruntime)"
    )
    bone.add_argument(
        "--bone-transform",
        type=Path,
        metavar="FILE",
        help="transform CT -> Reference as Slicer saves it (.tfm, .txt, .h5); default: none needed",
    )
    add_width_options(bone)
    add_settings(bone, BoneSettings)


def add_width_options(group: argparse._ActionsContainer) -> None:
    """Smoothing of the bone map, in voxels or mm."""
    width = group.add_mutually_exclusive_group()
    for name in ("bone_sigma_voxels", "bone_sigma_mm"):
        add_setting(width, name)


def check_bone_options(arguments: argparse.Namespace) -> None:
    """Return if the options that say where bone is go together.

    Raises SettingsError otherwise.
    """
    check_seen_bone(arguments)
    if arguments.bone_transform and not (names_labels(arguments) or arguments.bone_probability):
        raise SettingsError("--bone-transform places a bone input, and there is none. Give --bone-labels, --ct or --bone-probability.")


def seen_source(arguments: argparse.Namespace) -> str | None:
    """The option, as users write it, that lets the frames say where bone is; None where there is none."""
    return next((f"--{name.replace('_', '-')}" for name in SOURCES if getattr(arguments, name, None)), None)


def check_seen_bone(arguments: argparse.Namespace) -> None:
    """Return if these options go together with the others.

    Raises SettingsError otherwise.
    """
    source = seen_source(arguments)
    if getattr(arguments, "bone_frames_px", None) and not getattr(arguments, "bone_frames", None):
        raise SettingsError("--bone-frames-px says what predictions cover, and there are none. Give --bone-frames.")
    if source is None:
        return
    if arguments.bone_transform:
        raise SettingsError(f"--bone-transform places a CT, and {source} needs none. Leave out one of them.")
    if getattr(arguments, "speed_of_sound", None) is not None:
        raise SettingsError(f"{source} takes depths as the images show them. Leave out --speed-of-sound, or give --bone-labels.")


def bone_inputs(arguments: argparse.Namespace) -> list[Path | None]:
    """The files that say where bone is."""
    model = getattr(arguments, "bone_model", None)
    given = [*labels_inputs(arguments), arguments.bone_probability, arguments.bone_transform]
    return [*given, *(getattr(arguments, "bone_frames", None) or []), model, None if model is None else beside(model)]


def beside(model: Path) -> Path | None:
    """The description of a model, where there is one."""
    path = model.parent / f"{model.stem}.json"
    return path if path.is_file() else None


def bone_source_from(arguments: argparse.Namespace, progress: Progress | None = None, labels: Labels | None = None) -> BoneSource:
    """What the options name as bone, read; `labels` are theirs where they were read already.

    Raises SettingsError when options do not go together.
    """
    check_bone_options(arguments)
    labels = labels_from(arguments, progress) if labels is None else labels
    probability = read_volume(arguments.bone_probability) if arguments.bone_probability else None
    predictions = [read_sequence(path) for path in arguments.bone_frames or ()]
    return BoneSource(labels, probability, place_from(arguments), predictions or None, arguments.bone_model)


def job_from(
    arguments: argparse.Namespace, sequence: TrackedSequence, recipe: Recipe, progress: Progress | None = None
) -> ReconstructionJob:
    """The reconstruction that the options ask for."""
    bone = bone_source_from(arguments, progress)
    beside = [name for name in BESIDE if getattr(arguments, name)]
    return ReconstructionJob(sequence, recipe, bone, grid_from(arguments), beside, arguments.memory)
