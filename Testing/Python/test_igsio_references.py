"""Real recordings against what IGSIO's own reconstructor wrote for them.

The reference volumes were made with Optimization FULL: a fixed-point voxel index and a slightly smaller fan. The emulation shows that
these two explain them completely; our volumes follow IGSIO's double-precision rule instead.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import igsio
import numpy as np
import pytest
import SimpleITK as sitk

from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.extent import grid_around_sweep
from AIFReconLib.frames import TrackedFrame
from AIFReconLib.hole_kinds import HoleFilling, fill_holes_by_kind
from AIFReconLib.io.sequence_files import read_sequence
from AIFReconLib.poses import sweep_poses
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.region import ImageRegion
from AIFReconLib.settings import ReconstructionSettings

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


def ours(case, method, **arguments):
    settings = ReconstructionSettings(method=method, output_type="float32", holes="off")
    return reconstruct(case.sequence, settings, grid=case.grid, **arguments)


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


def test_igsios_fan_differs_from_the_documented_one_in_207_pixels(trus):
    fan = igsio.optimized_fan(trus.region, *trus.sequence.frame_size)
    assert int((fan ^ trus.mask).sum()) == 207


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


def test_the_exact_mean_is_brighter_than_igsios_by_what_truncation_loses(spine):
    truncated, hits = igsio.paste(spine.images, spine.poses, spine.grid, spine.mask, igsio.double_index, "mean")
    lost = (ours(spine, "average").intensity.array - truncated)[hits > 0]
    assert lost.min() >= 0
    assert 1.5 < lost.mean() < 3.0
    assert lost.max() < 18


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
    result = reconstruct(spine.sequence, ReconstructionSettings(output_type="float32"), grid=spine.grid)
    values, mask = ours(spine, "average").intensity.array, ours(spine, "average").mask.array
    fill_holes_by_kind(values, mask, (HoleFilling("stick", 9),))
    np.testing.assert_array_equal(result.intensity.array, values)
    np.testing.assert_array_equal(result.mask.array, mask)


@pytest.fixture(scope="module")
def linear(real_data):
    return load(real_data, "SpinePhantom_LN_MAXI.xml", "Reference_LNMAXI.mha")


def spread(case, poses):
    """What linear interpolation and maximum make of the images at these poses."""
    reconstructor = Reconstructor(case.grid, ReconstructionSettings(method="maximum", interpolation="linear"), region=case.region)
    reconstructor.insert(TrackedFrame(image, pose) for image, pose in zip(case.images, poses, strict=True))
    return reconstructor.finish().intensity.array


def test_linear_maximum_reproduces_igsios_volume_from_its_fixed_point_matrices(linear):
    matrices = [np.rint(linear.grid.reference_to_ijk @ pose * 2**14) / 2**14 for pose in linear.poses]
    values = spread(linear, [linear.grid.ijk_to_reference @ matrix for matrix in matrices])
    close = np.abs(values.astype(int) - linear.reference) <= 2
    assert close.mean() > 0.9999


def test_linear_maximum_in_double_precision_differs_from_igsios_volume_by_what_its_fixed_point_moves(linear):
    close = np.abs(spread(linear, linear.poses).astype(int) - linear.reference) <= 2
    assert 0.995 < close.mean() < 0.999


def test_interpolation_and_method_of_the_configuration_are_used(linear):
    result = reconstruct(linear.sequence, grid=linear.grid)
    np.testing.assert_array_equal(result.intensity.array, spread(linear, linear.poses))


def test_the_clip_of_the_configuration_is_honored(trus):
    clipped = ours(trus, "average", region=ImageRegion(trus.region.clip))
    assert clipped.hits.array.sum() == 421 * 581 * len(trus.images)


def test_a_linear_probe_with_its_scan_conversion_reconstructs(real_data):
    sequence = read_sequence(real_data("BoneUltrasound_L14.igs.mha"), config=real_data("BoneUltrasound_L14_config.xml"))
    assert sequence.configuration.probe.kind == "linear"
    result = reconstruct(sequence, ReconstructionSettings(method="average"))
    assert result.frames_inserted == 21
    np.testing.assert_allclose(result.grid.spacing, 0.5)
    assert result.intensity.array.max() > 150


def test_the_bone_surface_lies_where_the_frames_show_it(real_data):
    """The brightest pixels of the real bone, frame by frame, are bright in the volume at their place in Reference."""
    sequence = read_sequence(real_data("BoneUltrasound_L14.igs.mha"), config=real_data("BoneUltrasound_L14_config.xml"))
    result = reconstruct(sequence, ReconstructionSettings(method="maximum", spacing=0.3))
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
    result = reconstruct(replace(sequence, records=spoiled), ReconstructionSettings(method="latest", spacing=1.0))
    assert result.skipped == {"ProbeToTracker INVALID": [3, 4]}
    assert result.frames_inserted == 95
