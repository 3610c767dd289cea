"""The numbers of the study of free paths as tables: all lines of all patients together."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from AIFReconLib.evaluation.lines import BLOCKED, FREE, Roc, told_apart
from AIFReconLib.paths.states import FREE as GIVEN_FREE
from AIFReconLib.paths.states import ROOM, TIGHT, states_of
from AIFReconLib.paths.surroundings import FAR

from .method_cases import OURS, PLAIN
from .paths_cases import FIXED, NONE, PLANNED, RIGHT, WRONG, Row
from .patients import table_head, table_line

WITH_BONE = "the same, with the CT's bone"
SHOWN = (
    (f"`{PLAIN}`", NONE, PLAIN, False),
    (f"`{OURS}`, no CT", NONE, OURS, False),
    (f"`{OURS}`, {WRONG}", WRONG, OURS, True),
    (f"`{OURS}`, {RIGHT}", RIGHT, OURS, False),
    (WITH_BONE, RIGHT, OURS, True),
    (f"the CT alone, {WRONG.removeprefix('CT ')}", WRONG, "", False),
    ("the CT alone, right", RIGHT, "", False),
)
"""Lines of the tables: name, CT, method, and whether the CT's bone counts beside the volume's where both agree."""


@dataclass(frozen=True, eq=False)
class Judged:
    """All lines of some rows, (n,) each."""

    truth: np.ndarray  #: mm
    clearance: np.ndarray  #: mm
    seen: np.ndarray
    brightest: np.ndarray | None
    unreached: np.ndarray  #: Share in no beam, or in shadow only
    margin: float

    @classmethod
    def of(cls, rows: Iterable[Row], with_ct: bool) -> Judged:
        """Of the rows of some patients; a CT alone is taken to have seen all."""
        rows = list(rows)
        truth, reached = (np.concatenate([getattr(row, name) for row in rows]) for name in ("truth", "reached"))
        clearance = np.concatenate([row.with_ct if with_ct else row.clearance for row in rows])
        if not rows[0].method:
            return cls(truth, clearance, np.ones(len(truth)), None, 1.0 - reached, rows[0].margin)
        seen, brightest = (np.concatenate([getattr(row, name) for row in rows]) for name in ("seen", "brightest"))
        return cls(truth, clearance, seen, brightest, 1.0 - reached, rows[0].margin)

    @property
    def free(self) -> np.ndarray:
        """Which ones pass, (n,) bool."""
        return self.truth >= FREE

    @property
    def blocked(self) -> np.ndarray:
        """Which ones touch bone, (n,) bool."""
        return self.truth <= BLOCKED

    @property
    def given(self) -> np.ndarray:
        """Which ones the product calls free or tight, (n,) bool."""
        return states_of(self.clearance, self.seen) >= TIGHT

    def told_by(self, number: np.ndarray) -> Roc:
        """By a number that is to be greater for free lines."""
        return told_apart(number[self.free], number[self.blocked])

    def told_by_seen(self) -> float:
        """Blocked called free where nine in ten of the free lines that were seen are found; what was not seen is not called free."""
        all_seen = self.seen >= 1.0
        return told_apart(self.clearance[self.free & all_seen], np.where(all_seen, self.clearance, -np.inf)[self.blocked])[1]

    def cells(self) -> list[str]:
        """What a line of the tables holds."""
        free, blocked, given = self.free, self.blocked, self.given
        bright = (np.nan, np.nan) if self.brightest is None else self.told_by(-self.brightest)
        near = self.told_by(self.clearance)
        clear = states_of(self.clearance, self.seen) == GIVEN_FREE
        off = np.abs(np.maximum(self.clearance + self.margin, 0.0) - np.clip(self.truth, 0.0, FAR))
        return [
            _number(bright[0]),
            _share(bright[1]),
            _number(near[0]),
            _share(near[1]),
            _share(self.told_by_seen()),
            _share(_mean(self.seen[free] >= 1.0)),
            _share(_mean(given[free])),
            _share(_mean(given[blocked]), 2),
            _share(_mean(clear[blocked]), 2),
            _share(_mean(self.unreached[given] > 0.0)),
            _share(_mean(off[free & (self.seen >= 1.0)] <= 1.0)),
        ]


COLUMNS = (
    "area, brightest",
    "blocked called free",
    "area, distance",
    "blocked called free",
    "the same of lines seen",
    "free lines seen",
    "free given",
    "blocked given",
    f"blocked given {ROOM:g} mm",
    "given through what no beam reached",
    "distance within 1 mm",
)


def paths_page(rows: list[Row]) -> str:
    """A table for each scan."""
    text = []
    for scan in (FIXED, PLANNED):
        some = [row for row in rows if row.scan == scan]
        text += [_head(some, scan), table_of(some)]
    return "\n\n".join(text) + "\n"


def table_of(rows: list[Row]) -> str:
    """The table of one scan, with the lines that there are rows of."""
    there = {(row.ct, row.method) for row in rows}
    shown = [one for one in SHOWN if (one[1], one[2]) in there]
    return "\n".join([*table_head(COLUMNS), *(table_line(one[0], judged_of(rows, *one[1:]).cells()) for one in shown)])


def judged_of(rows: list[Row], ct: str, method: str, with_ct: bool) -> Judged:
    """All lines of one scan, CT and method."""
    return Judged.of([row for row in rows if (row.ct, row.method) == (ct, method)], with_ct)


def _head(rows: list[Row], scan: str) -> str:
    """What a table is of."""
    right = [row for row in rows if (row.ct, row.method) == (RIGHT, OURS)]
    truth = np.concatenate([row.truth for row in right])
    off = [row.misplaced for row in right]
    return (
        f"**{scan.capitalize()}s** of {right[0].frames} frames, {len(right)} patients: {(truth >= FREE).sum():,} free lines and "
        f"{(truth <= BLOCKED).sum():,} blocked ones. `register` accepted {sum(row.accepted for row in right)} of {len(right)} CTs and left "
        f"them {np.median(off):.1f} mm off, {max(off):.1f} mm at worst."
    )


def _mean(chosen: np.ndarray) -> float:
    return float(chosen.mean()) if chosen.size else float("nan")


def _share(number: float, digits: int = 1) -> str:
    return "-" if number != number else f"{100 * number:.{digits}f}%"


def _number(number: float) -> str:
    return "-" if number != number else f"{number:.3f}"
