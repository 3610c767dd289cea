"""What a frame itself tells of bone: which pixels sound reached, and where a shadow begins.

Bone stops sound. Behind it a scan line stays dark to its end, however weak the echo of the bone itself was: so the last place before
lasting darkness is bone, at any angle of incidence, and whatever lies in the darkness was not seen. Neither needs a CT.

Ancestors: shadows as evidence of bone in ultrasound segmentation, and confidence along scan lines (Karamalis et al., Ultrasound
confidence maps using random walks, Medical Image Analysis 2012), of which this is a much simpler, one-pass relative.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Integers, Mask, Singles
from ..imaging.beams import ProbeGeometry
from ..imaging.scan_lines import scan_line_samples
from .layout import PixelLayout

SMOOTHING = 1.25
"""mm along the beam over which speckle is averaged before brightness is judged."""

SMOOTHING_LINES = 3
"""Scan lines across which speckle is averaged before brightness is judged."""

ONSET_DEPTH = 3.0
"""mm. A shadow must have begun this far behind bone: an oblique echo with its smoothing is about as long as this."""

CREST = 1.0
"""mm before a pixel in which nothing may be brighter: an onset is the crest of the last echo, not its slope down into the shadow."""

LEAST_SHADOW = 8.0
"""mm. Darkness shorter than this, at the end of a scan line, is no evidence of a shadow."""

REACHED = 0.35
"""Part of the gray scale that a scan line must still attain, here or deeper, for sound to count as having fully arrived."""

LEAST_REACH = 0.01
"""Weight left to pixels in full shadow, so that a voxel seen by shadowed beams alone shows their mean and not nothing."""

FALL = 0.16
"""Part of the gray scale by which brightness must fall for a full-blown onset (with 8 bit over 58 dB: 9 dB)."""

LAST_ECHO = 0.9
"""Part of the brightest echo from `CREST` before it to the end of the line that a pixel must have to count as the shadow's source."""

VECTOR = 16
"""Scan lines that compiled code takes at a time."""

Scales = tuple[np.float32, np.float32, np.float32, np.float32, np.float32, np.float32, np.float32]
"""What brightness is multiplied with: 1 / taps, 1 / 3, 1 / reached, 1 / fall, the last echo, 1 / (1 - last echo), least reach."""


@dataclass(frozen=True, eq=False)
class FrameEvidence:
    """Evidence at the pixels of a layout.

    Parameters
    ----------
    reach : (n,) float32 array, 0.01 to 1.01
        R: how surely sound reached the pixel.
    onset : (n,) float32 array, 0 to 1
        E: how surely a shadow begins there.
    """

    reach: Singles
    onset: Singles


