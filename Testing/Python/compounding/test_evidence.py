"""What a frame tells of bone: where sound arrived, and where a shadow begins."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import ndimage
from sweeps import rigid

from AIFReconLib.compounding.evidence import LEAST_REACH, ScanLines
from AIFReconLib.compounding.layout import PixelLayout
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.gray_levels import GrayLevels
from AIFReconLib.imaging.region import ClipRectangle, Fan, ImageRegion

COLUMNS, ROWS, SPACING = 120, 160, (0.25, 0.25)
LINEAR = ProbeGeometry("linear")
SECTOR = ProbeGeometry("sector", (60.0, -20.0))
PROBES = pytest.mark.parametrize("probe", [LINEAR, SECTOR], ids=["linear", "sector"])


AS_RECORDED = GrayLevels.as_recorded()


def evidence(image, probe, region=None, gray_levels=AS_RECORDED):
    """Reach and onset as images, NaN outside the region."""
    region = region or ImageRegion()
    rows, columns = image.shape
    layout = PixelLayout.build((columns, rows), SPACING, region, probe)
    judged = ScanLines(layout, probe).evidence(layout.values(image), gray_levels)
    images = np.full((2, rows, columns), np.nan, np.float32)
    images[:, region.mask(columns, rows)] = judged
    return images


def tissue(level=90.0, seed=0):
    """Speckle without bone."""
    field = ndimage.gaussian_filter(np.random.default_rng(seed).normal(size=(ROWS, COLUMNS)), 1.0)
    return np.clip(level + 25 * field / field.std(), 1, 255).astype(np.uint8)


def shadowed(probe, echo, surface_px=80.0, thickness_px=4.0, sides=(-0.15, 0.15)):
    """Tissue with a bone surface `surface_px` below the probe's origin, between two slopes, and black behind it."""
    image = tissue().astype(float)
    rows, columns = np.indices(image.shape, dtype=float)
    if probe.kind == "linear":
        depth, slope = rows, (columns - 60) / 100
    else:
        depth, slope = np.hypot(columns - 60, rows + 20) - 20, (columns - 60) / (rows + 20)
    within = (slope >= sides[0]) & (slope <= sides[1])
    image[within & (depth >= surface_px)] = 4
    image[within & (depth >= surface_px) & (depth < surface_px + thickness_px)] = echo
    return image.astype(np.uint8), within, depth


@PROBES
@pytest.mark.parametrize("echo", [240, 200, 110], ids=["strong echo", "echo", "echo no brighter than tissue"])
def test_a_shadow_begins_at_bone_however_weak_its_echo_and_sound_does_not_reach_it(probe, echo):
    image, within, depth = shadowed(probe, echo)
    reach, onset = evidence(image, probe)
    inner = ndimage.binary_erosion(within, iterations=4)
    assert np.median(onset[inner & (depth >= 81) & (depth < 82)]) > 0.8
    assert onset[inner & (depth > 95)].max() < 0.05
    assert np.quantile(reach[inner & (depth > 95)], 0.99) < 0.05


def test_an_onset_is_the_crest_of_an_echo_and_not_its_slope():
    image = np.full((ROWS, COLUMNS), 100.0)
    image[80:] = 0.0
    image += 140.0 * np.exp(-(((np.arange(ROWS) - 80.0) / 4.0) ** 2))[:, None]
    _, onset = evidence(image.astype(np.uint8), LINEAR)
    rows = np.flatnonzero(onset[:, 60] > 0)
    assert abs(np.average(rows, weights=onset[rows, 60]) - 80.0) < 3.0
    assert np.ptp(rows) <= 4


@PROBES
def test_no_shadow_begins_in_tissue_with_a_bright_layer_nor_at_the_very_end_of_a_line(probe):
    fan = ImageRegion(fan=Fan((60.0, -20.0), (-25.0, 25.0), (25.0, 170.0)))
    reach, onset = evidence(tissue(), probe, fan)
    inside = fan.mask(COLUMNS, ROWS)
    assert onset[inside].mean() < 0.01
    assert np.isfinite(reach[inside]).all()
    assert np.isnan(reach[~inside]).all()
    image = tissue()
    image[60:64], image[150:] = 230, 4
    _, onset = evidence(image, LINEAR)
    assert onset[55:70].max() == onset[130:].max() == 0.0
    reach, onset = evidence(tissue()[:6], LINEAR)
    assert np.isfinite(reach).all()
    assert (onset == 0).all()


