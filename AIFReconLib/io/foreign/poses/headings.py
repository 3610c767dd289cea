"""What a column of a table of poses holds, by its heading: a short list of synonyms, and the headings of makers, as data.

What is none of these, with a tool's name before or behind it or without, is asked for (`tracks.py`).
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

TIME, FRAME, TOOL, IMAGE, STATUS, OCCLUDED = "time", "frame", "tool", "image", "status", "occluded"
RECEIVED = "received"
"""When a message of ROS came in; it counts where the message itself has no time."""

TRANSLATION = ("x", "y", "z")
QUATERNION = ("qx", "qy", "qz", "qw")
UNORDERED_QUATERNION = ("q0", "q1", "q2", "q3")
EULER = ("rx", "ry", "rz")
UNNAMED_EULER = ("e0", "e1", "e2")
"""Euler angles in the order of the turns, where they have no names."""

KUKA = ("a", "b", "c")
"""A about Z, then B about the new Y, then C about the new X (KUKA System Software, operating instructions); deg."""

AZIMUTH = ("azimuth", "elevation", "roll")
"""About Z, the new Y and the new X (Polhemus and Ascension, user manuals); deg."""

ROTATION_VECTOR = ("vx", "vy", "vz")
MATRIX = tuple(f"m{row}{column}" for row in range(4) for column in range(4))
TURN = tuple(name for name in MATRIX if name[1] < "3" and name[2] < "3")
"""The nine of a rotation."""

COUNTED_TURN = tuple(f"n{number}" for number in range(9))
"""The same without names, row by row or column by column."""

WAYS = (TURN, COUNTED_TURN, QUATERNION, UNORDERED_QUATERNION, ROTATION_VECTOR, EULER, UNNAMED_EULER, KUKA, AZIMUTH)
"""Ways to say a rotation; where a table has several, the first of these counts."""

POSE = frozenset(name for way in (MATRIX, TRANSLATION, *WAYS) for name in way)

QUATERNION_ORDERS = ("xyzw", "wxyz")
LENGTHS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}
ANGLES = ("deg", "rad")
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "100ns": 1e-7, "ns": 1e-9}
LONG_TIMES = {"min": 60.0, "h": 3600.0}
_UNITS = {
    word: unit
    for unit, words in {
        "mm": "mm millimeter millimeters millimetre millimetres",
        "cm": "cm centimeter centimeters centimetre centimetres",
        "m": "m meter meters metre metres",
        "in": "in inch inches",
        "deg": "deg degree degrees °",
        "rad": "rad radian radians",
        "s": "s sec secs second seconds",
        "ms": "ms msec msecs millis millisec millisecond milliseconds",
        "us": "us µs usec usecs micros microsec microsecond microseconds",
        "ns": "ns nsec nsecs nanos nanosec nanosecs nanosecond nanoseconds",
        "min": "min minute minutes",
        "h": "h hour hours",
        "": "ft hz fps % count counts v unitless none quaternion nm n deg/s mm/s m/s rad/s",
    }.items()
    for word in words.split()
}
"""Of the words of units; of those that say nothing of a pose, nothing."""

_ALONE = "t ts id name a b c el az roll e0 e1 e2 port object subject station body device sample segment"
ALONE = frozenset(_ALONE.split())
"""Headings that mean something only where they stand alone, or beside a tool's name on one side."""

_INDEXED = re.compile(
    r"(m|r|rot|rotation|rotmat|mat|matrix|transform|tform|q|quat|quaternion|orientation|t|trans|translation|pos|position)(\d\d?)"
)
_PLACE_WORDS = ("t", "trans", "translation", "pos", "position")


@cache
def _tables() -> dict[str, Any]:
    tables: dict[str, Any] = json.loads(Path(__file__).with_name("pose_tables.json").read_text("utf-8"))
    return tables


@cache
def _roles() -> dict[str, str]:
    return {spelling: role for role, spellings in _tables()["headings"].items() for spelling in spellings}


@dataclass(frozen=True)
class Column:
    """A column: its heading, what it holds and in which unit, and the words of its heading."""

    heading: str
    role: str | None = None
    unit: str | None = None
    words: tuple[str, ...] = ()


@dataclass(frozen=True)
class Preset:
    """A maker's layout: headings of its own or names of its columns in order, and what its files leave unsaid.

    Parameters
    ----------
    maker : str
    headings : dict of str to str
        What they hold, with a unit behind a colon.
    columns : tuple of str
    said : dict
        Fields of `PoseFormat`.
    """

    maker: str
    headings: dict[str, str] = field(default_factory=dict)
    columns: tuple[str, ...] = ()
    said: dict[str, Any] = field(default_factory=dict)


def preset_of(table: dict[str, Any]) -> Preset:
    """A layout as JSON has it: ``columns`` or ``headings``, and fields of `PoseFormat`."""
    own = {name: value for name, value in table.items() if name not in ("name", "maker", "columns", "headings", "needs", "above")}
    columns = table.get("columns", ())
    return Preset(
        str(table.get("maker", "")), dict(table.get("headings", {})), tuple(columns.split() if isinstance(columns, str) else columns), own
    )


def preset_called(name: str) -> Preset | None:
    """The layout of that name."""
    return next((preset_of(each) for each in _tables()["makers"] if each["name"] == name.lower()), None)


