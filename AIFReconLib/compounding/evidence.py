"""What a frame itself tells of bone: which pixels sound reached, and where a shadow begins.

Bone stops sound. Behind it a scan line stays dark to its end, however weak the echo of the bone itself was: so the last place before
lasting darkness is bone, at any angle of incidence, and whatever lies in the darkness was not seen. Neither needs a CT.

Ancestors: shadows as evidence of bone in ultrasound segmentation, and confidence along scan lines (Karamalis et al., Ultrasound
confidence maps using random walks, Medical Image Analysis 2012), of which this is a much simpler, one-pass relative.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from ..beams import ProbeGeometry
from ..scan_lines import scan_line_samples
from .layout import PixelLayout

SMOOTHING = 1.25
"""mm along the beam over which speckle is averaged before brightness is judged."""

SMOOTHING_LINES = 3
"""The same across, in scan lines."""

ONSET_DEPTH = 1.5
"""mm. A shadow must begin this far behind bone: its echo is about as long as this."""

LEAST_SHADOW = 8.0
"""mm. Darkness shorter than this, at the end of a scan line, is no evidence of a shadow."""

REACHED = 0.25
"""Share of the gray scale that a scan line must still attain, here or deeper, for sound to count as having fully arrived."""

LEAST_REACH = 0.01
"""Weight left to pixels in full shadow, so that a voxel seen by shadowed beams alone shows their mean and not nothing."""

FALL = 0.16
"""Share of the gray scale by which brightness must fall for a full-blown onset (with 8 bit over 58 dB: 9 dB)."""

LAST_ECHO = 0.75
"""Share of the brightest echo at or below it that a pixel must have to begin counting as the shadow's source."""


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

    reach: np.ndarray
    onset: np.ndarray


class ScanLines:
    """Samples along the beams of one image layout, and which sample belongs to which pixel.

    Parameters
    ----------
    layout : PixelLayout
    probe : ProbeGeometry

    Notes
    -----
    Samples take the nearest pixel (see `scan_line_samples`); those outside the layout's pixels are dark.
    """

    def __init__(self, layout: PixelLayout, probe: ProbeGeometry):
        top, bottom, left, right = layout.window
        height, width = bottom - top, right - left
        rows, columns = np.divmod(layout.inside, width)
        lines = scan_line_samples(columns + left, rows + top, layout.spacing, probe)
        self.step, self.sample_of_pixel = lines.step, lines.sample_of_pixel
        self._depth = max(self._samples(ONSET_DEPTH), 1)
        column, row = np.floor(lines.columns - left + 0.5), np.floor(lines.rows - top + 0.5)
        beside = (column < 0) | (column >= width) | (row < 0) | (row >= height)
        sampled = np.where(beside, -1, row * width + column).astype(np.int64)
        # Positions in the layout's pixel list, one past its end for samples that are dark
        number = np.full(height * width + 1, layout.inside.size, dtype=np.int64)
        number[layout.inside] = np.arange(layout.inside.size)
        self._pixel_of_sample = number[sampled]
        # Where a line leaves the pixels, its darkness is no shadow: nothing is judged within the last millimeters before
        inside = self._pixel_of_sample < layout.inside.size
        ends = np.where(inside.any(axis=1), inside.shape[1] - inside[:, ::-1].argmax(axis=1), 0)
        self._judged = np.arange(inside.shape[1])[None, :] < (ends - max(self._samples(LEAST_SHADOW), self._depth))[:, None]

    def evidence(self, values: np.ndarray, full_scale: float) -> FrameEvidence:
        """Judge one frame.

        Parameters
        ----------
        values : (n,) float32 array
            The layout's pixels.
        full_scale : float
            Brightest value an image can hold.

        Notes
        -----
        With q the smoothed brightness along a scan line, S(r) = max of q from r to the end of the line, M the full scale:
        A(r) = min(1, S(r) / (0.25 M))^2 is the share of sound that arrives at r or deeper, and R = A(r) + 0.01;
        E = clip((S(r) - S(r')) / (0.16 M)) clip((q(r) / S(r) - 0.75) / 0.25) (1 - A(r')), r' = r + 1.5 mm, where clip limits to 0 to 1:
        brightness falls here, this is the last bright place, and nothing arrives behind it. E is 0 in the last 8 mm of a line.
        """
        lines = np.append(np.nan_to_num(values), np.float32(0))[self._pixel_of_sample]
        brightness = ndimage.uniform_filter1d(lines, self._samples(SMOOTHING) | 1, axis=1, mode="nearest")
        brightness = ndimage.uniform_filter1d(brightness, SMOOTHING_LINES, axis=0, mode="nearest")
        np.maximum(brightness, np.float32(0), out=brightness)
        below = np.maximum.accumulate(brightness[:, ::-1], axis=1)[:, ::-1]
        arrived = np.minimum(below / np.float32(REACHED * full_scale), np.float32(1))
        arrived *= arrived
        onset = np.zeros_like(below)
        depth = self._depth
        now, later = below[:, :-depth], below[:, depth:]
        share = brightness[:, :-depth] / np.maximum(now, np.float32(np.finfo(np.float32).tiny))
        found = onset[:, :-depth]
        np.clip((now - later) / np.float32(FALL * full_scale), 0, 1, out=found)
        found *= np.clip((share - np.float32(LAST_ECHO)) / np.float32(1 - LAST_ECHO), 0, 1)
        found *= np.float32(1) - arrived[:, depth:]
        onset *= self._judged
        return FrameEvidence(arrived.reshape(-1)[self.sample_of_pixel] + np.float32(LEAST_REACH), onset.reshape(-1)[self.sample_of_pixel])

    def _samples(self, length: float) -> int:
        return round(length / self.step)
