"""Bone metrics on made volumes whose answers are known: a flat bone surface, oblique to anisotropic voxels."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import ndimage
from sweeps import places, rigid

from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.evaluation.quantities import BoneMetrics
from AIFReconLib.evaluation.surface import bone_surface
from AIFReconLib.evaluation.visibility import REACHED, SHADOWED, BoneTruth, SweepBeams, bone_truth
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.imaging.beams import LINEAR, ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, ImageRegion
from AIFReconLib.sweep.configuration import PlusConfiguration
from AIFReconLib.sweep.frames import TrackedSequence

TISSUE = 40.0
TURN = rigid((25.0, -35.0, 15.0), (100.0, -50.0, 20.0))
"""From the plane's own coordinates (u, v along it, s before it) to Reference."""


def coordinates(grid: VoxelGrid, to_reference=TURN) -> np.ndarray:
    """u, v, s of every voxel, three [k, j, i] arrays, mm."""
    return np.moveaxis(transform_points(np.linalg.inv(to_reference), places(grid)), -1, 0)


def grid_around(size, spacing, rotation_vector_deg=(0.0, 0.0, 0.0)) -> VoxelGrid:
    """A grid of about `size` mm about the middle of the plane, turned against Reference."""
    columns, rows, slices = (int(a / b) for a, b in zip(size, spacing))
    voxels = columns, rows, slices
    matrix = rigid(rotation_vector_deg) @ np.diag([*spacing, 1.0])
    matrix[:3, 3] = TURN[:3, 3] - matrix[:3, :3] @ ((np.array(voxels) - 1) / 2)
    return VoxelGrid(voxels, matrix)


VOLUME_GRID = grid_around((56, 56, 56), (0.5, 0.7, 0.6), (-20, 10, 30))


@pytest.fixture(scope="module")
def uvs():
    return coordinates(VOLUME_GRID)


@pytest.fixture(scope="module")
def truth() -> BoneTruth:
    """A flat surface of 24 x 24 mm, known exactly; everything before it was reached, everything behind is in shadow."""
    matrix = TURN @ rigid(translation=(-12, -12, -12))
    grid = VoxelGrid((25, 25, 25), matrix)
    distance = Volume(coordinates(grid)[2].astype(np.float32), matrix)
    surface = bone_surface(distance)
    shadows = Volume(np.where(distance.array < 0, SHADOWED, REACHED).astype(np.uint8), matrix)
    u = transform_points(np.linalg.inv(TURN), surface.points_reference)[:, 0]
    cosine = np.where(u > 6.0, 0.5, 0.9)
    return BoneTruth(surface, distance, u < -6.0, cosine, shadows)


def volume(gray) -> Volume:
    return Volume(np.asarray(gray, dtype=np.float32), VOLUME_GRID.ijk_to_reference)


def ridge(s, height=120.0, fwhm=3.0, offset=0.0):
    return height * np.exp(-4 * np.log(2) * ((s - offset) / fwhm) ** 2)


def noise(seed=0):
    """Gray levels without any bone: mean 100, standard deviation 25, independent voxels."""
    return 100 + 25 * np.random.default_rng(seed).standard_normal(VOLUME_GRID.shape)


def speckle(seed=0):
    """Log-compressed Rayleigh amplitudes with cells of some voxels, mean about 100."""
    phasors = np.random.default_rng(seed).standard_normal((2, *VOLUME_GRID.shape))
    amplitude = np.hypot(*ndimage.gaussian_filter(phasors, (0, 0.9, 0.9, 0.9)))
    return 100 + 35 * np.log(amplitude / amplitude.mean())


def measures(gray, truth, mask=None) -> BoneMetrics:
    return evaluate(volume(gray), truth, None if mask is None else Volume(mask.astype(np.uint8), VOLUME_GRID.ijk_to_reference))


# Thickness and place


@pytest.mark.parametrize("fwhm", [2.5, 3.0, 4.0])
def test_thickness_is_the_fwhm_of_an_oblique_ridge(fwhm, uvs, truth):
    # Linear interpolation blurs by at most a quarter of the squared voxel size in variance
    assert measures(TISSUE + ridge(uvs[2], fwhm=fwhm), truth).bone.thickness == pytest.approx(fwhm, abs=0.12)


@pytest.mark.parametrize("offset", [-0.8, 0.0, 0.55, 1.0])
def test_the_peak_is_found_where_it_is(offset, uvs, truth):
    found = measures(TISSUE + ridge(uvs[2], offset=offset), truth).bone
    assert found.localization_bias == pytest.approx(offset, abs=0.03)
    assert found.localization_error == pytest.approx(abs(offset), abs=0.06)


