"""The options of a reconstruction, recorded or live, which are the columns of a table of cases too."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from ..geometry.volume import VoxelGrid
from ..io.volume.files import read_volume
from ..recipe.recipe import ImagingSettings, MethodSettings, OutputSettings, ReadingSettings, VolumeSettings
from .bone_options import add_bone_options
from .recipe_options import add_setting, add_settings

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


def add_imaging_options(parser: argparse.ArgumentParser) -> argparse._ArgumentGroup:
    """Probe, clip rectangle and fan; the answer is the group, for more of the kind."""
    image = parser.add_argument_group("image", "what the image shows; default: the configuration's, else recognized by the black surround")
    for name in ("probe", "apex_px", "clip_px", "fan_angles_deg", "fan_radius_px"):
        add_setting(image, name)
    return image


def add_memory_option(group: argparse._ArgumentGroup) -> None:
    """How much memory the volumes may take."""
    meaning = "that volumes may take; larger ones are worked in parts, with the same voxels (default: three quarters of what is free)"
    group.add_argument("--memory", type=gigabytes, metavar="GB", help=meaning)


def gigabytes(text: str) -> int:
    """GB as bytes."""
    try:
        size = 1e9 * float(text)
    except ValueError:
        size = 0.0
    if not 0 < size < float("inf"):
        raise argparse.ArgumentTypeError(f"must be positive GB, got {text!r}")
    return int(size)


def grid_from(arguments: argparse.Namespace) -> VoxelGrid | None:
    """The voxels of --grid-like; None where the recipe says which."""
    return read_volume(arguments.grid_like).grid if arguments.grid_like else None
