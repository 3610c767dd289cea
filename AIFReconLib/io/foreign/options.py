"""What files of images and poses do not say: options of the command line and questions of the panel, each declared once."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable
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
        "size of a pixel in mm, where poses take millimeters", minimum=1e-6, metavar="X Y", label="Size of a pixel (mm, x y):"
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
        "frames per second of the images, where no file has their times", unit="Hz", minimum=1e-6, metavar="HZ", label="Images per second:"
    )
    times: Path | None = _file(  # noqa: RUF009  # it is a field
        "when each image was taken, where its file does not tell: a table of one time an image, with or without its name"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        parse_orientation(self.orientation)
        order = self.euler_order
        if order not in (None, VECTOR) and not (re.fullmatch("[xyz]{3}|[XYZ]{3}", order) and order[0] != order[1] != order[2]):
            must = "must be three axes, as xyz (fixed axes) or ZYX (axes that turn along), or vector"
            raise SettingsError(f"Input euler_order {must}; got {order!r}. See the tracker's manual.")

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


_PARSERS: dict[str, Callable[[str], Any]] = {
    FLAG: "yes".__eq__,
    WORDS: lambda text: [word.strip() for word in text.split(",") if word.strip()],
    NUMBERS: lambda text: [float(word) for word in text.replace(",", " ").split()],
    NUMBER: float,
}

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
    rules = {name: RULES[name] for name in sentence.settings if name in RULES}
    return tuple(_Question(n, rule, ("yes", "no") if rule["kind"] == FLAG else rule["choices"] or others) for n, rule in rules.items())


def answer(name: str, text: str) -> Any:
    """The value of an option that a text means, several with commas or blanks between them; None of an empty text.

    Raises SettingsError when it is none.
    """
    rule, text = RULES[name], text.strip()
    value: Any = text
    if not text:
        return rule["default"]
    with contextlib.suppress(ValueError):  # a text is none of these numbers, and is refused
        value = _PARSERS.get(rule["kind"], str)(text)
    return checked(name, value, rule)