# Contrast


def striped(u, s, behind=5.0):
    """Tissue of 30 and 50 in equal parts, a bone of 120 that is 3 mm thick, and shadow."""
    tissue = np.where(u > 0, 30.0, 50.0)
    return np.where(s > 2, tissue, np.where(s > -2, 120.0, behind))


def test_cnr_is_contrast_over_the_spread_of_tissue(uvs, truth):
    found = measures(striped(uvs[0], uvs[2]), truth).bone
    assert found.contrast == pytest.approx(120 - 40, rel=0.02)
    assert found.cnr == pytest.approx(80 / 10, rel=0.04)


def test_a_gain_scales_contrast_and_nothing_else(uvs, truth):
    plain = measures(speckle() + ridge(uvs[2]), truth).bone
    louder = measures(2 * (speckle() + ridge(uvs[2])), truth).bone
    np.testing.assert_allclose(louder.contrast, 2 * plain.contrast, rtol=1e-5)
    for name in ("cnr", "detectability", "thickness", "localization_bias", "localization_error", "coverage"):
        np.testing.assert_allclose(getattr(louder, name), getattr(plain, name), rtol=1e-4, err_msg=name)


def test_bone_darker_than_tissue_has_negative_contrast_and_is_not_covered(uvs, truth):
    found = measures(np.where(uvs[2] > 2, 80 + 10 * np.sign(uvs[0]), 20.0), truth).bone
    assert found.contrast == pytest.approx(-60, rel=0.02)
    assert found.detectability == 0.0
    assert found.coverage == 0.0


def test_other_bone_before_the_surface_is_not_tissue(uvs, truth):
    gray = striped(uvs[0], uvs[2])
    other = np.abs(uvs[2] - 7.0) < 1.5
    closer = np.abs(coordinates(truth.distance.grid)[2] - 7.0) - 0.5
    distance = Volume(np.minimum(truth.distance.array, closer).astype(np.float32), truth.distance.ijk_to_reference)
    found = measures(np.where(other, 200.0, gray), replace(truth, distance=distance)).bone
    assert found.contrast == pytest.approx(120 - 40, rel=0.02)


# Coverage


def test_coverage_is_the_share_that_has_the_ridge(uvs, truth):
    found = measures(speckle() / 2 + ridge(uvs[2], height=200.0) * (uvs[0] > 0.5), truth)
    # 25 rows of points, 1 mm apart, of which 12 have it
    assert found.bone.coverage == pytest.approx(12 / 25, abs=0.02)
    # Beyond 45 degrees at best
    assert found.oblique.area == pytest.approx(truth.surface.areas[truth.best_cosine < 0.7].sum())
    assert found.oblique.coverage > 0.98
    assert found.interspinous.coverage < 0.02


def test_coverage_weighs_by_area(uvs, truth):
    heavier = np.where(transform_points(np.linalg.inv(TURN), truth.surface.points_reference)[:, 0] > 0.5, 3.0, 1.0)
    uneven = replace(truth, surface=replace(truth.surface, areas=heavier))
    found = measures(TISSUE + ridge(uvs[2]) * (uvs[0] > 0.5), uneven).bone
    assert found.coverage == pytest.approx(3 * 12 / (3 * 12 + 13), abs=0.02)


@pytest.mark.parametrize("seed", range(3))
def test_speckle_without_bone_is_hardly_ever_taken_for_bone(seed, truth):
    found = measures(speckle(seed), truth).bone
    assert found.coverage < 0.01
    assert found.detectability == pytest.approx(0.5, abs=0.05)
    assert 0.3 < found.cnr < 1.5


def test_tissue_that_ends_at_a_shadow_is_not_a_response(uvs, truth):
    assert measures(np.where(uvs[2] > 0, speckle(), 3.0), truth).bone.coverage < 0.01


@pytest.mark.parametrize("side", [-1, 1])
def test_the_slope_of_something_brighter_beside_the_surface_is_not_a_response(side, uvs, truth):
    # At 1.5 mm it is still far brighter than the tissue
    assert measures(TISSUE + ridge(uvs[2], height=200.0, fwhm=1.6, offset=2.1 * side), truth).bone.coverage == 0.0
    assert measures(TISSUE + ridge(uvs[2], offset=2.6 * side), truth).bone.coverage == 0.0


# What was measured


