"""Which columns, and which rows, are those of one tool: tables hold several side by side, or one below the other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ....errors import SettingsError
from ....message import listed
from ....remedies import Remedy
from .headings import (
    AZIMUTH,
    COUNTED_TURN,
    EULER,
    FRAME,
    KUKA,
    MATRIX,
    QUATERNION,
    ROTATION_VECTOR,
    TOOL,
    TRANSLATION,
    TURN,
    UNNAMED_EULER,
    UNORDERED_QUATERNION,
    Column,
    resolved,
)

ROTATIONS = (TURN, COUNTED_TURN, QUATERNION, UNORDERED_QUATERNION, ROTATION_VECTOR, EULER, UNNAMED_EULER, KUKA, AZIMUTH)
"""Ways to say a rotation; where a table has several, the first of these counts."""

_POSE = frozenset(name for way in (MATRIX, TRANSLATION, *ROTATIONS) for name in way)

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
        return {column.role: place for place, column in self.described.items() if column.role is not None}

    @property
    def is_whole(self) -> bool:
        """Whether it has a pose."""
        roles = {column.role for column in self.described.values()}
        return set(MATRIX[:12]) <= roles or (set(TRANSLATION) <= roles and any(set(way) <= roles for way in ROTATIONS))


def track_of(columns: Sequence[Column], rows: Rows, tool: str | None) -> tuple[Track, list[str], bool]:
    """The columns of the tool that is asked for, or of the only one; in words what was chosen; and whether its name chose among columns.

    Raises SettingsError when there are several tools and none is named, or two columns mean the same.
    """
    whole = [track for track in _side_by_side(columns, rows) if track.is_whole]
    if not whole:  # the first column of a tool may be the only one that names it
        whole = [track for track in _side_by_side(_named_once(columns), rows) if track.is_whole]
    if not whole:  # place and rotation may be headed by different words
        every = Track("", _resolved({place: column for place, column in enumerate(columns) if column.role is not None}))
        return (_one_of_a_kind(every) if every.is_whole else every), [], False
    if len(whole) == 1:
        return _one_of_a_kind(whole[0]), [], False
    names = [track.name for track in whole]
    number = _chosen(names, tool)
    if number is None:
        raise SettingsError(
            f"The table holds poses of {len(names)} tools side by side: {listed(names)}." + _not_there(tool),
            Remedy.WHICH_TOOL,
            tool=names[0],
        )
    return _one_of_a_kind(whole[number]), [f"tool: {names[number]}, of {listed(names)} (columns side by side)"], True


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
    )


def _not_there(tool: str | None) -> str:
    return "" if tool is None else f" There is none called {tool!r}."


def _chosen(names: Sequence[str], tool: str | None, by_place: bool = True) -> int | None:
    """Which of these is meant: by name, by a word of the name that no other has, else by its place from 1."""
    if tool is None:
        return None
    low = [name.lower() for name in names]
    if low.count(tool.lower()) == 1:
        return low.index(tool.lower())
    words = [set(name.split()) for name in low]
    holding = [number for number, each in enumerate(words) if set(tool.lower().split()) <= each]
    if len(holding) == 1:  # Motive names a number too
        return holding[0]
    return int(tool) - 1 if by_place and tool.isdecimal() and 1 <= int(tool) <= len(names) else None


def _side_by_side(columns: Sequence[Column], rows: Rows) -> list[Track]:
    """The tools of the columns, those that belong to no tool with each of them."""
    names = list(dict.fromkeys(column.tool.lower() for column in columns if column.role is not None))
    own = [name for name in names if any(column.role in _POSE or _may_turn(column) for column in columns if column.tool.lower() == name)]
    tracks = []
    for name in own:
        described = {place: column for place, column in enumerate(columns) if column.role is not None and column.tool.lower() == name}
        spelled = next(column.tool for column in described.values())
        tracks += _repeated(spelled, described, columns, rows)
    taken = {place for track in tracks for place in track.described}
    beside = {place: column for place, column in enumerate(columns) if column.role not in (None, *_POSE) and place not in taken}
    found = []
    for track in tracks:
        # What the tool itself has counts, else what stands beside all tools
        roles = {column.role for column in track.described.values()}
        shared = {place: column for place, column in beside.items() if column.role not in roles and not _may_turn(column)}
        found.append(Track(track.name, _resolved(dict(sorted({**track.described, **shared}.items())))))
    return found


def _named_once(columns: Sequence[Column]) -> list[Column]:
    """The columns, those of poses that name no tool being of the tool that was named last."""
    named, last = [], ""
    for column in columns:
        last = column.tool or last
        is_pose = column.role in _POSE or _may_turn(column) or column.role in ("roll", "pitch", "yaw")
        named.append(replace(column, tool=last) if is_pose else column)
    return named


def _may_turn(column: Column) -> bool:
    return column.role is not None and (column.role.startswith("turn ") or (column.role[-1].isdigit() and " " in column.role))


def _resolved(described: dict[int, Column]) -> dict[int, Column]:
    return dict(zip(described, resolved(list(described.values()))))


def _repeated(name: str, described: dict[int, Column], columns: Sequence[Column], rows: Rows) -> list[Track]:
    """One tool, or several where the same headings are written again and again."""
    done = _resolved(described)
    turns = [column.role for column in done.values() if column.role is not None and any(column.role in way for way in ROTATIONS)]
    times = max(Counter(turns).values(), default=1)
    if times < 2:
        return [Track(name, described)]
    headings = [column.heading for column in columns]
    first = next((heading for heading in headings if heading and headings.count(heading) == times), None)
    if first is None:
        return [Track(name, described)]
    starts = [place for place, heading in enumerate(headings) if heading == first]
    tracks = []
    for number, (start, end) in enumerate(zip(starts, [*starts[1:], len(headings)]), start=1):
        part = {place: column for place, column in described.items() if start <= place < end}
        word = next((_only_word(rows, place) for place, column in part.items() if column.role == TOOL), None)
        tracks.append(Track(word or f"{name} {number}".strip(), part))
    if len({track.name for track in tracks}) < len(tracks):
        tracks = [replace(track, name=str(number)) for number, track in enumerate(tracks, start=1)]
    return tracks


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
    for role, count in Counter(column.role for column in described.values() if column.role in _POSE).items():
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
