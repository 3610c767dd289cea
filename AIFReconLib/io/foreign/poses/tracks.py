"""Which columns, and which rows, are those of one tool: tables hold several side by side, or one below the other."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from ....errors import SettingsError
from ....message import listed, shorten
from ....remedies import NAME_THE_COLUMNS, WHICH_TOOL
from .headings import (
    IMAGE,
    OCCLUDED,
    POSE,
    STATUS,
    TOOL,
    Column,
    column_of,
    is_of_pose,
    is_whole,
    numbered,
)
from .rotations import NEEDED
from .sheet import Sheet, cells_of

_ROWS_SHOWN = 2
_MOST_UNREAD = 6
"""Headings that nothing is known of are as many as a pose has: another tool's, perhaps."""

_MOST_LEFT = 2
"""Columns of a pose that are nobody's, such as an error in x."""

_Name = tuple[str, str, str]
"""Of a tool: by its place, and what stands before and behind."""

_OF_ONE_TOOL = POSE | {STATUS, OCCLUDED}


@dataclass(frozen=True)
class Track:
    """The columns of one tool, by their place in the table; of times there may be several."""

    name: str
    described: dict[int, Column]

    @property
    def columns(self) -> dict[str, int]:
        """Where each value stands."""
        return {column.role: place for place, column in reversed(self.described.items()) if column.role is not None}


def name_the_columns(why: str, sheet: Sheet) -> SettingsError:
    """The question what the columns are, which shows them and the first rows."""
    shown = [listed(cells_of(row, sheet.separator)[:20]) for row in sheet.rows[:_ROWS_SHOWN]]
    headings = f" Headings: {listed(sheet.headings[:20])}." if sheet.headings else ""
    return SettingsError(f"{why}{headings} First rows: {shorten(' | '.join(shown), 300)}.", NAME_THE_COLUMNS)


def in_blocks(columns: Sequence[Column], sheet: Sheet, starts: str) -> list[Column]:
    """The same columns with their tools: a heading like `starts` begins those of one, and names it, or a column of theirs does."""
    found = {place: match for place, column in enumerate(columns) if (match := re.fullmatch(starts, column.heading))}
    blocks = [range(start, end) for start, end in pairwise([*found, len(columns)])]
    ports = [next((sheet.words(place)[0] for place in block if columns[place].role == TOOL), "") for block in blocks]
    names = [match[1] if match.re.groups else port for match, port in zip(found.values(), ports)]
    names = names if len(set(names)) == len(names) else list(map(str, range(1, len(names) + 1)))
    told = list(columns)
    for name, block in zip(names, blocks):
        for place in block:
            bare = column_of(columns[place].heading.removeprefix(name))
            told[place] = replace(columns[place], words=bare.words, tool=name.strip())
    return told


def track_of(columns: Sequence[Column], sheet: Sheet, tool: str | None, is_known: bool) -> tuple[Track, list[str], bool]:
    """The columns of the tool that is asked for, or of the only one; in words what was chosen; and whether its name chose among columns.

    Raises SettingsError when there are several tools and none is named, two columns mean the same, or it cannot be told which columns
    are one tool's.

    Parameters
    ----------
    columns : sequence of Column
    sheet : Sheet
    tool : str or None
    is_known : bool
        The layout is a maker's: what else is in it is no pose.
    """
    tracks = _tracks(columns, sheet, is_known)
    names = _written(tracks)
    number = 0 if len(tracks) == 1 else _chosen(names, tool)
    if number is None:
        raise _which(" side by side", names, tool)
    track = tracks[number]
    counts = Counter(column.role for column in track.described.values() if column.role in {*_OF_ONE_TOOL, IMAGE})
    twice = [role for role, count in counts.items() if count > 1]
    if twice and not is_known:
        places = [place for place, column in track.described.items() if column.role == twice[0]]
        both = listed(f"{columns[place].heading} (column {place + 1})" for place in places)
        raise name_the_columns(f"{len(places)} columns mean {twice[0]}: {both}.", sheet)
    # The places of markers stand behind the pose of their tool
    described = {place: column for place, column in track.described.items() if column.role not in twice or place in track.columns.values()}
    told = [f"tool: {names[number]}, of {listed(names)} (columns side by side)"] if len(tracks) > 1 else []
    return Track(track.name, described), told, len(tracks) > 1


