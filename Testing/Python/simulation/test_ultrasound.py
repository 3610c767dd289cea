import numpy as np
import pytest
from study.flat_bone import FlatBone

from AIFReconLib.errors import SettingsError
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.recipe.recipe import SCANNER_SPEED
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.ultrasound import (
    ATTENUATION_DB_PER_MM,
    CLUTTER_DB,
    CLUTTER_FALL,
    DYNAMIC_RANGE_DB,
    TIME_GAIN_DB_PER_MM,
    UltrasoundEffects,
    simulate_frame,
)

DEPTH, TISSUE_DB = 45.0, 20.0


def plane(depth=DEPTH, angle_deg=0.0, axis="in-plane", tissue_db=TISSUE_DB) -> FlatBone:
    return FlatBone(depth, angle_deg, axis, tissue_db)


NO_BONE = plane(depth=500.0)
SILENCE = -40.0
"""dB of tissue that does not scatter."""
SEEDS = 8
PROBE = PhasedArray()


def frame(target, effects=None, seed: int = 1) -> np.ndarray:
    """The face's middle at the origin of Reference, beams along +y, image columns along +x."""
    return simulate_frame(target, PROBE, PROBE.probe_to_reference(np.eye(4)), np.random.default_rng(seed), effects)


def row_of(depth: float) -> int:
    return round((depth - PROBE.image_to_transducer[1, 3]) / PROBE.pixel_spacing)


def levels(target, effects=None) -> np.ndarray:
    """dB above the smallest echo, one per pixel row below the reverberation: the mean power of many speckled images within 4 mm."""
    half, middle = round(4 / PROBE.pixel_spacing), PROBE.columns // 2
    images = np.array([frame(target, effects, seed)[:, middle - half : middle + half] for seed in range(SEEDS)])
    level = 10 * np.log10((10 ** ((images.astype(float) - 1) * DYNAMIC_RANGE_DB / 254 / 10)).mean(axis=(0, 2)))
    level[: row_of(14.0)] = 0.0
    return level


def middle_band(image: np.ndarray, first: float, last: float) -> np.ndarray:
    """Pixels within 8 mm of the middle between two depths, mm."""
    half = round(8 / PROBE.pixel_spacing)
    middle = PROBE.columns // 2
    return image[row_of(first) : row_of(last), middle - half : middle + half].astype(float)


def half_amplitude_thickness(level: np.ndarray) -> float:
    """Of the strongest echo, mm, between the crossings 6 dB below its peak."""
    threshold = level.max() - 20 * np.log10(2)
    above = np.flatnonzero(level >= threshold)
    low, high = above[0], above[-1]
    start = low - (level[low] - threshold) / (level[low] - level[low - 1])
    stop = high + (level[high] - threshold) / (level[high] - level[high + 1])
    return (stop - start) * PROBE.pixel_spacing


@pytest.mark.parametrize("depth", [25.0, 45.0, 70.0])
def test_echo_lies_where_the_surface_is_and_comes_earlier_in_faster_tissue(depth):
    assert np.argmax(levels(plane(depth))) == pytest.approx(row_of(depth), abs=1)
    fast = UltrasoundEffects(speed_of_sound=1.05 * SCANNER_SPEED)
    assert np.argmax(levels(plane(1.05 * depth), fast)) == pytest.approx(row_of(depth), abs=1)
    assert not frame(plane(depth))[~PROBE.fan.mask(PROBE.columns, PROBE.rows)].any()
    face = np.array([PROBE.apex_px[0], PROBE.apex_px[1] + PROBE.apex_offset / PROBE.pixel_spacing, 0.0])
    assert transform_points(PROBE.image_to_probe, face) == pytest.approx(PROBE.transducer_to_probe[:3, 3])


def test_nothing_but_noise_lies_behind_bone():
    behind = middle_band(frame(plane()), 52, 80)
    noise = middle_band(frame(plane(500.0, tissue_db=SILENCE)), 52, 80)
    assert behind.mean() == pytest.approx(noise.mean(), abs=2.0)
    assert behind.mean() < 0.4 * middle_band(frame(NO_BONE), 52, 80).mean()


