"""Transmission along scan lines: full before bone, falling behind it."""

from __future__ import annotations

import numpy as np
import pytest

from AIFReconLib.beams import ProbeGeometry
from AIFReconLib.compounding.layout import PixelLayout
from AIFReconLib.compounding.shadow import ScanLines
from AIFReconLib.region import Fan, ImageRegion

SIZE = (40, 60)
SPACING = (0.5, 0.5)


def image_of(values, layout, mask):
    image = np.full(mask.shape, np.nan, np.float32)
    image[mask] = values
    return image


def transmission(probe, bone, region=None, depth=1.5, length=1.0):
    """Transmission as an image; `bone` is a (rows, columns) mask, one voxel per pixel."""
    region = region or ImageRegion()
    layout = PixelLayout.build(SIZE, SPACING, region, probe)
    values = ScanLines(layout, probe).transmission(np.eye(4), bone[None].astype(np.uint8), depth, length)
    return image_of(values, layout, region.mask(*SIZE))


def slab(first_row, rows):
    bone = np.zeros(SIZE[::-1], bool)
    bone[first_row : first_row + rows] = True
    return bone


@pytest.mark.parametrize("probe", [ProbeGeometry("linear"), ProbeGeometry("sector", (20.0, -10.0))], ids=["linear", "sector"])
def test_without_bone_all_sound_gets_through(probe):
    assert (transmission(probe, slab(0, 0)) == 1.0).all()


def test_before_bone_all_sound_gets_through():
    assert (transmission(ProbeGeometry("linear"), slab(30, 10))[:30] == 1.0).all()


def test_behind_a_slab_the_sound_follows_the_formula():
    image = transmission(ProbeGeometry("linear"), slab(30, 10), depth=1.5, length=1.0)
    assert image[45] == pytest.approx(np.exp(-(10 * 0.5 - 1.5)))


def test_the_surface_itself_is_not_dimmed():
    image = transmission(ProbeGeometry("linear"), slab(30, 10), depth=1.5)
    assert (image[30:33] == 1.0).all()
    assert (image[34] < 1.0).all()


def test_a_linear_shadow_falls_straight_down():
    bone = np.zeros(SIZE[::-1], bool)
    bone[20:40, 10:15] = True
    shadowed = transmission(ProbeGeometry("linear"), bone)[50] < 0.01
    assert np.flatnonzero(shadowed).tolist() == [10, 11, 12, 13, 14]


def test_a_sector_shadow_falls_along_its_beams():
    bone = np.zeros(SIZE[::-1], bool)
    bone[20:31, 12:16] = True
    apex = (20.0, -10.0)
    image = transmission(ProbeGeometry("sector", apex), bone)
    rows, columns = np.indices(image.shape)
    slope = (columns - apex[0]) / (rows - apex[1])
    center = (13.5 - apex[0]) / (25.5 - apex[1])
    behind = (rows > 45) & (np.abs(slope - center) < 0.02)
    beside = (rows > 45) & (np.abs(slope - center) > 0.2)
    assert image[behind].max() < 0.05
    assert image[beside].min() == 1.0


def test_bone_crossed_by_a_sector_beam_is_measured_along_the_beam():
    apex, bone = (20.0, -10.0), slab(30, 10)
    image = transmission(ProbeGeometry("sector", apex), bone, depth=0.0, length=5.0)
    angle = np.arctan2(0 - apex[0], 55 - apex[1])
    assert -5.0 * np.log(image[55, 0]) == pytest.approx(10 * 0.5 / np.cos(angle), abs=0.5)


def test_bone_outside_the_grid_casts_no_shadow():
    probe, region = ProbeGeometry("linear"), ImageRegion()
    layout = PixelLayout.build(SIZE, SPACING, region, probe)
    beside = np.eye(4)
    beside[0, 3] = 1000.0
    values = ScanLines(layout, probe).transmission(beside, slab(0, 60)[None].astype(np.uint8), 1.5, 1.0)
    assert (values == 1.0).all()


def test_every_pixel_of_a_fan_has_a_sample():
    fan = Fan((20.0, -10.0), (-30.0, 30.0), (12.0, 60.0))
    image = transmission(ProbeGeometry("sector", (20.0, -10.0)), slab(30, 30), ImageRegion(fan=fan))
    inside = fan.mask(*SIZE)
    assert np.isfinite(image[inside]).all()
    assert image[inside].min() < 0.01
    assert image[inside].max() == 1.0
