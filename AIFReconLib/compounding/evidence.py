"""What a frame itself tells of bone: which pixels sound reached, and where a shadow begins.

Bone stops sound. Behind it a scan line holds no more than reverberation and clutter to its end, however weak the echo of the bone itself
was: so the place from which brightness falls to that level for good is bone, at any angle of incidence. A scan line has one such place at
most. Where several compete, the CT's word counts, if there is one; it makes no echo where there is none.

Ancestors: shadows as evidence of bone in ultrasound segmentation (Foroughi et al., Ultrasound bone segmentation using dynamic programming,
IEEE Ultrasonics Symposium 2007), and confidence along scan lines (Karamalis et al., Ultrasound confidence maps using random walks, Medical
Image Analysis 2012), of which this is a much simpler, one-pass relative.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Integers, Matrix, Numbers, Singles
from ..imaging.beams import ProbeGeometry
from ..imaging.gray_levels import BRIGHTEST, GrayLevels
from ..imaging.scan_lines import scan_line_samples
from .layout import PixelLayout

SMOOTHING = 1.25
"""mm along the beam over which speckle is averaged before brightness is judged."""

SMOOTHING_LINES = 3
"""Scan lines across which speckle is averaged before brightness is judged."""

ONSET_DEPTH = 2.0
"""mm. A shadow must have begun this far behind bone: an oblique echo with its smoothing is about as long as this."""

PACE = 0.25
"""mm along the beam at which onsets are looked for: brightness is smoothed over five times that."""

FADE = 4.0
"""mm over which the level of a shadow is averaged: one speckle in it is not its level, and what is left of a line in its last 4 mm is not
enough to tell it."""

LEAST_SHADOW = 8.0
"""mm. Darkness shorter than this, at the end of a scan line, is no evidence of a shadow."""

REACHED = 0.35
"""Part of the standard gray scale (see `GrayLevels`), as all that follow, that a scan line must still attain,
here or deeper, for sound to count as having fully arrived."""

LEAST_REACH = 0.01
"""Weight left to pixels in full shadow, so that a voxel seen by shadowed beams alone shows their mean and not nothing."""

LEAST_CONTRAST, FULL_CONTRAST = 0.1, 0.25
"""Contrast of an echo to the shadow behind it from which an onset counts, and from which it counts in full."""

DARK = 0.2
"""Part of the gray scale that is added to echo and shadow when they are compared: a contrast among faint echoes says little."""

UNSURE = 0.1
"""How much more contrast is asked for where the CT expects no bone."""

TISSUE, SHADOW = 0.31, 0.23
"""Part of the gray scale from which what is behind an echo is no shadow, and below which it is: a bright layer over tissue is no bone."""

PREFERENCE, RIVAL = 1.5, 0.3
"""Times the level behind them that is taken off echoes where they compete, so that a bright layer over tissue loses against a faint echo
over a shadow; and part of the gray scale by which the CT's word counts against brightness."""

UNEXPECTED = 0.05
"""What is added to the CT's probability of bone where echoes compete: where it expects none they may still win."""

EXPECTED_PITCH = 0.5
"""mm along and across the beams at which the CT's probability is read; its maps are 1.5 mm wide at least."""

CREST = 0.25
"""mm about the place that wins within which pixels belong to the onset: its crest."""

Scales = tuple[np.float32, ...]
"""What brightness is judged by, 14 numbers: see `ScanLines.scales`."""


