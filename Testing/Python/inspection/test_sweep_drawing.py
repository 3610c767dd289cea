"""The drawing of a sweep: what is ultrasound is marked in it."""

from __future__ import annotations

import re

import numpy as np

from AIFReconLib.imaging.region import ClipRectangle, Fan, ImageRegion
from AIFReconLib.inspection.sweep_drawing import PANEL, draw_sweep

POSES = np.tile(np.diag([0.5, 0.5, 0.5, 1.0]), (3, 1, 1))


def marked(region) -> list[np.ndarray]:
    """The blue outlines, one a panel, (n, 2) on the page."""
    found = re.findall(r'<polygon points="([^"]+)" fill="#2471a3"', draw_sweep(POSES, (200, 100), region=region).to_svg())
    return [np.array([pair.split(",") for pair in points.split()], dtype=float) for points in found]


def test_the_rectangle_that_is_ultrasound_is_drawn_at_its_place():
    first, _second = marked(ImageRegion(ClipRectangle((50.0, 20.0), (100.0, 60.0))))
    scale = PANEL / (199 * 0.5)
    np.testing.assert_allclose(np.ptp(first, axis=0), (100 * 0.5 * scale, 60 * 0.5 * scale), atol=0.2)


def test_the_outline_of_a_sector_goes_around_it_once():
    first, _second = marked(ImageRegion(fan=Fan((100.0, 0.0), (-30.0, 30.0), (20.0, 90.0))))
    x, y = first.T
    enclosed = 0.5 * abs(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1)))
    scale = PANEL / (199 * 0.5) * 0.5
    # The near arc bends inward, which the first and last pixels of rows do not tell
    assert 0.97 * np.pi / 6 * (90**2 - 20**2) < enclosed / scale**2 < 1.05 * np.pi / 6 * 90**2


def test_without_a_region_nothing_is_marked():
    assert marked(None) == []
