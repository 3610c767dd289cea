"""From the best angle at which bone was met to the chance that `weighted` shows it."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats

ANGLES_DEG = np.array([0.0, 38.0, 52.5, 65.0, 72.5, 77.5, 85.0])
SHOWN = np.array([0.95, 0.94, 0.71, 0.53, 0.25, 0.11, 0.04])
"""Part of bone at these best angles of incidence that stands out in `weighted`, as docs/study.md measured it: 94% below 45 degrees, 71%
from 45 to 60, 53% from 60 to 70, 25% from 70 to 75, and 18% falling to 4% beyond; each at the middle of its range."""


def expected_visibility(best_cosine: Floats) -> Floats:
    """The chance that bone shows, 0 to 1, of points whose best cosines of incidence are given (NaN: not met, chance 0)."""
    met = np.isfinite(best_cosine)
    angles = np.degrees(np.arccos(np.clip(np.where(met, best_cosine, 0.0), -1.0, 1.0)))
    return np.where(met, np.interp(angles, ANGLES_DEG, SHOWN), 0.0)
