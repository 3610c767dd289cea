"""Which columns, and which rows, are those of one tool: tables hold several side by side, or one below the other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product

from ....errors import SettingsError
from ....message import listed, shorten
from ....remedies import NAME_THE_COLUMNS, WHICH_TOOL
from .headings import (
    FRAME,
    IMAGE,
    MATRIX,
    OCCLUDED,
    POSE,
    STATUS,
    TOOL,
    TRANSLATION,
    WAYS,
    Column,
    numbered,
    parts_of,
)
from .sheet import Cells, Sheet, cells_of

_ROWS_SHOWN = 2
_MOST_UNREAD = 6
"""Headings that nothing is known of are as many as a pose has: another tool's, perhaps."""
_ONLY_ONE = POSE | {STATUS, OCCLUDED, IMAGE}


@dataclass(frozen=True)
class Track:
    """The columns of one tool, by their place in the table; of times there may be several."""

    name: str
    described: dict[int, Column]

    @property
    def columns(self) -> dict[str, int]:
        """Where each value stands."""
        return {column.role: place for place, column in reversed(self.described.items()) if column.role is not None}

    @property
    def is_whole(self) -> bool:
        """Whether it has a pose."""
        roles = {column.role for column in self.described.values()}
        return set(MATRIX[:12]) <= roles or (set(TRANSLATION) <= roles and any(set(way) <= roles for way in WAYS))


def name_the_columns(why: str, sheet: Sheet) -> SettingsError:
    """The question what the columns are, which shows them and the first rows."""
    shown = [listed(cells_of(row, sheet.separator)[:20]) for row in sheet.rows[:_ROWS_SHOWN]]
    headings = f" Headings: {listed(sheet.headings[:20])}." if sheet.headings else ""
    return SettingsError(f"{why}{headings} First rows: {shorten(' | '.join(shown), 300)}.", NAME_THE_COLUMNS)


def track_of(columns: Sequence[Column], sheet: Sheet, tool: str | None, is_preset: bool) -> tuple[Track, list[str], bool]:
    """The columns of the tool that is asked for, or of the only one; in words what was chosen; and whether its name chose among columns.

    Raises SettingsError when there are several tools and none is named, two columns mean the same, or it cannot be told which columns
    are one tool's.
    """
    tracks = _repeated(columns, sheet) or _by_name(columns, sheet, is_preset)
    if len(tracks) == 1:
        return _checked(tracks[0], sheet), [], False
    names = [track.name for track in tracks]
    number = _chosen(names, tool)
    if number is None:
        raise SettingsError(
            f"The table holds poses of {len(names)} tools side by side: {listed(names)}." + _not_there(tool),
            WHICH_TOOL,
            first=names[0],
            choices=names,
        )
    return _checked(tracks[number], sheet), [f"tool: {names[number]}, of {listed(names)} (columns side by side)"], True


