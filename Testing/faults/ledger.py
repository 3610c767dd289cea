"""What was tried, how often, and what came of it."""

from __future__ import annotations

import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path


@dataclass
class Entry:
    """One fault at one place.

    Parameters
    ----------
    fault : str
        ``kill -9``.
    how : str
        How it was made.
    where : str
        Which write, read or command it met.
    outcomes : Counter of str
        What came out, each with its number of times.
    lost : Counter of str
        What must not be; empty when nothing was lost.
    """

    fault: str
    how: str
    where: str
    outcomes: Counter = field(default_factory=Counter)
    cleared: int = 0
    """Temporary folders that a killed program left, and the next write took away."""
    lost: Counter = field(default_factory=Counter)

    @property
    def times(self) -> int:
        """How often it was tried."""
        return self.outcomes.total() + self.lost.total()

    def cells(self) -> list[str]:
        """The row of a table."""
        told = [", ".join(f"{count} {what}" for what, count in counter.most_common()) for counter in (self.outcomes, self.lost)]
        cleared = f"; {self.cleared} temporary folders left, cleared by the next write" if self.cleared else ""
        return [self.fault, self.how, self.where, str(self.times), told[0] + cleared, told[1] or "nothing"]


class Ledger:
    """All entries, and the time that is left for more.

    Parameters
    ----------
    seconds : float
        How long entries may be begun.
    keep : Path or None
        Where the table is written after every entry, so that a run that is ended has not been for nothing.
    """

    def __init__(self, seconds: float, keep: Path | None = None):
        self._keep = keep
        self.entries: list[Entry] = []
        self._until = time.monotonic() + seconds
        self.left_out: list[str] = []

    def begin(self, fault: str, how: str, where: str) -> Entry | None:
        """A new entry; None when the time is up."""
        if self.time_left() <= 0:
            self.left_out.append(f"{fault}: {where}")
            return None
        if self._keep is not None:
            self._keep.write_text(self.markdown(), encoding="utf-8")
        self.entries.append(Entry(fault, how, where))
        print(f"{fault}: {where} ...", file=sys.stderr, flush=True)
        return self.entries[-1]

    def time_left(self) -> float:
        """s."""
        return self._until - time.monotonic()

    @property
    def lost(self) -> int:
        """How often something was lost."""
        return sum(entry.lost.total() for entry in self.entries)

    def in_the_pages(self) -> dict[str, str]:
        """What docs/reliability.md shows, by the name of the file in docs/measured: a line for each fault."""
        lines = ["| Fault | times | what came out | lost |", "|---|---|---|---|"]
        for fault in dict.fromkeys(entry.fault for entry in self.entries):
            these = [entry for entry in self.entries if entry.fault == fault]
            outcomes: Counter[str] = sum((entry.outcomes for entry in these), Counter())
            lost = sum(entry.lost.total() for entry in these)
            shown = outcomes.most_common(4)
            others = outcomes.total() - sum(count for _, count in shown)
            told = "; ".join([*(f"{count} {what}" for what, count in shown), *([f"{others} others"] if others else [])])
            lines.append(f"| {fault} | {sum(entry.times for entry in these)} | {told} | {lost or 'nothing'} |")
        return {"faults": "\n".join(lines)}

    def markdown(self) -> str:
        """All of it as a table."""
        head = ["Fault", "How it was made", "Where", "Times", "What came out", "Lost"]
        rows = [head, ["---"] * len(head), *(entry.cells() for entry in self.entries)]
        lines = ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows]
        lines += ["", f"{sum(entry.times for entry in self.entries)} trials, {self.lost} losses."]
        lines += [f"Not run, the time was up: {what}." for what in self.left_out]
        return "\n".join(lines) + "\n"
