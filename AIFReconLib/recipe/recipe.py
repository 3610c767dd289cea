"""Every setting of a reconstruction: name, default, range, unit and meaning.

A setting is declared here, once, and used where its value matters. The docstring of its branch explains it.
Options of all commands, settings files, headers of volumes, columns of a table of cases, and the panel's fields follow from both.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Reals
from ..compounding.methods.method import CompoundingMethod
from ..compounding.methods.table import DEFAULT_METHOD_WITH_BONE, DEFAULT_METHOD_WITHOUT_BONE, IN_WORDS, METHODS, MethodName
from ..errors import SettingsError
from ..geometry.volume import VoxelGrid
from .rules import FILE, FLAG, MATRIX, NUMBERS, TEXT, WHOLE, Rule, checked, explained, rule_of, setting

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


def _numbers(*counts: int, **more: Any) -> Any:
    return setting(None, kind=NUMBERS, counts=counts, **more)


@dataclass(frozen=True)
class Branch:
    """Settings that belong together; its docstring says what each takes and what it means.

    Raises SettingsError when a value is not of its kind, or outside its range.
    """

    def __init_subclass__(cls) -> None:
        for name, (takes, meaning) in explained(cls).parameters.items():
            told = {"help": meaning, **({"metavar": takes} if takes else {})}
            cls.__dict__[name].metadata = {**cls.__dict__[name].metadata, **told}

    def __post_init__(self) -> None:
        for spec in fields(self):
            value = getattr(self, spec.name)
            if value is not spec.default:
                object.__setattr__(self, spec.name, checked(spec.name, value, rule_of(spec.metadata)))


@dataclass(frozen=True)
class ReadingSettings(Branch):
    """How a recording is read. What its file does not say, or says wrongly, counts where the file is read.

    Parameters
    ----------
    image_to_reference : NAME
        transform that places the image, as recorded or as a chain (default: ImageToReference); of several
        ways the one to take, as in ImageToProbe,ProbeToReference
    reference : FRAME
        frame to reconstruct in, e.g. Tracker (default: Reference)
    orientation : CODE
        how the stored pixels run: MF, MN, UF or UN (default: as the file says)
    time_offset : S
        add this to the images' time stamps, as Plus's LocalTimeOffsetSec of the image device does, and
        interpolate the poses (negative: images come late; positive: poses do)
    longest_gap : S
        do not interpolate between poses farther apart than this
    skip
        use every N-th frame (default: the configuration's, else every one)
    motion
        take out of the poses how the patient moved, as the bone echoes show it; off: not (default:
        auto for weighted)
    """

    image_to_reference: str | None = setting(None, kind=TEXT)
    reference: str | None = setting(None, kind=TEXT)
    orientation: str | None = setting(None, kind=TEXT, label="Stored pixels:")
    time_offset: float = setting(0.0, unit="s", label="Time offset:", decimals=3)
    longest_gap: float = setting(LONGEST_GAP, unit="s", label="Longest gap:", decimals=2)
    skip: int | None = setting(None, kind=WHOLE, minimum=1, label="Every N-th frame:", preset=True)
    motion: str | None = setting(None, choices=(AUTOMATIC, "off"))


@dataclass(frozen=True)
class ImagingSettings(Branch):
    """What the images show, and which of their pixels count. What is left open is the configuration's, else recognized.

    Parameters
    ----------
    probe
        shape of the beams
    apex_px : COLUMN ROW
        virtual apex of a sector probe
    clip_px : X Y W H
        use this rectangle of the image (columns X to X + W); four zeros: all of it
    fan_angles_deg : A B
        use this fan about the apex, from +y toward +x
    fan_radius_px : R0 R1
        between these radii about the apex; 0 0: no fan
    fan_apex_px
        apex of the fan, where it is not the probe's
    fan_pixel_size
        size of a pixel of a fan in mm, in whose unit the radii are then
    fan_detection
        the fan is narrowed in each frame to what is lit: gray level, radius of a filter in pixels
    importance_mask : IMAGE
        weight of each pixel in an average: 8-bit gray image as large as the frames, 0 does not count
    pixel_rejection
        pixels darker than this gray level are left out (default: the configuration's, else none)
    intensity_maximum
        brightest value an image can hold (default: 255 for 8-bit images, else the largest of their type; none
        for float)
    gray_levels
        gray levels of the images that are taken to those of the standard scale
    speed_of_sound
        true speed of sound, where it is not the scanner's: pixels move along their beams (default: no
        correction)
    scanner_speed_of_sound
        speed of sound that the scanner assumes; matters with the true one alone
    """

    probe: str = setting(AUTOMATIC, choices=PROBES, label="Probe:")
    apex_px: tuple[float, float] | None = _numbers(2, label="Apex:")
    clip_px: tuple[float, float, float, float] | None = _numbers(4, label="Clip rectangle:")
    fan_angles_deg: tuple[float, float] | None = _numbers(2, label="Fan angles:")
    fan_radius_px: tuple[float, float] | None = _numbers(2, label="Fan radii:")
    fan_apex_px: tuple[float, float] | None = _numbers(2, metavar="")
    fan_pixel_size: tuple[float, float] | None = _numbers(2, metavar="")
    fan_detection: tuple[float, float] | None = _numbers(2, metavar="")
    importance_mask: Path | Reals | None = setting(None, kind=FILE, label="Pixel weights:")  # noqa: RUF009  # it is a field
    pixel_rejection: float | None = setting(None, minimum=0.0, label="Darkest pixel:")
    intensity_maximum: float | None = setting(None, minimum=1e-6, label="Brightest value:")
    gray_levels: tuple[float, ...] | None = _numbers(8, metavar="")
    speed_of_sound: float | None = _speed(None, label="Speed of sound:")
    scanner_speed_of_sound: float = _speed(SCANNER_SPEED, label="Scanner's speed:")


@dataclass(frozen=True)
class BoneSettings(Branch):
    """How what is known of bone becomes a map of it.

    Parameters
    ----------
    bone_from_sweep
        no CT: take for bone what is bright with darkness behind it in the sweep itself
    bone_frames_px : X Y W H
        rectangle of the frame that a prediction covers, where it has not the size of one
    bone_sigma_voxels
        smoothing of the bone map, in voxels of the labels (default: 10, but for weighted)
    bone_sigma_mm : MM
        the same in mm, or auto: by how well CT and sweep agree (default of weighted: auto)
    bone_belief
        how far labels are believed, above 0 to 1 (default: 1; less where a width that is found turns out
        wide)
    bone_direction
        where bone faces: gradient of the probability map (the paper), or of the smoothed bone surface
    """

    bone_from_sweep: bool = setting(False, kind=FLAG)
    bone_frames_px: tuple[float, float, float, float] | None = _numbers(4)
    bone_sigma_voxels: float | None = setting(None, label="Tolerance:", preset=True)
    bone_sigma_mm: float | str | None = setting(None, word=AUTOMATIC, preset=True)
    bone_belief: float | None = setting(None)
    bone_direction: str = setting("gradient", choices=("gradient", "surface"), label="Bone faces by:", preset=True)


@dataclass(frozen=True)
class VolumeSettings(Branch):
    """The voxels, and what becomes of empty ones.

    Parameters
    ----------
    spacing : MM
        distance between voxels, one number or x y z (default: the configuration's, else 0.5)
    grid_size
        voxels along x, y, z of the box
    grid_to_reference
        where the voxels of the box are in Reference
    hole_limit : MM
        empty voxels take the nearest measured value up to this distance; 0: off; auto: from how far the
        frames lie apart, at most 4 (or the configuration's own hole filling)
    holes
        how empty voxels within the limit are filled: nearest measured value; or as Plus does it, mean of the
        nearest cube, gaussian average, sticks that bridge gaps; off: not (default: nearest where a limit is
        given, else the configuration's way, else nearest)
    """

    spacing: float | tuple[float, float, float] | None = _numbers(
        1, 3, unit="mm", minimum=0.01, maximum=50.0, label="Voxel size:", decimals=2, preset=True
    )
    grid_size: tuple[int, int, int] | None = _numbers(3, metavar="")
    grid_to_reference: tuple[tuple[float, ...], ...] | None = setting(None, kind=MATRIX, metavar="")
    hole_limit: float | str = setting(
        AUTOMATIC, unit="mm", minimum=0.0, maximum=20.0, word=AUTOMATIC, label="Fill gaps up to:", preset=True
    )
    holes: str | None = setting(None, choices=HOLE_FILLINGS, label="Fill them by:", preset=True)

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
    """How pixels become a voxel.

    Parameters
    ----------
    alpha
        aif methods: how much well-insonified bone is brightened
    beta
        smallest cosine of incidence that is compensated (0.1: beams up to 84.3 degrees)
    bone_gain
        weighted: how much bone that a frame shows and the map expects is brightened, times up to 3 for
        oblique beams
    weight_floor
        weighted: weight of a pixel that shows no bone, against 1 of one that does
    interpolation
        each pixel enters its nearest voxel, or spreads linearly over the eight around it (average, latest,
        maximum only; default: the configuration's, else nearest)
    engine
        what computes the volume; every engine gives the same voxels (auto: numba where it is installed, which
        is several times as fast)
    """

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
    alpha: float = setting(0.1, minimum=0.0, maximum=10.0, label="Brighten bone:", decimals=2, preset=True)
    beta: float = setting(0.1, minimum=0.001, maximum=1.0, label="Flattest angle:", decimals=3, preset=True)
    bone_gain: float = setting(4.0, minimum=0.0, maximum=10.0, label="Bone contrast:", decimals=2, preset=True)
    weight_floor: float = setting(0.003, minimum=1e-6, maximum=1.0, label="Weight of the rest:", decimals=3, preset=True)
    interpolation: str | None = setting(None, choices=INTERPOLATIONS, label="Between voxels:", preset=True)
    engine: str = setting("auto", choices=ENGINES, label="Computed by:")

    def method_for(self, has_bone: bool) -> str:
        """The method to use, resolving the default by whether there is a bone map."""
        if self.method is not None:
            return self.method if isinstance(self.method, str) else self.method.name
        return DEFAULT_METHOD_WITH_BONE if has_bone else DEFAULT_METHOD_WITHOUT_BONE


@dataclass(frozen=True)
class OutputSettings(Branch):
    """What comes of it.

    Parameters
    ----------
    output_type
        type of the intensity volume (default: uint8 for 8-bit images, else float32)
    best_cosine
        also keep each voxel's best cosine of incidence (needs a bone map)
    """

    output_type: str | None = setting(None, choices=("uint8", "float32"), label="Stored as:")
    best_cosine: bool = setting(False, kind=FLAG, metavar="", kept=False, label="Squareness")


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
