"""Which columns, and which rows, are those of one tool: tables hold several side by side, or one below the other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from ....errors import SettingsError
from ....message import listed
from ....remedies import Remedy
from .headings import (
    AZIMUTH,
    COUNTED_TURN,
    EULER,
    FRAME,
    IMAGE,
    KUKA,
    MATRIX,
    OCCLUDED,
    PLACE_WORDS,
    QUATERNION,
    ROTATION_VECTOR,
    STATUS,
    TIME,
    TOOL,
    TRANSLATION,
    TURN,
    UNNAMED_EULER,
    UNORDERED_QUATERNION,
    Column,
    Open,
    Reading,
    Role,
    resolved,
)

ROTATIONS = (TURN, COUNTED_TURN, QUATERNION, UNORDERED_QUATERNION, ROTATION_VECTOR, EULER, UNNAMED_EULER, KUKA, AZIMUTH)
"""Ways to say a rotation; where a table has several, the first of these counts."""

_POSE = frozenset([*(name for way in (MATRIX, TRANSLATION, *ROTATIONS) for name in way), "pitch", "yaw"])
_ONLY_ONE = _POSE | {STATUS, OCCLUDED, IMAGE}
_FEWEST = 6
"""Columns of a pose."""

_NAMELESS = ("", "", "")

Rows = Sequence[tuple[int, Sequence[str]]]


@dataclass(frozen=True)
class Track:
    """The columns of one tool.

    Parameters
    ----------
    columns : dict of str to int
        Where each of its values stands, by what it is; of times there may be several.
    described : dict of int to Column
        The same columns, by their place.
    """

    name: str
    described: dict[int, Column]

    @property
    def columns(self) -> dict[str, int]:
        """Where each value stands."""
        return {column.role: place for place, column in self.described.items() if isinstance(column.role, str)}

    @property
    def is_whole(self) -> bool:
        """Whether it has a pose."""
        roles = {column.role for column in self.described.values()}
        return set(MATRIX[:12]) <= roles or (set(TRANSLATION) <= roles and any(set(way) <= roles for way in ROTATIONS))


def track_of(columns: Sequence[Column], rows: Rows, tool: str | None) -> tuple[Track, list[str], bool]:
    """The columns of the tool that is asked for, or of the only one; in words what was chosen; and whether its name chose among columns.

    Raises SettingsError when there are several tools and none is named, or two columns mean the same.
    """
    tracks = _side_by_side(columns, rows)
    if len(tracks) == 1:
        return (_one_of_a_kind(tracks[0]) if tracks[0].is_whole else tracks[0]), [], False
    names = [track.name for track in tracks]
    number = _chosen(names, tool)
    if number is None:
        raise SettingsError(
            f"The table holds poses of {len(names)} tools side by side: {listed(names)}." + _not_there(tool),
            Remedy.WHICH_TOOL,
            tool=names[0],
            choices=names,
        )
    return _one_of_a_kind(tracks[number]), [f"tool: {names[number]}, of {listed(names)} (columns side by side)"], True


def rows_of(track: Track, rows: Rows, tool: str | None, is_chosen: bool) -> tuple[Rows, list[str]]:
    """The rows of the tool that is asked for, or all where they are one tool's; and in words what was chosen.

    Raises SettingsError when there are rows of several tools, and none is named.
    """
    places = [place for place, column in track.described.items() if column.role == TOOL]
    told = []
    for place in places:
        words = [cells[place] if place < len(cells) else "" for _number, cells in rows]
        # A number of its own in each row tells no tool
        if 2 <= len(set(words)) <= max(len(rows) // 2, 2) and len(rows) > 2:
            told.append((place, words))
    if not told:
        if (
            tool is not None
            and not is_chosen
            and not any(tool.lower() == cells[place].lower() for place in places for _n, cells in rows[:1])
        ):
            raise SettingsError(f"The table holds poses of one tool.{_not_there(tool)}", Remedy.NO_TOOL)
        return rows, []
    for place, words in told if tool is not None and not is_chosen else ():
        names = list(dict.fromkeys(words))
        number = _chosen(names, tool, by_place=False)
        if number is not None:
            chosen = [row for row, word in zip(rows, words) if word == names[number]]
            return chosen, [
                f"tool: {names[number]}, of {listed(names)} (column {track.described[place].heading}); {len(chosen)} of {len(rows)} rows"
            ]
    place, words = told[0]
    names = list(dict.fromkeys(words))
    raise SettingsError(
        f"The table holds poses of {len(names)} tools, told by its column {track.described[place].heading}: {listed(names[:8])}."
        + _not_there(None if is_chosen else tool),
        Remedy.WHICH_TOOL,
        tool=names[0],
        choices=names,
    )


def _not_there(tool: str | None) -> str:
    return "" if tool is None else f" There is none called {tool!r}."


def _chosen(names: Sequence[str], tool: str | None, by_place: bool = True) -> int | None:
    """Which of these is meant: by name (without what all names have), by a word that no other has, or by place from 1 where none has it."""
    if tool is None:
        return None
    low = [name.lower() for name in names]
    if low.count(tool.lower()) == 1:
        return low.index(tool.lower())
    words = [set(name.split()) for name in low]
    common, asked = set.intersection(*words), set(tool.lower().split())
    holding = [number for number, each in enumerate(words) if asked <= each]  # Motive names a number too
    alone = [number for number in holding if words[number] - common == asked - common]
    if len(alone) == 1 or len(holding) == 1:
        return (alone or holding)[0]
    return int(tool) - 1 if by_place and not holding and tool.isdecimal() and 1 <= int(tool) <= len(names) else None


def _side_by_side(columns: Sequence[Column], rows: Rows) -> list[Track]:
    """The columns of each tool, those that belong to none of them with each."""
    blocks = _repeated(columns, rows)
    outside = dict(enumerate(columns))
    for block in blocks:
        outside = {place: column for place, column in outside.items() if place not in block.described}
    found = []
    for block in blocks or [Track("", outside)]:
        tools = _by_name(block.described) or [_every(block.described)]
        beside = {**block.described, **outside}
        for place in (place for track in tools for place in track.described):
            del beside[place]
        for track in tools:
            # What the tool itself has counts, else what stands beside all tools
            roles = {None, *(column.role for column in track.described.values())}
            shared = {place: column for place, column in beside.items() if column.role not in roles and not _is_of_pose(column.role)}
            found.append(Track(block.name or track.name, dict(sorted({**track.described, **shared}.items()))))
    if len(found) > 1:
        words = {word for track in found for word in track.name.split()}
        unnamed = [f"unnamed {number}" if str(number) in words else str(number) for number in range(1, len(found) + 1)]
        found = [replace(track, name=track.name or other) for track, other in zip(found, unnamed)]
    if len({track.name.lower() for track in found}) < len(found):
        found = [replace(track, name=str(number)) for number, track in enumerate(found, start=1)]
    return found


def _every(columns: dict[int, Column]) -> Track:
    """All columns as one tool: place and rotation may be headed by different words."""
    return Track("", _resolved({place: column for place, column in columns.items() if column.role is not None}))


def _by_name(columns: dict[int, Column]) -> list[Track]:
    """The tools whose headings are those of a pose but for a name that all of them have, and, of the rest, the one without a name.

    A name is told by where it stands alone, never by what it means: it may be a letter, or a word that means something of a pose.
    """
    groups: dict[tuple[str, ...], dict[int, Reading]] = {}
    for place, column in columns.items():
        for reading in column.readings:
            groups.setdefault(reading.tool, {})[place] = reading
            groups.setdefault(("".join(reading.tool),), {})[place] = reading
    tools: dict[str, dict[int, Reading]] = {}
    taken: set[int] = set()
    # Those that stand at one place before those that do not (``x_L``, ``q_L_x``), before or behind what they name rather than amid it,
    # and the longest names first (``arm_L_x`` is of arm L)
    for key in sorted(groups, key=lambda key: (len(key) == 1, any(key[1:2]), -sum(map(len, key)))):
        group = _pose_of({place: reading for place, reading in groups[key].items() if place not in taken}, columns)
        track = _track(group, columns)
        if len(group) >= _FEWEST and track.is_whole:
            # ``r02`` beside a tool 2 whose rotation is whole is of another
            group = {place: reading for place, reading in group.items() if track.described[place].role is not None}
            tools.setdefault("".join(key), {}).update(group)
            taken |= group.keys()
    for place, column in columns.items():
        own = [reading for reading in column.readings if "".join(reading.tool) in tools and _is_own(reading, column)]
        if own and place not in taken:
            reading = max(own, key=lambda reading: len(reading.name))
            tools["".join(reading.tool)][place] = reading
    return sorted((_track(group, columns) for group in tools.values()), key=lambda track: min(track.described))


def _pose_of(group: dict[int, Reading], columns: dict[int, Column]) -> dict[int, Reading]:
    """Those of a pose. Where its words are one, no word is cut in two: ``r01`` is of no tool 1. ``R_x`` counts before ``rx``."""
    of_pose = {place: reading for place, reading in group.items() if _is_of_pose(reading.role)}
    # ``pos_x`` beside ``pos/pos_x`` has no name
    named = {reading.role for place, reading in of_pose.items() if not _has_no_name(reading, columns[place])}
    of_pose = {place: each for place, each in of_pose.items() if each.role not in named or not _has_no_name(each, columns[place])}
    whole = {place: reading for place, reading in of_pose.items() if not reading.is_split}
    if _track(whole, columns).is_whole:
        return whole
    roles = {reading.role for reading in whole.values()}
    return {place: reading for place, reading in of_pose.items() if not (reading.is_split and reading.role in roles)}


def _has_no_name(reading: Reading, column: Column) -> bool:
    """Whether the whole heading means the same."""
    return any(each.tool == _NAMELESS and each.role == reading.role for each in column.readings)


def _is_own(reading: Reading, column: Column) -> bool:
    """Whether this may be a tool's own time, status or the like. ``time_s`` is the time in s, and of no tool s."""
    if reading.tool == _NAMELESS:
        return reading.role in (STATUS, OCCLUDED)
    is_known = any(each.tool == _NAMELESS for each in column.readings)
    return not (_is_of_pose(reading.role) or (reading.name and is_known and (reading.is_split or reading.role == TIME)))


