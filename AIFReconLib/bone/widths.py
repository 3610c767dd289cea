"""How wide the map of bone is around labels, where nobody says it."""

from __future__ import annotations

SIGMA_VOXELS = 10.0
"""Smoothing of the probability map in the paper, in voxels of the labels."""

UNKNOWN_WIDTH = 4.0
"""mm. Where CT and sweep were not compared, as before a live scan: the paper's 10 voxels on a CT of 0.4 mm."""
