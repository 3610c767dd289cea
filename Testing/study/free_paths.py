"""The question that all of this is for: which straight lines from the skin to the spinal canal pass between the vertebrae?"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.simulation.scan import ScannedBack

LINES, STEP = 3000, 0.5
"""Lines that are drawn, and mm between looks along them."""

ASIDE, STEEPEST_DEG = 22.0, 30.0
"""mm from the midline within which lines begin, and the largest angle between a line and straight forward."""

FREE, BLOCKED = 1.0, 0.0
"""mm: a line whose nearest bone is farther is free, one that touches bone is blocked; those between are not asked."""

FOUND = 0.9
"""Share of the free lines that are to be found."""

NARROWEST_CANAL = 10.0
"""mm of no bone between bone, in the midline."""


@dataclass(frozen=True, eq=False)
class NeedleLines:
    """Lines from the skin into the canal, (n, m, 3) mm, and how near to bone each comes, (n,) mm."""

    points: np.ndarray
    nearest_bone: np.ndarray

    @classmethod
    def of(cls, back: ScannedBack, labels: Volume, distance: Volume, seed: int = 0) -> NeedleLines:
        """Random ones of a patient whose labels and signed distance to bone are given in Reference."""
        rng = np.random.default_rng([seed, 60])
        tips = back.spinous_tips()
        low, high = tips[:, 2].min(), tips[:, 2].max()
        entry_x, entry_z = rng.uniform(-ASIDE, ASIDE, LINES), rng.uniform(low - 5, high + 5, LINES)
        entries = np.stack([entry_x, back.skin_y(entry_x, entry_z) + 1.0, entry_z], axis=1)
        depth = canal_depth(labels, tips)
        targets = np.stack([rng.uniform(-5, 5, LINES), np.full(LINES, depth), rng.uniform(low, high, LINES)], axis=1)
        way = targets - entries
        steep = np.degrees(np.arctan2(np.hypot(way[:, 0], way[:, 2]), way[:, 1]))
        kept = steep < STEEPEST_DEG
        along = np.linspace(0.0, 1.0, int(np.linalg.norm(way, axis=1).max() / STEP))
        points = entries[kept, None] + along[None, :, None] * way[kept, None]
        return cls(points, _read(distance, points, far=99.0).min(axis=1))

    def called_free(self, volume: Volume) -> float:
        """Of the blocked lines, the share whose brightest voxel is no brighter than that of nine in ten free ones; NaN without any."""
        brightest = _read(volume, self.points).max(axis=1)
        free, blocked = brightest[self.nearest_bone >= FREE], brightest[self.nearest_bone <= BLOCKED]
        if not (free.size and blocked.size):
            return float("nan")
        return float((blocked <= np.quantile(free, FOUND)).mean())


def canal_depth(labels: Volume, tips: np.ndarray) -> float:
    """y of the middle of the spinal canal in Reference, the median over the heights at which bone closes it, mm."""
    y, z = np.arange(tips[:, 1].min() - 5, tips[:, 1].min() + 80, STEP), np.arange(tips[:, 2].min() - 10, tips[:, 2].max() + 12, 1.0)
    plane = np.stack(np.meshgrid([np.median(tips[:, 0])], y, z, indexing="ij"), axis=-1)[0]
    bone = _read(Volume((labels.array > 0).astype(np.float32), labels.ijk_to_reference), plane) > 0.5
    middles = []
    for column in bone.T:
        at = np.flatnonzero(column)
        gaps = np.diff(at)
        if gaps.size and gaps.max() * STEP > NARROWEST_CANAL:
            widest = int(gaps.argmax())
            middles.append((y[at[widest]] + y[at[widest + 1]]) / 2)
    return float(np.median(middles))


def _read(volume: Volume, points: np.ndarray, far: float = 0.0) -> np.ndarray:
    ijk = transform_points(volume.grid.reference_to_ijk, points.reshape(-1, 3))
    return ndimage.map_coordinates(volume.array, ijk.T[::-1], output=np.float32, order=1, cval=far).reshape(points.shape[:-1])
