"""Where each beam goes: the direction of sound through every pixel of an image.

A linear array sends parallel beams down the image columns. Curvilinear and phased arrays send them from a virtual apex, a
point behind (curvilinear) or on (phased array) the transducer's face.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Mask, Singles
from ..errors import BeamGeometryError
from ..remedies import NAME_THE_PROBE

LINEAR = "linear"
SECTOR = "sector"

DRAWN = 9
"""Beams that are drawn."""


@dataclass(frozen=True)
class ProbeGeometry:
    """The shape of the beams."""

    kind: str  #: "linear" or "sector"
    apex_px: tuple[float, float] | None = None
    """(column, row). Virtual apex of a sector, in pixels of the MF-oriented image; it may lie outside the image."""

    def __post_init__(self) -> None:
        if self.kind not in (LINEAR, SECTOR):
            raise BeamGeometryError(f"Input probe must be linear or sector; got {self.kind!r}.")
        if self.kind == SECTOR and (self.apex_px is None or len(self.apex_px) != 2 or not all(math.isfinite(v) for v in self.apex_px)):
            raise BeamGeometryError(f"Input apex of a sector probe must be a column and a row; got {self.apex_px!r}.", NAME_THE_PROBE)

    @property
    def apex(self) -> tuple[float, float]:
        """The apex (column, row) of a sector, px.

        Raises
        ------
        BeamGeometryError
            When the probe is linear: its beams meet nowhere.
        """
        if self.apex_px is None:
            raise BeamGeometryError("A linear probe has no apex.", NAME_THE_PROBE)
        return self.apex_px

    def directions(self, columns: int, rows: int, spacing: tuple[float, float]) -> Singles:
        """Beam direction through every pixel.

        Parameters
        ----------
        spacing : (x, y), mm
            Pixel pitch; it is applied before normalizing, so anisotropic pixels do not bend the beams.

        Returns
        -------
        directions_image : (rows, columns, 2) float32 array, unit vectors
            Components along the image's columns (x) and rows (y). The third, elevational component of a beam in the imaging plane
            is 0. At the apex itself, where no direction exists, the vector is 0.
        """
        directions = np.zeros((rows, columns, 2), dtype=np.float32)
        if self.kind == LINEAR:
            directions[..., 1] = 1.0
            return directions
        column, row = self.apex
        x = (np.arange(columns, dtype=np.float64) - column)[None, :] * spacing[0]
        y = (np.arange(rows, dtype=np.float64) - row)[:, None] * spacing[1]
        distance = np.hypot(x, y)
        distance[distance == 0] = np.inf
        directions[..., 0] = x / distance
        directions[..., 1] = y / distance
        return directions

    def lines(self, mask: Mask, count: int = DRAWN) -> list[Floats]:
        """Some beams as lines of 2 points (column, row): down the image, or from the apex to the end of the kept pixels."""
        rows, columns = np.nonzero(mask)
        if self.kind != SECTOR:
            return [
                np.array([(column, rows.min()), (column, rows.max())], dtype=np.float64)
                for column in np.linspace(columns.min(), columns.max(), count)
            ]
        apex = np.array(self.apex, dtype=np.float64)
        x, y = columns - apex[0], rows - apex[1]
        angles, radii = np.arctan2(x, y), np.hypot(x, y)
        lines = []
        for angle in np.linspace(angles.min(), angles.max(), count):
            near = np.abs(angles - angle) < max(np.ptp(angles) / count / 2, 1e-3)
            radius = radii[near].max() if near.any() else radii.max()
            lines.append(np.array([apex, apex + radius * np.array([math.sin(angle), math.cos(angle)])]))
        return lines
