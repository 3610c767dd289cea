"""Real recordings against what IGSIO's own reconstructor wrote for them.

The reference volumes were made with Optimization FULL: a fixed-point voxel index and a slightly smaller fan. The emulation shows that
these two explain them completely. Our volumes follow IGSIO's fixed-point index where the configuration asks for it, else its
double-precision rule.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import igsio
import numpy as np
import pytest
import SimpleITK as sitk

from AIFReconLib.effective_settings import imaging_fields
from AIFReconLib.holes.filling import HoleFilling
from AIFReconLib.holes.igsio_hole_filling import fill_holes_by_kind
from AIFReconLib.imaging.extent import grid_around_sweep
from AIFReconLib.imaging.region import ImageRegion
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.poses import sweep_poses

SPINE = "SpinePhantomFreehand.igs.mha"


@dataclass(frozen=True)
class Case:
    """A recording, its configuration, and the volume IGSIO made of them ([k, j, i], in Reference without a flip)."""

    sequence: object
    images: np.ndarray
    poses: np.ndarray
    grid: object
    mask: np.ndarray
    region: ImageRegion
    reference: np.ndarray
    reference_origin: tuple


def load(real_data, configuration, volume):
    sequence = read_sequence(real_data(SPINE), config=real_data(configuration))
    region = sequence.configuration.region
    poses = sweep_poses(sequence).image_to_reference
    # IGSIO spans the box around the clip rectangle, whatever the fan leaves of it
    grid = grid_around_sweep(poses, sequence.frame_size, ImageRegion(region.clip), sequence.configuration.spacing)
    written = sitk.ReadImage(str(real_data(volume)))
    mask = region.mask(*sequence.frame_size)
    return Case(sequence, np.asarray(sequence.images), poses, grid, mask, region, sitk.GetArrayFromImage(written), written.GetOrigin())


@pytest.fixture(scope="module")
def trus(real_data):
    return load(real_data, "SonixRP_TRUS_D70mm_NN_LATE.xml", "Reference_NNLATE.mha")


@pytest.fixture(scope="module")
def spine(real_data):
    return load(real_data, "SpinePhantom_NN_MEAN.xml", "Reference_NNMEAN.mha")


def ours(case, method, **asked):
    """A volume of the case, in double precision."""
    settings = ReconstructionSettings(method=method, output_type="float32", holes="off", **asked)
    sequence = replace(case.sequence, configuration=replace(case.sequence.configuration, fixed_point=False))
    return reconstruct(sequence, settings, grid=case.grid)


@pytest.mark.parametrize("name", ["trus", "spine"])
def test_the_box_around_the_sweep_is_igsios(name, request):
    case = request.getfixturevalue(name)
    assert case.grid.shape == case.reference.shape
    np.testing.assert_allclose(case.grid.origin, case.reference_origin, atol=5e-4)


def test_the_emulation_of_igsio_reproduces_its_latest_volume_in_every_voxel(trus):
    fan = igsio.optimized_fan(trus.region, *trus.sequence.frame_size)
    emulated, _ = igsio.paste(trus.images, trus.poses, trus.grid, fan, igsio.fixed_point_index, "latest")
    np.testing.assert_array_equal(emulated, trus.reference)


def test_latest_is_igsios_with_its_double_precision_index(trus):
    expected, hits = igsio.paste(trus.images, trus.poses, trus.grid, trus.mask, igsio.double_index, "latest")
    result = ours(trus, "latest")
    np.testing.assert_array_equal(result.intensity.array, expected)
    np.testing.assert_array_equal(result.hits.array, hits)


def test_maximum_is_igsios_with_its_double_precision_index(spine):
    expected, _ = igsio.paste(spine.images, spine.poses, spine.grid, spine.mask, igsio.double_index, "maximum")
    np.testing.assert_array_equal(ours(spine, "maximum").intensity.array, expected)


def test_latest_differs_from_igsios_volume_only_where_its_index_or_fan_moved_a_pixel(trus):
    fan = igsio.optimized_fan(trus.region, *trus.sequence.frame_size)
    last_pixel_theirs = last_pixel(trus, fan, igsio.fixed_point_index)
    last_pixel_ours = last_pixel(trus, trus.mask, igsio.double_index)
    moved = last_pixel_theirs != last_pixel_ours
    differs = ours(trus, "latest").intensity.array != trus.reference
    assert not (differs & ~moved).any()
    assert differs.mean() < 0.012


def last_pixel(case, mask, index):
    """Which pixel (frame and place in it) wrote each voxel last; -1 for none."""
    size = mask.size
    numbers = [np.arange(size).reshape(mask.shape) + 1 + frame * size for frame in range(len(case.images))]
    last, _ = igsio.paste(numbers, case.poses, case.grid, mask, index, "latest")
    return last - 1


def test_the_emulation_of_igsio_reproduces_its_mean_where_it_measured(spine):
    emulated, hits = igsio.paste(spine.images, spine.poses, spine.grid, spine.mask, igsio.fixed_point_index, "mean")
    np.testing.assert_array_equal(emulated[hits > 0], spine.reference[hits > 0])


def test_sticks_over_the_emulated_mean_reproduce_igsios_filled_volume(spine):
    emulated, hits = igsio.paste(spine.images, spine.poses, spine.grid, spine.mask, igsio.fixed_point_index, "mean")
    values, mask = emulated.astype(np.float32), (hits > 0).astype(np.uint8)
    fill_holes_by_kind(values, mask, (HoleFilling("stick", 9),))
    difference = np.abs(np.floor(values) - spine.reference)
    assert difference.max() <= 2
    # The rest is what IGSIO loses by cutting every stick's value to a whole number before it averages them
    assert (difference == 0).mean() > 0.99


def test_the_hole_filling_of_the_configuration_is_done(spine):
    assert spine.sequence.configuration.holes == (HoleFilling("stick", 9),)
    result, unfilled = (
        reconstruct(spine.sequence, ReconstructionSettings(output_type="float32", holes=holes), grid=spine.grid) for holes in (None, "off")
    )
    values, mask = unfilled.intensity.array, unfilled.mask.array
    fill_holes_by_kind(values, mask, (HoleFilling("stick", 9),))
    np.testing.assert_array_equal(result.intensity.array, values)
    np.testing.assert_array_equal(result.mask.array, mask)


def test_latest_as_configured_is_igsios_with_its_fixed_point_index(trus):
    expected, hits = igsio.paste(trus.images, trus.poses, trus.grid, trus.mask, igsio.fixed_point_index, "latest")
    result = reconstruct(trus.sequence, ReconstructionSettings(holes="off"), grid=trus.grid)
    np.testing.assert_array_equal(result.intensity.array, expected)
    np.testing.assert_array_equal(result.hits.array, hits)


def test_latest_as_configured_is_igsios_volume_but_for_the_fan(trus):
    close = (
        np.abs(
            reconstruct(trus.sequence, ReconstructionSettings(hole_limit=0.0), grid=trus.grid).intensity.array.astype(int) - trus.reference
        )
        <= 2
    )
    assert close.mean() > 0.999


@pytest.fixture(scope="module")
def linear(real_data):
    return load(real_data, "SpinePhantom_LN_MAXI.xml", "Reference_LNMAXI.mha")


def within_tolerance(values, reference):
    """The share of voxels within the 2 gray levels that IGSIO's own regression tests allow."""
    return (np.abs(values.astype(float) - reference) <= 2).mean()


