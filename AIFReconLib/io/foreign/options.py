"""What files of images and poses do not say: options of the command line and questions of the panel, each declared once."""

from __future__ import annotations

import contextlib
import re
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any

from ...errors import SettingsError
from ...geometry.transform_graph import TransformName
from ...message import message_of
from ...recipe.recipe import AUTOMATIC, Branch
from ...recipe.rules import FILE, FLAG, NUMBER, NUMBERS, TEXT, WORDS, Rule, checked, rule_of, setting
from ..sequence.orientation import parse_orientation
from .poses.headings import ANGLES, LENGTHS, QUATERNION_ORDERS, TIMES, VECTOR

_unsaid = partial(setting, None)
_text = partial(_unsaid, kind=TEXT)
_pair = partial(_unsaid, kind=NUMBERS, counts=(2,))
_file = partial(_unsaid, kind=FILE, metavar="FILE")


@dataclass(frozen=True)
class ImportOptions(Branch):
    """How images and poses are to be understood, where the files leave it open. Their names are those of the options of `aifrecon import`.

    Raises SettingsError when a value is not of its kind.

    Euler angles with names belong to the axes of those names; without, they come in the order of the turns. What is None is as the file
    says.
    """

    transform: str | None = _text(
        "what the poses are, direction included: ImageToTracker, ProbeToTracker, or an inverse such as TrackerToProbe", metavar="NAME"
    )
    columns: str | None = _text(
        'what they hold, in order ("time x y z qw qx qy qz", - for one that is not used), by number or heading ("time_ms=3 x=Tx"), '
        "or a preset: tum, hololens, or a .json of your own",
        metavar="WORDS",
        label="Names of the columns:",
    )
    tool: str | None = _text(
        "the one whose poses are taken, where the file holds several: its name or place", metavar="NAME", label="Tool that holds the image:"
    )
    reference_tool: str | None = _text(
        "the marker on the patient, in the same file: it becomes the frame Reference", metavar="NAME", label="Marker on the patient:"
    )
    time_offset: float | str = setting(
        0.0,
        f"how long after the poses the images began: 2 where they began 2 s later, -2 where earlier; {AUTOMATIC}: found, and applied",
        unit="s",
        word=AUTOMATIC,
        metavar="S",
        label="Images began later by (s):",
    )
    quaternion_order: str | None = _unsaid(
        "of a quaternion whose numbers have no names", choices=QUATERNION_ORDERS, label="Order of the quaternion:"
    )
    euler_order: str | None = _text(
        "order of the turns: xyz about fixed axes, ZYX about axes that turn along; vector: a rotation vector",
        metavar="AXES",
        label="Order of the turns:",
    )
    angle_unit: str | None = _unsaid("of angles (default: as the file says)", choices=ANGLES, label="Unit of the angles:")
    units: str | None = _unsaid(
        "of lengths in the poses (default: as the file says, else mm)", choices=tuple(LENGTHS), label="Unit of the lengths:"
    )
    time_unit: str | None = _unsaid(
        "of times in the poses (default: as the file says, or by their size)", choices=tuple(TIMES), label="Unit of the times:"
    )
    status_ok: tuple[str, ...] | None = _unsaid(
        "words of the tracker that mean a valid pose", WORDS, metavar="WORD", label="Words for a valid pose:"
    )
    column_major: bool | None = _unsaid("matrices are written column by column", FLAG, label="Matrices column by column:")
    sure: bool = setting(False, "take poses as they are where no hand moves so", FLAG, label="It is right as it is:")
    spacing: tuple[float, float] | None = _pair(
        "size of a pixel in mm, where poses take millimeters", metavar="X Y", label="Size of a pixel (mm, x y):"
    )
    image_origin_px: tuple[float, float] | None = _pair(
        "the pixel that the poses place (default: 0 0)", metavar="COLUMN ROW", label="Pixel that is placed:"
    )
    calibration: str | None = _text(
        "ImageToProbe: Plus configuration, Slicer transform or 16 numbers", metavar="[NAME=]FILE", label="Calibration:"
    )
    calibration_unit: str | None = _unsaid(
        "of lengths in the calibration (default: mm)", choices=tuple(LENGTHS), label="Unit of the calibration:"
    )
    orientation: str = setting("MF", "how the pixels run: MF, MN, UF or UN", TEXT, metavar="CODE", label="Stored pixels:")
    rate: float | None = _unsaid(
        "frames per second of the images, where no file has their times", unit="Hz", metavar="HZ", label="Images per second:"
    )
    times: Path | None = _file(  # noqa: RUF009  # it is a field
        "when each image was taken, where its file does not tell: a table of one time an image, with or without its name"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        parse_orientation(self.orientation)
        if self.spacing is not None and min(self.spacing) <= 0:
            raise SettingsError(f"Input spacing must be two numbers above 0, in mm per pixel; got {self.spacing!r}.")
        if self.rate is not None and self.rate <= 0:
            raise SettingsError(f"Input rate must be above 0 frames per second; got {self.rate!r}.")
        order = self.euler_order
        if order not in (None, VECTOR) and not (re.fullmatch("[xyz]{3}|[XYZ]{3}", order) and order[0] != order[1] != order[2]):
            raise SettingsError(
                f"Input euler_order must be three axes, as xyz (fixed axes) or ZYX (axes that turn along), or vector; got {order!r}. See "
                "the tracker's manual."
            )

    @property
    def poses_of(self) -> TransformName:
        """What the poses are: ImageToTracker takes the image's points to the tracker, TrackerToProbe is the inverse of ProbeToTracker."""
        if self.transform is None:
            raise SettingsError("Input transform must say what the poses are, such as ImageToTracker or ProbeToTracker; got none.")
        return TransformName.parse(self.transform)

    @property
    def column_names(self) -> tuple[str, ...] | None:
        """Of the columns, in order or as they are assigned."""
        return tuple(self.columns.replace(",", " ").split()) if self.columns else None


RULES: dict[str, Rule] = {spec.name: rule_of(spec.metadata) for spec in fields(ImportOptions)}
"""By option."""


@dataclass(frozen=True)
class _Question:
    """What an error asks: the option that answers, what is declared of it, and the answers there are, as far as they are known."""

    name: str
    rule: Rule
    choices: tuple[str, ...]


def questions_of(asking: object) -> tuple[_Question, ...]:
    """What an error or a sentence asks, the likeliest first; nothing where no option would help.

    `choices` of its details answer what has none declared.
    """
    sentence = message_of(asking)
    known = sentence.details.get("choices")
    others = tuple(map(str, known)) if isinstance(known, tuple | list) else ()
    return tuple(_Question(name, RULES[name], _choices(RULES[name]) or others) for name in sentence.settings if name in RULES)


def _choices(rule: Rule) -> tuple[str, ...]:
    return ("yes", "no") if rule["kind"] == FLAG else rule["choices"] or ()


def answer(name: str, text: str) -> Any:
    """The value of an option that a text means, several with commas or blanks between them; None of an empty text.

    Raises SettingsError when it is none.
    """
    rule, text = RULES[name], text.strip()
    value: Any = text
    if not text:
        return rule["default"]
    if rule["kind"] == FLAG:
        return text == "yes"
    if rule["kind"] == WORDS:
        value = [word.strip() for word in text.split(",") if word.strip()]
    with contextlib.suppress(ValueError):  # a text is none of these numbers, and is refused
        if rule["kind"] == NUMBERS:
            value = [float(word) for word in text.replace(",", " ").split()]
        elif rule["kind"] == NUMBER:
            value = float(text)
    return checked(name, value, rule)
