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

from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.holes.filling import HoleFilling
from AIFReconLib.holes.igsio_hole_filling import fill_holes_by_kind
from AIFReconLib.imaging.extent import grid_around_sweep
from AIFReconLib.imaging.region import ImageRegion
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

SPINE = "SpinePhantomFreehand.igs.mha"


@dataclass(frozen=True)
class Case:
    """A recording, its configuration, and the volume IGSIO made of them ([k, j, i], in Reference without a flip)."""

    sequence: TrackedSequence
    images: np.ndarray
    poses: np.ndarray
    grid: VoxelGrid
    mask: np.ndarray
    region: ImageRegion
    reference: np.ndarray
    reference_origin: tuple

    @property
    def place(self):
        """What the emulation takes first."""
        return self.images, self.poses, self.grid

    def pasted(self, index, method):
        """Gray levels and pixel counts by the emulation."""
        return igsio.paste(*self.place, self.mask, index, method)

    def pasted_linearly(self, method, arithmetic):
        return igsio.paste_linear(*self.place, self.mask, method, arithmetic)


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
    case = load(real_data, "SonixRP_TRUS_D70mm_NN_LATE.xml", "Reference_NNLATE.mha")
    emulated, _ = igsio.paste(*case.place, igsio.optimized_fan(case.region, *case.sequence.frame_size), igsio.fixed_point_index, "latest")
    np.testing.assert_array_equal(emulated, case.reference)
    return case


@pytest.fixture(scope="module")
def spine(real_data):
    case = load(real_data, "SpinePhantom_NN_MEAN.xml", "Reference_NNMEAN.mha")
    emulated, hits = case.pasted(igsio.fixed_point_index, "mean")
    np.testing.assert_array_equal(emulated[hits > 0], case.reference[hits > 0])
    return case


@pytest.fixture(scope="module")
def linear(real_data):
    case = load(real_data, "SpinePhantom_LN_MAXI.xml", "Reference_LNMAXI.mha")
    np.testing.assert_array_equal(case.pasted_linearly("maximum", igsio.Arithmetic(2**14))[0], case.reference)
    return case


@pytest.fixture(scope="module")
def linear_mean(trus):
    """The sector images with LINEAR and MEAN."""
    configuration = replace(trus.sequence.configuration, interpolation="linear", method="average")
    return replace(trus, sequence=replace(trus.sequence, configuration=configuration))


def ours(case, method, **asked):
    """A volume of the case, in double precision."""
    settings = ReconstructionSettings(method=method, output_type="float32", holes="off", **asked)
    sequence = replace(case.sequence, configuration=replace(case.sequence.configuration, fixed_point=False))
    return reconstruct(sequence, settings, grid=case.grid)


@pytest.mark.parametrize(("name", "method"), [("trus", "latest"), ("spine", "maximum")])
def test_plus_own_methods_are_igsios_with_its_double_precision_index_in_its_box(name, method, request):
    case = request.getfixturevalue(name)
    assert case.grid.shape == case.reference.shape
    np.testing.assert_allclose(case.grid.origin, case.reference_origin, atol=5e-4)
    expected, hits = case.pasted(igsio.double_index, method)
    result = ours(case, method)
    np.testing.assert_array_equal(result.intensity.array, expected)
    np.testing.assert_array_equal(result.hits.array, hits)


def test_latest_as_configured_is_igsios_volume_with_its_fixed_point_index_but_for_the_fan(trus):
    expected, hits = trus.pasted(igsio.fixed_point_index, "latest")
    result = reconstruct(trus.sequence, ReconstructionSettings(holes="off"), grid=trus.grid)
    np.testing.assert_array_equal(result.intensity.array, expected)
    np.testing.assert_array_equal(result.hits.array, hits)
    assert within_tolerance(result.intensity.array, trus.reference) > 0.999
    assert (ours(trus, "latest").intensity.array != trus.reference).mean() < 0.012


def test_sticks_over_the_emulated_mean_reproduce_igsios_filled_volume(spine):
    emulated, hits = spine.pasted(igsio.fixed_point_index, "mean")
    values, mask = emulated.astype(np.float32), (hits > 0).astype(np.uint8)
    fill_holes_by_kind(values, mask, (HoleFilling("stick", 9),))
    difference = np.abs(np.floor(values) - spine.reference)
    assert difference.max() <= 2
    # The rest is what IGSIO loses by cutting every stick's value to a whole number before it averages them
    assert (difference == 0).mean() > 0.99


def within_tolerance(values, reference):
    """The share of voxels within the 2 gray levels that IGSIO's own regression tests allow."""
    return (np.abs(values.astype(float) - reference) <= 2).mean()


def test_linear_maximum_as_configured_reproduces_igsios_volume(linear):
    assert linear.sequence.configuration.fixed_point
    result = reconstruct(linear.sequence, ReconstructionSettings(hole_limit=0.0), grid=linear.grid)
    assert within_tolerance(result.intensity.array, linear.reference) > 0.9999


@pytest.mark.parametrize("method", ["latest", "maximum", "average"])
def test_linear_methods_are_igsios_in_double_precision_the_average_before_it_rounds(linear_mean, method):
    result = ours(linear_mean, method)
    rounds = method != "average"
    arithmetic = igsio.Arithmetic(stores_whole_numbers=rounds)
    expected, weight = linear_mean.pasted_linearly("mean" if method == "average" else method, arithmetic)
    if rounds:
        np.testing.assert_array_equal(result.intensity.array, expected)
        return
    assert within_tolerance(result.intensity.array, expected) > 0.9999
    np.testing.assert_allclose(result.score.array, weight / 256, atol=1e-4)
    # IGSIO's own mean rounds after every pixel
    emulated, weight = linear_mean.pasted_linearly("mean", igsio.Arithmetic())
    off = np.abs(result.intensity.array - emulated)[weight > 0]
    assert 0.4 < (off <= 2).mean() < 0.7
    assert 2.0 < off.mean() < 3.0


def test_the_hole_filling_of_the_configuration_is_done(spine):
    assert spine.sequence.configuration.holes == (HoleFilling("stick", 9),)
    result, unfilled = (
        reconstruct(spine.sequence, ReconstructionSettings(output_type="float32", holes=holes), grid=spine.grid) for holes in (None, "off")
    )
    values, mask = unfilled.intensity.array, unfilled.mask.array
    fill_holes_by_kind(values, mask, (HoleFilling("stick", 9),))
    np.testing.assert_array_equal(result.intensity.array, values)
    np.testing.assert_array_equal(result.mask.array, mask)


def test_the_bone_surface_lies_where_the_frames_of_a_linear_probe_show_it(real_data):
    """The brightest pixels of the real bone, frame by frame, are bright in the volume at their place in Reference."""
    sequence = read_sequence(real_data("BoneUltrasound_L14.igs.mha"), config=real_data("BoneUltrasound_L14_config.xml"))
    assert sequence.configuration.probe.kind == "linear"
    result = reconstruct(sequence, ReconstructionSettings(hole_limit=0.0, method="maximum", spacing=0.3))
    assert result.frames_inserted == 21
    poses = sweep_poses(sequence).image_to_reference
    for number in (0, 10, 20):
        image = sequence.images[number]
        row, column = np.unravel_index(np.argmax(image), image.shape)
        i, j, k, _ = np.floor(result.grid.reference_to_ijk @ poses[number] @ (column, row, 0, 1) + 0.5).astype(int)
        assert result.intensity.array[k, j, i] >= image[row, column]
