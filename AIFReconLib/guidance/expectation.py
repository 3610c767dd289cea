"""From the angles at which frames meet bone to the chance that `weighted` shows it."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from ..arrays import Floats, Singles

Number = TypeVar("Number", Floats, Singles)

ANGLES_DEG = np.array([0.0, 35.0, 42.5, 52.5, 57.5, 62.5, 67.5, 72.5, 77.5, 85.0])
EVIDENCE = np.array([6.4, 3.0, 2.0, 1.1, 0.83, 0.6, 0.32, 0.14, 0.1, 0.1])
"""What a frame at these angles of incidence adds. Most likely for what ten scans of 120 and 360 frames of two simulated patients, 100 and
101, show by the present `weighted`, borders of the interspinous gaps counted three times (docs/guidance.md)."""

MOST = 0.995
"""The chance that bone shows which was met squarely without end."""


def evidence_of(cosines: Floats) -> Floats:
    """What each of some frames that meet a point adds to its evidence, by the cosine of its angle of incidence."""
    evidence: Floats = np.interp(np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0))), ANGLES_DEG, EVIDENCE)
    return evidence


def expected_visibility(evidence: Floats) -> Floats:
    """The chance that bone shows, 0 to 1, by the sum of the evidence of all frames that meet it.

    Notes
    -----
    MOST (1 - exp(-sqrt(evidence))). Were frames independent, the root would not be there; but bone that many frames did not show is bone
    that is hard to show.
    """
    shown: Floats = MOST * (1.0 - unseen(evidence))
    return shown


def unseen(evidence: Number) -> Number:
    """The part of `MOST` that is still missing, in the precision of the evidence."""
    missing: Number = np.exp(-np.sqrt(evidence))
    return missing


def evidence_for(visibility: Floats) -> Floats:
    """The evidence by which bone is expected to show so likely: the inverse of `expected_visibility`."""
    evidence: Floats = np.log1p(-visibility / MOST) ** 2
    return evidence
