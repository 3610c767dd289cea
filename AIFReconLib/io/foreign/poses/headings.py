"""What a column of a table of poses holds, by its heading: synonyms, units and the layouts of makers are data (`pose_tables.json`).

What is none of these, with a tool's name before or behind it or without, is asked for (`tracks.py`).
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from ....message import listed, shorten

TABLES: dict[str, Any] = json.loads(Path(__file__).with_name("pose_tables.json").read_text("utf-8"))

TIME, FRAME, TOOL, IMAGE, STATUS, OCCLUDED = "time", "frame", "tool", "image", "status", "occluded"

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
TURN = tuple(name for name in MATRIX if "3" not in name)
"""The nine of a rotation."""

COUNTED_TURN = tuple(f"n{number}" for number in range(9))
"""The same without names, row by row or column by column."""

WAYS = (TURN, COUNTED_TURN, QUATERNION, UNORDERED_QUATERNION, ROTATION_VECTOR, EULER, KUKA, AZIMUTH, UNNAMED_EULER)
"""Ways to say a rotation; where a table has several, the first of these counts."""

POSE = frozenset(name for way in (MATRIX, TRANSLATION, *WAYS) for name in way)

QUATERNION_ORDERS = ("xyzw", "wxyz")
VECTOR = "vector"
"""In the place of an order of Euler angles: the three numbers are a rotation vector, axis times angle."""

LENGTHS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}
ANGLES = ("deg", "rad")
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "100ns": 1e-7, "ns": 1e-9}
LONG_TIMES = {"min": 60.0, "h": 3600.0}

_UNITS = {word: unit for unit, words in TABLES["units"].items() for word in words.split()}
"""Of the words of units; of those that say nothing of a pose, nothing."""

_ROLES = {spelling: role for role, spellings in TABLES["headings"].items() for spelling in spellings.split()}
_LONGEST = 4
"""Words of the longest synonym."""

_NUMBERED = re.compile(f"({'|'.join({name for each in TABLES['numbered'] for name in each['names'].split()})})" + r"(\d\d?)")

_IDENTITY = re.compile(r"[0-9A-Fa-f]{32}|\d+")
"""Of a rigid body, as Motive numbers it."""


@dataclass(frozen=True)
class Column:
    """A column: its heading, what it holds and in which unit, the words of its heading, its tool where its place tells it, and what is
    written above it."""

    heading: str
    role: str | None = None
    unit: str | None = None
    words: tuple[str, ...] = ()
    tool: str = ""
    above: tuple[str, ...] = ()

    def readings(self) -> tuple[tuple[tuple[str, str, str], str], ...]:
        """Every way to read it: the tool's name by its place, before and behind, and what the column holds."""
        known = readings_of(self.words) if self.words else ((("", ""), self.role),) if self.role else ()
        return tuple(((self.tool, *name), role) for name, role in known)


def in_words_of_the_table(columns: Collection[Column]) -> str:
    """Columns as the table calls them: by what stands above several, without numbers that identify a body, or by their headings."""
    above = (" ".join(word for word in each.above if not _IDENTITY.fullmatch(word)) * (each.role not in (TIME, FRAME)) for each in columns)
    return shorten(listed(dict.fromkeys(filter(None, (title or each.heading for title, each in zip(above, columns))))), 400)


def layout_of(headings: Sequence[str], above: Sequence[Sequence[str]]) -> dict[str, Any]:
    """The layout of the maker whose headings, or words above them, these are; empty where it is nobody's."""
    plain, title = set(map(plain_word, headings)), {cell for cells in above for cell in cells}
    known = (m for m in TABLES["makers"] if m.get("above") in title or ("needs" in m and plain.issuperset(m["needs"].split())))
    return next(known, {})


def plain_word(heading: str) -> str:
    """A heading in small letters, without marks."""
    return re.sub("[^a-z0-9]", "", heading.lower())


def unit_of(word: str) -> str | None:
    """The unit that a word is, nothing for one that says nothing of a pose; None for other words."""
    return _UNITS.get(word.strip("()[] ").lower())


