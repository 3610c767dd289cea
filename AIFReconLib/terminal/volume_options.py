"""Which volumes a reconstruction makes, on which voxels, and the parameters of its methods."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..geometry.volume import VoxelGrid
from ..io.volume.files import read_volume
from ..provenance.kept import KeptSettings
from .one_line_parser import NumbersAction, numbers
from .options import add_setting

SIDE_OUTPUTS = ("score", "hits", "mask", "cosine")


def add_volume_options(parser: argparse.ArgumentParser) -> argparse._ArgumentGroup:
    """The volumes to make, and their voxels; the answer is the group, for more of the kind."""
    volume = parser.add_argument_group("volume")
    where = volume.add_mutually_exclusive_group()
    where.add_argument("--grid-like", type=Path, metavar="VOLUME", help="use the voxels of this volume (any orientation)")
    where.add_argument("--spacing", action=NumbersAction, type=numbers, metavar="MM", help="voxel size, one number or x y z")
    add_setting(volume, "hole_limit", metavar="MM")
    add_setting(volume, "holes")
    add_setting(volume, "output_type")
    for name, meaning in zip(
        SIDE_OUTPUTS, ("sum of weights", "pixels per voxel", "0 empty, 1 measured, 2 filled", "best cosine of incidence"), strict=True
    ):
        volume.add_argument(f"--{name}", type=Path, metavar="FILE", help=f"also write this volume: {meaning}")
    return volume


def add_tuning_options(parser: argparse.ArgumentParser) -> None:
    """The parameters of the methods."""
    tuning = parser.add_argument_group("tuning")
    for name in ("alpha", "beta", "bone_gain", "weight_floor", "interpolation", "pixel_rejection", "intensity_maximum", "skip", "engine"):
        add_setting(tuning, name)
    for name in ("speed_of_sound", "scanner_speed_of_sound"):
        add_setting(tuning, name)


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
    """The voxels that the options name; None where they leave them open."""
    if arguments.grid_like:
        return read_volume(arguments.grid_like).grid
    kept: KeptSettings | None = arguments.kept
    return None if kept is None else kept.grid