class ScanLines:
    """Samples along the beams of one image layout, and which sample belongs to which pixel.

    Parameters
    ----------
    layout : PixelLayout
    probe : ProbeGeometry

    Attributes
    ----------
    step : float, mm
        Between samples along a line.
    shape : (samples, lines)
    sample_of_pixel : (n,) uint32 array
        The sample nearest to each of the layout's pixels, flat.
    padded : int
        Lines, and as many more as let compiled code read arrays (samples, padded) faster.
    padded_sample_of_pixel : (n,) uint32 array
        The same in such an array.
    pixel_of_sample : (samples, lines) int32 array
        The pixel of the whole image nearest to each sample, flat; 0 where there is none.
    lit : (n, 2) int64 array
        First line, and the one after the last, of unbroken runs of samples that have a pixel.
    first_lit : (samples + 1,) int64 array
        Number of the first run of each sample, and of all runs.
    active : (samples, 2) int64 array
        First line, and the one after the last, that a sample must be computed for: on no other does it matter to any pixel.
    judged : (lines,) int32 array
        First sample of each line at which no onset is looked for any more.

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
        self.depth, self.crest = max(self._samples(ONSET_DEPTH), 1), max(self._samples(CREST), 1)
        self.taps = self._samples(SMOOTHING) | 1
        # Kept as (samples, lines), so that neighbors on neighboring lines lie side by side and rows are added to rows
        self.shape = samples, count
        line, sample = np.divmod(lines.sample_of_pixel, samples)
        self.sample_of_pixel = (sample * count + line).astype(np.uint32)
        # Rows of an odd number of cache lines: those of a power of two would all compete for the same places in the cache
        self.padded = -(-count // 16) * 16 + (0 if -(-count // 16) % 2 else 16)
        self.padded_sample_of_pixel = (sample * self.padded + line).astype(np.uint32)
        column, row = np.floor(lines.columns - left + 0.5).T, np.floor(lines.rows - top + 0.5).T
        beside = (column < 0) | (column >= width) | (row < 0) | (row >= height)
        sampled = np.where(beside, height * width, row * width + column).astype(np.int64)
        # Positions in the layout's pixel list, one past its end for samples that are dark
        number = np.full(height * width + 1, layout.inside.size, dtype=np.int64)
        number[layout.inside] = np.arange(layout.inside.size)
        self._number_of_sample = number[sampled].reshape(-1)
        inside = number[sampled] < layout.inside.size
        # Stored as it will be read, line after line; the places above come the other way round
        self.pixel_of_sample = np.where(inside, (row + top) * layout.size[0] + (column + left), 0).astype(np.int32, order="C")
        edges = np.diff(np.pad(inside, ((0, 0), (1, 1))).astype(np.int8), axis=1)
        self.lit = np.stack([np.nonzero(edges == 1)[1], np.nonzero(edges == -1)[1]], axis=1)
        self.first_lit = np.append(0, np.cumsum((edges == 1).sum(axis=1)))
        self.active = self._active(inside)
        # Where a line leaves the pixels, its darkness is no shadow: nothing is judged within the last millimeters before
        ends = np.where(inside.any(axis=0), samples - inside[::-1].argmax(axis=0), 0)
        self.judged = (ends - max(self._samples(LEAST_SHADOW), self.depth)).astype(np.int32)
        self._is_judged = np.arange(samples)[:, None] < self.judged

    def _active(self, inside: Mask) -> Integers:
        """`active`, of the samples (samples, lines) that have a pixel.

        Notes
        -----
        Outside of these lines brightness is 0. Each line counts from its deepest bright sample or pixel up to the last place before the
        first, without a gap, because what is found there is handed on from sample to sample.
        """
        bright, wanted = inside.copy(), np.zeros(inside.size, dtype=bool)
        bright[:, 1:] |= inside[:, :-1]
        bright[:, :-1] |= inside[:, 1:]
        wanted[self.sample_of_pixel] = True
        smoothed = self.taps // 2 + 1
        first, last = _first_and_last(bright)
        first_wanted, last_wanted = _first_and_last(wanted.reshape(inside.shape))
        first, last = np.minimum(first - smoothed, first_wanted) - self.crest, np.maximum(last + smoothed, last_wanted)
        sample = np.arange(len(inside))[:, None]
        starts, stops = _first_and_last(((first <= sample) & (sample <= last)).T)
        # Whole vectors are the fastest; where there is nothing at all, nothing
        starts, stops = starts // VECTOR * VECTOR, np.minimum(-(-(stops + 1) // VECTOR) * VECTOR, inside.shape[1])
        return np.stack([np.minimum(starts, stops), stops], axis=1)

    def scales(self, full_scale: float) -> Scales:
        """What brightness is judged by."""
        per_tap, per_line = np.float32(1 / self.taps), np.float32(1 / SMOOTHING_LINES)
        per_reached, per_fall = np.float32(1 / (REACHED * full_scale)), np.float32(1 / (FALL * full_scale))
        return per_tap, per_line, per_reached, per_fall, np.float32(LAST_ECHO), np.float32(1 / (1 - LAST_ECHO)), np.float32(LEAST_REACH)

    def evidence(self, values: Singles, full_scale: float) -> FrameEvidence:
        """Judge one frame.

        Parameters
        ----------
        values : (n,) float32 array
            The layout's pixels; those that are not finite count as dark.
        full_scale : float
            Brightest value an image can hold.

        Notes
        -----
        With q the smoothed brightness along a scan line, S(r) = max of q from r to the end of the line (all of it for r < 0), M the full
        scale: A(r) = min(1, S(r) / (0.35 M))^2 is how much of the sound arrives at r or deeper, and R = A(r) + 0.01;
        E = clip((S(r) - S(r')) / (0.16 M)) clip((q(r) / S(r - 1 mm) - 0.9) / 0.1) (1 - A(r')), r' = r + 3 mm, where clip limits to 0 to 1:
        brightness falls here, this is the crest of the last bright place, and nothing arrives behind it. E is 0 in the last 8 mm of a
        line.
        """
        per_tap, per_line, per_reached, per_fall, last_echo, per_echo, least = self.scales(full_scale)
        samples, _ = self.shape
        dark = np.float32(0)
        finite = values if np.isfinite(values).all() else np.where(np.isfinite(values), values, dark)
        lines = np.append(finite, dark)[self._number_of_sample].reshape(self.shape)
        around = np.pad(lines, ((self.taps // 2, self.taps // 2), (0, 0)), mode="edge")
        brightness = lines
        brightness[:] = around[:samples]
        for tap in range(1, self.taps):
            brightness += around[tap : tap + samples]
        brightness *= per_tap
        around = np.pad(brightness, ((0, 0), (1, 1)), mode="edge")
        np.add(around[:, :-2], around[:, 1:-1], out=brightness)
        brightness += around[:, 2:]
        brightness *= per_line
        np.maximum(brightness, dark, out=brightness)
        below = brightness.copy()
        # Row by row: the accumulation of numpy goes down every line by itself
        for sample in range(samples - 1, 0, -1):
            np.maximum(below[sample - 1], below[sample], out=below[sample - 1])
        arrived = np.minimum(below * per_reached, np.float32(1))
        arrived *= arrived
        onset = np.zeros_like(below)
        now, later = below[: -self.depth], below[self.depth :]
        found, ratio = onset[: -self.depth], brightness[: -self.depth]
        np.subtract(now, later, out=found)
        found *= per_fall
        np.minimum(np.maximum(found, dark, out=found), np.float32(1), out=found)
        crest = np.empty_like(now)
        crest[: self.crest] = below[0]
        crest[self.crest :] = now[: -self.crest]
        ratio /= np.maximum(crest, np.float32(np.finfo(np.float32).tiny), out=crest)
        ratio -= last_echo
        ratio *= per_echo
        found *= np.minimum(np.maximum(ratio, dark, out=ratio), np.float32(1), out=ratio)
        found *= np.float32(1) - arrived[self.depth :]
        onset *= self._is_judged
        arrived += least
        return FrameEvidence(arrived.reshape(-1)[self.sample_of_pixel], onset.reshape(-1)[self.sample_of_pixel])

    def _samples(self, length: float) -> int:
        return round(length / self.step)


def _first_and_last(marked: Mask) -> tuple[Integers, Integers]:
    """Of each column of a bool array (n, m): its first and its last True; n and -1 where there is none."""
    some = marked.any(axis=0)
    return np.where(some, marked.argmax(axis=0), len(marked)), np.where(some, len(marked) - 1 - marked[::-1].argmax(axis=0), -1)
