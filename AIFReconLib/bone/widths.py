"""How wide the map of bone is around labels, where nobody says it."""

from __future__ import annotations

SIGMA_VOXELS = 10.0
"""Smoothing of the probability map in the paper, in voxels of the labels."""

UNKNOWN_WIDTH = 3.0
"""mm. Where CT and sweep were not compared, as before a live scan: the widest that an agreement asks for."""
