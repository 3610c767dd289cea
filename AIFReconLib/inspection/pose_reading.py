"""Whether poses are read in their direction, judged by images: frames that look alike should lie near each other."""

from __future__ import annotations

import numpy as np
import scipy

from ..arrays import Floats, Matrix
from ..sweep.frames import TrackedSequence

MOST_FRAMES, SEEN_PIXELS = 80, 32
"""Frames that are compared with each other, and pixels along each side of their images then."""

AGREES, BETTER = 0.5, 0.2
"""Rank correlation of what images and poses say of two frames, from which the inverse counts, and how much better it must be."""

FEWEST_FRAMES = 12


def is_inverse_better(sequence: TrackedSequence, poses: Matrix, image_to_tool: Matrix) -> bool:
    """Whether the images of a sequence agree clearly better with the inverse of poses (n, 4, 4), rigid and NaN where there are none.

    `image_to_tool` takes pixels to where the poses begin. Sweeps that go straight on agree with both.
    """
    known = np.flatnonzero(np.isfinite(poses).all(axis=(1, 2)))
    if len(known) < FEWEST_FRAMES:
        return False
    chosen = known[np.linspace(0, len(known) - 1, min(len(known), MOST_FRAMES)).astype(int)]
    columns, rows = sequence.frame_size
    picked = np.ix_(*(np.linspace(0, size - 1, min(SEEN_PIXELS, size)).astype(int) for size in (rows, columns)))
    seen = np.stack([scipy.ndimage.uniform_filter(np.asarray(sequence.images[int(n)], np.float64), 5)[picked].ravel() for n in chosen])
    seen -= seen.mean(axis=0)
    lengths = np.linalg.norm(seen, axis=1)
    if not (lengths > 0).all():
        return False
    seen /= lengths[:, None]
    first, second = np.triu_indices(len(chosen), 1)
    unlike = 1.0 - (seen @ seen.T)[first, second]
    corners = image_to_tool @ np.array([[0, 0, 0, 1], [columns, 0, 0, 1], [0, rows, 0, 1], [columns, rows, 0, 1]], np.float64).T

    def agreement(read: Matrix) -> float:
        places: Floats = (read @ corners)[:, :3]
        apart = np.sqrt(((places[first] - places[second]) ** 2).sum(axis=1).mean(axis=1))
        return float(scipy.stats.spearmanr(unlike, apart).statistic) if np.ptp(apart) > 0 else 0.0

    inverse = agreement(np.asarray(np.linalg.inv(poses[chosen]), np.float64))
    return inverse >= AGREES and inverse - agreement(poses[chosen]) >= BETTER
