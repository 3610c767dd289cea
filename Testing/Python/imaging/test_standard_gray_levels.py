"""The gray levels that images are judged by are the same whatever the knobs of a scanner are set to, and never a wild guess."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import ndimage
from study.scanner_looks import LOOKS

from AIFReconLib.imaging.gray_levels import FAR_OFF, LARGEST_SHIFT, PERCENTILES, STANDARD, UNTOLD, GrayLevels

ROWS, COLUMNS = 90, 70
EVERYWHERE = np.ones((ROWS, COLUMNS), bool)
POINTWISE = ("gray curve 0.6", "gray curve 1.6", "gain +8 dB of 60")


def sweep(frames=30, seed=0):
    """Speckle over shadows that move, as tissue over bone has them."""
    rng = np.random.default_rng(seed)
    field = ndimage.gaussian_filter(rng.normal(size=(frames, ROWS, COLUMNS)), (0, 1, 1))
    images = 60 + 32 * field / field.std()
    for number in range(frames):
        images[number, 40:, number : number + 25] *= 0.15
    return np.clip(np.rint(images), 1, 255).astype(np.uint8)


def learned(images, mask=EVERYWHERE):
    return GrayLevels.learned(images, mask)


def test_the_pixels_of_a_sweep_have_the_percentiles_of_the_standard():
    images = sweep()
    standard = learned(images).of(images)
    np.testing.assert_allclose(np.percentile(standard, PERCENTILES), STANDARD, atol=6)


@pytest.mark.parametrize(("look", "bright"), [*((look, 30) for look in POINTWISE), ("gain -8 dB of 60", 60)])
def test_gain_and_gray_curve_change_nothing_that_is_judged_and_what_is_cut_off_stays_black(look, bright):
    images = sweep()
    seen = LOOKS[look](images)
    ours, theirs = (learned(each).of(each).astype(int) for each in (images, seen))
    assert np.abs(ours - theirs)[images > bright].mean() < 2.5
    assert (theirs[seen == 0] == 0).all()
    levels = GrayLevels.as_recorded()
    np.testing.assert_array_equal(levels.of(np.array([np.nan, -5.0, np.inf, -np.inf, 80.0], np.float32)), [0, 0, 0, 0, 80])


def test_a_cut_range_is_told_with_what_to_turn():
    images = sweep().astype(float)
    cut = np.clip(1.5 * (images - 85), 0, 255).astype(np.uint8)
    assert any("dynamic range" in note for note in learned(cut).notes)
    assert not learned(sweep()).notes


@pytest.mark.parametrize("dtype", [np.uint16, np.int16, np.float32])
def test_sixteen_bits_and_floating_point_are_judged_as_eight_bits_are(dtype):
    images = sweep()
    wide = images.astype(dtype) * dtype(16)
    np.testing.assert_allclose(learned(wide).of(wide).astype(int), learned(images).of(images), atol=1)


def test_black_surround_text_and_a_third_without_contact_leave_the_curve_as_it_is():
    images = sweep()
    framed = np.zeros((len(images), ROWS + 60, COLUMNS + 40), np.uint8)
    framed[:, 30 : 30 + ROWS, 20 : 20 + COLUMNS] = images
    framed[:, :8, :8] = 255
    whole = GrayLevels.learned(framed, np.ones(framed.shape[1:], bool))
    np.testing.assert_allclose(whole.landmarks, learned(images).landmarks, atol=6)


@pytest.mark.parametrize(
    "images",
    [np.zeros((9, ROWS, COLUMNS), np.uint8), np.full((9, ROWS, COLUMNS), 77, np.uint8), np.full((9, ROWS, COLUMNS), np.nan, np.float32)],
    ids=["black", "constant", "not finite"],
)
def test_images_that_tell_nothing_are_judged_as_they_are(images):
    levels = learned(images)
    assert levels.notes == (UNTOLD,)
    if images.dtype == np.uint8:
        np.testing.assert_array_equal(levels.table, np.arange(256))


def test_water_is_not_turned_into_tissue():
    noise = np.random.default_rng(0).integers(0, 12, (20, ROWS, COLUMNS)).astype(np.uint8)
    levels = learned(noise)
    assert FAR_OFF in levels.notes
    assert levels.of(noise).max() < 0.2 * 255


@given(st.lists(st.integers(0, 255), min_size=8, max_size=8), st.integers(1, 40))
def test_every_curve_rises_is_bounded_and_leaves_black_black(values, frames):
    images = np.array(values, np.uint8).repeat(ROWS * COLUMNS // 8 + 1)[: ROWS * COLUMNS].reshape(1, ROWS, COLUMNS).repeat(frames, 0)
    levels = learned(images)
    assert (np.diff(levels.table.astype(int)) >= 0).all()
    assert levels.table[0] == 0
    assert (np.subtract(levels.landmarks, STANDARD) <= LARGEST_SHIFT + 1e-3).all()
    assert levels.landmarks[-1] >= STANDARD[-1] - LARGEST_SHIFT - 1e-3
