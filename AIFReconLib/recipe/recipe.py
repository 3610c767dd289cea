"""Every setting of a reconstruction: name, default, range, unit and meaning.

A setting is declared here, once, and used where its value matters. Options of all commands, settings files, headers of volumes, columns of
a table of cases, and the panel's fields follow from its declaration.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Reals
from ..compounding.methods.method import CompoundingMethod
from ..compounding.methods.table import DEFAULT_METHOD_WITH_BONE, DEFAULT_METHOD_WITHOUT_BONE, IN_WORDS, LINEAR_METHODS, METHODS, MethodName
from ..errors import SettingsError
from ..geometry.volume import VoxelGrid
from ..message import listed
from .rules import FILE, FLAG, MATRIX, NUMBERS, TEXT, WHOLE, Rule, checked, rule_of, setting

AUTOMATIC = "auto"
"""Stands for what is chosen from the sweep."""
PROBES = (AUTOMATIC, "linear", "sector")
ENGINES = ("auto", "numpy", "numba")
INTERPOLATIONS = ("nearest", "linear")
HOLE_FILLINGS = ("off", "nearest", "cube", "gaussian", "stick")

DEFAULT_SPACING = 0.5
"""mm, where neither the caller nor a configuration says."""
SCANNER_SPEED = 1540.0
"""m/s. The speed of sound that scanners assume."""

LONGEST_GAP = 0.5
"""s. Poses of a recording that are farther apart are not interpolated between. Plus's own limit."""

_speed = partial(setting, unit="m/s", minimum=800.0, maximum=2500.0, decimals=0)


@dataclass(frozen=True)
class Branch:
    """Settings that belong together.

    Raises SettingsError when a value is not of its kind, or outside its range.
    """

    def __post_init__(self) -> None:
        for spec in fields(self):
            value = getattr(self, spec.name)
            if value is not spec.default:
                object.__setattr__(self, spec.name, checked(spec.name, value, rule_of(spec.metadata)))


@dataclass(frozen=True)
class ReadingSettings(Branch):
    """How a recording is read. What its file does not say, or says wrongly, counts where the file is read."""

    image_to_reference: str | None = setting(
        None,
        "transform that places the image, as recorded or as a chain (default: ImageToReference); of several ways the one to take, as in "
        "ImageToProbe,ProbeToReference",
        TEXT,
        metavar="NAME",
    )
    reference: str | None = setting(None, "frame to reconstruct in, e.g. Tracker (default: Reference)", TEXT, metavar="FRAME")
    orientation: str | None = setting(
        None, "how the stored pixels run: MF, MN, UF or UN (default: as the file says)", TEXT, metavar="CODE", label="Stored pixels:"
    )
    time_offset: float = setting(
        0.0,
        "add this to the images' time stamps, as Plus's LocalTimeOffsetSec of the image device does, and interpolate the poses (negative: "
        "images come late; positive: poses do)",
        unit="s",
        metavar="S",
        label="Time offset:",
        decimals=3,
    )
    longest_gap: float = setting(
        LONGEST_GAP, "do not interpolate between poses farther apart than this", unit="s", metavar="S", label="Longest gap:", decimals=2
    )
    skip: int | None = setting(
        None,
        "use every N-th frame (default: the configuration's, else every one)",
        WHOLE,
        minimum=1,
        label="Every N-th frame:",
        preset=True,
    )
    motion: str | None = setting(
        None,
        "take out of the poses how the patient moved, as the bone echoes show it; off: not (default: auto for weighted)",
        choices=(AUTOMATIC, "off"),
    )


