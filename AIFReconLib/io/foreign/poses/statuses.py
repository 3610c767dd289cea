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
from ....remedies import Remedy
from .headings import OCCLUDED, TABLES

_KNOWN = {word: TransformStatus[name] for name, words in TABLES["statuses"].items() for word in words.split()}
_IS_SO = {"true": True, "yes": True, "1": True, "false": False, "no": False, "0": False}
_SAYS_WHETHER = re.compile("valid|visib|track|enabled|found|detect", re.IGNORECASE)
"""Headings whose numbers say yes or no: 1 is good. A number below `status` may be a code, whose 0 is good."""


def statuses_of(words: Sequence[str], heading: str, role: str, has_pose: Mask, good: Sequence[str]) -> tuple[tuple[str, ...], str]:
    """One of Plus's statuses for each word, by its name; and in words how they were taken.

    Raises SettingsError when a word is not known.

    Parameters
    ----------
    words : sequence of str
    heading : str
        Of their column.
    role : str
        STATUS or OCCLUDED.
    has_pose : (n,) bool array
        Where there is a pose that is more than zeros.
    good : sequence of str
        What the user says is good.
    """
    kinds = {word: _status(word, heading, role, good) for word in dict.fromkeys(words)}
    posed = {word for word, has in zip(words, has_pose) if has}
    numbers = [word for word, status in kinds.items() if status is None and word in ("0", "1")]
    if len(numbers) == 2 and len(posed.intersection(numbers)) == 1:
        # A number that stands only where there is no pose is bad, and the other one good
        kinds |= {word: TransformStatus.OK if word in posed else TransformStatus.MISSING for word in numbers}
    if kinds.get("", True) is None and "" not in posed:
        kinds[""] = TransformStatus.MISSING
    unknown = [shorten(word) or "nothing" for word, status in kinds.items() if status is None]
    if unknown:
        raise SettingsError(
            f"What the column {heading} says of a pose is not known: {listed(unknown[:8])}.",
            Remedy.GOOD_STATUS,
            word=unknown[0],
            choices=unknown,
        )
    taken = {word: status.value for word, status in kinds.items() if status is not None}
    told = listed(f"{shorten(word) or 'nothing'} is {status} ({words.count(word)})" for word, status in taken.items())
    return tuple(taken[word] for word in words), f"status ({heading}): {told}"


def _status(word: str, heading: str, role: str, good: Sequence[str]) -> TransformStatus | None:
    """That of a word; None of one that is not known."""
    plain = re.sub("[^a-z0-9]", "", word.lower())
    of_plus = TransformStatus.parse(word.strip().replace(" ", "_"))
    known = _KNOWN.get(plain, of_plus if of_plus is not TransformStatus.UNKNOWN or plain == "unknown" else None)
    if good:
        bad = TransformStatus.INVALID if known in (None, TransformStatus.OK) else known
        return TransformStatus.OK if word.lower() in [each.lower() for each in good] else bad
    if role == OCCLUDED:
        hidden = _IS_SO.get(plain)
        return None if hidden is None else TransformStatus.MISSING if hidden else TransformStatus.OK
    if plain in ("0", "1") and _SAYS_WHETHER.search(heading):
        return TransformStatus.OK if plain == "1" else TransformStatus.INVALID
    return known
