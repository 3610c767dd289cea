"""How much sound reaches each pixel: 1 before bone, falling quickly once a beam has gone through some of it."""

from __future__ import annotations

import numpy as np

from ..beams import LINEAR, ProbeGeometry
from .layout import PixelLayout


class ScanLines:
    """Samples along the beams of one image layout, and which sample belongs to which pixel.

    Parameters
    ----------
    layout : PixelLayout
    probe : ProbeGeometry

    Notes
    -----
    A linear probe has one scan line per image column. A sector has lines at equal angles, about one pixel apart at the far end
    and at most 512; samples are one pixel apart along the beam.
    """

    MOST_LINES = 512

    def __init__(self, layout: PixelLayout, probe: ProbeGeometry):
        top, bottom, left, right = layout.window
        rows, columns = np.divmod(layout.inside, right - left)
        if probe.kind == LINEAR:
            self.step = layout.spacing[1]
            self.columns = np.broadcast_to(np.arange(left, right, dtype=np.float64)[:, None], (right - left, bottom - top))
            self.rows = np.broadcast_to(np.arange(top, bottom, dtype=np.float64)[None, :], (right - left, bottom - top))
            self.sample_of_pixel = columns * (bottom - top) + rows
            return
        x = (columns + (left - probe.apex_px[0])) * layout.spacing[0]
        y = (rows + (top - probe.apex_px[1])) * layout.spacing[1]
        radius, angle = np.hypot(x, y), np.arctan2(x, y)
        self.step = min(layout.spacing)
        first, last = float(radius.min()), float(radius.max())
        samples = int(np.ceil((last - first) / self.step)) + 1
        spread = float(angle.max() - angle.min())
        lines = int(np.clip(np.ceil(spread * last / self.step) + 1, 2, self.MOST_LINES))
        angle_step = spread / (lines - 1) or 1.0
        angles = angle.min() + angle_step * np.arange(lines)[:, None]
        radii = first + self.step * np.arange(samples)[None, :]
        self.columns = probe.apex_px[0] + radii * np.sin(angles) / layout.spacing[0]
        self.rows = probe.apex_px[1] + radii * np.cos(angles) / layout.spacing[1]
        line = np.floor((angle - angle.min()) / angle_step + 0.5).astype(np.int64)
        sample = np.floor((radius - first) / self.step + 0.5).astype(np.int64)
        self.sample_of_pixel = line * samples + np.minimum(sample, samples - 1)

    def transmission(self, image_to_ijk: np.ndarray, bone_inside: np.ndarray, depth: float, length: float) -> np.ndarray:
        """Share of sound that reaches each pixel of the layout, (n,) float32, 0 to 1.

        Parameters
        ----------
        image_to_ijk : (4, 4) array
        bone_inside : [k, j, i] uint8 array
            1 within bone.
        depth : float, mm
            Bone that a beam may cross at full strength, so that the surface itself and what blurs below it are not dimmed.
        length : float, mm
            Further bone in which the sound falls by e.

        Notes
        -----
        T = exp(-max(0, crossed - depth) / length), `crossed` being the bone above the sample along its scan line. Bone outside
        the grid is not known and casts no shadow.
        """
        shape = bone_inside.shape
        flat = np.zeros(self.columns.shape, dtype=np.int64)
        known = np.ones(self.columns.shape, dtype=bool)
        for axis in (2, 1, 0):
            row_part = image_to_ijk[axis, 1] * self.rows + (image_to_ijk[axis, 3] + 0.5)
            position = np.floor(row_part + image_to_ijk[axis, 0] * self.columns).astype(np.int64)
            size = shape[2 - axis]
            known &= (position >= 0) & (position < size)
            flat = flat * size + np.clip(position, 0, size - 1)
        blocked = bone_inside.reshape(-1)[flat] * known
        crossed = np.cumsum(blocked, axis=1, dtype=np.float32) * np.float32(self.step)
        transmission = np.exp(-np.maximum(crossed - np.float32(depth), np.float32(0)) / np.float32(length))
        return transmission.reshape(-1)[self.sample_of_pixel].astype(np.float32)
