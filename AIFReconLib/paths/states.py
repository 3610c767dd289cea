"""What a line can meet, in one of four words."""

from __future__ import annotations

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
