"""Bone in one frame: a bright echo with darkness behind it.

References
----------
Foroughi P, Boctor E, Swartz MJ, Taylor RH, Fichtinger G (2007), "Ultrasound bone segmentation using dynamic programming", IEEE
Ultrasonics Symposium: echo and shadow together make bone; neighboring scan lines must agree. Hacihaliloglu I, Abugharbieh R, Hodgson AJ,
Rohling RN, Guy P (2012), "Automatic bone localization and fracture detection from volumetric ultrasound images using 3-D local phase
features", Ultrasound in Medicine and Biology 38(1): ridges from local phase instead. The rule here is simpler than any of
them and shares no code.
"""

from __future__ import annotations

import numpy as np
import scipy

from ...arrays import Floats, Integers, Mask, Numbers, Reals, Singles
from ...effective_settings import Imaging
from ..scan_line_reader import ScanLineReader, running_sum
from .found import BoneEchoes

ECHO_ALONG, ECHO_ACROSS = 0.4, 0.8
"""mm. Smoothing of the image along scan lines (about the axial resolution) and across them, against speckle."""

SHADOW_FROM, SHADOW_TO, SHADOW_LEAST = 1.0, 10.0, 3.0
"""mm behind an echo: where its shadow is measured, and how much of that must lie in the image."""

SKIN = 8.0
"""mm below the transducer in which nothing counts: skin, gel and reverberation are bright and never bone."""

SIDES = 2.0
"""mm at either side of the image in which nothing counts: where contact with the skin ends, lines look like echo and shadow."""

FAINT = 55.0
"""Gray level, on the standard scale, that is added to echo and shadow when they are compared: a contrast among faint echoes says little."""

DARK, DARK_FROM = 25.0, 3.0
"""Gray level, on the standard scale, that the mean of a scan line is below from so many mm behind bone to its end."""

LEAST_SCORE = 0.4
"""Score from which an echo counts as bone."""

CREST = 1.0
"""mm in which the echo's brightest place is looked for: the score alone peaks on its far flank, where the shadow is deepest."""

NEIGHBORHOOD, NEIGHBOR_DEPTH, NEIGHBORS_NEEDED = 2.0, 2.0, 0.5
"""Where neighbors of an echo are, mm to the sides; how much deeper or higher theirs may be, mm; which part of the lines must have one."""


