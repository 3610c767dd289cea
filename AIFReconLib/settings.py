"""Every parameter of a reconstruction: name, default, range, unit and meaning, stated once.

The command line, the Slicer module and the documentation take them from here.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from numbers import Integral, Real
from typing import TypedDict, TypeVar, cast

from .compounding.methods.table import (
    DEFAULT_METHOD_WITH_BONE,
    DEFAULT_METHOD_WITHOUT_BONE,
    IN_WORDS,
    LINEAR_METHODS,
    METHODS,
    OWN_METHOD,
    is_own_method,
)
from .errors import SettingsError
from .message import listed

ENGINES = ("auto", "numpy", "numba")
INTERPOLATIONS = ("nearest", "linear")
AUTOMATIC = "auto"
"""Stands for a number that is chosen from the sweep."""
HOLE_FILLINGS = ("off", "nearest", "cube", "gaussian", "stick")

DEFAULT_SPACING = 0.5
"""mm, where neither the caller nor a configuration says."""


Value = TypeVar("Value")


class Rule(TypedDict):
    """What a parameter may be, and what a user interface says of it: the metadata of its field."""

    help: str
    unit: str
    minimum: float | None
    maximum: float | None
    choices: tuple[str, ...] | None
    default: object
    whole: bool
    word: str | None
    own: bool


def parameter(
    default: Value,
    help: str,
    *,
    unit: str = "",
    minimum: float | None = None,
    maximum: float | None = None,
    choices: tuple[str, ...] | None = None,
    whole: bool = False,
    word: str | None = None,
    own: bool = False,
) -> Value:
    """A dataclass field that carries what a user interface needs to know of it: where its default is None, None may be given.

    `word` is one that may be given instead of a number; `own`: the name of a method of the user's own is a choice too.
    """
    rule = Rule(help=help, unit=unit, minimum=minimum, maximum=maximum, choices=choices, default=default, whole=whole, word=word, own=own)
    return field(default=default, metadata=rule)


@dataclass(frozen=True)
class ReconstructionSettings:
    """How frames become a volume. Field metadata holds unit, range and help of each; see docs for the method.

    Raises
    ------
    SettingsError
        When a value is outside its range.
    """

    method: str | None = parameter(
        None,
        f"how pixels of a voxel are combined. {IN_WORDS}; the last: a method of your own "
        f"(default: {DEFAULT_METHOD_WITH_BONE} with bone, else the configuration's, else {DEFAULT_METHOD_WITHOUT_BONE})",
        choices=METHODS,
        own=True,
    )
    spacing: float | tuple[float, float, float] | None = parameter(
        None,
        f"distance between voxels, one number or x y z (default: the configuration's, else {DEFAULT_SPACING})",
        unit="mm",
        minimum=0.01,
        maximum=50.0,
    )
    alpha: float = parameter(0.1, "aif methods: how much well-insonified bone is brightened", minimum=0.0, maximum=10.0)
    beta: float = parameter(
        0.1, "smallest cosine of incidence that is compensated (0.1: beams up to 84.3 degrees)", minimum=0.001, maximum=1.0
    )
    bone_direction: str = parameter(
        "gradient",
        "where bone faces: gradient of the probability map (the paper), or of the smoothed bone surface",
        choices=("gradient", "surface"),
    )
    hole_limit: float | str = parameter(
        AUTOMATIC,
        "empty voxels take the nearest measured value up to this distance; 0: off; auto: from how far the frames lie apart, at most 4 "
        "(or the configuration's own hole filling)",
        unit="mm",
        minimum=0.0,
        maximum=20.0,
        word=AUTOMATIC,
    )
    holes: str | None = parameter(
        None,
        "how empty voxels within the limit are filled: nearest measured value; or as Plus does it, mean of the nearest cube, gaussian "
        "average, sticks that bridge gaps; off: not (default: nearest where a limit is given, else the configuration's way, else nearest)",
        choices=HOLE_FILLINGS,
    )
    interpolation: str | None = parameter(
        None,
        f"each pixel enters its nearest voxel, or spreads linearly over the eight around it ({listed(LINEAR_METHODS)} only; "
        "default: the configuration's, else nearest)",
        choices=INTERPOLATIONS,
    )
    pixel_rejection: float | None = parameter(
        None, "pixels darker than this gray level do not enter (default: the configuration's, else all enter)", minimum=0.0
    )
    speed_of_sound: float | None = parameter(
        None,
        "true speed of sound, where it is not the scanner's: pixels move along their beams (default: no correction)",
        unit="m/s",
        minimum=800.0,
        maximum=2500.0,
    )
    scanner_speed_of_sound: float = parameter(
        1540.0, "speed of sound that the scanner assumes; matters with the true one alone", unit="m/s", minimum=800.0, maximum=2500.0
    )
    intensity_maximum: float | None = parameter(
        None,
        "brightest value an image can hold (default: 255 for 8-bit images, else the largest of their type; none for float)",
        minimum=1e-6,
    )
    best_cosine: bool = parameter(False, "also keep each voxel's best cosine of incidence (needs a bone map)")
    skip: int | None = parameter(None, "use every N-th frame (default: the configuration's, else every one)", minimum=1, whole=True)
    engine: str = parameter(
        "auto",
        "what computes the volume; every engine gives the same voxels (auto: numba where it is installed, which is many times as fast)",
        choices=ENGINES,
    )
    output_type: str | None = parameter(
        None, "type of the intensity volume (default: uint8 for 8-bit images, else float32)", choices=("uint8", "float32")
    )

    bone_gain: float = parameter(
        4.0,
        "weighted: how much bone that a frame shows and the map expects is brightened, times up to 3 for oblique beams",
        minimum=0.0,
        maximum=10.0,
    )
    weight_floor: float = parameter(
        0.003, "weighted: weight of a pixel that shows no bone, against 1 of one that does", minimum=1e-6, maximum=1.0
    )

    def __post_init__(self) -> None:
        rules = {spec.name: rule_of(spec.metadata) for spec in fields(self)}
        for name, rule in rules.items():
            if name == "spacing" and isinstance(self.spacing, Iterable) and not isinstance(self.spacing, str):
                along_axes = tuple(self.spacing)
                if len(along_axes) != 3:
                    raise SettingsError(f"Input spacing must be one number or three (x y z); got {len(along_axes)}.")
                for number in along_axes:
                    check_value(name, number, {**rule, "default": DEFAULT_SPACING})
                object.__setattr__(self, "spacing", tuple(float(s) for s in along_axes))
            else:
                check_value(name, getattr(self, name), rule)

    def method_for(self, has_bone: bool) -> str:
        """The method to use, resolving the default by whether there is a bone map."""
        if self.method is not None:
            return self.method
        return DEFAULT_METHOD_WITH_BONE if has_bone else DEFAULT_METHOD_WITHOUT_BONE

    def spacing_xyz(self) -> tuple[float, float, float]:
        """Spacing along x, y, z in mm, with the default where none is set."""
        spacing = DEFAULT_SPACING if self.spacing is None else self.spacing
        return spacing if isinstance(spacing, tuple) else (float(spacing),) * 3


def rule_of(metadata: Mapping[str, object]) -> Rule:
    """The metadata of a settings' field as what it is."""
    return cast("Rule", metadata)