def test_linear_maximum_as_configured_reproduces_igsios_volume(linear):
    assert linear.sequence.configuration.fixed_point
    assert (
        within_tolerance(
            reconstruct(linear.sequence, ReconstructionSettings(hole_limit=0.0), grid=linear.grid).intensity.array, linear.reference
        )
        > 0.9999
    )


def test_the_emulation_of_igsio_reproduces_its_linear_maximum_in_every_voxel(linear):
    emulated, _ = igsio.paste_linear(linear.images, linear.poses, linear.grid, linear.mask, "maximum", igsio.Arithmetic(2**14))
    np.testing.assert_array_equal(emulated, linear.reference)


@pytest.fixture(scope="module")
def linear_mean(trus):
    """The sector images with LINEAR and MEAN."""
    configuration = replace(trus.sequence.configuration, interpolation="linear", method="average")
    return replace(trus, sequence=replace(trus.sequence, configuration=configuration))


@pytest.mark.parametrize("method", ["latest", "maximum"])
def test_linear_latest_and_maximum_are_igsios_in_double_precision(linear_mean, method):
    case = linear_mean
    expected, _ = igsio.paste_linear(case.images, case.poses, case.grid, case.mask, method, igsio.Arithmetic())
    np.testing.assert_array_equal(ours(case, method).intensity.array, expected)


def test_the_linear_average_is_igsios_before_it_rounds(linear_mean):
    case = linear_mean
    unrounded = igsio.Arithmetic(stores_whole_numbers=False)
    expected, weight = igsio.paste_linear(case.images, case.poses, case.grid, case.mask, "mean", unrounded)
    result = ours(case, "average")
    assert within_tolerance(result.intensity.array, expected) > 0.9999
    np.testing.assert_allclose(result.score.array, weight / 256, atol=1e-4)