def _track(group: dict[int, Reading], columns: dict[int, Column]) -> Track:
    described = {place: replace(columns[place], role=reading.role, unit=reading.unit) for place, reading in sorted(group.items())}
    return Track(next((reading.name for reading in group.values()), ""), _resolved(described))


def _is_of_pose(role: Role | None) -> bool:
    return role in _POSE or isinstance(role, Open)


def _resolved(described: dict[int, Column]) -> dict[int, Column]:
    return dict(zip(described, resolved(list(described.values()))))


def _repeated(columns: Sequence[Column], rows: Rows) -> list[Track]:
    """The columns of each tool where the same headings are written again and again; those before them may differ by the tool's name."""
    counts = Counter(columns)
    times = max((counts[column] for column in columns if _is_turn(column.role)), default=1)
    if times < 2:
        return []
    first = next(column for column in columns if column.heading and counts[column] == times)
    starts = [place for place, column in enumerate(columns) if column == first]
    described, names = dict(enumerate(columns)), [""] * times
    while starts[0] > 0:
        before = [{each.role: each.name for each in columns[start - 1].readings if each.name} for start in starts]
        axis = next((axis for axis in TRANSLATION if all(axis in names for names in before)), None)
        if axis is None:
            break
        starts, names = [start - 1 for start in starts], [each[axis] for each in before]
        described |= {start: replace(columns[start], role=axis, words=(axis,)) for start in starts}
    longest = max(end - start for start, end in pairwise(starts))
    tracks = []
    for name, start, end in zip(names, starts, [*starts[1:], min(starts[-1] + longest, len(columns))]):
        part = {place: described[place] for place in range(start, end)}
        word = next((_only_word(rows, place) for place, column in part.items() if column.role == TOOL), None)
        tracks.append(Track(name or word or "", part))
    return tracks