def rows_of(track: Track, sheet: Sheet, tool: str | None) -> tuple[Sheet, list[str]]:
    """The rows of the tool that is asked for, or all where they are one tool's; and in words what was chosen.

    Raises SettingsError when there are rows of several tools, and none is named.
    """
    for place, column in ((place, column) for place, column in track.described.items() if column.role == TOOL):
        words = sheet.words(place)
        names = list(dict.fromkeys(words))
        # A number of its own in each row tells no tool
        if len(words) > 2 and 2 <= len(names) <= max(len(words) // 2, 2):
            number = _chosen(names, tool, by_place=False)
            if number is None:
                raise _which(f", told by its column {column.heading}", names, tool)
            chosen = sheet.where([word == names[number] for word in words])
            which = f"{names[number]}, of {listed(names)} (column {column.heading})"
            return chosen, [f"tool: {which}; {len(chosen)} of {len(words)} rows"]
        tool = None if tool and tool.lower() == names[0].lower() else tool
    if tool is not None:
        raise SettingsError(f"The table holds poses of one tool. There is none called {tool!r}.", "Leave out {tool}.")
    return sheet, []


def _which(how: str, names: Sequence[str], tool: str | None) -> SettingsError:
    told = f"The table holds poses of {len(names)} tools{how}: {listed(names[:8])}."
    return SettingsError(told + ("" if tool is None else f" There is none called {tool!r}."), WHICH_TOOL, first=names[0], choices=names)


def _written(tracks: Sequence[Track]) -> list[str]:
    """The names of tools as the table has them, where it writes them above the columns; else by their words."""
    above = [next(column for column in track.described.values() if column.role in POSE).above for track in tracks]
    written = [next((text for text in mine if sum(text in each for each in above) == 1), "") for mine in above]
    return written if all(written) else [track.name for track in tracks]


def _chosen(names: Sequence[str], tool: str | None, by_place: bool = True) -> int | None:
    """Which of these is meant: by name, by a word or a part of three characters that no other has, or by place from 1."""
    if tool is None:
        return None
    low, asked = [name.lower() for name in names], tool.lower()
    part = "".join(filter(str.isalnum, asked))
    ways = asked.__eq__, lambda name: asked in name.split(), lambda name: len(part) > 2 and part in "".join(filter(str.isalnum, name))
    for is_meant in ways:
        having = [number for number, name in enumerate(low) if is_meant(name)]
        if len(having) == 1:
            return having[0]
    is_place = by_place and re.fullmatch("[1-9][0-9]?", tool) and int(tool) <= len(names) and not any(asked in name for name in low)
    return int(tool) - 1 if is_place else None


def _tracks(columns: Sequence[Column], sheet: Sheet, is_known: bool) -> list[Track]:
    """The tools of a table: names whose headings make whole poses. A heading that can be of two of them is asked about."""
    unread = [column for column in columns if column.words and not column.readings()]
    if len(unread) >= _MOST_UNREAD and not is_known:
        raise name_the_columns(f"{len(unread)} headings are not known.", sheet)
    tools: dict[_Name, dict[int, Column]] = {}
    for name in dict.fromkeys(name for column in columns for name, _ in column.readings()):
        roles = {place: role for place, column in enumerate(columns) for each, role in column.readings() if each == name}
        held = {place: numbered(roles.values()).get(role, role) for place, role in roles.items()}
        if is_whole(held.values()):
            own = {place: role for place, role in held.items() if any(name) or role in _OF_ONE_TOOL}
            tools[name] = {place: replace(columns[place], role=role) for place, role in own.items()}
    owned = Counter(place for own in tools.values() for place in own)
    for place in (place for place, count in owned.items() if count > 1):
        raise name_the_columns(f"The heading {columns[place].heading} can be read in several ways.", sheet)
    rest = {place: column.readings() for place, column in enumerate(columns) if place not in owned and column.readings()}
    left = sum(any(is_of_pose(role) for _, role in readings) for readings in rest.values())
    if not tools or (left > _MOST_LEFT and not is_known):
        known = dict.fromkeys(column.role for column in columns if column.role and not column.role.startswith("#"))
        raise name_the_columns(NEEDED.format(listed(known) or "none"), sheet)
    # Tool2 Mean Marker Error names no tool
    beside = {place: (whose[0], role) for place, ((whose, role), *_) in rest.items() if not whose[2] and not is_of_pose(role)}
    tracks = []
    for number, (name, of_tool) in enumerate(sorted(tools.items(), key=lambda each: min(each[1])), start=1):
        own_roles = {column.role for column in of_tool.values()}
        more = {p: replace(columns[p], role=r) for p, (whose, r) in beside.items() if r not in own_roles and whose in ("", name[0])}
        unnamed = f"unnamed {number}" if any(str(number) in each for each in tools) else str(number)
        tracks.append(Track(" ".join(filter(None, name)) or unnamed, dict(sorted({**of_tool, **more}.items()))))
    return tracks
