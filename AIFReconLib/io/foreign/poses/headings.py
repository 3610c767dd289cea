"""What a column of a table of poses holds, by its heading as trackers, robots and programs write it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import accumulate, combinations, pairwise
from typing import NamedTuple

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

QUATERNION_ORDERS = ("xyzw", "wxyz")
LENGTHS = {"mm": 1.0, "cm": 10.0, "m": 1000.0}
ANGLES = ("deg", "rad")
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_LONG_TIMES = {"min": 60.0, "h": 3600.0}
_UNITS = {
    **dict.fromkeys(("mm", "millimeter", "millimeters", "millimetre", "millimetres"), "mm"),
    **dict.fromkeys(("cm", "centimeter", "centimeters", "centimetre", "centimetres"), "cm"),
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres"), "m"),
    **dict.fromkeys(("deg", "degree", "degrees", "°"), "deg"),
    **dict.fromkeys(("rad", "radian", "radians"), "rad"),
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), "s"),
    **dict.fromkeys(("ms", "msec", "msecs", "millis", "millisec", "millisecond", "milliseconds"), "ms"),
    **dict.fromkeys(("us", "µs", "usec", "usecs", "micros", "microsec", "microsecond", "microseconds"), "us"),
    **dict.fromkeys(("ns", "nsec", "nsecs", "nanos", "nanosec", "nanosecs", "nanosecond", "nanoseconds"), "ns"),
    **dict.fromkeys(("min", "minute", "minutes"), "min"),
    **dict.fromkeys(("h", "hour", "hours"), "h"),
}
_OTHER_UNITS = frozenset(
    [
        "in",
        "inch",
        "inches",
        "ft",
        "hz",
        "fps",
        "%",
        "count",
        "counts",
        "v",
        "unitless",
        "none",
        "quaternion",
        "nm",
        "n",
        "deg/s",
        "mm/s",
        "m/s",
        "rad/s",
    ]
)

_PLACES = ["t", "p", "pos", "position", "translation", "trans", "location", "loc", "origin", "coordinate"]
_TURNS = ["rot", "rotation", "orientation", "orient", "attitude", "ori"]
_SPELLINGS = {
    TIME: "time timestamp t times stamp timespec unixtime epoch systemtime hosttime elapsed elapsedtime datetime ts",
    FRAME: "frame frameno framenumber framenum frameindex seq sample sampleno subframe",
    TOOL: "tool toolid toolname toolno port porthandle toolhandle handle sensor sensorid sensorno station stationno object objectid "
    "objectname marker markerid body bodyid bodyname rigidbody rigidbodyid rigidbodyname childframeid frameid device deviceid devicename "
    "subject segment geometryid id name source target",
    IMAGE: "image file filename imagefile picture imagename",
    STATUS: "status state valid isvalid visible isvisible visibility tracked istracked trackingstatus transformstatus toolstatus enabled "
    "isenabled found detected trackingstate validity",
    OCCLUDED: "occluded isoccluded occlusion ismissing islost",
    **{axis: " ".join([axis, *(f"{place}{axis}" for place in _PLACES)]) for axis in TRANSLATION},
    **{
        f"q{axis}": " ".join(f"{word}{axis}" for word in ("q", "quat", "quaternion", "o", "rotq", "qrot", "rquat")) + extra
        for axis, extra in zip("xyzw", (" qi", " qj", " qk", " qr qs"))
    },
    **{f"r{axis}": f"r{axis} euler{axis} angle{axis} rvect{axis}" for axis in "xyz"},
    **{f"v{axis}": f"rotvec{axis} rvec{axis} rotationvector{axis} axisangle{axis}" for axis in "xyz"},
    "azimuth": "azimuth az",
    "elevation": "elevation el",
    "roll": "roll",
    "pitch": "pitch",
    "yaw": "yaw",
    **{name: name for name in (*UNNAMED_EULER, *KUKA)},
}


class Open(NamedTuple):
    """What a heading leaves open until it is known which others a tool has: ``rot x`` is an angle, or beside ``rot w`` of a quaternion."""

    word: str
    which: str


Role = str | Open
"""What a column holds."""

_TURN = "turn"
_ROLES: dict[str, Role] = {spelling: role for role, spellings in _SPELLINGS.items() for spelling in spellings.split()}
_ROLES |= {f"{word}{axis}": Open(_TURN, axis) for word in _TURNS for axis in "xyzw"}
_WHOLE = frozenset(
    [
        "t",
        "ts",
        "id",
        "name",
        "a",
        "b",
        "c",
        "el",
        "az",
        "s",
        "roll",
        "e0",
        "e1",
        "e2",
        "port",
        "object",
        "subject",
        "source",
        "target",
        "station",
        "handle",
        "body",
        "device",
        "sample",
    ]
)
"""Spellings that mean something only where the heading says nothing else."""

_INDEXED = re.compile(
    r"(m|r|rot|rotation|rotmat|mat|matrix|transform|tform|q|quat|quaternion|orientation|t|trans|translation|pos|position)(\d\d?)"
)
PLACE_WORDS = ("t", "trans", "translation", "pos", "position")
"""Those of `Open` that are places."""

_LONGEST, _LONGEST_ROLE = 120, 28
"""Characters of a heading that is taken apart, and of what can be known in it."""


class Reading(NamedTuple):
    """One way to take a heading apart: what the column holds, and the name of a tool before, behind or amid it, whatever it means.

    `tool` tells the tool and where its name stands, three times nothing where there is none; `is_split`: a word is cut in two, as ``Lx``.
    """

    role: Role
    unit: str | None
    tool: tuple[str, str, str]
    name: str
    is_split: bool


@dataclass(frozen=True)
class Column:
    """A column: its heading, what it holds and in which unit; the words of its heading, and the unit that is said beside them."""

    heading: str
    role: Role | None = None
    unit: str | None = None
    words: tuple[str, ...] = ()
    said: str | None = None

    @property
    def readings(self) -> tuple[Reading, ...]:
        """Every way to read it with a tool's name in it, or without."""
        return _readings(self.words, self.said)


