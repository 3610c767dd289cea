"""Areas of an image are those of scipy's binary morphology."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from scipy import ndimage

from AIFReconLib.imaging.masks import closed, largest_area, opened

MASKS = arrays(bool, array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=14))
STEPS = st.integers(1, 4)


@given(MASKS, STEPS)
def test_gaps_are_closed_as_by_scipy_with_room_around_the_image(mask, steps):
    expected = ndimage.binary_closing(np.pad(mask, steps), iterations=steps)[steps:-steps, steps:-steps]
    np.testing.assert_array_equal(closed(mask, steps), expected)


@given(MASKS, STEPS)
def test_thin_lines_are_dropped_as_by_scipy(mask, steps):
    np.testing.assert_array_equal(opened(mask, steps), ndimage.binary_opening(mask, iterations=steps))


@given(MASKS.filter(lambda mask: bool(mask.any())))
def test_the_largest_area_is_the_first_of_the_largest_that_scipy_labels_with_its_holes_filled(mask):
    labels, _ = ndimage.label(mask)
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    np.testing.assert_array_equal(largest_area(mask), ndimage.binary_fill_holes(labels == sizes.argmax()))
