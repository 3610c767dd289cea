"""Which pixels of an image are ultrasound: a clip rectangle, a fan, and what a single frame shows. Others never enter a volume.

All follow the Plus toolkit's definitions, always on the image in MF orientation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Floats, Integers, Mask, Numbers
from ..errors import SettingsError


@dataclass(frozen=True)
class ClipRectangle:
    """A rectangle of pixels. A size of 0 along either axis means the full image.

    Notes
    -----
    As in IGSIO, columns ceil(x) to floor(x + width) belong to it, both included, so that a whole-numbered width keeps
    width + 1 columns; rows alike; then it is cut to the image.
    """

    origin_px: tuple[float, float]
    size_px: tuple[float, float]

    def __post_init__(self) -> None:
        if not all(math.isfinite(v) for v in (*self.origin_px, *self.size_px)) or min(self.size_px) < 0:
            raise SettingsError(f"Input clip rectangle must be X Y W H with W, H not negative; got {self.origin_px} {self.size_px}.")

    def bounds(self, columns: int, rows: int) -> tuple[int, int, int, int]:
        """First and last column, first and last row that it keeps; a last below its first means none."""
        if 0 in self.size_px:
            return 0, columns - 1, 0, rows - 1
        (x, y), (width, height) = self.origin_px, self.size_px
        left, top = max(math.ceil(x), 0), max(math.ceil(y), 0)
        right, bottom = min(math.floor(x + width), columns - 1), min(math.floor(y + height), rows - 1)
        # Never below -1, which a slice would count from the image's other end
        return left, max(right, left - 1), top, max(bottom, top - 1)


@dataclass(frozen=True)
class Fan:
    """A sector about an apex, between two angles and two radii.

    Notes
    -----
    With x = column - apex, y = row - apex, a pixel is kept where y >= 0, tan(first) <= x sx / (y sy) <= tan(last) and
    first^2 <= (x sx)^2 + (y sy)^2 <= last^2 (IGSIO's rule without optimization; at y = 0 only x = 0 can be kept). IGSIO states the
    slopes as x / y against tan(angle) sy / sx, which is the same.
    """

    apex_px: tuple[float, float]  #: (column, row)
    angles_deg: tuple[float, float]  #: (first, last). From the image's +y axis toward +x. Within (-90, 90).
    radii: tuple[float, float]  #: (first, last). In the unit of `pixel_size`.
    pixel_size: tuple[float, float] = (1.0, 1.0)
    """(x, y). Size of a pixel. Plus measures fans in pixels, (1, 1), whatever their size; a scan conversion in mm."""

    def __post_init__(self) -> None:
        first, last = sorted(self.angles_deg)
        object.__setattr__(self, "angles_deg", (first, last))
        if not -90 < self.angles_deg[0] < self.angles_deg[1] < 90:
            raise SettingsError(f"Input fan angles must differ and lie between -90 and 90 degrees; got {self.angles_deg}.")
        if not 0 <= self.radii[0] < self.radii[1] or not math.isfinite(self.radii[1]):
            raise SettingsError(f"Input fan radii must be two rising, not negative numbers; got {self.radii}.")
        if min(self.pixel_size) <= 0 or not all(math.isfinite(v) for v in (*self.apex_px, *self.pixel_size)):
            raise SettingsError(f"Input fan must have a finite apex and a positive pixel size; got {self.apex_px}, {self.pixel_size}.")

    def mask(self, columns: int, rows: int) -> Mask:
        """Which pixels are inside, (rows, columns) bool."""
        x = np.arange(columns, dtype=np.float64)[None, :] - self.apex_px[0]
        y = np.arange(rows, dtype=np.float64)[:, None] - self.apex_px[1]
        aspect = self.pixel_size[1] / self.pixel_size[0]
        left, right = (math.tan(math.radians(angle)) * aspect for angle in self.angles_deg)
        squared_radius = (x * self.pixel_size[0]) ** 2 + (y * self.pixel_size[1]) ** 2
        return (
            (y >= 0) & (left * y <= x) & (x <= right * y) & (squared_radius >= self.radii[0] ** 2) & (squared_radius <= self.radii[1] ** 2)
        )


@dataclass(frozen=True)
class ImageRegion:
    """The part of the image that is ultrasound: clip rectangle and fan, each optional.

    With `fan_detection`, each frame's own angles are looked for within those of the fan; `mask` has the fan's.
    """

    clip: ClipRectangle | None = None
    fan: Fan | None = None
    fan_detection: FanDetection | None = None

    def mask(self, columns: int, rows: int) -> Mask:
        """Which pixels enter a volume, (rows, columns) bool.

        Raises
        ------
        SettingsError
            When no pixel is left.
        """
        mask = np.ones((rows, columns), dtype=bool)
        if self.clip is not None:
            left, right, top, bottom = self.clip.bounds(columns, rows)
            mask[:] = False
            mask[top : bottom + 1, left : right + 1] = True
        if self.fan is not None:
            mask &= self.fan.mask(columns, rows)
        if not mask.any():
            raise SettingsError(f"The clip rectangle and fan leave no pixel of a {columns} x {rows} image. Check them against the image.")
        return mask

    def entering(self, image: Numbers, rejection: float | None) -> Mask | None:
        """The pixels of one image that enter, (rows, columns) bool; None for all of `mask`.

        Pixels darker than `rejection` do not, and with `fan_detection` the fan is narrowed frame by frame.
        """
        entering = None if rejection is None else image >= rejection
        if self.fan is not None and self.fan_detection is not None:
            angles = self.fan_detection.angles(image, self.fan)
            if angles is None:
                return np.zeros(image.shape, dtype=bool)
            fan = replace(self.fan, angles_deg=angles).mask(image.shape[1], image.shape[0])
            entering = fan if entering is None else entering & fan
        return entering


def extreme_pixels(mask: Mask) -> Floats:
    """The first and last kept pixel of every row, (n, 2) float64 (column, row): their hull is the hull of all kept pixels."""
    rows = np.flatnonzero(mask.any(axis=1))
    first = mask.argmax(axis=1)[rows]
    last = mask.shape[1] - 1 - mask[:, ::-1].argmax(axis=1)[rows]
    pixels: Floats = np.concatenate([np.stack([first, rows], axis=1), np.stack([last, rows], axis=1)]).astype(np.float64)
    return pixels


def outline_of(mask: Mask) -> Floats:
    """The closed line around the kept pixels of a mask (rows, columns), (n, 2) (column, row): down its left side, up its right one."""
    ends = extreme_pixels(mask)
    half = len(ends) // 2
    line = np.concatenate([ends[:half], ends[half:][::-1]])
    return np.concatenate([line, line[:1]])


DEPTHS = (0.15, 0.30, 0.50, 0.70)
"""Where the arcs are that are looked at, as parts of the way from the fan's first to its last radius."""

MARGIN_DEG = 3.0
"""What is taken off each side of the lit part of a fan."""


@dataclass(frozen=True)
class FanDetection:
    """How lit parts of a fan are told from dark ones."""

    threshold: float = 30.0  #: Gray level that a lit pixel has at least
    filter_radius_px: int = 10  #: Half the length of the window, along the arc, of which half the pixels must be lit

    def angles(self, image: Numbers, fan: Fan) -> tuple[float, float] | None:
        """The angles between which a frame shows something.

        `fan` is in pixels; the answer lies within its angles. None where no arc is lit.

        The widest lit part of any of four arcs, 3 degrees off either side. Arcs are sampled a pixel apart from the first angle on;
        samples outside the image are left out, and the apex counts in whole pixels.
        """
        widest = (0.0, 0.0)
        for depth in DEPTHS:
            angles, lit = self._arc(image, fan, fan.radii[0] + (fan.radii[1] - fan.radii[0]) * depth)
            for span in self._lit_spans(angles, lit, math.radians(fan.angles_deg[1])):
                if span[1] - span[0] > widest[1] - widest[0]:
                    widest = span
        if widest == (0.0, 0.0):
            return None
        first = max(math.degrees(widest[0]) + MARGIN_DEG, fan.angles_deg[0])
        last = min(math.degrees(widest[1]) - MARGIN_DEG, fan.angles_deg[1])
        return (min(first, last), max(first, last)) if first != last else None

    def _arc(self, image: Numbers, fan: Fan, radius: float) -> tuple[Floats, Mask]:
        """Angles along an arc, rad, and whether the pixels there are lit."""
        first, last = (math.radians(angle) for angle in fan.angles_deg)
        angles = first + np.arange(int((last - first) * radius)) / max(radius, 1e-9)
        column = _rounded(int(fan.apex_px[0]) + radius * np.sin(angles))
        row = _rounded(int(fan.apex_px[1]) + radius * np.cos(angles))
        inside = (column >= 0) & (column < image.shape[1]) & (row >= 0) & (row < image.shape[0])
        return angles[inside], image[row[inside], column[inside]] >= self.threshold

    def _lit_spans(self, angles: Floats, lit: Mask, end: float) -> list[tuple[float, float]]:
        """First and last angle of each lit part of an arc; one that does not end on it ends at `end`."""
        window = 2 * self.filter_radius_px
        count = np.cumsum(np.concatenate([[0], lit]))
        spans: list[tuple[float, float]] = []
        start: float | None = None
        for place in range(window, len(angles)):
            inside = count[place] - count[place - window]
            if start is None and 2 * inside >= window:
                start = float(angles[place - window])
            elif start is not None and 2 * inside <= window:
                spans.append((start, float(angles[place - 1])))
                start = None
        return spans if start is None else [*spans, (start, end)]


def _rounded(numbers: Floats) -> Integers:
    """The nearest whole numbers, halves away from zero."""
    whole: Floats = np.trunc(numbers + np.copysign(0.5, numbers))
    return whole.astype(np.int64)