def are_headings(cells: Sequence[str]) -> bool:
    """Whether words tell what columns hold: three things at least."""
    return len({column_of(cell).role for cell in cells if cell} - {None}) >= 3


def is_unit(cell: str) -> bool:
    """Whether a word below the headings is the unit of a column."""
    word = cell.strip("()[] ").lower()
    return word in _UNITS or word in _OTHER_UNITS


@cache
def column_of(heading: str, above: tuple[str, ...] = (), unit: str = "") -> Column:
    """The column with this heading, below these words that several columns share, in this unit."""
    said = _UNITS.get(unit.strip("()[] ").lower())
    bare = heading
    for bracket in re.findall(r"[(\[]([^)\]]*)[)\]]", heading):
        if is_unit(bracket):
            said, bare = _UNITS.get(bracket.strip().lower(), said), heading.replace(f"({bracket})", " ").replace(f"[{bracket}]", " ")
    if heading.strip().lower().startswith("%time"):
        return Column(heading, RECEIVED, said)
    words = _words(bare)
    if not words:
        return Column(heading, None, said)
    wide = [*(word for each in above for word in _words(each)), *words]
    role, found = _meaning(wide)
    if role is None and above:
        role, found = _meaning(words)
    return Column(heading, role, found or said, tuple(wide), said)


def _meaning(words: Sequence[str]) -> tuple[Role | None, str | None]:
    """What words mean, whatever else they say, and the unit among them: the longest ending that is known, else the longest beginning."""
    low = [word.lower() for word in words]
    unit = _UNITS.get(low[-1])
    if unit is not None and len(low) > 1:
        role = _known(low[:-1])
        if role is not None and _takes(role, unit):
            return role, unit
    role = _known(low)
    if role is None and (unit in TIMES or unit in _LONG_TIMES):  # sec, nanosec, minutes: a time by its unit
        return TIME, unit
    return role, None


def _takes(role: Role, unit: str) -> bool:
    """Whether a column that holds this can be in that unit."""
    if role in (TIME, RECEIVED):
        return unit in TIMES or unit in _LONG_TIMES
    return unit in LENGTHS if role in TRANSLATION else unit in ANGLES


def _known(low: Sequence[str]) -> Role | None:
    for start in range(len(low)):
        role = _spelled("".join(low[start:]), start == 0)
        if role is not None:
            return role
    for end in range(len(low) - 1, 0, -1):
        role = _spelled("".join(low[:end]), False)
        if role not in (None, TOOL, IMAGE, FRAME):
            return role
    return None


