"""From the best angle at which bone was met to the chance that `weighted` shows it."""

from __future__ import annotations

import numpy as np

from ..arrays import Floats

ANGLES_DEG = np.array([0.0, 38.0, 52.5, 65.0, 72.5, 77.5, 85.0])
SHOWN = np.array([0.96, 0.95, 0.78, 0.54, 0.30, 0.18, 0.08])
"""Part of bone at these best angles of incidence that stands out in `weighted`, each at the middle of its range. Between what docs/study.md
measured of the fixed scan (94%, 71%, 53%, 25%, and 18% to 4% beyond 75 degrees) and what a planned scan of patient 100 with as many frames
and an operator's errors showed (95%, 82%, 53%, 29%, 20% and 13%): there several frames come near the best angle."""


def expected_visibility(best_cosine: Floats) -> Floats:
    """The chance that bone shows, 0 to 1, of points whose best cosines of incidence are given (NaN: not met, chance 0)."""
    met = np.isfinite(best_cosine)
    angles = np.degrees(np.arccos(np.clip(np.where(met, best_cosine, 0.0), -1.0, 1.0)))
    return np.where(met, np.interp(angles, ANGLES_DEG, SHOWN), 0.0)
