"""The gray levels that images are judged by, whatever the scanner's gain, gray curve and dynamic range: intensity standardization.

A curve, one for a whole sweep, takes the percentiles of its pixels to those of a standard scale. All constants that speak of brightness
are parts of that scale. What is put into voxels stays as it was recorded.

References
----------
Nyul LG, Udupa JK (1999), "On standardizing the MR image intensity scale", Magnetic Resonance in Medicine 42(6): 1072-1081. Nyul LG, Udupa
JK, Zhang X (2000), "New variants of a method of MRI scale standardization", IEEE Transactions on Medical Imaging 19(2): 143-150.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Bytes, Floats, Mask, Numbers
from .change import frames_looked_at
from .images import ImageStack

PERCENTILES = (2.0, 10.0, 25.0, 50.0, 75.0, 90.0, 97.0, 99.5)
STANDARD = (0.0, 1.0, 13.0, 38.0, 85.0, 114.0, 141.0, 175.0)
"""Percent of a sweep's pixels, and the gray levels that they stay below on the standard scale."""

BRIGHTEST = 255.0
"""The largest gray level of the standard scale."""

LARGEST_SHIFT = 85.0
"""Gray levels of 255, 20 dB of 60, by which a landmark may lie above the standard, and the brightest below: more gain would make tissue of
noise."""

LEAST_LIT, LEAST_OF_REGION = 0.05, 0.02
"""Part of the frames in which a pixel is lit, for it to be no part of the surround; and of the region that such pixels are at least."""

MOST_PIXELS = 20_000
"""Of an image that are looked at."""

MOST_BLACK = 0.35
"""Part of what is lit at times that may be black on the mean. It is 0 to 0.15 in the recordings at hand, and 0.4 with 8 dB less gain."""

UNTOLD = "The images are too dark or too even to tell their gray scale by: brightness is judged as it is."
FAR_OFF = (
    "The images are far brighter or darker than ultrasound of bone is; their gray scale is told in part only. "
    "Check gain and gray curve of the scanner."
)
CUT_OFF = (
    "{black:.0%} of the scanned image are black: weak echoes of bone are cut off. "
    "Turn up the gain or the dynamic range of the scanner (to 60 dB or more)."
)


@dataclass(frozen=True)
class GrayLevels:
    """The curve of one sweep, from its gray levels to those of the standard scale.

    Parameters
    ----------
    landmarks : tuple of 8 floats, not falling
        Gray levels that `PERCENTILES` of the pixels stay below. They are taken to `STANDARD`, what lies between them in proportion, and
        what is brighter than the last in proportion to it.
    notes : tuple of str
        What is to be said of the images.
    """

    landmarks: tuple[float, ...]
    notes: tuple[str, ...] = ()

    @classmethod
    def as_recorded(cls, brightest: float = BRIGHTEST, notes: tuple[str, ...] = ()) -> GrayLevels:
        """The gray levels as they are, of images that hold values up to `brightest`."""
        return cls(tuple(level * brightest / BRIGHTEST for level in STANDARD), notes)

    @classmethod
    def learned(cls, images: ImageStack, mask: Mask) -> GrayLevels:
        """Those of the images (n, rows, columns) of a sweep, within the mask (rows, columns) of what is ultrasound.

        Of frames all over the sweep, pixels that are lit at times and change: black surround and text say nothing of a scanner. Where
        these are too few, or all alike, gray levels stay as they are, which a note says.
        """
        pixels = np.flatnonzero(mask)
        pixels = pixels[:: max(len(pixels) // MOST_PIXELS, 1) | 1]
        frames = (images[int(number)] for number in frames_looked_at(images))
        values = np.stack([_finite(image.reshape(-1)[pixels]) for image in frames if image.shape == mask.shape])
        lit = (values > 0).mean(axis=0) > LEAST_LIT
        moves = lit & (np.ptp(values, axis=0) > 0)
        seen = values[:, moves if moves.any() else lit]
        brightest = BRIGHTEST if images.dtype == np.uint8 else float(values.max(initial=1e-9))
        levels = np.percentile(seen, PERCENTILES) if lit.mean() >= LEAST_OF_REGION else np.zeros(len(PERCENTILES))
        if levels[-1] <= levels[3]:
            return cls.as_recorded(brightest, (UNTOLD,))
        black = float((seen == 0).mean())
        notes = [CUT_OFF.format(black=black)] if black > MOST_BLACK else []
        furthest = LARGEST_SHIFT * brightest / BRIGHTEST
        standard = np.array(STANDARD) * brightest / BRIGHTEST
        bounded, least = np.minimum(levels, standard + furthest), standard[-1] - furthest
        if levels[-1] < least:
            bounded = standard * (least / standard[-1])
        if not np.array_equal(bounded, levels):
            notes.append(FAR_OFF)
        return cls(tuple(bounded.round(3).tolist()), tuple(notes))

    def of(self, values: Numbers) -> Bytes:
        """What gray levels, of any shape and type, are on the standard scale; 0 for those below 0 and not finite."""
        return self.table[values] if values.dtype == np.uint8 else self._curve(_finite(values))

    @cached_property
    def table(self) -> Bytes:
        """What each of the 256 levels of 8 bits is on the standard scale, (256,)."""
        return self._curve(np.arange(256.0))

    def _curve(self, values: Floats) -> Bytes:
        last = self.landmarks[-1]
        levels = np.array([0.0, *self.landmarks, last * BRIGHTEST / STANDARD[-1]])
        # Rising, where landmarks are equal: black stays black
        levels += 1e-6 * last * np.arange(len(levels))
        standard: Bytes = np.rint(np.interp(values, levels, (0.0, *STANDARD, BRIGHTEST))).astype(np.uint8)
        return standard


def _finite(values: Array) -> Floats:
    return np.nan_to_num(values.astype(np.float64), posinf=0.0, neginf=0.0)
