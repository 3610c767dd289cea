"""Which columns, and which rows, are those of one tool: tables hold several side by side, or one below the other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from ....errors import SettingsError
from ....message import listed, shorten
from ....remedies import NAME_THE_COLUMNS, WHICH_TOOL
from .headings import (
    FRAME,
    IMAGE,
    OCCLUDED,
    POSE,
    STATUS,
    TOOL,
    TRANSLATION,
    Column,
    is_of_pose,
    is_whole,
    numbered,
    parts_of,
)
from .rotations import NEEDED
from .sheet import Cells, Sheet, cells_of

_ROWS_SHOWN = 2
_MOST_UNREAD = 6
"""Headings that nothing is known of are as many as a pose has: another tool's, perhaps."""
_Reading = tuple[tuple[str, str, str], str]
"""The words of a heading that name its tool, and what the others say that it holds."""

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
    number = 0 if len(tracks) == 1 else _chosen(names, tool, also=[track.name for track in tracks])
    if number is None:
        raise _which(f"The table holds poses of {len(names)} tools side by side: {listed(names)}.", names, tool)
    track = tracks[number]
    counts = Counter(column.role for column in track.described.values())
    for role in (role for role in counts if counts[role] > 1 and role in {*_OF_ONE_TOOL, IMAGE, FRAME}):
        places = [place for place, column in track.described.items() if column.role == role]
        if role != FRAME and not is_known:
            both = listed(f"{columns[place].heading} (column {place + 1})" for place in places)
            raise name_the_columns(f"{len(places)} columns mean {role}: {both}.", sheet)
        # Markers, whose places stand behind the pose of their tool
        track = replace(track, described={p: c for p, c in track.described.items() if p not in places[1:]})
    told = [f"tool: {names[number]}, of {listed(names)} (columns side by side)"] if len(tracks) > 1 else []
    return track, told, len(tracks) > 1


