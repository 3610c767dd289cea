"""What was tried, how often, and what came of it."""

from __future__ import annotations

import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

Trial = Callable[[Path, int], str]
"""Makes the fault once, in an empty folder; the answer says in words what came out."""


class Lost(Exception):
    """What must not be: a file that is neither version, a stray one, no sentence."""


@dataclass(frozen=True)
class Fault:
    """One fault at one place.

    Parameters
    ----------
    fault : str
        ``kill -9``, a row of the page.
    where : str
        How it was made, and which write, read or command it met.
    prepare : callable of folder, random.Random
        Makes what all trials need; the answer makes one.
    """

    fault: str
    where: str
    prepare: Callable[[Path, random.Random], Trial]


@dataclass
class Ledger:
    """What came out of each fault, and what was lost."""

    outcomes: dict[str, Counter[str]] = field(default_factory=dict)
    lost: Counter[str] = field(default_factory=Counter)

    def run(self, cases: Sequence[Fault], seconds: float) -> None:
        """Give each case its share of the time, and one trial at least."""
        chance, end = random.Random(0), time.monotonic() + seconds
        for left, case in zip(range(len(cases), 0, -1), cases):
            print(f"{case.fault}: {case.where} ...", file=sys.stderr, flush=True)
            until, number = time.monotonic() + max(end - time.monotonic(), 0) / left, 0
            outcomes = self.outcomes.setdefault(case.fault, Counter())
            with tempfile.TemporaryDirectory(prefix="faults-") as made:
                trial = case.prepare(Path(made), chance)
                while number == 0 or time.monotonic() < until:
                    with tempfile.TemporaryDirectory(prefix="faults-") as place:
                        try:
                            outcomes[trial(Path(place), number)] += 1
                        except Lost as lost:
                            self.lost[f"{case.fault}: {case.where}: {lost}"] += 1
                    number += 1

    def markdown(self) -> str:
        """A line for each fault."""
        lines = ["| Fault | times | what came out | lost |", "|---|---|---|---|"]
        for fault, outcomes in self.outcomes.items():
            lost = sum(count for what, count in self.lost.items() if what.startswith(f"{fault}: "))
            shown = outcomes.most_common(4)
            others = outcomes.total() - sum(count for _, count in shown)
            told = "; ".join([*(f"{count} {what}" for what, count in shown), *([f"{others} others"] if others else [])])
            lines.append(f"| {fault} | {outcomes.total() + lost} | {told} | {lost or 'nothing'} |")
        return "\n".join(lines)
