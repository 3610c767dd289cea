"""Which gray levels of ultrasound are worth showing."""

from __future__ import annotations

import numpy as np

from ..arrays import Numbers

BRIGHTEST_SHARE = 99.5
"""Percent of the measured voxels that the window reaches up to: single bright voxels must not darken the rest."""

SAMPLED = 250_000
"""Voxels that are looked at, at most."""


def gray_window(intensity: Numbers, mask: Numbers) -> tuple[float, float]:
    """Gray levels to show black and white: from 0, or the darkest, to what all but the brightest 0.5% of measured voxels stay below.

    Both arrays have one shape; what `mask` has as 0 was not measured.
    """
    step = max(1, intensity.size // SAMPLED)
    levels = intensity.ravel()[::step][mask.ravel()[::step] != 0]
    levels = levels[np.isfinite(levels)]
    if not levels.size:
        return 0.0, 1.0
    brightest = float(np.percentile(levels, BRIGHTEST_SHARE))
    return min(float(levels.min()), 0.0), brightest if brightest > 0 else 1.0
