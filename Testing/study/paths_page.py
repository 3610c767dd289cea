"""The numbers of the study of free paths as tables: all lines of all patients together."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from measured import shown, table

from AIFReconLib.evaluation.lines import BLOCKED, FREE, Roc, told_apart
from AIFReconLib.paths.states import FREE as GIVEN_FREE
from AIFReconLib.paths.states import ROOM, TIGHT, states_of
from AIFReconLib.paths.surroundings import FAR

from .method_cases import OURS, PLAIN
from .paths_cases import FIXED, NONE, PLANNED, RIGHT, WRONG, Row

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

    def columns(self) -> list[tuple[str, str]]:
        """What the tables say of them, by its heading."""
        free, blocked, given = self.free, self.blocked, self.given
        bright = (np.nan, np.nan) if self.brightest is None else self.told_by(-self.brightest)
        near, all_seen = self.told_by(self.clearance), self.seen >= 1.0
        clear = states_of(self.clearance, self.seen) == GIVEN_FREE
        off = np.abs(np.maximum(self.clearance + self.margin, 0.0) - np.clip(self.truth, 0.0, FAR))
        return [
            ("area, brightest", shown(bright[0], ".3f")),
            ("blocked called free", shown(bright[1], ".1%")),
            ("area, distance", shown(near[0], ".3f")),
            ("blocked called free", shown(near[1], ".1%")),
            ("the same of lines seen", shown(self.told_by_seen(), ".1%")),
            ("free lines seen", _share(all_seen[free])),
            ("free given", _share(given[free])),
            ("blocked given", _share(given[blocked], ".2%")),
            (f"blocked given {ROOM:g} mm", _share(clear[blocked], ".2%")),
            ("given through what no beam reached", _share(self.unreached[given] > 0.0)),
            ("distance within 1 mm", _share(off[free & all_seen] <= 1.0)),
        ]


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
    lines = {name: judged_of(rows, ct, method, with_ct).columns() for name, ct, method, with_ct in SHOWN if (ct, method) in there}
    heads = [head for head, _ in next(iter(lines.values()))]
    return table(["", *heads], ([name, *(cell for _, cell in columns)] for name, columns in lines.items()))


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


def _share(chosen: np.ndarray, form: str = ".1%") -> str:
    return shown(float(chosen.mean()) if chosen.size else np.nan, form)
