"""How far an operator's hand is from where it was told to be: what a plan counts on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .probe import Placement


@dataclass(frozen=True)
class Hand:
    """Standard deviations of normal errors."""

    off_mm: float = 5.0
    off_deg: float = 5.0
    """Of a whole pass: of its place along each axis of the skin, and of each of the three angles."""
    wander_mm: float = 1.0
    wander_deg: float = 1.0
    """The same of every frame of it, besides."""

    def follow(self, placements: Sequence[Placement], rng: np.random.Generator) -> list[Placement]:
        """A pass as this hand makes it; another one with every call."""
        off = rng.standard_normal(5) * ([self.off_mm] * 2 + [self.off_deg] * 3)
        wander = rng.standard_normal((len(placements), 5)) * ([self.wander_mm] * 2 + [self.wander_deg] * 3)
        return [
            replace(
                one,
                x=one.x + float(x),
                z=one.z + float(z),
                turn_deg=one.turn_deg + float(turn),
                in_plane_deg=one.in_plane_deg + float(tilt),
                across_deg=one.across_deg + float(across),
            )
            for one, (x, z, turn, tilt, across) in zip(placements, off + wander, strict=True)
        ]


HAND = Hand()
"""What plans and advice count on."""
