"""What a Plus configuration gives a reconstruction, and that whatever the caller gives comes first."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import SimpleITK as sitk
from files import IMAGE_TO_PROBE, tracked_sequence
from sweeps import sphere_bone

from AIFReconLib.commands.parser import main
from AIFReconLib.effective_settings import reconstructor_parts, resolve_settings
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample
from AIFReconLib.holes.filling import HoleFilling
from AIFReconLib.holes.igsio_hole_filling import fill_holes_by_kind
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, ImageRegion
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.configuration import PlusConfiguration

CALIBRATION = {TransformName("Image", "Probe"): TransformSample(IMAGE_TO_PROBE)}
FULL = ImageRegion(ClipRectangle((0, 0), (39, 29)))
BOX = {"spacing": (1.0, 1.5, 2.0), "origin": (-10.0, -5.0, -20.0), "extent": (0, 19, 0, 9, 0, 14)}


def configuration(**values) -> PlusConfiguration:
    return PlusConfiguration(**{"path": Path("made-up.xml"), "transforms": CALIBRATION, "region": FULL, **values})


def sweep(**values):
    """A recording with such a configuration."""
    return replace(tracked_sequence(), configuration=configuration(**values))


def resolved(configured=None, has_bone=False, **settings):
    return resolve_settings(ReconstructionSettings(**settings), configured, has_bone)


@pytest.mark.parametrize(
    ("configured", "settings", "expected"),
    [
        ({}, {}, "nearest"),
        ({"interpolation": "linear"}, {}, "linear"),
        ({"interpolation": "linear"}, {"interpolation": "nearest"}, "nearest"),
        ({}, {"interpolation": "linear"}, "linear"),
        ({"interpolation": "linear"}, {"method": "weighted"}, "nearest"),
        ({"interpolation": "linear"}, {"method": "weighted", "interpolation": "linear"}, "linear"),
        ({"interpolation": "linear"}, {"method": "average", "best_cosine": True}, "nearest"),
    ],
)
def test_interpolation_is_the_callers_then_the_configurations(configured, settings, expected):
    assert resolved(configuration(**configured), **settings).interpolation == expected


@pytest.mark.parametrize(("configured", "given", "expected"), [(None, None, None), (12, None, 12), (12, 0, 0), (None, 7, 7)])
def test_pixel_rejection_is_the_callers_then_the_configurations(configured, given, expected):
    assert resolved(configuration(pixel_rejection=configured), pixel_rejection=given).pixel_rejection == expected


def test_an_interpolation_that_does_not_go_with_the_method_is_told():
    asked = ReconstructionSettings()
    configured = configuration(interpolation="linear")
    (note,) = reconstructor_parts(asked, resolve_settings(asked, configured, True), configured).notes
    assert "Interpolation=LINEAR is not used: it is for methods average, latest, maximum, and this is weighted." in note


def test_the_box_of_the_configuration_is_the_grid():
    grid = reconstruct(sweep(**BOX)).grid
    assert grid.size == (20, 10, 15)
    np.testing.assert_allclose(grid.origin, (-10, -5, -20))
    np.testing.assert_allclose(grid.spacing, (1.0, 1.5, 2.0))


def test_a_spacing_of_the_caller_keeps_the_box():
    grid = reconstruct(sweep(**BOX), ReconstructionSettings(spacing=0.5)).grid
    assert grid.size == (39, 28, 57)


@pytest.mark.parametrize(("method", "moves"), [("average", True), ("maximum", True), ("weighted", False)])
def test_fixed_point_places_the_pixels_of_plus_own_methods(method, moves):
    asks = {"probe": ProbeGeometry("linear"), "spacing": (0.4, 0.4, 0.4)}
    bone = sphere_bone() if method == "weighted" else None
    double, fixed = (reconstruct(sweep(fixed_point=cut, **asks), ReconstructionSettings(method=method), bone) for cut in (False, True))
    assert (fixed.hits.array != double.hits.array).any() == moves


def test_a_spacing_that_is_to_fit_ends_with_the_sweep():
    plain, fitted, own = (
        reconstruct(
            sweep(fits_spacing=fits, spacing=(1.0, 1.0, 1.7)),
            ReconstructionSettings(method="average", spacing=spacing),
        ).grid
        for fits, spacing in ((False, None), (True, None), (True, 1.7))
    )
    assert own.spacing[2] == plain.spacing[2] == 1.7 < fitted.spacing[2]
    np.testing.assert_allclose(fitted.spacing[:2], (1, 1))


def test_in_another_reference_frame_the_box_means_nothing():
    sequence = sweep(**BOX)
    assert reconstruct(sequence, ReconstructionSettings(reference="Tracker")).grid.origin[2] < -800


def test_holes_are_filled_as_configured_and_not_where_the_caller_says_off():
    sequence = sweep(holes=(HoleFilling("cube", 5),), spacing=(0.6,) * 3)
    assert (reconstruct(sequence).mask.array == 2).sum() > 100
    assert (reconstruct(sequence, ReconstructionSettings(holes="off")).mask.array == 2).sum() == 0


def test_holes_are_filled_by_the_pixels_that_entered_where_that_is_asked_for():
    way = HoleFilling("gaussian by hits", 5, 1.0)
    sequence = sweep(holes=(way,), spacing=(0.8,) * 3)
    unfilled, filled = (reconstruct(sequence, ReconstructionSettings(output_type="float32", holes=holes)) for holes in ("off", None))
    assert unfilled.hits.array.max() > 1
    values, mask = unfilled.intensity.array, unfilled.mask.array
    fill_holes_by_kind(values, mask, (way,), score=unfilled.hits.array)
    np.testing.assert_array_equal(filled.intensity.array, values)


def test_a_configured_importance_mask_weights_the_average(tmp_path):
    weights = np.random.default_rng(0).choice(np.array([0, 90, 255], np.uint8), (30, 40))
    sitk.WriteImage(sitk.GetImageFromArray(weights), str(tmp_path / "mask.png"))
    asks = {"uses_importance_mask": True, "importance_mask": tmp_path / "mask.png", "method": "average", "spacing": (2.0,) * 3}
    configured = reconstruct(sweep(**asks))
    given = reconstruct(sweep(spacing=(2.0,) * 3), ReconstructionSettings(importance_mask=weights / 255))
    plain = reconstruct(sweep(spacing=(2.0,) * 3))
    np.testing.assert_array_equal(configured.intensity.array, given.intensity.array)
    assert (configured.intensity.array != plain.intensity.array).any()


def test_an_importance_mask_of_the_configuration_gives_way_to_a_method_of_the_caller():
    sequence = sweep(uses_importance_mask=True, method="average", spacing=(2.0,) * 3)
    result = reconstruct(sequence, ReconstructionSettings(method="maximum"))
    assert "The configuration's importance mask is not used: it is for an average, and the method is maximum." in result.notes


def test_bone_and_a_configuration_for_plus_go_together():
    asks = {"interpolation": "linear", "uses_importance_mask": True, "method": "average", "probe": ProbeGeometry("linear")}
    result = reconstruct(sweep(**asks, spacing=(2.0,) * 3), bone=sphere_bone())
    assert result.method == "weighted"
    assert len(result.notes) >= 2


# From the command line


@pytest.fixture
def recording(tmp_path):
    """A recording and a configuration that drives Plus's own reconstructor."""
    write_sequence(tracked_sequence(), tmp_path / "sweep.igs.mha")
    matrix = " ".join(f"{number:.17g}" for number in IMAGE_TO_PROBE.ravel())
    (tmp_path / "plus.xml").write_text(
        f"""<PlusConfiguration><CoordinateDefinitions><Transform From="Image" To="Probe" Matrix="{matrix}"/></CoordinateDefinitions>
        <VolumeReconstruction OutputSpacing="1 1 1" ClipRectangleSize="39 29" Interpolation="LINEAR" CompoundingMode="MAXIMUM"
        Optimization="PARTIAL" FillHoles="ON" PixelRejectionThreshold="20">
        <HoleFilling><HoleFillingElement Type="STICK" StickLengthLimit="9" NumberOfSticksToUse="1"/></HoleFilling>
        </VolumeReconstruction></PlusConfiguration>""",
        encoding="utf-8",
    )
    return tmp_path


def run(recording, *options):
    arguments = ["reconstruct", str(recording / "sweep.igs.mha"), "--config", str(recording / "plus.xml")]
    return main([*arguments, "--output", str(recording / "volume.nrrd"), *options])


def test_a_plus_configuration_drives_the_command(recording, capsys):
    assert run(recording, "--mask", str(recording / "mask.nrrd")) == 0
    assert "Optimization=PARTIAL has no effect" in capsys.readouterr().out
    assert (read_volume(recording / "mask.nrrd").array == 2).any()


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (("--holes", "stick", "--hole-limit", "0"), "hole_limit must be above 0 mm"),
        (("--importance-mask", "none.png"), "none.png: there is no such file"),
        (("--pixel-rejection", "-3"), "pixel_rejection must be at least 0"),
    ],
)
def test_options_that_cannot_be_carried_out_are_explained(recording, capsys, options, expected):
    assert run(recording, *options) == 2
    assert expected in capsys.readouterr().err
    assert not (recording / "volume.nrrd").exists()
