"""The question that all of this is for: which straight lines from the skin to the spinal canal pass between the vertebrae?"""

from __future__ import annotations

import numpy as np

from AIFReconLib.evaluation.lines import STEP, StraightLines, values_at
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.simulation.scan import ScannedBack

LINES = 3000

ASIDE, STEEPEST_DEG = 22.0, 30.0
"""mm from the midline within which lines begin, and the largest angle between a line and straight forward."""

NARROWEST_CANAL = 10.0
"""mm of no bone between bone, in the midline."""


def lines_to_canal(back: ScannedBack, labels: Volume, distance: Volume, seed: int = 0) -> StraightLines:
    """Random lines of a patient whose labels and signed distance to bone are given in Reference."""
    rng = np.random.default_rng([seed, 60])
    tips = back.spinous_tips()
    low, high = tips[:, 2].min(), tips[:, 2].max()
    entry_x, entry_z = rng.uniform(-ASIDE, ASIDE, LINES), rng.uniform(low - 5, high + 5, LINES)
    entries = np.stack([entry_x, back.skin_y(entry_x, entry_z) + 1.0, entry_z], axis=1)
    depth = canal_depth(labels, tips)
    ends = np.stack([rng.uniform(-5, 5, LINES), np.full(LINES, depth), rng.uniform(low, high, LINES)], axis=1)
    way = ends - entries
    kept = np.degrees(np.arctan2(np.hypot(way[:, 0], way[:, 2]), way[:, 1])) < STEEPEST_DEG
    return StraightLines.past(distance, entries[kept], ends[kept])


def canal_depth(labels: Volume, tips: np.ndarray) -> float:
    """y of the middle of the spinal canal in Reference, the median over the heights at which bone closes it, mm."""
    y, z = np.arange(tips[:, 1].min() - 5, tips[:, 1].min() + 80, STEP), np.arange(tips[:, 2].min() - 10, tips[:, 2].max() + 12, 1.0)
    plane = np.stack(np.meshgrid([np.median(tips[:, 0])], y, z, indexing="ij"), axis=-1)[0]
    bone = values_at(Volume((labels.array > 0).astype(np.float32), labels.ijk_to_reference), plane) > 0.5
    middles = []
    for column in bone.T:
        at = np.flatnonzero(column)
        gaps = np.diff(at)
        if gaps.size and gaps.max() * STEP > NARROWEST_CANAL:
            widest = int(gaps.argmax())
            middles.append((y[at[widest]] + y[at[widest + 1]]) / 2)
    return float(np.median(middles))
