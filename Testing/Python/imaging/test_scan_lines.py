"""Scan lines over an image: every pixel has a sample beside it, and samples run along the beams."""

from __future__ import annotations

import numpy as np
import pytest

from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import Fan, ImageRegion
from AIFReconLib.imaging.scan_lines import MOST_LINES, scan_line_samples

APEX = (60.0, -25.0)
SPACING = (0.3, 0.2)
FAN = ImageRegion(fan=Fan(APEX, (-35.0, 30.0), (9.0, 30.0), SPACING))
PIXELS = np.nonzero(FAN.mask(130, 140))[::-1]


@pytest.mark.parametrize("probe", [ProbeGeometry("linear"), ProbeGeometry("sector", APEX)], ids=["linear", "sector"])
def test_the_sample_of_a_pixel_is_within_a_pixel_of_it(probe):
    lines = scan_line_samples(*PIXELS, SPACING, probe)
    columns, rows = (at.reshape(-1)[lines.sample_of_pixel] for at in (lines.columns, lines.rows))
    off = np.hypot((columns - PIXELS[0]) * SPACING[0], (rows - PIXELS[1]) * SPACING[1])
    assert off.max() < max(SPACING)


def test_a_linear_probe_samples_every_pixel_of_its_columns():
    lines = scan_line_samples(*PIXELS, SPACING, ProbeGeometry("linear"))
    np.testing.assert_array_equal(lines.columns.reshape(-1)[lines.sample_of_pixel], PIXELS[0])
    np.testing.assert_array_equal(lines.rows.reshape(-1)[lines.sample_of_pixel], PIXELS[1])


def test_samples_of_a_sector_run_along_its_beams_at_equal_steps():
    lines = scan_line_samples(*PIXELS, SPACING, ProbeGeometry("sector", APEX))
    x, y = (lines.columns - APEX[0]) * SPACING[0], (lines.rows - APEX[1]) * SPACING[1]
    np.testing.assert_allclose(np.diff(np.hypot(x, y), axis=1), lines.step)
    np.testing.assert_allclose(np.ptp(np.arctan2(x, y), axis=1), 0, atol=1e-12)


def test_a_wide_image_has_no_more_lines_than_the_limit():
    columns, rows = np.meshgrid(np.arange(3000), np.arange(2000))
    lines = scan_line_samples(columns.ravel()[::97], rows.ravel()[::97], (0.1, 0.1), ProbeGeometry("sector", (1500.0, -10.0)))
    assert len(lines.columns) == MOST_LINES
