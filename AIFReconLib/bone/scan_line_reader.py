"""Images read along scan lines, no finer than what is looked for there: a tenth of the pixels, the same echoes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

import numpy as np
import scipy

from ..arrays import Array, Floats, Integers, Mask, Numbers, Singles
from ..effective_settings import Imaging
from ..errors import BeamGeometryError
from ..geometry.box import block_sums
from ..geometry.transforms import pixel_spacing
from ..imaging.scan_lines import scan_line_samples
from ..remedies import NAME_THE_PROBE
from ..sweep.frames import TrackedFrame

LINE_PITCH, SAMPLE_STEP = 0.5, 0.2
"""mm. Scan lines and samples closer than this are read as one, half of what echoes are smoothed by."""

Rectangle = tuple[float, float, float, float]
"""x, y, width, height in pixels of a frame; a pixel (column, row) covers column to column + 1, row to row + 1."""


Tool = TypeVar("Tool")


class ForEachKind(Generic[Tool]):
    """What reads images of one size and spacing, made for each kind of image that comes: sweeps that were joined may differ in depth."""

    def __init__(self, make: Callable[[tuple[int, int], tuple[float, float], Imaging], Tool], imaging: Imaging):
        self._make, self._imaging = make, imaging
        self._made: dict[tuple[object, ...], Tool] = {}

    def of(self, frame: TrackedFrame) -> Tool:
        """The one for a frame that has an image and a pose."""
        image, pose = frame.placed()
        size, spacing = (int(image.shape[1]), int(image.shape[0])), pixel_spacing(pose)
        key = (size, *np.round(spacing, 6))
        if key not in self._made:
            self._made[key] = self._make(size, spacing, self._imaging)
        return self._made[key]


class ScanLineReader:
    """Reads images of one size, spacing and probe along their scan lines.

    `size` is (columns, rows), `spacing` (x, y) in mm; `imaging` must know region and probe.

    Attributes
    ----------
    columns, rows : (lines, samples) float64 arrays
        Where the samples lie, in pixels of the image.
    known : (lines, samples) bool array
        Which of them lie in the region.
    pitch, step : float, mm
        Between lines (of a sector at half depth) and between samples of a line.
    """

    def __init__(self, size: tuple[int, int], spacing: tuple[float, float], imaging: Imaging):
        if imaging.probe is None:
            raise BeamGeometryError("Bone is looked for along the beams, whose directions are not known.", NAME_THE_PROBE)
        mask = imaging.region.mask(*size)
        at_row, at_column = np.nonzero(mask)
        lines = scan_line_samples(at_column, at_row, spacing, imaging.probe)
        columns, rows = lines.columns, lines.rows
        across = np.hypot(np.diff(columns, axis=0) * spacing[0], np.diff(rows, axis=0) * spacing[1])
        # A sector's lines diverge: their distance at half depth stands for all
        apart = max(float(across[:, across.shape[1] // 2].mean()), 1e-3) if across.size else 1.0
        known = _within(columns, rows, mask)
        # As many lines and samples are read as one as the smoothing that follows would blur anyway
        together = max(min(int(LINE_PITCH / apart), len(columns)), 1), max(min(int(SAMPLE_STEP / lines.step), columns.shape[1]), 1)
        self._spacing, self._samples = np.asarray(spacing), (columns, rows, known, together)
        self._read = _reading_matrix(columns, rows, known, size, together)
        self._others: dict[tuple[tuple[int, int], Rectangle], scipy.sparse.csr_matrix[np.float32]] = {}
        self.columns, self.rows, share = (block_sums(each, together, np.float64) / np.prod(together) for each in (columns, rows, known))
        self.known: Mask = share > 0.5
        self.pitch, self.step = apart * together[0], lines.step * together[1]

    def read(self, image: Numbers) -> Singles:
        """The mean of each sample's pixels, (lines, samples) float32; 0 out of the region, and for what is below 0 or not finite."""
        image = image.astype(np.float32)
        if not np.isfinite(image).all():
            image = np.nan_to_num(image, nan=0.0, posinf=0.0, neginf=0.0)
        return self._of(self._read, np.maximum(image, 0.0))

    def read_rectangle(self, values: Singles, rectangle: Rectangle) -> Singles:
        """The same of an array (rows, columns) of any size that covers this rectangle of the frame; 0 outside it."""
        size = int(values.shape[1]), int(values.shape[0])
        key = size, rectangle
        if key not in self._others:
            columns, rows, known, together = self._samples
            x, y, width, height = rectangle
            # Both count pixels from their centers
            there = (columns + 0.5 - x) * (size[0] / width) - 0.5, (rows + 0.5 - y) * (size[1] / height) - 0.5
            within = known.copy()
            for at, count in zip(there, size, strict=True):
                within &= (at > -0.5 - 1e-9) & (at < count - 0.5 + 1e-9)
            self._others[key] = _reading_matrix(*there, within, size, together)
        return self._of(self._others[key], values)

    def places(self, lines: Integers, samples: Floats) -> tuple[Floats, Floats]:
        """Places between samples of these lines: column and row (n, 2), and one mm along the beam there, in pixels (n, 2)."""
        # Scan lines are straight: both follow from the two samples around
        before = np.clip(np.floor(samples).astype(np.int64), 0, max(self.rows.shape[1] - 2, 0))
        after = np.minimum(before + 1, self.rows.shape[1] - 1)
        start, stop = (np.stack([self.columns[lines, at], self.rows[lines, at]], axis=-1) for at in (before, after))
        way = stop - start
        beams = way / np.maximum(np.linalg.norm(way * self._spacing, axis=1, keepdims=True), 1e-9)
        return start + (samples - before)[:, None] * way, beams

    def _of(self, matrix: scipy.sparse.csr_matrix[np.float32], values: Singles) -> Singles:
        samples: Singles = (matrix @ values.ravel()).reshape(self.known.shape)
        samples[~self.known] = 0.0
        return samples