@dataclass(frozen=True)
class ImagingSettings(Branch):
    """What the images show, and which of their pixels count. What is left open is the configuration's, else recognized."""

    probe: str = setting(AUTOMATIC, "shape of the beams", choices=PROBES, label="Probe:")
    apex_px: tuple[float, float] | None = setting(
        None, "virtual apex of a sector probe", NUMBERS, counts=(2,), metavar="COLUMN ROW", label="Apex:"
    )
    clip_px: tuple[float, float, float, float] | None = setting(
        None,
        "use this rectangle of the image (columns X to X + W); four zeros: all of it",
        NUMBERS,
        counts=(4,),
        metavar="X Y W H",
        label="Clip rectangle:",
    )
    fan_angles_deg: tuple[float, float] | None = setting(
        None, "use this fan about the apex, from +y toward +x", NUMBERS, counts=(2,), metavar="A B", label="Fan angles:"
    )
    fan_radius_px: tuple[float, float] | None = setting(
        None, "between these radii about the apex; 0 0: no fan", NUMBERS, counts=(2,), metavar="R0 R1", label="Fan radii:"
    )
    fan_apex_px: tuple[float, float] | None = setting(
        None, "apex of the fan, where it is not the probe's", NUMBERS, counts=(2,), metavar=""
    )
    fan_pixel_size: tuple[float, float] | None = setting(
        None, "size of a pixel of a fan in mm, in whose unit the radii are then", NUMBERS, counts=(2,), metavar=""
    )
    fan_detection: tuple[float, float] | None = setting(
        None, "the fan is narrowed in each frame to what is lit: gray level, radius of a filter in pixels", NUMBERS, counts=(2,), metavar=""
    )
    importance_mask: Path | Reals | None = setting(  # noqa: RUF009  # it is a field
        None,
        "weight of each pixel in an average: 8-bit gray image as large as the frames, 0 does not count",
        FILE,
        metavar="IMAGE",
        label="Pixel weights:",
    )
    pixel_rejection: float | None = setting(
        None,
        "pixels darker than this gray level are left out (default: the configuration's, else none)",
        minimum=0.0,
        label="Darkest pixel:",
    )
    intensity_maximum: float | None = setting(
        None,
        "brightest value an image can hold (default: 255 for 8-bit images, else the largest of their type; none for float)",
        minimum=1e-6,
        label="Brightest value:",
    )
    gray_levels: tuple[float, ...] | None = setting(
        None, "gray levels of the images that are taken to those of the standard scale", NUMBERS, counts=(8,), metavar=""
    )
    speed_of_sound: float | None = _speed(
        None,
        "true speed of sound, where it is not the scanner's: pixels move along their beams (default: no correction)",
        label="Speed of sound:",
    )
    scanner_speed_of_sound: float = _speed(
        SCANNER_SPEED, "speed of sound that the scanner assumes; matters with the true one alone", label="Scanner's speed:"
    )


@dataclass(frozen=True)
class BoneSettings(Branch):
    """How what is known of bone becomes a map of it."""

    bone_from_sweep: bool = setting(False, "no CT: take for bone what is bright with darkness behind it in the sweep itself", FLAG)
    bone_frames_px: tuple[float, float, float, float] | None = setting(
        None,
        "rectangle of the frame that a prediction covers, where it has not the size of one",
        NUMBERS,
        counts=(4,),
        metavar="X Y W H",
    )
    bone_sigma_voxels: float | None = setting(
        None, "smoothing of the bone map, in voxels of the labels (default: 10, but for weighted)", label="Tolerance:", preset=True
    )
    bone_sigma_mm: float | str | None = setting(
        None,
        f"the same in mm, or {AUTOMATIC}: by how well CT and sweep agree (default of weighted: {AUTOMATIC})",
        word=AUTOMATIC,
        metavar="MM",
        preset=True,
    )
    bone_belief: float | None = setting(
        None, "how far labels are believed, above 0 to 1 (default: 1; less where a width that is found turns out wide)"
    )
    bone_direction: str = setting(
        "gradient",
        "where bone faces: gradient of the probability map (the paper), or of the smoothed bone surface",
        choices=("gradient", "surface"),
        label="Bone faces by:",
        preset=True,
    )


