"""The compiled judge of frames gives every pixel what `ScanLines.evidence` gives it, whatever the shape of the ultrasound."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from AIFReconLib.compounding.evidence import ScanLines
from AIFReconLib.compounding.layout import PixelLayout
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.gray_levels import GrayLevels

pytest.importorskip("numba", reason="numba is not installed")
from AIFReconLib.compounding.compiled.numba_evidence import judge_frame

COLUMNS, ROWS = 70, 60
PROBES = [ProbeGeometry("linear"), ProbeGeometry("sector", (35.0, -12.0)), ProbeGeometry("sector", (-20.0, -30.0))]


def layout_of(mask, spacing):
    """A layout of just these pixels."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    window = int(rows[0]), int(rows[-1]) + 1, int(columns[0]), int(columns[-1]) + 1
    return PixelLayout((COLUMNS, ROWS), spacing, window, mask[window[0] : window[1], window[2] : window[3]], None, None)


def patches(seed, count):
    """A mask of some rectangles with holes between and in them."""
    rng = np.random.default_rng(seed)
    mask = np.zeros((ROWS, COLUMNS), bool)
    for number in range(2 * count):
        top, left = rng.integers(0, ROWS), rng.integers(0, COLUMNS)
        mask[top : top + rng.integers(1, ROWS), left : left + rng.integers(1, 30)] = number < count or rng.random() < 0.3
    mask[rng.integers(0, ROWS), rng.integers(0, COLUMNS)] = True
    return mask


def echoes(seed, dtype):
    """Speckle, bright places, and darkness below some of them."""
    rng = np.random.default_rng(seed)
    image = rng.integers(0, 60, (ROWS, COLUMNS)).astype(float)
    for column in range(0, COLUMNS, 7):
        surface = rng.integers(0, ROWS)
        image[surface : surface + 5, column : column + 6] = 240
        image[surface + 5 :, column : column + 6] *= rng.choice([0.0, 0.0, 1.0])
    return image.astype(dtype) if dtype == np.uint8 else (1.07 * image).astype(dtype)


@settings(max_examples=40)
@given(
    seed=st.integers(0, 10_000),
    count=st.integers(1, 5),
    probe=st.sampled_from(PROBES),
    spacing=st.sampled_from([(0.3, 0.3), (0.25, 0.6), (2.0, 2.0), (0.12, 0.1)]),
    dtype=st.sampled_from([np.uint8, np.float32]),
    levels=st.sampled_from([GrayLevels.as_recorded(), GrayLevels((3.0, 9.0, 30.0, 30.0, 70.0, 99.5, 180.0, 240.0))]),
)
def test_every_pixel_gets_the_evidence_of_its_scan_line(seed, count, probe, spacing, dtype, levels):
    layout = layout_of(patches(seed, count), spacing)
    lines = ScanLines(layout, probe)
    # A CT that expects bone here and there, on a grid that the images leave
    probability = np.random.default_rng(seed).random((5, 7, 9), dtype=np.float32)
    place = np.array([[0.12, 0.03, 0, -0.4], [0.02, 0.11, 0, 0.2], [0.05, -0.04, 1, 2], [0, 0, 0, 1]])
    for frame in range(2):
        image = echoes(seed + frame, dtype)
        by_ct = lines.expected(probability, place)
        expected = lines.evidence(layout.values(image), levels, by_ct)
        found = np.empty((2, expected[0].size), np.float32)
        judge_frame(lines, levels, layout.pixels(image), (probability, place), (found[0], found[1]))
        np.testing.assert_array_equal(found, expected)
