"""Clip rectangles and fans against Plus's and IGSIO's rules as plain loops."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from geometry_strategies import numbers
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from AIFReconLib.effective_settings import asked_imaging
from AIFReconLib.errors import SettingsError
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, Fan, FanDetection, ImageRegion
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.sweep.configuration import PlusConfiguration


def chosen_region(configured=None, clip=None, angles=None, radii=None, apex=None, probe=None):
    """The region that a recipe asks for, completed by a configuration."""
    clip_px = None if clip is None else (*clip.origin_px, *clip.size_px)
    asked = Recipe(clip_px=clip_px, fan_angles_deg=angles, fan_radius_px=radii, apex_px=apex)
    return asked_imaging(asked, PlusConfiguration(region=configured or ImageRegion(), probe=probe))[0]


def kept_by_loop(columns: int, rows: int, clip=None, fan=None) -> np.ndarray:
    """Plus's clip and IGSIO's fan without optimization, pixel by pixel, as plus-conventions.md states them."""
    kept = np.zeros((rows, columns), dtype=bool)
    for row in range(rows):
        for column in range(columns):
            inside = True
            if clip is not None:
                (ox, oy), (width, height) = clip
                if width > 0 and height > 0:
                    inside = math.ceil(ox) <= column <= math.floor(ox + width) and math.ceil(oy) <= row <= math.floor(oy + height)
            if inside and fan is not None:
                (ax, ay), angles, (start, stop), (sx, sy) = fan
                x, y = column - ax, row - ay
                low, high = (math.tan(math.radians(angle)) * abs(sy / sx) for angle in angles)
                if y < 0:
                    inside = False
                elif y == 0:
                    inside = x == 0
                else:
                    inside = low <= x / y <= high
                inside = inside and start**2 <= (x * sx) ** 2 + (y * sy) ** 2 <= stop**2
            kept[row, column] = inside
    return kept


BESIDE = (((-30, 2), (10, 5)), ((2, -30), (10, 5)), ((40, 2), (10, 5)), ((2, 40), (10, 5)), ((2.2, 2.2), (0.5, 0.5)), ((-1, 2), (0.5, 5)))


@pytest.mark.parametrize("clip", BESIDE)
def test_a_clip_beside_the_image_leaves_nothing_and_says_so(clip):
    with pytest.raises(SettingsError, match="leave no pixel of a 20 x 10 image"):
        ImageRegion(ClipRectangle(*clip)).mask(20, 10)


@given(st.tuples(numbers(-30, 40), numbers(-30, 40)), st.tuples(numbers(0, 50), numbers(0, 50)))
@settings(max_examples=80)
def test_a_clip_equals_the_plain_loop(origin, size):
    expected = kept_by_loop(13, 9, clip=(origin, size))
    assume(expected.any())
    np.testing.assert_array_equal(ImageRegion(ClipRectangle(origin, size)).mask(13, 9), expected)


@given(
    st.tuples(numbers(-10, 40), numbers(-20, 20)),
    st.tuples(numbers(-80, 80), numbers(-80, 80)),
    st.tuples(numbers(0, 15), numbers(1, 40)),
    st.tuples(numbers(0.1, 3), numbers(0.1, 3)),
)
@settings(max_examples=80)
def test_a_fan_equals_the_plain_loop(apex, angles, radii, pixel_size):
    # A pixel in the very apex has any angle: no apex is closer to one than the last digits tell
    apex, angles = tuple(round(value, 6) for value in apex), tuple(sorted(round(value, 6) for value in angles))
    assume(angles[0] < angles[1])
    assume(radii[0] < radii[1])
    expected = kept_by_loop(23, 17, fan=(apex, angles, radii, pixel_size))
    np.testing.assert_array_equal(Fan(apex, angles, radii, pixel_size).mask(23, 17), expected)


NAN = math.nan
NO_SECTOR: list[Any] = [((5, 0), angles, (0, 9)) for angles in ((10, 10), (-90, 10), (-10, 90), (NAN, 10))]
NO_SECTOR += [((5, 0), (-10, 10), radii) for radii in ((9, 9), (-1, 9), (0, math.inf), (0, NAN))]
NO_SECTOR += [((NAN, 0), (-10, 10), (0, 9)), *(((5, 0), (-10, 10), (0, 9), size) for size in ((0.0, 1.0), (1.0, NAN)))]


@pytest.mark.parametrize("fan", NO_SECTOR)
def test_a_fan_that_is_no_sector_is_refused(fan):
    with pytest.raises(SettingsError, match="Input fan"):
        Fan(*fan)


CLIP, OTHER_CLIP = ClipRectangle((1.0, 2.0), (10.0, 8.0)), ClipRectangle((0.0, 0.0), (5.0, 5.0))
FAN = Fan((20.0, -10.0), (-30.0, 30.0), (12.0, 30.0))
ANGLES, RADII = (-20.0, 15.0), (10.0, 25.0)


def test_what_is_asked_for_goes_before_what_is_configured_of_the_same_kind():
    assert chosen_region(ImageRegion(OTHER_CLIP, FAN), CLIP) == ImageRegion(CLIP, FAN)
    detected = ImageRegion(CLIP, FAN, FanDetection())
    assert chosen_region(detected, None, ANGLES, RADII) == ImageRegion(CLIP, Fan(FAN.apex_px, ANGLES, RADII))
    sector = ProbeGeometry("sector", (7.0, 8.0))
    for apex, configured, expected in (((1.0, 2.0), FAN, (1.0, 2.0)), (None, FAN, FAN.apex_px), (None, None, (7.0, 8.0))):
        assert chosen_region(ImageRegion(None, configured), None, ANGLES, RADII, apex, sector).fan.apex_px == expected
    with pytest.raises(SettingsError, match="apex"):
        chosen_region(None, None, ANGLES, RADII, None, ProbeGeometry("linear"))
    for half in ((ANGLES, None), (None, RADII)):
        with pytest.raises(SettingsError, match="both"):
            chosen_region(None, None, *half)
