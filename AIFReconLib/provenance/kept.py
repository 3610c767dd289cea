"""What settings say that were kept: names and values understood as options, grid, region and probe, or refused with the name."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, cast

import numpy as np

from .. import __version__
from ..errors import AIFReconError, SettingsError, SettingsFileError
from ..geometry.volume import VoxelGrid
from ..imaging.beams import LINEAR, SECTOR, ProbeGeometry
from ..imaging.region import ClipRectangle, Fan, FanDetection, ImageRegion
from ..message import shorten
from ..settings import AUTOMATIC, ReconstructionSettings
from .record import OF_OUTPUTS

NUMBERS = {
    "clip_px": 4,
    "apex_px": 2,
    "fan_apex_px": 2,
    "fan_angles_deg": 2,
    "fan_radius_px": 2,
    "fan_pixel_size": 2,
    "fan_detection": 2,
    "grid_size": 3,
    "time_offset": 1,
    "longest_gap": 1,
    "bone_sigma_voxels": 1,
    "bone_belief": 1,
    "bone_frames_px": 4,
}
"""Settings that are so many numbers, but for those of `ReconstructionSettings`."""

LARGEST = 1e300
"""Of a number; larger ones are not finite, or will not be."""

WORD_OR_NUMBER = "bone_sigma_mm"
"""A number, or the word that lets the sweep choose it."""

TEXTS = ("image_to_reference", "reference", "orientation", "probe")
FLAGS = ("bone_from_sweep",)
MATRIX = "grid_to_reference"
OF_RECONSTRUCTION = tuple(each.name for each in fields(ReconstructionSettings) if each.name != OF_OUTPUTS)
KNOWN = (*OF_RECONSTRUCTION, *NUMBERS, WORD_OR_NUMBER, *TEXTS, *FLAGS, MATRIX)

OF_FAN = ("fan_apex_px", "fan_angles_deg", "fan_radius_px", "fan_pixel_size", "fan_detection")
OF_IMAGES = ("probe", "apex_px", "clip_px", *OF_FAN)
OF_GRID = ("grid_size", MATRIX)


@dataclass(frozen=True)
class KeptSettings:
    """What a settings file, or a volume's header, says.

    Parameters
    ----------
    path : Path
    options : dict of str to object
        Settings that are numbers, words and flags, by the names of the command line's options.
    grid : VoxelGrid or None
    region : ImageRegion or None
        The whole of it: what a configuration says is not asked any more.
    probe : ProbeGeometry or None
    version : str
        Which wrote it; empty where that is not said.
    inputs : tuple of mappings
        Names and bytes of the files that a volume was made from.
    """

    path: Path
    options: dict[str, object]
    grid: VoxelGrid | None = None
    region: ImageRegion | None = None
    probe: ProbeGeometry | None = None
    version: str = ""
    inputs: tuple[Mapping[str, object], ...] = ()


def understood(path: Path, table: dict[str, object], version: str, inputs: tuple[Mapping[str, object], ...]) -> KeptSettings:
    """Names and values of a file as what they mean.

    Raises
    ------
    SettingsFileError
        When a name is not known, or a value is not of its kind or out of its range.
    """
    for name in table:
        if name not in KNOWN:
            raise _unknown(path, name, version)
    try:
        options = {name: _checked(name, value) for name, value in table.items()}
        of_reconstruction: dict[str, Any] = {name: value for name, value in options.items() if name in OF_RECONSTRUCTION}
        ReconstructionSettings(**of_reconstruction)
        grid, region, probe = _grid(options), _region(options), _probe(options)
    except AIFReconError as error:
        raise SettingsFileError(f"{path}: {error} Correct the file.") from None
    for name in (*OF_IMAGES, *OF_GRID):
        options.pop(name, None)
    return KeptSettings(path, options, grid, region, probe, version, inputs)


def _unknown(path: Path, name: str, version: str) -> SettingsFileError:
    if _is_newer(version):
        return SettingsFileError(
            f"{path}: version {version} wrote it, and this is {__version__}, which does not know {name}. Update AIFRecon, or remove "
            "that setting."
        )
    near = difflib.get_close_matches(name, KNOWN, n=1)
    if near:
        return SettingsFileError(f"{path}: there is no setting {name}, perhaps {near[0]} is meant. Correct it.")
    return SettingsFileError(f"{path}: there is no setting {name}. Remove it; files and what is printed are given on the command line.")


def _is_newer(version: str) -> bool:
    """Whether a version comes after this one; one that is no version does not."""
    theirs, ours = (text.partition("+")[0].split(".") for text in (version, __version__))
    return all(re.fullmatch("[0-9]{1,9}", part) for part in theirs) and [int(part) for part in theirs] > [int(part) for part in ours]


def _checked(name: str, value: object) -> object:
    """The value, if it is of the kind that the setting takes; that it is within its range is for others to see."""
    kind = _kind_of(name)
    if not _IS_KIND[kind](value):
        raise SettingsError(f"Input {name} must be {kind}; got {shorten(repr(value))}.")
    return value


def _kind_of(name: str) -> str:
    """What a setting takes, in words."""
    if name in NUMBERS:
        return f"{NUMBERS[name]} numbers" if NUMBERS[name] > 1 else "a number"
    if name == WORD_OR_NUMBER:
        return f"a number or {AUTOMATIC}"
    if name == MATRIX:
        return "4 rows of 4 numbers"
    if name == "spacing":
        return "one number or three"
    if name in FLAGS:
        return "true or false"
    return "a text" if name in TEXTS else "one number or word"


def _are_numbers(value: object, count: int) -> bool:
    """Whether it is a list of so many finite numbers."""
    return isinstance(value, list) and len(value) == count and all(map(_is_number, value))


def _is_number(value: object) -> bool:
    # Compared, because a whole number in a file may be too large for a float
    return isinstance(value, int | float) and not isinstance(value, bool) and -LARGEST < value < LARGEST


_IS_KIND: dict[str, Callable[[object], bool]] = {
    "a number": _is_number,
    f"a number or {AUTOMATIC}": lambda value: value == AUTOMATIC or _is_number(value),
    "2 numbers": lambda value: _are_numbers(value, 2),
    "3 numbers": lambda value: _are_numbers(value, 3),
    "4 numbers": lambda value: _are_numbers(value, 4),
    "4 rows of 4 numbers": lambda value: isinstance(value, list) and len(value) == 4 and all(_are_numbers(row, 4) for row in value),
    "one number or three": lambda value: _is_number(value) or _are_numbers(value, 3),
    "true or false": lambda value: isinstance(value, bool),
    "a text": lambda value: isinstance(value, str),
    "one number or word": lambda value: isinstance(value, str) or _is_number(value),
}


def _grid(options: dict[str, object]) -> VoxelGrid | None:
    """The voxels."""
    there = [name for name in OF_GRID if name in options]
    if not there:
        return None
    _require_all(options, OF_GRID)
    return VoxelGrid(cast("tuple[int, int, int]", tuple(cast("list[int]", options["grid_size"]))), np.array(options[MATRIX], np.float64))


def _region(options: dict[str, object]) -> ImageRegion | None:
    """The part of the image that is ultrasound."""
    clip = fan = detection = None
    if "clip_px" in options:
        x, y, width, height = _numbers(options, "clip_px")
        clip = ClipRectangle((x, y), (width, height)) if width and height else None
    if any(name in options for name in OF_FAN):
        _require_all(options, ("fan_angles_deg", "fan_radius_px"))
        about = "fan_apex_px" if "fan_apex_px" in options else "apex_px"
        _require_all(options, (about,))
        pairs = (_pair(options, name) for name in (about, "fan_angles_deg", "fan_radius_px"))
        fan = Fan(*pairs, *([_pair(options, "fan_pixel_size")] if "fan_pixel_size" in options else []))
    if "fan_detection" in options:
        threshold, radius = _pair(options, "fan_detection")
        detection = FanDetection(threshold, int(radius))
    return ImageRegion(clip, fan, detection) if "clip_px" in options or fan else None


def _probe(options: dict[str, object]) -> ProbeGeometry | None:
    """The shape of the beams; `auto`, and an apex alone, mean what they do on the command line."""
    kind = options.get("probe", "auto")
    apex = _pair(options, "apex_px") if "apex_px" in options else None
    if kind == "auto":
        return ProbeGeometry(SECTOR, apex) if apex else None
    if kind == LINEAR and apex:
        raise SettingsError("A linear probe has no apex. Remove apex_px.")
    return ProbeGeometry(str(kind), apex)


def _require_all(options: dict[str, object], names: Iterable[str]) -> None:
    missing = next((name for name in names if name not in options), None)
    if missing is not None:
        raise SettingsError(f"The setting {missing} is missing, which others need.")


def _numbers(options: dict[str, object], name: str) -> list[float]:
    return [float(number) for number in cast("list[float]", options[name])]


def _pair(options: dict[str, object], name: str) -> tuple[float, float]:
    first, second = _numbers(options, name)
    return first, second