class BoneEchoFinder:
    """Looks for bone in images of one size, spacing and probe.

    Per scan line, with e the smoothed gray level on the standard scale (see `GrayLevels`), and b the mean level from 1 to 10 mm behind::

        score = (e - b) / (e + b + 55)

    It tends to 0.8 for a bright echo over darkness, is about 0 where an echo has tissue behind it, and small
    in darkness. The strongest score of a line counts if it reaches `least`, lies below the skin and not at the
    sides of the image, and the neighboring lines agree; the echo then lies at the brightest e within `CREST`.

    `size` is (columns, rows), `spacing` (x, y) in mm; `imaging` must know region and probe; `least` is what a score must reach.
    """

    def __init__(self, size: tuple[int, int], spacing: tuple[float, float], imaging: Imaging, least: float = LEAST_SCORE):
        self._least, self._gray_levels = least, imaging.gray_levels
        self._lines = lines = ScanLineReader(size, spacing, imaging)
        self._pitch, self._step, self._known = lines.pitch, lines.step, lines.known
        self._sigma = ECHO_ACROSS / self._pitch, ECHO_ALONG / self._step
        self._reach = np.maximum(scipy.ndimage.gaussian_filter(self._known.astype(np.float32), self._sigma), np.float32(1e-3))
        samples = np.arange(self._known.shape[1])
        self._from, self._to = (np.minimum(samples + round(mm / self._step), samples.size) for mm in (SHADOW_FROM, SHADOW_TO))
        known_before = running_sum(self._known)
        self._behind = (known_before[:, self._to] - known_before[:, self._from]).astype(np.float32)
        depth = (samples - self._known.argmax(axis=1)[:, None]) * self._step
        self._eligible = self._known & (depth >= SKIN) & (self._behind * self._step >= SHADOW_LEAST)
        outer = min(round(SIDES / self._pitch), len(self._known) // 8)
        self._eligible[np.r_[:outer, len(self._known) - outer : len(self._known)]] = False

    @property
    def lines(self) -> int:
        """Scan lines that are looked at: the most echoes that an image can have."""
        return len(self._known)

    def find(self, image: Numbers) -> BoneEchoes:
        """The bone echoes of an image, (rows, columns); values below 0 and not finite count as 0."""
        values = self._lines.read(self._gray_levels.of(image))
        scores, samples, bone = self._strongest(values)
        return BoneEchoes(*self._lines.places(bone, samples[bone]), scores[bone], self._dark(values[bone], bone, samples[bone]))

    def _dark(self, values: Singles, lines: Integers, samples: Floats) -> Mask:
        """Whether these lines (n, samples) are dark behind these samples (n,) to their end."""
        behind = self._known[lines] & (np.arange(values.shape[1]) >= samples[:, None] + DARK_FROM / self._step)
        dark: Mask = (values * behind).sum(axis=1) < DARK * behind.sum(axis=1)
        return dark

    def _strongest(self, values: Singles) -> tuple[Singles, Floats, Integers]:
        """The score and place of the strongest echo of every line, (lines,) each, and the numbers of the lines where it is bone."""
        echo, score = self.look(values)
        strongest = score.argmax(axis=1)
        scores: Singles = np.take_along_axis(score, strongest[:, None], axis=1)[:, 0]
        samples = self._crest(echo, strongest)
        return scores, samples, np.flatnonzero(self._agreed(samples, scores >= self._least))

    def look(self, values: Singles) -> tuple[Singles, Singles]:
        """Smoothed gray level e and score of every sample, (lines, samples) each, by the levels read there."""
        echo: Singles = (scipy.ndimage.gaussian_filter(values, self._sigma, output=np.float32) / self._reach).astype(np.float32)
        sums = running_sum(values)
        behind = (sums[:, self._to] - sums[:, self._from]).astype(np.float32) / np.maximum(self._behind, 1)
        score: Singles = np.where(self._eligible, (echo - behind) / (echo + behind + np.float32(FAINT)), 0.0)
        return echo, score.astype(np.float32)

    def _crest(self, echo: Reals, samples: Integers) -> Floats:
        """Where each line is brightest up to `CREST` before these samples, between samples by a parabola, (lines,) float64."""
        reach, lines = round(CREST / self._step), np.arange(len(samples))
        near = np.clip(samples[:, None] + np.arange(-reach, 1), 0, echo.shape[1] - 1)
        crest = near[lines, np.take_along_axis(echo, near, axis=1).argmax(axis=1)]
        before, top, after = (echo[lines, np.clip(crest + shift, 0, echo.shape[1] - 1)].astype(np.float64) for shift in (-1, 0, 1))
        bend = before - 2 * top + after
        shift = np.divide(0.5 * (before - after), bend, out=np.zeros(len(crest)), where=bend < 0)
        between: Floats = np.clip(crest + np.clip(shift, -0.5, 0.5), 0, echo.shape[1] - 1)
        return between

    def _agreed(self, samples: Floats, found: Mask) -> Mask:
        """Which lines that found bone have enough neighbors that found it at about the same depth, (lines,) bool."""
        reach = max(round(NEIGHBORHOOD / self._pitch), 1)
        depth = np.pad(np.where(found, samples * self._step, np.inf), reach, constant_values=np.inf)
        agreeing = np.zeros(len(samples))
        here = np.where(found, samples * self._step, 0.0)
        for shift in (*range(-reach, 0), *range(1, reach + 1)):
            agreeing += np.abs(depth[reach + shift : reach + shift + len(here)] - here) <= NEIGHBOR_DEPTH
        return found & (agreeing >= NEIGHBORS_NEEDED * 2 * reach)
