"""Pixels that enter by what a frame shows: dark ones are rejected, and a fan is narrowed to where it is lit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sweeps import compounded, oblique_frames, sphere_bone

from AIFReconLib.compounding.methods.table import BONE_METHODS
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, Fan, FanDetection, ImageRegion

FAN = Fan((100, 0), (-45, 45), (20, 150))
DETECTION = FanDetection(30, 10)
COLUMN, ROW = np.meshgrid(np.arange(201), np.arange(160))
ANGLE = np.degrees(np.arctan2(COLUMN - 100, ROW))


def reconstructed(frames, method="average", engine="auto", rejection=None, interpolation="nearest", region=None):
    asked = {"method": method, "engine": engine, "pixel_rejection": rejection, "interpolation": interpolation}
    bone = sphere_bone() if method in BONE_METHODS else None
    return compounded(frames, None, bone, ProbeGeometry("linear"), region, intensity_maximum=255, **asked)


@pytest.mark.parametrize(("method", "interpolation"), [("average", "nearest"), ("aif", "nearest"), ("average", "linear")])
@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_rejected_pixels_are_as_if_they_were_not_numbers(method, interpolation, dtype, engine):
    frames = oblique_frames(seed=4, count=3, dtype=dtype)
    without = [replace(f, image=np.where(f.image >= 100, f.image, np.nan).astype(np.float32)) for f in frames]
    ours = reconstructed(frames, method, engine, 100, interpolation)
    theirs = reconstructed(without, method, engine, None, interpolation)
    np.testing.assert_array_equal(ours.hits.array, theirs.hits.array)
    np.testing.assert_allclose(ours.intensity.array, theirs.intensity.array, atol=0.51)


@pytest.mark.parametrize("engine", ["numpy", "auto"])
def test_bright_pixels_beside_the_ultrasound_do_not_make_a_dark_frame_count_as_outside(engine):
    frame = oblique_frames(seed=4, count=1)[0]
    image = np.zeros_like(frame.image)
    image[:3] = 255
    region = ImageRegion(ClipRectangle((0, 5), (33, 20)))
    result = reconstructed([replace(frame, image=image)], engine=engine, rejection=20, region=region)
    assert result.skipped == {"nothing bright enough in the image": [0]}


def lit(first, last, level=120):
    """An image that is bright between two angles about the fan's apex."""
    return np.where((first <= ANGLE) & (last >= ANGLE), level, 5).astype(np.uint8)


@pytest.mark.parametrize(
    ("window", "image", "expected", "off"),
    [
        # Half a window of 20 samples may be dark: along the arc that is widest in degrees, the first, 10 px are 14 degrees
        *((10, lit(first, last), (first + 3, last - 3), 15) for first, last in ((-30, 20), (-10, 40), (5, 35))),
        (1, lit(-30, 20), (-27, 17), 3),
        (2, np.maximum(lit(-40, -20), lit(0, 35)), (3, 32), 9),
        (10, np.full((160, 201), 99, np.uint8), (-42, 42), 1e-9),
    ],
)
def test_the_widest_lit_part_of_a_fan_is_found_less_three_degrees(window, image, expected, off):
    angles = FanDetection(30, window).angles(image, FAN)
    np.testing.assert_allclose(angles, expected, atol=off)
    assert angles[0] < expected[0] + 1e-6
    # Arcs outside the image are not looked at
    assert FanDetection(30, window).angles(image[:10, :10], Fan((-500, -500), (-45, 45), (20, 150))) is None


def test_a_frame_without_contact_is_counted_as_skipped():
    frames = oblique_frames(count=2, shape=(160, 201))
    frames = [replace(f, image=np.full_like(f.image, level)) for f, level in zip(frames, (0, 90), strict=True)]
    result = reconstructed(frames, region=ImageRegion(fan=FAN, fan_detection=DETECTION))
    assert result.skipped == {"nothing bright enough in the image": [0]}
    assert result.frames_inserted == 1