def test_places_not_measured_are_not_covered_and_dim_nothing(uvs, truth):
    whole = measures(striped(uvs[0], uvs[2]), truth).bone
    half = measures(np.where(uvs[1] > 0, striped(uvs[0], uvs[2]), 0.0), truth).bone
    assert whole.coverage == 1.0
    assert half.coverage == pytest.approx(0.5, abs=0.03)
    assert half.contrast == pytest.approx(whole.contrast, rel=0.01)


def test_a_mask_says_that_zeros_were_measured(uvs, truth):
    gray = np.where(uvs[2] > 2, 0.0, striped(uvs[0], uvs[2]))
    assert np.isnan(measures(gray, truth).bone.contrast)
    assert measures(gray, truth, mask=np.ones(gray.shape)).bone.contrast == pytest.approx(120.0, rel=0.02)


@pytest.mark.filterwarnings("error")
def test_a_volume_elsewhere_has_no_area(uvs, truth):
    found = evaluate(volume(TISSUE + ridge(uvs[2])).placed_by(rigid(translation=(500, 0, 0))), truth)
    assert found.bone.area == 0.0
    assert np.isnan(found.bone.coverage)


# Which bone counts


def test_bone_that_no_beam_reached_does_not_count(uvs, truth):
    u = transform_points(np.linalg.inv(TURN), truth.surface.points_reference)[:, 0]
    reached = replace(truth, best_cosine=np.where(u > 0, 0.9, np.nan))
    found = measures(TISSUE + ridge(uvs[2]) * (uvs[0] > 0), reached).bone
    assert found.area == pytest.approx(truth.surface.areas[u > 0].sum())
    assert found.coverage > 0.98


def test_without_a_sweep_measured_bone_counts_and_oblique_is_unknown(uvs, truth):
    unknown = replace(truth, best_cosine=None, shadows=None)
    found = measures(np.where(uvs[1] > 0, TISSUE + ridge(uvs[2]), 0.0), unknown)
    assert found.bone.area == pytest.approx(truth.surface.areas.sum() / 2, rel=0.05)
    assert found.bone.coverage > 0.95
    assert np.isnan(found.oblique.coverage)


# Shadow, speckle, invariance


@pytest.mark.parametrize("known_sweep", [True, False])
def test_shadow_noise_is_that_of_what_lies_behind(known_sweep, uvs, truth):
    shadow = 9.0 + (noise(4) - 100.0) * 2.0 / 25.0
    seen = truth if known_sweep else replace(truth, best_cosine=None, shadows=None)
    found = measures(np.where(uvs[2] > -2, 150.0, shadow), seen)
    assert found.shadow_mean == pytest.approx(9.0, abs=0.1)
    assert found.shadow_std == pytest.approx(2.0, abs=0.1)


def test_speckle_snr_is_mean_over_spread_of_tissue(uvs, truth):
    # Slow changes of the tissue, bone and shadow must not count
    gray = np.where(uvs[2] > 1, noise() * (1 + 0.01 * uvs[0]), 255.0)
    assert measures(gray, truth).speckle_snr == pytest.approx(4.0, rel=0.03)


# Labels in the place of a truth


def slab_labels() -> Volume:
    """A slab of bone, well within the volume."""
    labels = np.zeros(VOLUME_GRID.shape, np.uint8)
    labels[24:-24, 24:-24, 24:-24] = 1
    return Volume(labels, VOLUME_GRID.ijk_to_reference)


def test_a_sweep_decides_which_bone_of_the_labels_counts():
    labels = slab_labels()
    pose = VOLUME_GRID.ijk_to_reference.copy()
    pose[:3, 3] = transform_points(VOLUME_GRID.ijk_to_reference, [0, 0, VOLUME_GRID.size[2] / 2])
    size = VOLUME_GRID.size
    sequence = TrackedSequence.from_arrays(np.full((1, size[1], size[0]), 90, np.uint8), pose[None])
    beams = SweepBeams(pose[None], (size[0], size[1]), ProbeGeometry(LINEAR), ImageRegion())
    shown = volume(noise())
    whole = ImageRegion(ClipRectangle((0.0, 0.0), (float(size[0]), float(size[1]))))
    configured = replace(sequence, configuration=PlusConfiguration(probe=ProbeGeometry(LINEAR), region=whole))
    with_sweep = evaluate(shown, labels, sweep=configured)
    assert with_sweep.to_dict() == pytest.approx(evaluate(shown, bone_truth(labels, beams)).to_dict(), nan_ok=True)
    assert with_sweep.bone.area < 0.5 * evaluate(shown, labels).bone.area