def test_with_clutter_a_shadow_has_the_level_that_is_said():
    level = levels(plane(depth=40.0), UltrasoundEffects(clutter=True))
    for behind in (3.0, 8.0):
        lost = (ATTENUATION_DB_PER_MM - TIME_GAIN_DB_PER_MM) * (40.0 + behind)
        assert level[row_of(40.0 + behind)] == pytest.approx(CLUTTER_DB - CLUTTER_FALL * behind - lost, abs=1.5)


@pytest.mark.parametrize("angle_deg", [20.0, 40.0, 60.0])
def test_a_surface_hit_squarely_is_brighter_than_one_hit_obliquely(angle_deg):
    assert levels(plane()).max() > levels(plane(angle_deg=angle_deg)).max() + 2


def test_diffuse_echoes_that_a_thick_beam_spreads_add_up_in_power():
    """At these angles nothing else is left of bone's echo."""
    angles = np.deg2rad([57.0, 68.0])
    near, far = (levels(plane(PROBE.elevation_focus, np.rad2deg(a), "elevational", SILENCE)).max() for a in angles)
    amplitude = np.cos(angles) / np.sqrt(np.tan(angles))
    assert near - far == pytest.approx(20 * np.log10(amplitude[0] / amplitude[1]), abs=1.2)


@pytest.mark.parametrize("angle_deg", [25.0, 35.0, 45.0])
def test_an_oblique_plane_is_thicker_by_beam_width_times_tangent(angle_deg):
    thick = half_amplitude_thickness(levels(plane(PROBE.elevation_focus, angle_deg, "elevational", SILENCE)))
    thin = half_amplitude_thickness(levels(plane(PROBE.elevation_focus, tissue_db=SILENCE)))
    beam = PROBE.elevation_fwhm(PROBE.elevation_focus) * np.tan(np.deg2rad(angle_deg))
    assert np.sqrt(max(thick**2 - thin**2, 0)) == pytest.approx(beam, rel=0.15)


def test_point_spread_widens_speckle_across_the_beams_with_depth():
    image = frame(NO_BONE)

    def correlation(depth):
        band = middle_band(image, depth, depth + 12)
        band = band - band.mean()
        shift = round(1.0 / PROBE.pixel_spacing)
        return (band[:, shift:] * band[:, :-shift]).mean() / (band**2).mean()

    assert correlation(70) > correlation(25) + 0.2


def test_an_echo_is_as_thick_as_the_pulse_is_long():
    """0.26 mm near and 0.42 mm deep, as standard deviations."""
    near, deep = (half_amplitude_thickness(levels(plane(depth, tissue_db=SILENCE))) for depth in (20.0, 80.0))
    assert near == pytest.approx(2.355 * 0.29, abs=0.2)
    assert deep == pytest.approx(2.355 * 0.40, abs=0.2)


def test_speckle_is_rayleigh_distributed():
    band = middle_band(frame(plane(500.0, tissue_db=30.0)), 20, 80)
    assert band.std() * DYNAMIC_RANGE_DB / 254 == pytest.approx(5.57, abs=0.8)


KNOBS = {"normal": {}, "gain": {"gain_db": 6.0}, "depth gain": {"depth_gain_db": 6.0}, "gray curve": {"gray_curve": 1.6}}


def test_gain_depth_gain_and_gray_curve_change_the_picture_as_on_a_scanner():
    tissue = plane(500.0, tissue_db=30.0)
    band = {name: middle_band(frame(tissue, UltrasoundEffects(**knob)), 20, 80).mean() for name, knob in KNOBS.items()}
    # 254 levels are 58 dB
    assert band["gain"] - band["normal"] == pytest.approx(6.0 * 254.0 / 58.0, abs=2.0)
    assert 0.0 < band["depth gain"] - band["normal"] < band["gain"] - band["normal"]
    assert band["gray curve"] < band["normal"]
    for knob in ({"gray_curve": 0.0}, {"gain_db": np.nan}):
        with pytest.raises(SettingsError, match="gray curve"):
            UltrasoundEffects(**knob)
