"""Speed of sound: scanners turn time into depth with one speed, and tissue or a water bath may have another.

What a scanner shows at a depth d lies at d times the ratio of the two speeds, along the beam.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Mask, Matrix
from ..errors import BeamGeometryError
from ..recipe.recipe import Recipe
from ..remedies import NAME_THE_PROBE
from .beams import LINEAR, ProbeGeometry


@dataclass(frozen=True)
class DepthScale:
    """Moves pixels along their beams, away from the transducer's face or toward it."""

    probe: ProbeGeometry
    factor: float  #: True depth by shown depth: the true speed of sound by the scanner's
    face: float  #: Where depth is 0. Linear probe: a row, px. Sector: a radius about the apex, mm.
    spacing: tuple[float, float]  #: (x, y), mm. Pixel pitch; radii are round in mm.

    @classmethod
    def of(cls, mask: Mask, probe: ProbeGeometry, factor: float, spacing: tuple[float, float]) -> DepthScale:
        """The scale for images whose ultrasound is `mask` (rows, columns) bool: the face is where it begins."""
        rows, columns = np.nonzero(mask)
        if probe.kind == LINEAR:
            return cls(probe, factor, float(rows.min()), spacing)
        column, row = probe.apex
        radius = np.hypot((columns - column) * spacing[0], (rows - row) * spacing[1])
        return cls(probe, factor, float(radius.min()), spacing)

    @property
    def stretch(self) -> Matrix | None:
        """What moves the pixels of a linear probe, (4, 4), true from shown pixels; None for a sector, whose rows become curved."""
        if self.probe.kind != LINEAR:
            return None
        matrix = np.diag([1.0, self.factor, 1.0, 1.0])
        matrix[1, 3] = self.face - self.factor * self.face
        return matrix

    def moved(self, pixels: Floats) -> Floats:
        """Where pixels truly are.

        `pixels` are (2, n) columns and rows as shown.
        Linear probe: row' = face + factor (row - face). Sector: the same of the radius about the apex, at the same angle in mm.
        """
        stretch = self.stretch
        if stretch is not None:
            return np.stack([pixels[0], stretch[1, 1] * pixels[1] + stretch[1, 3]])
        apex = np.array(self.probe.apex, dtype=np.float64)[:, None]
        offset = pixels - apex
        radius = np.hypot(offset[0] * self.spacing[0], offset[1] * self.spacing[1])
        # At the apex itself there is no direction to move in
        farther = np.divide(self.face + self.factor * (radius - self.face), radius, out=np.ones_like(radius), where=radius > 0)
        moved: Floats = apex + farther * offset
        return moved


def depth_scale(settings: Recipe, mask: Mask, probe: ProbeGeometry | None, spacing: tuple[float, float]) -> DepthScale | None:
    """The scale that the settings ask for, of images whose ultrasound is `mask`; None where pixels are where they are shown.

    Raises BeamGeometryError when pixels are elsewhere and the probe is not known.
    """
    factor = depth_factor(settings)
    if factor == 1.0:
        return None
    if probe is None:
        raise BeamGeometryError("A speed of sound needs the direction of the beams.", NAME_THE_PROBE)
    return DepthScale.of(mask, probe, factor, spacing)


def depth_factor(settings: Recipe) -> float:
    """True depth by shown depth that the settings ask for; 1 where they do not say how fast sound was."""
    return 1.0 if settings.speed_of_sound is None else settings.speed_of_sound / settings.scanner_speed_of_sound