def rows_of(track: Track, cells: Cells, tool: str | None, is_chosen: bool) -> tuple[Cells, list[str]]:
    """The rows of the tool that is asked for, or all where they are one tool's; and in words what was chosen.

    Raises SettingsError when there are rows of several tools, and none is named.
    """
    told = {}
    for place in (place for place, column in track.described.items() if column.role == TOOL):
        words = cells.words(place)
        # A number of its own in each row tells no tool
        if 2 <= len(set(words)) <= max(len(words) // 2, 2) and len(words) > 2:
            told[place] = words
        elif tool is not None and words and tool.lower() == words[0].lower():
            is_chosen = True
    if not told:
        if tool is not None and not is_chosen:
            raise SettingsError(f"The table holds poses of one tool.{_not_there(tool)}", "Leave out {tool}.")
        return cells, []
    for place, words in told.items() if tool is not None and not is_chosen else ():
        names = list(dict.fromkeys(words))
        number = _chosen(names, tool, by_place=False)
        if number is not None:
            chosen = cells.where([word == names[number] for word in words])
            which = f"{names[number]}, of {listed(names)} (column {track.described[place].heading})"
            return chosen, [f"tool: {which}; {len(chosen)} of {len(words)} rows"]
    place, words = next(iter(told.items()))
    names = list(dict.fromkeys(words))
    raise SettingsError(
        f"The table holds poses of {len(names)} tools, told by its column {track.described[place].heading}: {listed(names[:8])}."
        + _not_there(None if is_chosen else tool),
        WHICH_TOOL,
        first=names[0],
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


def _by_name(columns: Sequence[Column], sheet: Sheet, is_preset: bool) -> list[Track]:
    """The tools whose names stand before, or behind, what their columns hold.

    Names may be words that mean something of a pose. So all columns are read in each of a few ways, and a way counts only if it leaves
    whole poses and nothing of a pose beside them. Ways that differ in this are asked about.
    """
    ways: dict[frozenset[frozenset[tuple[int, str]]], list[Track]] = {}
    unread = [column for column in columns if column.role is None and column.words and not parts_of(column.words)]
    if len(unread) >= _MOST_UNREAD and not is_preset:
        raise name_the_columns(f"{len(unread)} headings are not known.", sheet)
    for behind, longest in product((False, True), (True, False)):
        tracks = _grouped(columns, behind, longest, is_preset)
        if tracks:
            what = (frozenset((p, c.role) for p, c in track.described.items() if c.role in POSE) for track in tracks)
            ways.setdefault(frozenset(what), tracks)
    if len(ways) == 1:
        return next(iter(ways.values()))
    known = listed(dict.fromkeys(column.role for column in columns if column.role and not column.role.startswith("#"))) or "none"
    if ways:
        raise name_the_columns("The headings can be read in several ways.", sheet)
    raise name_the_columns(
        "The poses must be 4x4 matrices (m00 to m33), or x y z with a quaternion (qx qy qz qw), angles (rx ry rz) or a 3x3 rotation; "
        f"known columns: {known}.",
        sheet,
    )


def _grouped(columns: Sequence[Column], behind: bool, longest: bool, is_preset: bool) -> list[Track]:
    """The tools, names behind what columns hold or before it; none where poses are not whole, or something of a pose is left."""
    groups: dict[str, dict[int, Column]] = {}
    beside: dict[int, Column] = {}
    unexplained = 0
    for place, column in enumerate(columns):
        parts = parts_of(column.words)
        own = [(tool[behind], role) for tool, role in (parts if longest else reversed(parts)) if not tool[not behind]]
        unexplained += not own and any(_is_of_pose(role) for _, role in parts)
        named = next((each for each in own if each[0]), None)
        alone = column.role if not column.words else next((role for name, role in own if not name), None)
        if alone is not None and (longest or named is None):
            name, role = "", alone
        elif named is not None:
            name, role = named
        else:
            continue
        if name or _is_of_pose(role) or role in (STATUS, OCCLUDED):
            groups.setdefault(name.lower(), {})[place] = replace(column, role=role)
        else:
            beside[place] = replace(column, role=role)
    tracks = []
    for name, group in groups.items():
        names = numbered({column.role for column in group.values() if column.role})
        group = {place: replace(column, role=names.get(column.role or "", column.role)) for place, column in group.items()}
        tracks.append(Track(name, group))
    return _with_what_is_beside(tracks, beside, columns) if is_preset or unexplained < len(TRANSLATION) else []


def _with_what_is_beside(tracks: list[Track], beside: dict[int, Column], columns: Sequence[Column]) -> list[Track]:
    whole = [track for track in tracks if track.is_whole]
    others = [track for track in tracks if not track.is_whole]
    if not whole and len(tracks) == 2 and "" in [track.name for track in tracks]:  # some columns of one pose are named more fully
        whole, others = [Track("", dict(sorted({**tracks[0].described, **tracks[1].described}.items())))], []
        if not whole[0].is_whole or _twice(whole[0]):
            return []
    others = [track for track in others if "marker" not in track.name]  # they have places alone
    left = {place: column for track in others for place, column in track.described.items()}
    if not whole or any(_is_of_pose(column.role or "") for column in left.values()):
        return []
    beside |= left
    found = []
    for track in sorted(whole, key=lambda track: min(track.described)):
        roles = {column.role for column in track.described.values()}
        more = {place: column for place, column in beside.items() if column.role not in roles}
        found.append(Track(_shown(track, columns), dict(sorted({**track.described, **more}.items()))))
    words = {word for track in found for word in track.name.split()}
    return [
        replace(track, name=track.name or (f"unnamed {number}" if str(number) in words else str(number)))
        for number, track in enumerate(found, start=1)
    ]


def _shown(track: Track, columns: Sequence[Column]) -> str:
    """The name as the headings write it."""
    words = [word for place in track.described for word in columns[place].words]
    return " ".join(next((word for word in words if word.lower() == part), part) for part in track.name.split())


def _is_of_pose(role: str) -> bool:
    return role in POSE or (role.startswith(("#", "o")) and role != OCCLUDED) or role in ("pitch", "yaw")


def _repeated(columns: Sequence[Column], sheet: Sheet) -> list[Track]:
    """The columns of each tool where the same headings are written again and again; those before them may differ by the tool's name."""
    counts = Counter(column.heading for column in columns if column.heading)
    turns = [column.heading for column in columns if column.role and column.role not in TRANSLATION and _is_of_pose(column.role)]
    times = max((counts[heading] for heading in turns), default=1)
    if times < 2 or sheet.groups:
        return []
    first = next(column.heading for column in columns if column.heading and counts[column.heading] == times)
    starts, names = [place for place, column in enumerate(columns) if column.heading == first], [""] * times
    described = dict(enumerate(columns))
    while starts[0] > 0:
        before = [{role: tool[0] for tool, role in parts_of(columns[start - 1].words) if tool[0] and not tool[1]} for start in starts]
        axis = next((axis for axis in TRANSLATION if all(axis in each for each in before)), None)
        if axis is None:
            break
        starts, names = [start - 1 for start in starts], [each[axis] for each in before]
        described |= {start: replace(columns[start], role=axis) for start in starts}
    longest = max(end - start for start, end in pairwise(starts))
    shared = {place: column for place, column in described.items() if place < starts[0]}
    tracks = []
    for number, start, end in zip(range(times), starts, [*starts[1:], min(starts[-1] + longest, len(columns))]):
        part = {place: described[place] for place in range(start, end) if described[place].role is not None}
        told = numbered({column.role for column in part.values() if column.role})
        part = {place: replace(column, role=told.get(column.role or "", column.role)) for place, column in part.items()}
        tool = next((place for place, column in part.items() if column.role == TOOL), None)
        words = set() if tool is None else {cells_of(row, sheet.separator)[tool : tool + 1][0] for row in sheet.rows[:50]}
        own = {column.role for column in part.values()}
        part |= {place: column for place, column in shared.items() if column.role not in own and not _is_of_pose(column.role or "")}
        tracks.append(Track(names[number] or (words.pop() if len(words) == 1 else str(number + 1)), dict(sorted(part.items()))))
    if len({track.name.lower() for track in tracks}) < len(tracks):
        tracks = [replace(track, name=str(number)) for number, track in enumerate(tracks, start=1)]
    return tracks if all(track.is_whole for track in tracks) else []


def _twice(track: Track) -> list[str]:
    counts = Counter(column.role for column in track.described.values())
    return [role for role, count in counts.items() if role in _ONLY_ONE and count > 1]


def _checked(track: Track, sheet: Sheet) -> Track:
    """The track with one column for each value of its pose: markers beside a tool have places as well, and no rotation.

    Raises SettingsError when two columns mean the same.
    """
    described = dict(track.described)
    turns = [place for place, column in described.items() if any(column.role in way for way in WAYS)]
    triples = [
        (place, place + 1, place + 2)
        for place in described
        if [described[p].role if p in described else None for p in (place, place + 1, place + 2)] == list(TRANSLATION)
    ]
    near = [triple for triple in triples if turns and (triple[0] == max(turns) + 1 or triple[2] == min(turns) - 1)]
    if len(triples) > 1 and len(near) == 1:
        described = {p: c for p, c in described.items() if c.role not in TRANSLATION or p in near[0]}
    for role in _twice(Track("", described)):
        both = [f"{column.heading} (column {place + 1})" for place, column in described.items() if column.role == role]
        raise name_the_columns(f"{len(both)} columns mean {role}: {listed(both)}.", sheet)
    frames = [place for place, column in described.items() if column.role == FRAME]
    return Track(track.name, {place: column for place, column in described.items() if place not in frames[1:]})
