"""Automatic fan angles: which part of a fan has contact, told frame by frame from its brightness, as IGSIO does."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .region import Fan

DEPTHS = (0.15, 0.30, 0.50, 0.70)
"""Where the arcs are that are looked at, as shares of the way from the fan's first to its last radius."""

MARGIN_DEG = 3.0
"""What is taken off each side of the lit part."""


@dataclass(frozen=True)
class FanDetection:
    """How lit parts of a fan are told from dark ones.

    Parameters
    ----------
    threshold : float
        Gray level that a lit pixel has at least.
    filter_radius_px : int
        Half the length of the window, along the arc, of which half the pixels must be lit.
    """

    threshold: float = 30.0
    filter_radius_px: int = 10

    def angles(self, image: np.ndarray, fan: Fan) -> tuple[float, float] | None:
        """The angles between which a frame shows something.

        Parameters
        ----------
        image : (rows, columns) array
        fan : Fan
            In pixels; the answer lies within its angles.

        Returns
        -------
        angles_deg : (first, last) or None
            None where no arc is lit.

        Notes
        -----
        The widest lit part of any of four arcs, 3 degrees off either side. Arcs are sampled a pixel apart from the first angle on;
        samples outside the image are left out, and the apex counts in whole pixels.
        """
        widest = (0.0, 0.0)
        for depth in DEPTHS:
            angles, lit = self._arc(image, fan, fan.radii[0] + (fan.radii[1] - fan.radii[0]) * depth)
            for part in self._lit_parts(angles, lit, math.radians(fan.angles_deg[1])):
                if part[1] - part[0] > widest[1] - widest[0]:
                    widest = part
        if widest == (0.0, 0.0):
            return None
        first = max(math.degrees(widest[0]) + MARGIN_DEG, fan.angles_deg[0])
        last = min(math.degrees(widest[1]) - MARGIN_DEG, fan.angles_deg[1])
        return tuple(sorted((first, last))) if first != last else None

    def _arc(self, image: np.ndarray, fan: Fan, radius: float) -> tuple[np.ndarray, np.ndarray]:
        """Angles along an arc, rad, and whether the pixels there are lit."""
        first, last = (math.radians(angle) for angle in fan.angles_deg)
        angles = first + np.arange(int((last - first) * radius)) / max(radius, 1e-9)
        column = _rounded(int(fan.apex_px[0]) + radius * np.sin(angles))
        row = _rounded(int(fan.apex_px[1]) + radius * np.cos(angles))
        inside = (column >= 0) & (column < image.shape[1]) & (row >= 0) & (row < image.shape[0])
        return angles[inside], image[row[inside], column[inside]] >= self.threshold

    def _lit_parts(self, angles: np.ndarray, lit: np.ndarray, end: float) -> list[tuple[float, float]]:
        """First and last angle of each lit part of an arc; one that does not end on it ends at `end`."""
        window = 2 * self.filter_radius_px
        count = np.cumsum(np.concatenate([[0], lit]))
        parts, start = [], None
        for place in range(window, len(angles)):
            inside = count[place] - count[place - window]
            if start is None and 2 * inside >= window:
                start = float(angles[place - window])
            elif start is not None and 2 * inside <= window:
                parts.append((start, float(angles[place - 1])))
                start = None
        return parts if start is None else [*parts, (start, end)]


def _rounded(numbers: np.ndarray) -> np.ndarray:
    """The nearest whole numbers, halves away from zero."""
    return np.trunc(numbers + np.copysign(0.5, numbers)).astype(np.int64)
