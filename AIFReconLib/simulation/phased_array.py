"""A phased-array probe: its sector, its image, and where the image is on the probe."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ..arrays import Floats, Integers, Matrix
from ..geometry.transforms import affine, as_matrix, invert
from ..imaging.beams import SECTOR, ProbeGeometry
from ..imaging.region import Fan, ImageRegion
from .vertebra import turned_about


def _default_transducer_to_probe() -> Matrix:
    """Marker on the handle, 90 mm from the face, turned and tilted as clamps are. (4, 4), mm."""
    return affine(turned_about(1, math.radians(24.0)) @ turned_about(0, math.radians(-8.0)), (11.5, 90.0, -27.0))


@dataclass(frozen=True, eq=False)
class PhasedArray:
    """A sector probe like the ATL P7-4.

    Parameters
    ----------
    depth : float, mm
        From the probe's face to the last sample in the middle.
    apex_offset : float, mm
        How far behind the face the beams meet; the sector begins at this radius.
    lines, samples : int
        Beams, and samples along each.
    columns, rows : int
        Size of the sector image; the pixel spacing follows, the same along both.
    elevation_focus, elevation_width : float, mm
        Depth of the lens's focus, and the beam's full width at half maximum there.
    elevation_aperture : float, mm
        The beam's width at the face; it narrows to the focus and widens behind it.
    transducer_to_probe : (4, 4) array, mm
        Transducer: origin in the middle of the face, x along the image's columns, y along the middle beam, z = x cross y. Probe: the
        tracked marker.
    """

    field_of_view_deg: float = 84.0
    depth: float = 88.0
    apex_offset: float = 3.0
    lines: int = 128
    samples: int = 400
    columns: int = 480
    rows: int = 360
    elevation_focus: float = 50.0
    elevation_width: float = 2.2
    elevation_aperture: float = 7.0
    transducer_to_probe: Matrix = field(default_factory=_default_transducer_to_probe)

    def __post_init__(self) -> None:
        object.__setattr__(self, "transducer_to_probe", as_matrix(self.transducer_to_probe, "transducer_to_probe"))

    @property
    def half_angle(self) -> float:
        """Radians from the middle beam to the outermost."""
        return math.radians(self.field_of_view_deg) / 2

    @property
    def radii(self) -> tuple[float, float]:
        """First and last sample's distance from the apex, mm."""
        return self.apex_offset, self.apex_offset + self.depth

    @property
    def pixel_spacing(self) -> float:
        """mm per pixel, rounded up to a hundredth: the sector fits into the image with a margin of 1%."""
        height = self.radii[1] - self.radii[0] * math.cos(self.half_angle)
        width = 2 * self.radii[1] * math.sin(self.half_angle)
        return math.ceil(102.0 * max(height / self.rows, width / self.columns)) / 100.0

    @property
    def apex_px(self) -> tuple[float, float]:
        """Where the beams meet, (column, row); the sector's first arc starts 1% below the image's upper edge."""
        return (self.columns - 1) / 2, round(0.01 * self.rows) - self.radii[0] * math.cos(self.half_angle) / self.pixel_spacing

    @property
    def geometry(self) -> ProbeGeometry:
        """Where its beams go, for the reconstruction."""
        return ProbeGeometry(SECTOR, self.apex_px)

    @property
    def fan(self) -> Fan:
        """The sector, in pixels."""
        half = self.field_of_view_deg / 2
        return Fan(self.apex_px, (-half, half), (self.radii[0] / self.pixel_spacing, self.radii[1] / self.pixel_spacing))

    @property
    def region(self) -> ImageRegion:
        """The part of its images that is ultrasound."""
        return ImageRegion(fan=self.fan)

    @property
    def image_to_transducer(self) -> Matrix:
        """(4, 4), pixels to mm: the apex is `apex_offset` behind the face."""
        s = self.pixel_spacing
        matrix = np.diag([s, s, s, 1.0])
        matrix[:2, 3] = -s * self.apex_px[0], -s * self.apex_px[1] - self.apex_offset
        return matrix

    @property
    def image_to_probe(self) -> Matrix:
        """The calibration, (4, 4), pixels to mm."""
        return self.transducer_to_probe @ self.image_to_transducer

    def probe_to_reference(self, transducer_to_reference: Matrix) -> Matrix:
        """Where the marker is when the transducer is there, (4, 4)."""
        return transducer_to_reference @ invert(self.transducer_to_probe)

    def elevation_fwhm(self, depth: ArrayLike) -> Floats:
        """The beam's full width at half maximum across the image plane, mm, at a depth under the face (array or number)."""
        defocus = (np.asarray(depth, dtype=np.float64) - self.elevation_focus) / self.elevation_focus
        width: Floats = np.hypot(self.elevation_width, self.elevation_aperture * defocus)
        return width

    @cached_property
    def beam_angles(self) -> Floats:
        """From the middle beam toward +x, (lines,) float64, radians."""
        return np.linspace(-self.half_angle, self.half_angle, self.lines, dtype=np.float64)

    @cached_property
    def ranges(self) -> Floats:
        """Distance of the samples from the apex, (samples,) float64, mm."""
        return np.linspace(*self.radii, self.samples, dtype=np.float64)

    def beam_points(self, ranges: Floats) -> Floats:
        """Points at these distances from the apex on every beam, (lines, ranges, 3) float64, in the transducer frame, mm."""
        points = np.zeros((self.lines, len(ranges), 3))
        points[..., 0] = np.sin(self.beam_angles)[:, None] * ranges
        points[..., 1] = np.cos(self.beam_angles)[:, None] * ranges - self.apex_offset
        return points

    @cached_property
    def scan_conversion(self) -> tuple[Integers, scipy.sparse.csr_matrix[np.float32]]:
        """Pixels of the sector, and the bilinear weights that give them from samples.

        Returns
        -------
        pixels : (n,) int array
            Flat numbers of the pixels inside `fan`.
        weights : (n, lines * samples) sparse float32 matrix
        """
        pixels = np.flatnonzero(self.fan.mask(self.columns, self.rows))
        x = (pixels % self.columns - self.apex_px[0]) * self.pixel_spacing
        y = (pixels // self.columns - self.apex_px[1]) * self.pixel_spacing
        line = (np.arctan2(x, y) + self.half_angle) / (2 * self.half_angle) * (self.lines - 1)
        sample = (np.hypot(x, y) - self.radii[0]) / self.depth * (self.samples - 1)
        line0 = np.clip(np.floor(line).astype(int), 0, self.lines - 2)
        sample0 = np.clip(np.floor(sample).astype(int), 0, self.samples - 2)
        a, b = np.clip(line - line0, 0, 1), np.clip(sample - sample0, 0, 1)
        corner = line0 * self.samples + sample0
        indices = np.stack([corner, corner + 1, corner + self.samples, corner + self.samples + 1], axis=1)
        values = np.stack([(1 - a) * (1 - b), (1 - a) * b, a * (1 - b), a * b], axis=1).astype(np.float32)
        starts = np.arange(0, 4 * len(pixels) + 1, 4)
        return pixels, scipy.sparse.csr_matrix((values.ravel(), indices.ravel(), starts), shape=(len(pixels), self.lines * self.samples))
