"""From the best angle at which bone was met to the chance that `weighted` shows it."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats

ANGLES_DEG = np.array([0.0, 38.0, 52.5, 65.0, 72.5, 77.5, 85.0])
SHOWN = np.array([0.96, 0.95, 0.80, 0.56, 0.34, 0.24, 0.12])
"""Part of bone at these best angles of incidence that stands out in `weighted`, each at the middle of its range: about the mean of planned
and followed scans of 120 and 360 frames of two simulated patients (docs/guidance.md). A scan whose frames lie far apart shows less, one
that returns to the same place often more."""


def expected_visibility(best_cosine: Floats) -> Floats:
    """The chance that bone shows, 0 to 1, of points whose best cosines of incidence are given (NaN: not met, chance 0)."""
    met = np.isfinite(best_cosine)
    angles = np.degrees(np.arccos(np.clip(np.where(met, best_cosine, 0.0), -1.0, 1.0)))
    return np.where(met, np.interp(angles, ANGLES_DEG, SHOWN), 0.0)