def check_value(name: str, value: object, rule: Rule) -> None:
    """Raise `SettingsError` unless `value` (a number, a word, a bool or None) obeys a field's metadata."""
    if value is None and rule["default"] is None:
        return
    if rule["choices"] is not None:
        if value not in rule["choices"] and not (rule["own"] and isinstance(value, str) and is_own_method(value)):
            choices = ", ".join([*rule["choices"], *([OWN_METHOD] if rule["own"] else [])])
            raise SettingsError(f"Input {name} must be one of {choices}; got {value!r}.")
        return
    if isinstance(rule["default"], bool):
        if not isinstance(value, bool):
            raise SettingsError(f"Input {name} must be True or False; got {value!r}.")
        return
    whole = rule["whole"]
    if isinstance(value, str) and value == rule["word"]:
        return
    if isinstance(value, bool) or not isinstance(value, Integral if whole else Real) or not math.isfinite(value):
        if whole:
            raise SettingsError(f"Input {name} must be a whole number; got {value!r}.")
        if rule["word"] is not None:
            raise SettingsError(
                "Input {name} must be a finite number or {word}; got {value!r}.".format(name=name, word=rule["word"], value=value)
            )
        raise SettingsError(f"Input {name} must be a finite number; got {value!r}.")
    number = float(value)
    unit = f" {rule['unit']}" if rule["unit"] else ""
    if rule["minimum"] is not None and number < rule["minimum"]:
        raise SettingsError(
            "Input {name} must be at least {minimum:g}{unit}; got {value!r}.".format(
                name=name, minimum=rule["minimum"], unit=unit, value=value
            )
        )
    if rule["maximum"] is not None and number > rule["maximum"]:
        raise SettingsError(
            "Input {name} must be at most {maximum:g}{unit}; got {value!r}.".format(
                name=name, maximum=rule["maximum"], unit=unit, value=value
            )
        )