def _within(columns: Floats, rows: Floats, mask: Mask) -> Mask:
    """Which samples have a pixel of the mask (rows, columns) nearest to them."""
    column, row = np.rint(columns).astype(np.int64), np.rint(rows).astype(np.int64)
    within: Mask = (column >= 0) & (column < mask.shape[1]) & (row >= 0) & (row < mask.shape[0])
    within &= mask[np.clip(row, 0, mask.shape[0] - 1), np.clip(column, 0, mask.shape[1] - 1)]
    return within


def _reading_matrix(
    columns: Floats, rows: Floats, known: Mask, size: tuple[int, int], together: tuple[int, int]
) -> scipy.sparse.csr_matrix[np.float32]:
    """The matrix that takes an image's pixels to the mean of each block of known samples, by linear interpolation; sparse float32."""
    lines, samples = (n // block for n, block in zip(columns.shape, together))
    line, sample = (number // block for number, block in zip(np.nonzero(known), together))
    whole = (line < lines) & (sample < samples)
    block = (line * samples + sample)[whole]
    column, row = (np.clip(values[known][whole], 0, n - 1) for values, n in zip((columns, rows), size))
    left, top = (np.minimum(values.astype(np.int64), n - 2) for values, n in zip((column, row), np.maximum(size, 2)))
    right, down = column - left, row - top
    corners = [(0, 0, (1 - right) * (1 - down)), (1, 0, right * (1 - down)), (0, 1, (1 - right) * down), (1, 1, right * down)]
    pixels = np.concatenate([np.minimum(top + y, size[1] - 1) * size[0] + np.minimum(left + x, size[0] - 1) for x, y, _ in corners])
    share = (
        np.concatenate([weight for *_, weight in corners]) / np.maximum(np.bincount(block, minlength=lines * samples), 1)[np.tile(block, 4)]
    )
    return scipy.sparse.csr_matrix((share.astype(np.float32), (np.tile(block, 4), pixels)), shape=(lines * samples, size[0] * size[1]))


def running_sum(lines: Array) -> Floats:
    """Sums before each sample of a line: (lines, samples + 1)."""
    return np.cumsum(np.pad(lines, ((0, 0), (1, 0))), axis=1, dtype=np.float64)
