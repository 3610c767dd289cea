"""Linear interpolation and importance masks against a plain loop over pixels and corners, and in closed form."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from sweeps import compounded, oblique_frames, rigid, sphere_bone, turned_grid

from AIFReconLib.compounding import splat_engine
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.errors import SettingsError
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, ImageRegion
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import TrackedFrame

METHODS = ("average", "latest", "maximum")
REGION = ImageRegion(ClipRectangle((3, 2), (27, 20)))


def loop(frames, grid, method, mask, interpolation="linear", importance=None):
    """IGSIO's rules written out; returns values and how many pixels acted on each voxel, [k, j, i]."""
    ni, nj, nk = grid.size
    total, weights, value = np.zeros((3, nk, nj, ni))
    hits = np.zeros((nk, nj, ni), int)
    for frame in frames:
        matrix = grid.reference_to_ijk @ frame.image_to_reference
        for row, column in np.argwhere(mask):
            place = matrix @ (column, row, 0, 1)
            pixel = float(frame.image[row, column])
            count = 1.0 if importance is None else float(importance[row, column])
            if count == 0:
                continue
            corners = {tuple(math.floor(p + 0.5) for p in place[:3]): 1.0}
            if interpolation == "linear":
                low = [math.floor(p) for p in place[:3]]
                corners = {}
                for step in itertools.product((0, 1), repeat=3):
                    share = math.prod((p - a) if s else 1 - (p - a) for p, a, s in zip(place, low, step, strict=False))
                    if share > 0:
                        corners[tuple(a + s for a, s in zip(low, step, strict=True))] = share
            if not all(0 <= i < ni and 0 <= j < nj and 0 <= k < nk for i, j, k in corners):
                continue
            for (i, j, k), share in corners.items():
                at = (k, j, i)
                if method != "average" and share < 0.125:
                    continue
                value[at] = pixel if method == "latest" or hits[at] == 0 else max(value[at], pixel)
                hits[at] += 1
                total[at] += share * count * pixel
                weights[at] += share * count
    if method == "average":
        value = np.divide(total, weights, out=np.zeros_like(total), where=hits > 0)
    return value, hits


def reconstructed(frames, grid, method, engine="auto", region=REGION, importance=None, interpolation="linear"):
    return compounded(frames, grid, None, None, region, importance, method=method, engine=engine, interpolation=interpolation)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_linear_interpolation_equals_the_loop_over_corners(method, dtype, engine):
    frames, grid = oblique_frames(seed=2, count=3, dtype=dtype), turned_grid()
    mask = REGION.mask(34, 26)
    if dtype == np.float32:
        mask[5:9, 10:20] = False
        for frame in frames:
            frame.image[5:9, 10:20] = np.nan
    expected, hits = loop(frames, grid, method, mask)
    result = reconstructed(frames, grid, method, engine)
    np.testing.assert_array_equal(result.hits.array, hits)
    np.testing.assert_allclose(result.intensity.array, expected, rtol=1e-5, atol=1e-5)
    assert result.frames_inserted == 3


@pytest.mark.parametrize("interpolation", ["linear", "nearest"])
def test_an_importance_mask_weights_the_average_as_the_loop_does(interpolation, engine):
    frames, grid = oblique_frames(seed=5, count=3), turned_grid()
    importance = np.random.default_rng(1).choice([0.0, 0.2, 0.6, 1.0], (26, 34))
    expected, hits = loop(frames, grid, "average", REGION.mask(34, 26), interpolation, importance)
    result = reconstructed(frames, grid, "average", engine, importance=importance, interpolation=interpolation)
    np.testing.assert_array_equal(result.hits.array, hits)
    np.testing.assert_allclose(result.intensity.array, expected, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("method", METHODS)
def test_the_size_of_the_parts_makes_no_difference(method, monkeypatch, engine):
    frames, grid = oblique_frames(seed=3, count=2), turned_grid()
    whole = reconstructed(frames, grid, method, engine).intensity.array
    monkeypatch.setattr(splat_engine, "PIXELS_AT_ONCE", 37)
    np.testing.assert_array_equal(reconstructed(frames, grid, method, engine).intensity.array, whole)


def one_pixel(place, method, engine):
    frame = TrackedFrame(np.full((1, 1), 80.0, np.float32), rigid(translation=place))
    return reconstructed([frame], VoxelGrid.from_spacing((0, 0, 0), (4, 4, 4), 1.0), method, engine, region=None)


@pytest.mark.parametrize(("place", "corners"), [((1.5, 1.5, 1.5), 8), ((1.5, 1.5, 1.49), 4), ((1.2, 1.2, 1.2), 4), ((1.1, 1.1, 1.1), 1)])
def test_latest_and_maximum_act_where_a_pixel_has_an_eighth_of_its_weight(place, corners, engine):
    for method in ("latest", "maximum"):
        assert one_pixel(place, method, engine).hits.array.sum() == corners


@pytest.mark.parametrize(("place", "enters"), [((3, 3, 3), True), ((3.01, 3, 3), False), ((0, -0.01, 0), False), ((0, -1e-9, 0), True)])
def test_a_pixel_with_a_corner_outside_does_not_enter(place, enters, engine):
    result = one_pixel(place, "average", engine)
    assert (result.frames_inserted, result.hits.array.sum()) == (int(enters), int(enters))


def test_bone_methods_refuse_linear_interpolation_and_an_importance_mask_must_fit():
    for method in ("aif", "aif-compensated", "weighted"):
        settings = ReconstructionSettings(method=method, interpolation="linear")
        with pytest.raises(SettingsError, match=f"interpolation must be nearest for method {method}; got 'linear'"):
            Reconstructor(turned_grid(), settings, sphere_bone(), probe=ProbeGeometry("linear"))
    with pytest.raises(SettingsError, match="importance mask must be as large as the images, 34 x 26; got 3 x 2"):
        reconstructed(oblique_frames(count=1), turned_grid(), "average", importance=np.ones((2, 3)))