@dataclass(frozen=True)
class VolumeSettings(Branch):
    """The voxels, and what becomes of empty ones."""

    spacing: float | tuple[float, float, float] | None = setting(
        None,
        f"distance between voxels, one number or x y z (default: the configuration's, else {DEFAULT_SPACING})",
        NUMBERS,
        counts=(1, 3),
        unit="mm",
        minimum=0.01,
        maximum=50.0,
        metavar="MM",
        label="Voxel size:",
        decimals=2,
        preset=True,
    )
    grid_size: tuple[int, int, int] | None = setting(None, "voxels along x, y, z of the box", NUMBERS, counts=(3,), metavar="")
    grid_to_reference: tuple[tuple[float, ...], ...] | None = setting(
        None, "where the voxels of the box are in Reference", MATRIX, metavar=""
    )
    hole_limit: float | str = setting(
        AUTOMATIC,
        "empty voxels take the nearest measured value up to this distance; 0: off; auto: from how far the frames lie apart, at most 4 "
        "(or the configuration's own hole filling)",
        unit="mm",
        minimum=0.0,
        maximum=20.0,
        word=AUTOMATIC,
        metavar="MM",
        label="Fill gaps up to:",
        preset=True,
    )
    holes: str | None = setting(
        None,
        "how empty voxels within the limit are filled: nearest measured value; or as Plus does it, mean of the nearest cube, gaussian "
        "average, sticks that bridge gaps; off: not (default: nearest where a limit is given, else the configuration's way, else nearest)",
        choices=HOLE_FILLINGS,
        label="Fill them by:",
        preset=True,
    )

    def spacing_xyz(self) -> tuple[float, float, float]:
        """Spacing along x, y, z in mm, with the default where none is set."""
        spacing = DEFAULT_SPACING if self.spacing is None else self.spacing
        return spacing if isinstance(spacing, tuple) else (float(spacing),) * 3

    @property
    def grid(self) -> VoxelGrid | None:
        """The voxels, where they are given one by one."""
        if self.grid_size is None or self.grid_to_reference is None:
            return None
        return VoxelGrid(self.grid_size, np.array(self.grid_to_reference))


@dataclass(frozen=True)
class MethodSettings(Branch):
    """How pixels become a voxel."""

    method: MethodName | str | CompoundingMethod | None = setting(  # noqa: RUF009  # it is a field
        None,
        f"how pixels of a voxel are combined. {IN_WORDS}; the last: a method of your own "
        f"(default: {DEFAULT_METHOD_WITH_BONE} with bone, a CT's or else a recorded sweep's own; where there is none, or the "
        f"configuration names one, the configuration's, else {DEFAULT_METHOD_WITHOUT_BONE})",
        choices=METHODS,
        own=True,
        label="Method:",
        preset=True,
    )
    alpha: float = setting(
        0.1,
        "aif methods: how much well-insonified bone is brightened",
        minimum=0.0,
        maximum=10.0,
        label="Brighten bone:",
        decimals=2,
        preset=True,
    )
    beta: float = setting(
        0.1,
        "smallest cosine of incidence that is compensated (0.1: beams up to 84.3 degrees)",
        minimum=0.001,
        maximum=1.0,
        label="Flattest angle:",
        decimals=3,
        preset=True,
    )
    bone_gain: float = setting(
        4.0,
        "weighted: how much bone that a frame shows and the map expects is brightened, times up to 3 for oblique beams",
        minimum=0.0,
        maximum=10.0,
        label="Bone contrast:",
        decimals=2,
        preset=True,
    )
    weight_floor: float = setting(
        0.003,
        "weighted: weight of a pixel that shows no bone, against 1 of one that does",
        minimum=1e-6,
        maximum=1.0,
        label="Weight of the rest:",
        decimals=3,
        preset=True,
    )
    interpolation: str | None = setting(
        None,
        f"each pixel enters its nearest voxel, or spreads linearly over the eight around it ({listed(LINEAR_METHODS)} only; "
        "default: the configuration's, else nearest)",
        choices=INTERPOLATIONS,
        label="Between voxels:",
        preset=True,
    )
    engine: str = setting(
        "auto",
        "what computes the volume; every engine gives the same voxels (auto: numba where it is installed, which is several times as fast)",
        choices=ENGINES,
        label="Computed by:",
    )

    def method_for(self, has_bone: bool) -> str:
        """The method to use, resolving the default by whether there is a bone map."""
        if self.method is not None:
            return self.method if isinstance(self.method, str) else self.method.name
        return DEFAULT_METHOD_WITH_BONE if has_bone else DEFAULT_METHOD_WITHOUT_BONE