def preset_for(headings: Sequence[str], above: Sequence[Sequence[str]]) -> Preset | None:
    """The layout of the maker whose headings, or words above them, these are."""
    plain = {_plain(heading) for heading in headings}
    title = {cell for cells in above for cell in cells}
    for each in _tables()["makers"]:
        needed = {*each.get("needs", ()), *(() if "above" in each else each.get("headings", {}))}
        if each.get("above") in title or ("above" not in each and "columns" not in each and needed <= plain):
            return preset_of(each)
    return None


def are_headings(cells: Sequence[str]) -> bool:
    """Whether words tell what columns hold: three things at least."""
    found = {field for cell in cells if cell for _, field in parts_of(column_of(cell).words)}
    return len(found) >= 3


def is_unit(cell: str) -> bool:
    """Whether a word below the headings is the unit of a column."""
    return cell.strip("()[] ").lower() in _UNITS


@cache
def column_of(heading: str, above: tuple[str, ...] = (), unit: str = "") -> Column:
    """The column with this heading, below these words that several columns share, in this unit."""
    said = _UNITS.get(unit.strip("()[] ").lower()) or None
    bare = heading
    for bracket in re.findall(r"[(\[]([^)\]]*)[)\]]", heading):
        if is_unit(bracket):
            said, bare = _UNITS[bracket.strip().lower()] or said, heading.replace(f"({bracket})", " ").replace(f"[{bracket}]", " ")
    if heading.strip().lower().startswith("%time"):
        return Column(heading, RECEIVED, said)
    words = [word for each in (*above, bare) for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-zµ]+|\d+", each)]
    last = _UNITS.get(words[-1] if len(words[-1]) < 3 else words[-1].lower()) if words else None  # M is a name
    if last and len(words) > 1 and any(takes(field, last) for _, field in parts_of(tuple(words[:-1]))):
        words, said = words[:-1], last
    elif last and words and (last in TIMES or last in LONG_TIMES) and not parts_of(tuple(words)):
        return Column(heading, TIME, last)  # sec, nanosec, minutes: a time by its unit
    return Column(heading, meaning("".join(words)), said, tuple(words))


def takes(field: str, unit: str) -> bool:
    """Whether a column that holds this can be in that unit."""
    if field in (TIME, RECEIVED):
        return unit in TIMES or unit in LONG_TIMES
    return unit in (LENGTHS if field in TRANSLATION or field[:-1] in _PLACE_WORDS else ANGLES)


def meaning(word: str) -> str | None:
    """What a heading without marks and units holds; numbered ones stay as they are until `numbered` has all of them."""
    word = word.lower()
    return _roles().get(word) or (f"#{word}" if _INDEXED.fullmatch(word) else None)


@cache
def parts_of(words: tuple[str, ...]) -> tuple[tuple[tuple[str, str], str], ...]:
    """Every way to read words as what a column holds with a tool's name before it, behind it, or none; the longest first."""
    found = []
    for start in range(len(words)):
        for end in range(len(words), start, -1):
            word = "".join(words[start:end]).lower()
            role = meaning(word)
            if role is not None and (start == 0 or end == len(words) or word not in ALONE):
                found.append((end - start, (" ".join(words[:start]), " ".join(words[end:])), role))
    return tuple((tool, role) for _, tool, role in sorted(found, key=lambda each: -each[0]))


def numbered(roles: set[str]) -> dict[str, str]:
    """What numbered headings of one tool hold, told by how many there are: a matrix, a quaternion, a translation."""
    names: dict[str, str] = {}
    found: dict[str, set[str]] = {}
    for role in roles:
        if (indexed := _INDEXED.fullmatch(role.removeprefix("#"))) and role.startswith("#"):
            found.setdefault(indexed[1], set()).add(indexed[2])
    for base, digits in found.items():
        for pattern, fields in _patterns(base):
            if set(pattern) <= digits and (len(pattern) >= 9 or digits == set(pattern)):
                names |= {f"#{base}{digit}": name for digit, name in zip(pattern, fields)}
                break
    turned = {"ox", "oy", "oz"}
    if turned <= roles:
        names |= {name: f"{'q' if 'ow' in roles else 'r'}{name[1]}" for name in (*turned, "ow")}
    if {"#q0", "qx", "qy", "qz"} <= roles:
        names["#q0"] = "qw"
    if not {"azimuth", "elevation"} <= roles:
        names |= {"roll": "rx", "pitch": "ry", "yaw": "rz"}
    return names


def _patterns(base: str) -> list[tuple[list[str], tuple[str, ...]]]:
    """How numbered headings with this beginning are told, and what they hold; the largest first."""

    def pairs(start: int, count: int) -> list[str]:
        return [f"{row + start}{column + start}" for row in range(count) for column in range(count)]

    def counted(start: int, count: int) -> list[str]:
        return [str(number + start) for number in range(count)]

    if base in _PLACE_WORDS:
        return [(counted(start, 3), TRANSLATION) for start in (0, 1)]
    quaternions: list[tuple[list[str], tuple[str, ...]]] = [(counted(start, 4), UNORDERED_QUATERNION) for start in (0, 1)]
    if base in ("q", "quat", "quaternion", "orientation"):
        return quaternions
    whole = [pairs(0, 4), pairs(1, 4), counted(0, 16), counted(1, 16)]
    found = [(names[:count], MATRIX[:count]) for count in (16, 12) for names in whole]
    return [*found, *((pairs(start, 3), TURN) for start in (0, 1)), *((counted(start, 9), COUNTED_TURN) for start in (0, 1)), *quaternions]


def _plain(heading: str) -> str:
    return re.sub("[^a-z0-9]", "", heading.lower())
