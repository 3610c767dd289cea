"""Sweeps of a made-up body whose poses are a known time old."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy import ndimage
from sweeps import rigid

from AIFReconLib.sweep.frames import TrackedSequence

COLUMNS, ROWS, SPACING, RATE = 48, 40, 1.0, 20.0


def to_and_fro(t):
    """Elevational position in mm: 6 s there and back, 24 mm wide."""
    return 12.0 * np.sin(2 * np.pi * t / 6.0)


def one_way(t):
    return 4.0 * t - 20.0


@cache
def made_up_body(seed):
    body = ndimage.gaussian_filter(np.random.default_rng(seed).standard_normal((90, 70, 90)), 2.5)
    return 128 + 60 * body / body.std()


def late_sweep(path=to_and_fro, late=0.0, seconds=12.0, seed=0, noise=8.0, sideways=False) -> TrackedSequence:
    """Images of a made-up body at the true places, with poses that are `late` seconds old."""
    rng = np.random.default_rng(seed)
    body = made_up_body(seed)
    rows, columns = np.indices((ROWS, COLUMNS), dtype=float)
    images, poses, times = [], [], np.arange(int(seconds * RATE)) / RATE
    for t in times:
        offset = (path(t), 0.0) if sideways else (0.0, path(t))
        place = np.stack([np.full_like(rows, 45.0 + offset[1]), rows + 10, columns + 20 + offset[0]])
        image = ndimage.map_coordinates(body, place, order=1, mode="reflect") + noise * rng.standard_normal(rows.shape)
        images.append(np.clip(image, 0, 255).astype(np.uint8))
        claimed = path(t - late)
        poses.append(rigid((20.0, 5.0, -30.0), (7.0, 8.0, 9.0)) @ rigid((0, 0, 0), (claimed, 0, 0) if sideways else (0, 0, claimed)))
    return TrackedSequence.from_arrays(np.array(images), poses, 100.0 + times, spacing=SPACING)