@dataclass(frozen=True)
class OutputSettings(Branch):
    """What comes of it."""

    output_type: str | None = setting(
        None,
        "type of the intensity volume (default: uint8 for 8-bit images, else float32)",
        choices=("uint8", "float32"),
        label="Stored as:",
    )
    best_cosine: bool = setting(
        False, "also keep each voxel's best cosine of incidence (needs a bone map)", FLAG, metavar="", kept=False, label="Squareness"
    )


@dataclass(frozen=True, repr=False)
class Recipe(OutputSettings, MethodSettings, VolumeSettings, BoneSettings, ImagingSettings, ReadingSettings):
    """All that can be asked of a reconstruction, in one flat row of names: those of options, settings files and columns of a table.

    Its branches say what belongs together; a function that takes a branch takes a recipe too. Every setting is explained below, as the
    command line explains its option; docs/parameters.md has what they mean.

    Raises
    ------
    SettingsError
        When a value is not of its kind or outside its range, or is of no use without another that is missing.
    """

    def __repr__(self) -> str:
        given = self.given(*(spec.name for spec in fields(self)))
        return f"Recipe({', '.join(f'{name}={value!r}' for name, value in given.items())})"

    def given(self, *names: str) -> dict[str, Any]:
        """Those of these settings that are not at their defaults; of all without names."""
        values = {name: getattr(self, name) for name in names or RULES}
        return {name: value for name, value in values.items() if repr(value) != repr(RULES[name]["default"])}

    def left_open(self, *names: str) -> Recipe:
        """The same with these settings at their defaults."""
        return replace(self, **{name: RULES[name]["default"] for name in names})

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, needed in _NEEDED.items():
            if getattr(self, name) is not None and getattr(self, needed) is None:
                advice = "Give both {fan_angles_deg:A B} and {fan_radius_px:R0 R1}." if name.startswith("fan_") else ""
                raise SettingsError(f"Input {needed} is missing, and {name} needs it.", advice)


_NEEDED = {
    "fan_angles_deg": "fan_radius_px",
    "fan_radius_px": "fan_angles_deg",
    "fan_apex_px": "fan_radius_px",
    "fan_pixel_size": "fan_radius_px",
    "fan_detection": "fan_radius_px",
    "grid_size": "grid_to_reference",
    "grid_to_reference": "grid_size",
}
"""What is of no use without another."""

ReconstructionSettings = Recipe
"""The name that `Recipe` had before; scripts may have it."""

BRANCHES = (ReadingSettings, ImagingSettings, BoneSettings, VolumeSettings, MethodSettings, OutputSettings)
RULES: dict[str, Rule] = {spec.name: rule_of(spec.metadata) for branch in BRANCHES for spec in fields(branch)}
"""The rule of every setting."""

OF_READING, OF_IMAGES = (tuple(spec.name for spec in fields(branch)) for branch in (ReadingSettings, ImagingSettings))
OF_REGION = ("probe", "apex_px", "clip_px", *(name for name in OF_IMAGES if name.startswith("fan_")))
OF_GRID = ("spacing", "grid_size", "grid_to_reference")
OF_LABELS = ("bone_sigma_voxels", "bone_sigma_mm", "bone_belief", "bone_frames_px")
"""Names of settings: how a recording is read; what its images show, and which of that says region and probe; which voxels there are; how
labels or predictions become a bone map."""

KEPT = tuple(name for name, rule in RULES.items() if rule["kept"])
"""What volumes and settings files say."""


def _explained(name: str) -> str:
    """A setting as numpydoc has a parameter."""
    rule = RULES[name]
    kind = " or ".join(map(str, rule["choices"])) if rule["choices"] else rule["unit"] or rule["kind"]
    default = "" if rule["default"] is None else f" Default: {rule['default']!r}."
    of_files = "Of a recording that is read from a file: " if name in OF_READING and name not in ("skip", "motion") else ""
    return f"    {name} : {kind}\n        {of_files}{rule['help'][:1].upper()}{rule['help'][1:]}.{default}\n"


if Recipe.__doc__:  # not where Python leaves docstrings out
    _ORDER = sorted(RULES, key=lambda name: (name in OF_READING, name not in ("method", "spacing")))
    Recipe.__doc__ += "\n    Parameters\n    ----------\n" + "".join(map(_explained, _ORDER))