def rows_of(track: Track, cells: Cells, tool: str | None, is_chosen: bool) -> tuple[Cells, list[str]]:
    """The rows of the tool that is asked for, or all where they are one tool's; and in words what was chosen.

    Raises SettingsError when there are rows of several tools, and none is named.
    """
    named = {place: cells.words(place) for place, column in track.described.items() if column.role == TOOL}
    # A number of its own in each row tells no tool
    several = {place: words for place, words in named.items() if 2 <= len(set(words)) <= max(len(words) // 2, 2) and len(words) > 2}
    only = {words[0].lower() for place, words in named.items() if place not in several and words}
    asked = None if is_chosen or tool is None or tool.lower() in only else tool
    for place, words in several.items():
        names = list(dict.fromkeys(words))
        number = _chosen(names, asked, by_place=False)
        if number is not None:
            chosen = cells.where([word == names[number] for word in words])
            which = f"{names[number]}, of {listed(names)} (column {track.described[place].heading})"
            return chosen, [f"tool: {which}; {len(chosen)} of {len(words)} rows"]
    for place, words in several.items():
        names, heading = list(dict.fromkeys(words)), track.described[place].heading
        raise _which(f"The table holds poses of {len(names)} tools, told by its column {heading}: {listed(names[:8])}.", names, asked)
    if asked is not None:
        raise SettingsError(f"The table holds poses of one tool. There is none called {asked!r}.", "Leave out {tool}.")
    return cells, []


def _which(sentence: str, names: Sequence[str], tool: str | None) -> SettingsError:
    no_such = "" if tool is None else f" There is none called {tool!r}."
    return SettingsError(sentence + no_such, WHICH_TOOL, first=names[0], choices=names)


def _written(tracks: Sequence[Track]) -> list[str]:
    """The names of tools as the table has them, where it writes them above the columns; else by their words."""
    above = [next(column for column in track.described.values() if column.role in POSE).above for track in tracks]
    written = [next((text for text in mine if sum(text in each for each in above) == 1), "") for mine in above]
    return written if all(written) else [track.name for track in tracks]


def _chosen(names: Sequence[str], tool: str | None, by_place: bool = True, also: Sequence[str] = ()) -> int | None:
    """Which of these is meant: by name (without what all names have), by words that no other has, by place from 1 where none has them, or
    by any part of three characters or more; `also` are other names of the same."""
    if tool is None:
        return None
    low = [name.lower() for name in names]
    if low.count(tool.lower()) == 1:
        return low.index(tool.lower())
    words = [set(name.lower().split()) for name in also or names]
    common, asked = set.intersection(*words), set(tool.lower().split())
    holding = [number for number, each in enumerate(words) if asked <= each]  # Motive names a number too
    alone = [number for number in holding if words[number] - common == asked - common]
    if len(alone) == 1 or len(holding) == 1:
        return (alone or holding)[0]
    if by_place and not holding and tool.isdecimal() and 1 <= int(tool) <= len(names):
        return int(tool) - 1
    part = "".join(filter(str.isalnum, tool.lower()))
    with_part = [number for number, name in enumerate(low) if part in "".join(filter(str.isalnum, name))]
    return with_part[0] if len(part) > 2 and len(with_part) == 1 else None


def _tracks(columns: Sequence[Column], sheet: Sheet, is_known: bool) -> list[Track]:
    """The tools of a table.

    Their names may be words that mean something of a pose. So headings are read as long as they can be, and as short, and a way counts
    only if it leaves whole poses and nothing of a pose beside them. Where both count and differ, it is asked.
    """
    unread = [column for column in columns if column.role is None and column.words and not parts_of(column.words)]
    if len(unread) >= _MOST_UNREAD and not is_known:
        raise name_the_columns(f"{len(unread)} headings are not known.", sheet)
    told = _told_by_place(columns, sheet)
    ways = [tracks for longest in (True, False) if (tracks := _read(told, longest, is_known))]
    if not ways and is_known:  # QTM writes the name of an only body before the first of its columns
        ends = [next((role for name, role in parts_of(column.words) if not name[1]), column.role) for column in told]
        ways = [_read([replace(column, role=role, words=()) for column, role in zip(told, ends)], True, is_known)]
    if not any(ways):
        known = dict.fromkeys(column.role for column in columns if column.role and not column.role.startswith("#"))
        raise name_the_columns(NEEDED.format(listed(known) or "none"), sheet)
    if _poses_in(ways[0]) != _poses_in(ways[-1]):
        raise name_the_columns("The headings can be read in several ways.", sheet)
    tracks = sorted(ways[0], key=lambda track: min(track.described))
    words = {word for track in tracks for word in track.name.split()}
    return [
        replace(track, name=track.name or (f"unnamed {number}" if str(number) in words else str(number)))
        for number, track in enumerate(tracks, start=1)
    ]


def _poses_in(tracks: Iterable[Track]) -> set[frozenset[tuple[int, str | None]]]:
    return {frozenset((place, column.role) for place, column in t.described.items() if column.role in POSE) for t in tracks}


def _read(columns: Sequence[Column], longest: bool, is_known: bool) -> list[Track]:
    """The tools, by headings read as long or as short as they can be; none where poses are not whole, or part of one is left."""
    parts = [parts_of(c.words) if c.words else (((("", ""), c.role),) if c.role else ()) for c in columns]
    readings: list[list[_Reading]] = [[((c.tool, *name), role) for name, role in each if not all(name)] for c, each in zip(columns, parts)]
    roles: dict[tuple[str, str, str], set[str]] = {}
    for each in readings:
        for name, role in each:
            roles.setdefault(name, set()).add(role)
    whole = {name: named for name, had in roles.items() if is_whole({(named := numbered(had)).get(role, role) for role in had})}
    tools: dict[tuple[str, str, str], dict[int, Column]] = {}
    beside: dict[int, Column] = {}
    left = 0
    for place, (column, part, each) in enumerate(zip(columns, parts, readings)):
        of_tools = [reading for reading in each if reading[0] in whole]
        name, role = of_tools[0 if longest else -1] if of_tools else each[0] if each else (("", "", ""), "")
        role = whole.get(name, {}).get(role, role)
        if of_tools and (any(name) or role in _OF_ONE_TOOL):
            tools.setdefault(name, {})[place] = replace(column, role=role)
        elif not of_tools and any(is_of_pose(other) for _, other in part):
            left += "marker" not in " ".join(column.words).lower()  # they have places alone
        elif each and not name[2]:  # Tool2 Mean Marker Error names no tool
            beside[place] = replace(column, role=role)
    own = {name: {column.role for column in of_tool.values()} for name, of_tool in tools.items()}
    if not all(is_whole({role for role in each if role}) for each in own.values()) or (left > 2 and not is_known):
        return []
    found = []
    for name, of_tool in tools.items():
        more = {p: c for p, c in beside.items() if c.role not in own[name] and c.tool in ("", name[0])}
        found.append(Track(" ".join(filter(None, name)), dict(sorted({**of_tool, **more}.items()))))
    return found


def _told_by_place(columns: Sequence[Column], sheet: Sheet) -> list[Column]:
    """The same, with their tools where headings of a pose stand again and again: the name before the first of them, or a number."""
    counts = Counter(column.heading for column in columns if column.heading)
    turns = [column.heading for column in columns if is_of_pose(column.role or "") and column.role not in TRANSLATION]
    times = max((counts[heading] for heading in turns), default=1)
    if times < 2 or sheet.groups:
        return list(columns)
    first = next(heading for heading, count in counts.items() if count == times)
    starts = [place for place, column in enumerate(columns) if column.heading == first]
    ahead = [parts_of(columns[start - 1].words) for start in starts]
    before = [{role: name[0] for name, role in parts if not name[1]}.get("x", "") for parts in ahead]
    titles = [columns[start - 1].heading for start in starts]
    told = list(columns)
    if all(":" in title and counts[title] == 1 for title in titles):  # NDI Track: Port 0x01: Probe s/n:3E4C880C
        before = titles
    elif all(before) and starts[0]:
        starts = [start - 1 for start in starts]
        for start in starts:
            told[start] = replace(columns[start], words=("x",))
    else:
        tools = [next((place for place in range(start, len(told)) if told[place].role == TOOL), None) for start in starts]
        words = [{cells_of(row, sheet.separator)[place] for row in sheet.rows[:50]} if place else set() for place in tools]
        before = [each.pop() if len(each) == 1 else "" for each in words]
    if len(set(filter(None, before))) < times:
        before = [str(number + 1) for number in range(times)]
    longest = max(end - start for start, end in pairwise(starts))
    for name, start in zip(before, starts):
        told[start : start + longest] = [replace(column, tool=name) for column in told[start : start + longest]]
    return told
