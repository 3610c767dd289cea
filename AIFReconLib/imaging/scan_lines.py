"""An image read along its beams: where the samples of its scan lines lie, and which sample is nearest to a pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, Integers
from .beams import LINEAR, ProbeGeometry

MOST_LINES = 512


@dataclass(frozen=True, eq=False)
class _ScanLineSamples:
    """Samples along the beams through a set of pixels."""

    columns: Floats
    rows: Floats
    """(lines, samples). Where the samples lie, in pixels of the image."""
    step: float  #: mm. Distance between samples along a line.
    sample_of_pixel: Integers  #: (n,). The nearest sample of each pixel, flat in (lines, samples).


def scan_line_samples(columns: Integers, rows: Integers, spacing: tuple[float, float], probe: ProbeGeometry) -> _ScanLineSamples:
    """Lay scan lines over pixels.

    A linear probe has one scan line per image column. A sector has lines at equal angles, about one pixel apart at the far end and at
    most 512; samples are one pixel apart along the beam.

    `columns` and `rows` (n,) are the pixels that are ultrasound, `spacing` is (x, y) in mm.
    """
    if probe.kind == LINEAR:
        left, top = int(columns.min()), int(rows.min())
        across, down = np.arange(float(left), float(columns.max()) + 1.0), np.arange(float(top), float(rows.max()) + 1.0)
        lines = np.meshgrid(across, down, indexing="ij")
        return _ScanLineSamples(lines[0], lines[1], spacing[1], (columns - left) * lines[0].shape[1] + (rows - top))
    column, row = probe.apex
    x, y = (columns - column) * spacing[0], (rows - row) * spacing[1]
    radius, angle, step = np.hypot(x, y), np.arctan2(x, y), min(spacing)
    first, last, spread = float(radius.min()), float(radius.max()), float(np.ptp(angle))
    samples = int(np.ceil((last - first) / step)) + 1
    count = int(np.clip(np.ceil(spread * last / step) + 1, 2, MOST_LINES))
    angle_step = spread / (count - 1) or 1.0
    angles = angle.min() + angle_step * np.arange(count)[:, None]
    radii = first + step * np.arange(samples)[None, :]
    line = np.floor((angle - angle.min()) / angle_step + 0.5).astype(np.int64)
    sample = np.floor((radius - first) / step + 0.5).astype(np.int64)
    return _ScanLineSamples(
        column + radii * np.sin(angles) / spacing[0],
        row + radii * np.cos(angles) / spacing[1],
        step,
        line * samples + np.minimum(sample, samples - 1),
    )