def _is_turn(role: Role | None) -> bool:
    return any(role in way for way in ROTATIONS) or (isinstance(role, Open) and role.word not in PLACE_WORDS)


def _only_word(rows: Rows, place: int) -> str | None:
    words = {cells[place] for _number, cells in rows if place < len(cells)}
    return words.pop() if len(words) == 1 else None


def _one_of_a_kind(track: Track) -> Track:
    """The track with one column for each value of its pose: markers beside a tool have places as well, and no rotation.

    Raises SettingsError when two columns mean the same.
    """
    described = dict(track.described)
    turns = [place for place, column in described.items() if any(column.role in way for way in ROTATIONS)]
    triples = [
        (place, place + 1, place + 2)
        for place in described
        if [described[p].role if p in described else None for p in (place, place + 1, place + 2)] == list(TRANSLATION)
    ]
    beside = [triple for triple in triples if turns and (triple[0] == max(turns) + 1 or triple[2] == min(turns) - 1)]
    if len(triples) > 1 and len(beside) == 1:
        described = {p: c for p, c in described.items() if c.role not in TRANSLATION or p in beside[0]}
    for role, count in Counter(column.role for column in described.values() if column.role in _ONLY_ONE).items():
        if count > 1:
            both = [(place, column.heading) for place, column in described.items() if column.role == role]
            raise SettingsError(
                f"{count} columns mean {role}: " + listed(f"{heading} (column {place + 1})" for place, heading in both) + ".",
                Remedy.NAME_THE_COLUMNS,
            )
    return Track(
        track.name, {place: column for place, column in described.items() if column.role != FRAME or place == _first(described, FRAME)}
    )


def _first(described: dict[int, Column], role: str) -> int | None:
    return next((place for place, column in described.items() if column.role == role), None)
