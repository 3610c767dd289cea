"""What trackers say of a pose, in the words of their makers (`pose_tables.json`), as one of Plus's statuses.

Sources: NDI Combined API (TransformStatus), NDI Track, Atracsys fusionTrack, OptiTrack Motive, Vicon Nexus, Plus.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from ....arrays import Mask
from ....errors import SettingsError
from ....geometry.transform_graph import TransformStatus
from ....message import listed, shorten
from .headings import OCCLUDED, STATUS, TABLES, plain_word
from .sheet import Sheet
from .tracks import Track


def _vocabulary(name: str) -> dict[str, TransformStatus]:
    return {word: TransformStatus[status] for status, words in TABLES[name].items() for word in words.split()}


_KNOWN = {plain_word(status.value): status for status in TransformStatus} | _vocabulary("statuses")
_OCCLUDED = _vocabulary("occluded")
_YES_OR_NO = _KNOWN | {"1": TransformStatus.OK, "0": TransformStatus.INVALID}
_SAYS_WHETHER = re.compile("valid|visib|track|enabled|found|detect", re.IGNORECASE)
"""Headings whose numbers say yes or no: 1 is good. A number below `status` may be a code, whose 0 is good."""


def statuses_in(track: Track, sheet: Sheet, has_pose: Mask, good: Sequence[str]) -> tuple[tuple[str, ...] | None, list[str]]:
    """One of Plus's statuses for each row, by its name, where a column says them; and in words how they were taken.

    Raises SettingsError when a word is not known.

    Parameters
    ----------
    track : Track
    sheet : Sheet
    has_pose : (n,) bool array
        Where there is a pose that is more than zeros.
    good : sequence of str
        What the user says is good.
    """
    role = next((role for role in (STATUS, OCCLUDED) if role in track.columns), None)
    if role is None:
        return None, []
    place = track.columns[role]
    heading, words = track.described[place].heading, sheet.words(place)
    known = _OCCLUDED if role == OCCLUDED else _YES_OR_NO if _SAYS_WHETHER.search(heading) else _KNOWN
    kinds = {word: known.get(plain_word(word)) for word in dict.fromkeys(words)}
    for word, status in kinds.items() if good else ():
        others = TransformStatus.INVALID if status in (None, TransformStatus.OK) else status
        kinds[word] = TransformStatus.OK if word.lower() in map(str.lower, good) else others
    if kinds.get("", True) is None and not any(has for word, has in zip(words, has_pose) if not word):
        kinds[""] = TransformStatus.MISSING
    unknown = [shorten(word) or "nothing" for word, status in kinds.items() if status is None]
    if unknown:
        told = f"What the column {heading} says of a pose is not known: {listed(unknown[:8])}."
        advice = 'Give the words that mean a valid pose, as in {status_ok:"{word}"}.'
        raise SettingsError(told, advice, word=unknown[0], choices=unknown)
    taken = {word: status.value for word, status in kinds.items() if status is not None}
    told = listed(f"{shorten(word) or 'nothing'} is {status} ({words.count(word)})" for word, status in taken.items())
    return tuple(taken[word] for word in words), [f"status ({heading}): {told}"]