@PROBES
def test_a_shadow_full_of_reverberation_is_a_shadow(probe):
    image, within, depth = shadowed(probe, echo=235)
    image[within & (depth > 86)] = 0.6 * tissue(seed=1)[within & (depth > 86)]
    _, onset = evidence(image, probe)
    inner = ndimage.binary_erosion(within, iterations=4)
    assert np.median(onset[inner & (depth >= 81) & (depth < 82)]) > 0.5
    assert onset[inner & (depth > 95)].max() == 0.0


def test_of_two_echoes_of_a_scan_line_the_ct_decides_which_is_bone():
    """Fascia at row 60 and bone at row 90 over one shadow; the CT stands for a layer of rows."""
    image = np.full((ROWS, COLUMNS), 60, np.uint8)
    image[60:64], image[90:94], image[94:] = 160, 120, 4
    layout = PixelLayout.build((COLUMNS, ROWS), SPACING, ImageRegion(), LINEAR)
    lines = ScanLines(layout, LINEAR)
    for middle in (62, 92):
        probability = np.exp(-0.5 * ((np.arange(ROWS) - middle) / 6.0) ** 2).astype(np.float32)
        expected = lines.expected(np.tile(probability[:, None], (1, 1, COLUMNS)), np.eye(4))
        onset = lines.evidence(layout.values(image), AS_RECORDED, expected)[1].reshape(image.shape)
        found = np.flatnonzero(onset[:, 60])
        assert found.size
        assert np.abs(found - middle).max() <= 4


def test_what_the_ct_expects_is_read_where_the_frame_lies():
    layout = PixelLayout.build((COLUMNS, ROWS), SPACING, ImageRegion(), LINEAR)
    lines = ScanLines(layout, LINEAR)
    plane = np.arange(COLUMNS * ROWS, dtype=np.float32).reshape(1, ROWS, COLUMNS)
    expected = lines.expected(plane, rigid(translation=(-10.0, 0.0, 0.0)))
    column, row = np.meshgrid(np.arange(0, COLUMNS, 2), np.arange(0, ROWS, 2))
    np.testing.assert_array_equal(expected, np.where(column >= 10, row * COLUMNS + column - 10, 0))


@pytest.mark.parametrize("left_mm", [8.5, 10.0, 12.0])
@PROBES
def test_a_fascia_shortly_before_the_end_of_a_line_is_no_bone_and_bone_there_is(probe, left_mm):
    """A line ends so far behind the layer; behind it is tissue, or a shadow as bright as those behind real bone."""
    end = 130.0
    image, within, depth = shadowed(probe, echo=230, surface_px=end - left_mm / SPACING[0])
    fan = Fan((60.0, -20.0), (-30.0, 30.0), (20.0, 20.0 + end))
    region = ImageRegion(fan=fan) if probe.kind == "sector" else ImageRegion(ClipRectangle((0, 0), (COLUMNS, round(end))))
    layer = within & (depth >= end - left_mm / SPACING[0]) & (depth < end - left_mm / SPACING[0] + 4)
    inner = ndimage.binary_erosion(within, iterations=4) & region.mask(*image.shape[::-1])
    for behind, is_bone in ((tissue(95.0, 2), False), (0.5 * tissue(seed=1), True)):
        shown = np.where(within & ~layer & (depth > end - left_mm / SPACING[0]), behind, image).astype(np.uint8)
        _, onset = evidence(shown, probe, region)
        assert (np.median(onset[layer & inner & (depth < end - left_mm / SPACING[0] + 2)]) > 0.5) == is_bone
        assert is_bone or onset[inner & (depth > end - 60)].max() == 0.0


def test_pixels_outside_the_region_say_nothing():
    region = ImageRegion(ClipRectangle((10, 10), (99, 99)))
    image = tissue(30.0)
    plain = evidence(image, LINEAR, region)
    image[115:] = 255  # text below the ultrasound
    np.testing.assert_array_equal(evidence(image, LINEAR, region), plain)


@PROBES
def test_black_images_are_reached_nowhere_and_show_no_bone(probe):
    reach, onset = evidence(np.zeros((ROWS, COLUMNS), np.uint8), probe)
    assert (reach == np.float32(LEAST_REACH)).all()
    assert (onset == 0).all()


@PROBES
def test_the_gray_scale_of_the_images_does_not_matter(probe):
    image, _, _ = shadowed(probe, echo=200)
    ours = evidence(image, probe)
    theirs = evidence(image.astype(np.uint16) * 257, probe, gray_levels=GrayLevels.as_recorded(65535.0))
    np.testing.assert_array_equal(ours, theirs)