@cache
def column_of(heading: str, above: tuple[str, ...] = ()) -> Column:
    """The column with this heading, below these words that several columns share."""
    named, bare = "", heading
    for bracket in re.findall(r"[(\[][^)\]]*[)\]]", heading):
        if (unit := unit_of(bracket)) is not None:
            named, bare = unit or named, bare.replace(bracket, " ")
    words = [word for each in (*above, bare) for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-zµ]+|\d+", each)]
    last = _UNITS.get(words[-1] if len(words[-1]) < 3 else words[-1].lower()) if words else None  # M is a name
    if last and len(words) > 1 and any(_takes(field, last) for _, field in readings_of(tuple(words[:-1]))):
        words, named = words[:-1], last
    elif last and _takes(TIME, last) and not readings_of(tuple(words)):
        return Column(heading, TIME, last)  # sec, nanosec, minutes: a time by its unit
    return Column(heading, _meaning("".join(words)), named or None, tuple(words))


def _takes(field: str, unit: str) -> bool:
    """Whether a column that holds this can be in that unit."""
    if field == TIME:
        return unit in {*TIMES, *LONG_TIMES}
    return unit in (LENGTHS if field in TRANSLATION or field.startswith(("#t", "#pos")) else ANGLES)


def _meaning(word: str) -> str | None:
    """What a heading without marks and units holds; numbered ones stay as they are until `numbered` has all of them."""
    word = word.lower()
    return _ROLES.get(word) or (f"#{word}" if _NUMBERED.fullmatch(word) else None)


@cache
def readings_of(words: tuple[str, ...]) -> tuple[tuple[tuple[str, str], str], ...]:
    """Every way to read words as what a column holds with a tool's name before it or behind it, or none; the longest first."""
    found: dict[tuple[tuple[str, str], str], None] = {}
    for count in range(min(len(words), _LONGEST), 0, -1):
        before, behind = words[:-count], words[count:]
        for name, held in ((" ".join(before), ""), words[-count:]), (("", " ".join(behind)), words[:count]):
            if (role := _meaning("".join(held))) is not None:
                found[name, role] = None
    return tuple(found)


def numbered(roles: Collection[str]) -> dict[str, str]:
    """What numbered headings of one tool hold, told by how many there are: a matrix, a quaternion, a translation."""
    names: dict[str, str] = {}
    found: dict[str, set[str]] = {}
    for role in roles:
        if indexed := _NUMBERED.fullmatch(role.removeprefix("#")) if role.startswith("#") else None:
            found.setdefault(indexed[1], set()).add(indexed[2])
    for base, digits in found.items():
        for each in TABLES["numbered"]:
            numbers = each["numbers"].split()
            if base in each["names"].split() and (digits == set(numbers) or (len(numbers) >= 9 and digits >= set(numbers))):
                names |= {f"#{base}{number}": field for number, field in zip(numbers, each["hold"].split())}
                break
    if {"ox", "oy", "oz"} <= set(roles):
        names |= {f"o{axis}": f"{'q' if 'ow' in roles else 'r'}{axis}" for axis in "xyzw"}
    if {"#q0", "qx", "qy", "qz"} <= set(roles):
        names["#q0"] = "qw"
    if not {"azimuth", "elevation"} <= set(roles):
        names |= {"roll": "rx", "pitch": "ry", "yaw": "rz"}
    return names


def is_of_pose(role: str | None) -> bool:
    """Whether it is a number of a pose, by its name or by one that others of its kind tell."""
    return role is not None and (role in POSE or role in ("pitch", "yaw") or (role.startswith(("#", "o")) and role != OCCLUDED))


def is_whole(roles: Collection[str | None]) -> bool:
    """Whether they make a pose."""
    has_turn = any(set(way) <= set(roles) for way in WAYS)
    return set(MATRIX[:12]) <= set(roles) or (has_turn and set(TRANSLATION) <= set(roles))
