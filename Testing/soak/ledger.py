"""What the server did to every frame, as only the server can know it."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

WHOLE, DESTROYED, AGAIN = "whole", "destroyed", "again"
"""An image message went out whole; it was cut or spoiled on the wire; a message that had gone out before was sent once more."""

UNUSABLE, FOREIGN = "unusable", "foreign"
"""Whole, and its contents make no sense; whole, and of another device. Neither is a frame of the scan."""

FATES = (WHOLE, DESTROYED, AGAIN, UNUSABLE, FOREIGN)


@dataclass
class Ledger:
    """One line for every image message: its number, the fault it met (``plain`` without) and what became of it on the wire.

    Parameters
    ----------
    path : Path or None
        Where the lines go; None keeps the counts alone.
    """

    path: Path | None = None
    fates: Counter = field(default_factory=Counter)
    faults: Counter = field(default_factory=Counter)

    def __post_init__(self):
        self._file = open(self.path, "w", encoding="ascii") if self.path else None  # noqa: SIM115 (closed in close)

    def note(self, number: int, fault: str, fate: str) -> None:
        """Write down an image message that was sent."""
        self.fates[fault, fate] += 1
        if self._file:
            self._file.write(f"{number}\t{fault}\t{fate}\n")

    def happened(self, fault: str) -> None:
        """Count a fault, however many frames it met."""
        self.faults[fault] += 1

    def close(self) -> None:
        """Nothing more is sent."""
        if self._file:
            self._file.close()

    def total(self, *fates: str) -> int:
        """Image messages of these fates."""
        return sum(count for (_, fate), count in self.fates.items() if fate in fates)


def read_ledger(path: Path) -> tuple[dict[int, str], set[int]]:
    """The lines of a ledger.

    Returns
    -------
    whole : dict of int to str
        Number of every frame that went out whole, with the fault it met.
    destroyed : set of int
    """
    whole, destroyed = {}, set()
    for line in path.read_text("ascii").splitlines():
        number, fault, fate = line.split("\t")
        if fate == WHOLE:
            whole[int(number)] = fault
        elif fate == DESTROYED:
            destroyed.add(int(number))
    return whole, destroyed
