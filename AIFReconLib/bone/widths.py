"""How wide the map of bone is around labels, where nobody says it."""

from __future__ import annotations

import math
from collections.abc import Sequence

SIGMA_VOXELS = 10.0
"""Smoothing of the probability map in the paper, in voxels of the labels."""

UNKNOWN_WIDTH = 3.0
"""mm. Where CT and sweep were not compared, as before a live scan: the widest that an agreement asks for."""

PADDING = 8
"""Voxels of nothing around bone, beyond what smoothing reaches."""

SMOOTHING_REACH = 4.0
"""Sigmas."""


def voxels_around(spacing: Sequence[float], sigma_voxels: float | None = None, sigma_mm: float | None = None) -> int:
    """How many voxels of these spacings, (3,) mm, around bone leave room for its map; of a width that nobody says, for the widest."""
    millimeters = UNKNOWN_WIDTH if sigma_voxels is None and sigma_mm is None else sigma_mm
    sigma = (SIGMA_VOXELS if sigma_voxels is None else sigma_voxels) if millimeters is None else millimeters / min(spacing)
    return math.ceil(SMOOTHING_REACH * sigma) + PADDING if math.isfinite(sigma) and sigma > 0 else 0
