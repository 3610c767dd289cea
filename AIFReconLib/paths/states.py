"""What a line can meet, in one of four words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Bytes, Floats

STATES = ("blocked", "not seen", "tight", "free")
BLOCKED, NOT_SEEN, TIGHT, FREE = range(4)

COLORS = ("#73767d", "#4b6bff", "#fde725", "#5ec962")
"""Of those: as every eye tells them apart."""

ROOM = 1.0
"""mm of clearance below which a line is tight."""


def states_of(clearance: Floats, seen: Floats) -> Bytes:
    """`BLOCKED`, `NOT_SEEN`, `TIGHT` or `FREE`, (n,), of lines with these clearances, mm, and shares that were seen."""
    open_ = np.where(seen < 1.0, NOT_SEEN, np.where(clearance < ROOM, TIGHT, FREE))
    states: Bytes = np.where(clearance <= 0.0, BLOCKED, open_).astype(np.uint8)
    return states


@dataclass(frozen=True, eq=False)
class MetLine:
    """A line, and what it meets."""

    entry: Floats  #: (3,), mm in Reference. On the skin.
    end: Floats  #: (3,)
    clearance: float  #: mm. Distance from the bone that is known, less the margin.
    seen: float  #: 0 to 1. The share of it that was seen.

    @property
    def depth(self) -> float:
        """mm from the skin to the end."""
        return float(np.linalg.norm(self.end - self.entry))

    @property
    def state(self) -> int:
        """One of `AIFReconLib.paths.states`."""
        return int(states_of(np.array([self.clearance]), np.array([self.seen]))[0])