class ScanLines:
    """Samples along the beams of one image layout, and which sample belongs to which pixel.

    Attributes
    ----------
    step : float, mm
        Between samples along a line.
    shape : (samples, lines)
    sample_of_pixel : (n,) uint32 array
        The sample nearest to each of the layout's pixels, flat.
    number_of_sample : (samples, lines) uint32 array
        The pixel nearest to each sample, one past the last for those that are dark.
    pace : int
        Every so many samples an onset is looked for.
    judged : (lines,) int32 array
        First sample of each line at which no onset is looked for any more.
    behind : (paces, lines) float32 array
        What makes a mean of the brightness behind each sample at which an onset is looked for: 1 over the share of all weights that the
        rest of its line has; 0 where that is too short.
    paces : int
        How many of these share a number of the CT's probability.
    expected_of_line : (lines,) int64 array
        Column of `expected` that each line reads.
    expected_at : (2, n, m) float32 array
        The columns and rows at which `expected` is read; not a number where there is no pixel.

    Notes
    -----
    Samples take the nearest pixel (see `scan_line_samples`); those outside the layout's pixels are dark.
    """

    def __init__(self, layout: PixelLayout, probe: ProbeGeometry):
        top, bottom, left, right = layout.window
        height, width = bottom - top, right - left
        rows, columns = np.divmod(layout.inside, width)
        lines = scan_line_samples(columns + left, rows + top, layout.spacing, probe)
        count, samples = lines.columns.shape
        self.step = lines.step
        self.pace = max(self._samples(PACE), 1)
        self.depth, self.crest = (max(self._samples(length), 1) for length in (ONSET_DEPTH, CREST))
        # A whole number of paces
        self.depth = -(-self.depth // self.pace) * self.pace
        self.paces = max(round(EXPECTED_PITCH / (self.pace * self.step)), 1)
        across = np.hypot(*(np.diff(lines.columns, axis=0) * layout.spacing[0], np.diff(lines.rows, axis=0) * layout.spacing[1]))
        # A sector's lines diverge: their distance at half depth stands for all
        pitch = max(float(across[:, samples // 2].mean()), 1e-3) if across.size else lines.step
        every = max(round(EXPECTED_PITCH / pitch), 1)
        self.expected_of_line = np.arange(count) // every
        self.taps = self._samples(SMOOTHING) | 1
        # Kept as (samples, lines), so that neighbors on neighboring lines lie side by side and rows are added to rows
        self.shape = samples, count
        line, sample = np.divmod(lines.sample_of_pixel, samples)
        self.sample_of_pixel = (sample * count + line).astype(np.uint32)
        column, row = np.floor(lines.columns - left + 0.5).T, np.floor(lines.rows - top + 0.5).T
        beside = (column < 0) | (column >= width) | (row < 0) | (row >= height)
        sampled = np.where(beside, height * width, row * width + column).astype(np.int64)
        # Positions in the layout's pixel list, one past its end for samples that are dark
        number = np.full(height * width + 1, layout.inside.size, dtype=np.int64)
        number[layout.inside] = np.arange(layout.inside.size)
        # Stored as it will be read, line after line; the places come the other way round
        self.number_of_sample = np.ascontiguousarray(number[sampled], dtype=np.uint32)
        inside = self.number_of_sample < layout.inside.size
        asked = self.number_of_sample[:: self.pace * self.paces, ::every]
        places = layout.coordinates if layout.moved is None else layout.moved
        self.expected_at = np.pad(places, ((0, 0), (0, 1)), constant_values=np.nan).astype(np.float32)[:, asked]
        # Where a line leaves the pixels, its darkness is no shadow: nothing is judged within the last millimeters before
        ends = np.where(inside.any(axis=0), samples - inside[::-1].argmax(axis=0), 0)
        self.judged = (ends - max(self._samples(LEAST_SHADOW), self.depth)).astype(np.int32)
        self._is_judged = np.arange(samples)[:, None] < self.judged
        self.behind = self._behind(ends)

    def _behind(self, ends: Integers) -> Singles:
        """`behind`, of lines that end before these samples (lines,)."""
        samples = np.arange(0, self.shape[0], self.pace)
        left = np.maximum(ends - 1 - samples[:, None], 0) * self.step
        with np.errstate(divide="ignore"):
            return np.where(left >= FADE, 1 / (1 - np.exp(-left / FADE)), 0.0).astype(np.float32)

    def scales(self) -> Scales:
        """What brightness is judged by, M being the largest level of the standard scale: 1 / taps, 1 / 3, 1 /
        (reached M), least reach; what of a shadow's level is kept from pace to pace, and what the new one
        adds; 1 / ((tissue - shadow) M), dark M, least contrast where no bone is expected, tissue / (tissue -
        shadow), unsure, 1 / (full - least contrast); preference, rival M."""
        kept = np.float32(np.exp(-self.pace * self.step / FADE))
        return (
            np.float32(1 / self.taps),
            np.float32(1 / SMOOTHING_LINES),
            np.float32(1 / (REACHED * BRIGHTEST)),
            np.float32(LEAST_REACH),
            kept,
            np.float32(1) - kept,
            np.float32(1 / ((TISSUE - SHADOW) * BRIGHTEST)),
            np.float32(DARK * BRIGHTEST),
            np.float32(LEAST_CONTRAST + UNSURE),
            np.float32(TISSUE / (TISSUE - SHADOW)),
            np.float32(UNSURE),
            np.float32(1 / (FULL_CONTRAST - LEAST_CONTRAST)),
            np.float32(PREFERENCE),
            np.float32(RIVAL * BRIGHTEST),
        )

    def expected(self, probability: Singles, image_to_map: Matrix) -> Singles:
        """Where the CT expects bone in a frame, at a few samples of a few lines, (n, m) float32; 0 outside of the CT.

        `probability` [k, j, i], 0 to 1, is in the CT's own voxels, to which `image_to_map` leads: what a frame shows of bone does not
        depend on what is reconstructed of it.
        """
        column, row = self.expected_at.astype(np.float64)
        flat, inside = np.zeros(column.shape), np.ones(column.shape, dtype=bool)
        for along, size in zip(image_to_map[2::-1], probability.shape, strict=True):
            place = np.floor((along[1] * row + (along[3] + 0.5)) + along[0] * column)
            inside &= (place >= 0.0) & (place < size)
            flat = flat * size + place
        read: Singles = probability.reshape(-1)[np.where(inside, flat, 0.0).astype(np.int64)]
        read[~inside] = 0.0
        return read

    def evidence(self, values: Numbers, gray_levels: GrayLevels, expected: Singles | None = None) -> tuple[Singles, Singles]:
        """Judge one frame: R, how surely sound reached each pixel, (n,) 0.01 to 1.01, and E, how surely a shadow begins there, 0 to 1.

        Parameters
        ----------
        values : (n,) array
            The layout's pixels; those that are not finite count as dark.
        gray_levels : GrayLevels
            What makes of them the levels that are judged.
        expected : float32 array or None
            As `expected` returns it; None without a CT.

        Notes
        -----
        With q the smoothed brightness along a scan line, on the standard gray scale, M the largest level of
        that, b(r) the mean of q from r to the end of the line, weighted by exp(-distance / 4 mm), and L(r)
        the largest b from r + 2 mm on, up to 4 mm before the end, which is the level of the shadow if r is
        bone, an onset is possible where c = (q - L) / (q + L + 0.2 M) - 0.2 + 0.1 P exceeds 0 and L is below
        0.31 M. Of these places of a line, without its last 8 mm, that of the largest max(0, q - 1.5 L + 0.3
        M) (0.05 + P) is its onset; there
        E = clip(c / 0.15) clip((0.31 - L / M) / 0.08) within 0.25 mm, and 0 elsewhere.
        With S(r) = max of q from r to the end, A = min(1, S / (0.35 M))^2 is how much of the sound arrives at r or deeper; R = A + 0.01.
        clip limits to 0 to 1.
        """
        one = np.float32(1)
        _, _, per_reached, least, *_ = scales = self.scales()
        brightness = self._brightness(gray_levels.of(values).astype(np.float32), scales)
        below, paced = brightness.copy(), np.ascontiguousarray(brightness[:: self.pace])
        # Row by row: the accumulation of numpy goes down every line by itself
        for sample in range(len(below) - 1, 0, -1):
            np.maximum(below[sample - 1], below[sample], out=below[sample - 1])
        arrived = np.minimum(below * per_reached, one)
        arrived *= arrived
        arrived += least
        place, strength = self._onsets(paced, self._levels_behind(paced, self.behind, scales), expected, scales)
        onset = np.zeros_like(below)
        for line in np.flatnonzero(strength > 0):
            onset[max(place[line] - self.crest, 0) : place[line] + self.crest + 1, line] = strength[line]
        return arrived.reshape(-1)[self.sample_of_pixel], onset.reshape(-1)[self.sample_of_pixel]

    def _brightness(self, values: Singles, scales: Scales) -> Singles:
        """q at the samples, (samples, lines)."""
        per_tap, per_line, *_ = scales
        dark, samples = np.float32(0), self.shape[0]
        lines = np.append(values, dark)[self.number_of_sample]
        around = np.pad(lines, ((self.taps // 2, self.taps // 2), (0, 0)), mode="edge")
        brightness: Singles = lines
        brightness[:] = around[:samples]
        for tap in range(1, self.taps):
            brightness += around[tap : tap + samples]
        brightness *= per_tap
        around = np.pad(brightness, ((0, 0), (1, 1)), mode="edge")
        np.add(around[:, :-2], around[:, 1:-1], out=brightness)
        brightness += around[:, 2:]
        brightness *= per_line
        return brightness

    @staticmethod
    def _levels_behind(brightness: Singles, behind: Singles, scales: Scales) -> Singles:
        """The largest mean level behind each sample and the deeper ones, (samples, lines)."""
        kept, new = scales[4:6]
        levels = np.empty_like(brightness)
        level, largest = np.zeros((2, brightness.shape[1]), np.float32)
        for sample in range(len(brightness) - 1, -1, -1):
            np.maximum(largest, level * behind[sample], out=largest)
            levels[sample] = largest
            level *= kept
            level += new * brightness[sample]
        return levels

    def _onsets(self, brightness: Singles, levels: Singles, expected: Singles | None, scales: Scales) -> tuple[Integers, Singles]:
        """Of each line: the sample of its onset, and how surely it is one; 0 where there is none.

        `brightness` and `levels` are those at every `pace`-th sample.
        """
        per_span, dark, least, tissue, unsure, per_contrast = scales[6:12]
        none, depth, lines = np.float32(0), self.depth // self.pace, np.arange(self.shape[1])
        if len(brightness) <= depth:
            return np.zeros(self.shape[1], np.int64), np.zeros(self.shape[1], np.float32)
        now, later = brightness[:-depth], levels[depth:]
        believed = np.ones_like(now)
        if expected is not None:
            believed = np.repeat(expected[:, self.expected_of_line], self.paces, axis=0)[: len(now)]
        asked = least - unsure * believed
        enough = (now - later > asked * ((now + later) + dark)) & (later * per_span < tissue) & self._is_judged[:: self.pace][:-depth]
        merit = np.maximum((now - scales[12] * later) + scales[13], none) * (believed + np.float32(UNEXPECTED))
        merit[~enough] = none
        place = merit.argmax(axis=0)
        echo, shadow, asked = now[place, lines], later[place, lines], asked[place, lines]
        contrast = (echo - shadow) / ((echo + shadow) + dark) - asked
        strength = np.minimum(np.maximum(contrast * per_contrast, none), np.float32(1))
        strength *= np.minimum(np.maximum(tissue - shadow * per_span, none), np.float32(1))
        return place * self.pace, np.where(merit[place, lines] > none, strength, none)

    def _samples(self, length: float) -> int:
        return round(length / self.step)
