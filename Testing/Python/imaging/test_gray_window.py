"""The window of gray levels of a volume."""

from __future__ import annotations

import numpy as np

from AIFReconLib.imaging.gray_window import gray_window


def test_the_window_ends_where_almost_all_measured_voxels_do():
    levels = np.full((10, 10, 100), 120.0, np.float32)
    levels[0, 0, 0], levels[1] = 60000.0, 9000.0
    mask = np.ones(levels.shape, np.uint8)
    mask[1] = 0
    assert gray_window(levels, mask) == (0.0, 120.0)