def test_igsios_linear_mean_stops_following_because_it_rounds_after_every_pixel(linear_mean):
    case = linear_mean
    emulated, weight = igsio.paste_linear(case.images, case.poses, case.grid, case.mask, "mean", igsio.Arithmetic())
    off = np.abs(ours(case, "average").intensity.array - emulated)[weight > 0]
    assert 0.4 < (off <= 2).mean() < 0.7
    assert 2.0 < off.mean() < 3.0


def test_the_emulation_of_igsio_reproduces_its_linear_mean_where_it_measured(real_data, trus):
    written = real_data("VolumeReconstructorTestLNMEANvolumeRef.mha")
    reference = sitk.GetArrayFromImage(sitk.ReadImage(str(written)))
    fan = igsio.optimized_fan(trus.region, *trus.sequence.frame_size)
    emulated, weight = igsio.paste_linear(trus.images, trus.poses, trus.grid, fan, "mean", igsio.Arithmetic(2**14))
    np.testing.assert_array_equal(emulated[weight > 0], reference[weight > 0])


@pytest.fixture(scope="module")
def importance(trus):
    """Weights that fall off from the middle of the image, 0 at its sides."""
    columns, rows = trus.sequence.frame_size
    across = 1 - np.abs(np.arange(columns) - 380) / 200
    return np.broadcast_to(np.round(255 * np.clip(across, 0, 1)), (rows, columns)).astype(np.uint8)


@pytest.mark.parametrize("interpolation", ["nearest", "linear"])
def test_an_importance_mask_weights_as_igsio_does_before_it_rounds(linear_mean, importance, interpolation):
    case = linear_mean
    unrounded, place = igsio.Arithmetic(stores_whole_numbers=False), (case.images, case.poses, case.grid, case.mask)
    if interpolation == "linear":
        expected, weight = igsio.paste_linear(*place, "importance", unrounded, importance)
    else:
        expected, weight = igsio.paste_weighted(*place, unrounded, importance)
    settings = ReconstructionSettings(method="average", interpolation=interpolation, output_type="float32", holes="off")
    sequence = replace(case.sequence, configuration=replace(case.sequence.configuration, fixed_point=False))
    result = reconstruct(sequence, replace(settings, importance_mask=importance / 255), grid=case.grid)
    assert within_tolerance(result.intensity.array, expected) > 0.9999
    np.testing.assert_allclose(result.score.array, weight / 255, rtol=1e-4, atol=1e-4)


def test_the_clip_of_the_configuration_is_honored(trus):
    clipped = ours(trus, "average", **imaging_fields(ImageRegion(trus.region.clip)))
    assert clipped.hits.array.sum() == 421 * 581 * len(trus.images)


def test_a_linear_probe_with_its_scan_conversion_reconstructs(real_data):
    sequence = read_sequence(real_data("BoneUltrasound_L14.igs.mha"), config=real_data("BoneUltrasound_L14_config.xml"))
    assert sequence.configuration.probe.kind == "linear"
    result = reconstruct(sequence, ReconstructionSettings(hole_limit=0.0, method="average"))
    assert result.frames_inserted == 21
    np.testing.assert_allclose(result.grid.spacing, 0.5)
    assert result.intensity.array.max() > 150


def test_the_bone_surface_lies_where_the_frames_show_it(real_data):
    """The brightest pixels of the real bone, frame by frame, are bright in the volume at their place in Reference."""
    sequence = read_sequence(real_data("BoneUltrasound_L14.igs.mha"), config=real_data("BoneUltrasound_L14_config.xml"))
    result = reconstruct(sequence, ReconstructionSettings(hole_limit=0.0, method="maximum", spacing=0.3))
    poses = sweep_poses(sequence).image_to_reference
    for number in (0, 10, 20):
        image = sequence.images[number]
        row, column = np.unravel_index(np.argmax(image), image.shape)
        i, j, k, _ = np.floor(result.grid.reference_to_ijk @ poses[number] @ (column, row, 0, 1) + 0.5).astype(int)
        assert result.intensity.array[k, j, i] >= image[row, column]


def test_frames_with_invalid_poses_are_skipped_and_named(real_data):
    sequence = read_sequence(real_data("NwirePhantomFreehand.igs.nrrd"), config=real_data("SpinePhantom_NN_MEAN.xml"))
    spoiled = [
        replace(record, transforms={name: replace(sample, status=other) for name, sample in record.transforms.items()})
        if number in (3, 4)
        else record
        for number, record in enumerate(sequence.records)
        for other in [next(s.status for n, s in record.transforms.items() if str(n) == "StylusToTracker")]
    ]
    result = reconstruct(replace(sequence, records=spoiled), ReconstructionSettings(hole_limit=0.0, method="latest", spacing=1.0))
    assert result.skipped == {"ProbeToTracker INVALID": [3, 4]}
    assert result.frames_inserted == 95