@cache
def _readings(words: tuple[str, ...], unit: str | None) -> tuple[Reading, ...]:
    """Every way to take words apart; a name is one word or several, or the first or last part of all."""
    text, ends = "".join(words), [0, *accumulate(map(len, words))]
    if len(text) > _LONGEST:
        return ()
    count, found = len(text), []
    parts = {*combinations(ends, 2), *((0, end) for end in range(1, count)), *((start, count) for start in range(count))}
    for start, end in sorted(parts):
        is_split = not (start in ends and end in ends)
        if end - start <= _LONGEST_ROLE:
            role, own = _exactly(_between(text, ends, (start, end)))
            if role is not None:
                tool = text[:start].lower(), "", text[end:].lower()
                found.append(Reading(role, own or unit, tool, " ".join(_between(text, ends, (0, start), (end, count))), is_split))
        if start > 0 and end < count and count - end + start <= _LONGEST_ROLE:
            role, own = _exactly(_between(text, ends, (0, start), (end, count)))
            if role is not None:
                tool = "", text[start:end].lower(), ""
                found.append(Reading(role, own or unit, tool, " ".join(_between(text, ends, (start, end))), False))
    return tuple(found)


def _exactly(words: Sequence[str]) -> tuple[Role | None, str | None]:
    """What words mean that say nothing else, and their unit."""
    low = [word.lower() for word in words]
    unit = _UNITS.get(low[-1])
    role = _spelled("".join(low[:-1]), True) if unit is not None and len(low) > 1 else None
    if role is not None and unit is not None and _takes(role, unit):
        return role, unit
    return _spelled("".join(low), True), None


def _between(text: str, ends: Sequence[int], *parts: tuple[int, int]) -> list[str]:
    """The words, or parts of words, in parts of a text whose words end there."""
    cuts = [[start, *(at for at in ends if start < at < end), end] for start, end in parts]
    return [text[a:b] for each in cuts for a, b in pairwise(each) if a < b]


def _spelled(word: str, is_whole: bool) -> Role | None:
    if word in _WHOLE and not is_whole:
        return None
    indexed = _INDEXED.fullmatch(word)
    return _ROLES.get(word) or (Open(indexed[1], indexed[2]) if indexed else None)


def _words(text: str) -> list[str]:
    return re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-zµ]+|\d+", text)


def resolved(columns: Sequence[Column]) -> list[Column]:
    """Columns of one tool, their numbered headings told by how many there are: a matrix, a quaternion, a translation."""
    roles = {column.role for column in columns}
    indexed: dict[str, set[str]] = {}
    for role in roles:
        if isinstance(role, Open):
            indexed.setdefault(role.word, set()).add(role.which)
    turns = indexed.pop(_TURN, set())
    names: dict[Role | None, str] = {Open(_TURN, axis): f"{'q' if 'w' in turns else 'r'}{axis}" for axis in turns}
    for base, digits in indexed.items():
        for pattern, fields in _patterns(base):
            if set(pattern) <= digits and (len(pattern) >= 9 or digits == set(pattern)):
                names |= {Open(base, digit): name for digit, name in zip(pattern, fields)}
                names |= {Open(base, digit): name for digit, name in zip(_LAST_ROW.get(pattern, ()), MATRIX[12:])}
                break
    if {Open("q", "0"), "qx", "qy", "qz"} <= roles:
        names[Open("q", "0")] = "qw"
    if not ({"azimuth", "elevation"} <= roles):
        names |= {"roll": "rx", "pitch": "ry", "yaw": "rz"}
    done = [names.get(column.role, column.role) for column in columns]
    return [replace(column, role=None if isinstance(role, Open) else role) for column, role in zip(columns, done)]


_FROM_0 = tuple(f"{row}{column}" for row in range(4) for column in range(4))
_FROM_1 = tuple(f"{row}{column}" for row in range(1, 5) for column in range(1, 5))
_COUNTED = tuple(str(n) for n in range(16))
_LAST_ROW = {names[:12]: names[12:] for names in (_FROM_0, _FROM_1, _COUNTED)}


def _patterns(base: str) -> list[tuple[tuple[str, ...], tuple[str, ...]]]:
    """How numbered headings with this beginning are told, and what they hold."""
    if base in PLACE_WORDS:
        return [(("0", "1", "2"), TRANSLATION), (("1", "2", "3"), TRANSLATION)]
    nine = [
        (tuple(f"{row}{column}" for row in range(3) for column in range(3)), TURN),
        (tuple(f"{row}{column}" for row in range(1, 4) for column in range(1, 4)), TURN),
        (tuple(str(n) for n in range(9)), COUNTED_TURN),
        (tuple(str(n) for n in range(1, 10)), COUNTED_TURN),
    ]
    four: list[tuple[tuple[str, ...], tuple[str, ...]]] = [
        (("0", "1", "2", "3"), UNORDERED_QUATERNION),
        (("1", "2", "3", "4"), UNORDERED_QUATERNION),
    ]
    if base in ("q", "quat", "quaternion", "orientation"):
        return four
    return [*((names[:12], MATRIX[:12]) for names in (_FROM_0, _FROM_1, _COUNTED)), *nine, *four]
