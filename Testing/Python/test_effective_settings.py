"""What a Plus configuration gives a reconstruction, and that whatever the caller gives comes first."""

from __future__ import annotations

import numpy as np
import pytest
import SimpleITK as sitk
from files import calibrated, tracked_sequence, write_configuration
from sweeps import sphere_bone

from AIFReconLib.commands.parser import main
from AIFReconLib.effective_settings import resolve_settings
from AIFReconLib.holes.filling import HoleFilling
from AIFReconLib.holes.igsio_hole_filling import fill_holes_by_kind
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, ImageRegion
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct

FULL = ImageRegion(ClipRectangle((0, 0), (39, 29)))
BOX = {"spacing": (1.0, 1.5, 2.0), "origin": (-10.0, -5.0, -20.0), "extent": (0, 19, 0, 9, 0, 14)}


def sweep(**values):
    """A recording with such a configuration."""
    return calibrated(**{"region": FULL, **values})


LINEAR, NEAREST = {"interpolation": "linear"}, {"interpolation": "nearest"}


@pytest.mark.parametrize(
    ("configured", "asked", "expected"),
    [
        ({}, {}, NEAREST),
        (LINEAR, {}, LINEAR),
        (LINEAR, NEAREST, NEAREST),
        ({}, LINEAR, LINEAR),
        (LINEAR, {"method": "weighted"}, NEAREST),
        (LINEAR, {"method": "weighted", **LINEAR}, LINEAR),
        (LINEAR, {"method": "average", "best_cosine": True}, NEAREST),
        ({"pixel_rejection": 12}, {}, {"pixel_rejection": 12}),
        ({"pixel_rejection": 12}, {"pixel_rejection": 0}, {"pixel_rejection": 0}),
        ({}, {"pixel_rejection": 7}, {"pixel_rejection": 7}),
    ],
)
def test_what_the_caller_asks_for_goes_before_what_is_configured(configured, asked, expected):
    found = resolve_settings(ReconstructionSettings(**asked), sweep(**configured).configuration, False)
    assert {name: getattr(found, name) for name in expected} == expected


@pytest.mark.parametrize(("spacing", "size"), [(None, (20, 10, 15)), (0.5, (39, 28, 57))])
def test_the_box_of_the_configuration_is_the_grid_at_any_spacing_but_in_no_other_reference_frame(spacing, size):
    grid = reconstruct(sweep(**BOX), ReconstructionSettings(spacing=spacing)).grid
    assert grid.size == size
    np.testing.assert_allclose(grid.origin, (-10, -5, -20))
    np.testing.assert_allclose(grid.spacing, spacing or (1.0, 1.5, 2.0))
    assert reconstruct(sweep(**BOX), ReconstructionSettings(reference="Tracker", spacing=spacing)).grid.origin[2] < -800


@pytest.mark.parametrize(("method", "moves"), [("average", True), ("maximum", True), ("weighted", False)])
def test_fixed_point_places_the_pixels_of_plus_own_methods(method, moves):
    asks = {"probe": ProbeGeometry("linear"), "spacing": (0.4, 0.4, 0.4)}
    bone = sphere_bone() if method == "weighted" else None
    double, fixed = (reconstruct(sweep(fixed_point=cut, **asks), ReconstructionSettings(method=method), bone) for cut in (False, True))
    assert (fixed.hits.array != double.hits.array).any() == moves


def test_a_spacing_that_is_to_fit_ends_with_the_sweep():
    def made(fits, spacing=None):
        settings = ReconstructionSettings(method="average", spacing=spacing)
        return reconstruct(sweep(fits_spacing=fits, spacing=(1.0, 1.0, 1.7)), settings).grid

    plain, fitted, own = made(False), made(True), made(True, 1.7)
    assert own.spacing[2] == plain.spacing[2] == 1.7 < fitted.spacing[2]
    np.testing.assert_allclose(fitted.spacing[:2], (1, 1))


@pytest.mark.parametrize("way", [HoleFilling("cube", 5), HoleFilling("gaussian by hits", 5, 1.0)], ids=str)
def test_holes_are_filled_as_configured_and_not_where_the_caller_says_off(way):
    sequence = sweep(holes=(way,), spacing=(0.7,) * 3)
    unfilled, filled = (reconstruct(sequence, ReconstructionSettings(output_type="float32", holes=holes)) for holes in ("off", None))
    assert unfilled.hits.array.max() > 1
    values, mask = unfilled.intensity.array, unfilled.mask.array
    assert (mask == 2).sum() == 0
    assert fill_holes_by_kind(values, mask, (way,), score=unfilled.hits.array) > 100
    np.testing.assert_array_equal(filled.intensity.array, values)
    np.testing.assert_array_equal(filled.mask.array, mask)


def test_a_configured_importance_mask_weights_the_average(tmp_path):
    weights = np.random.default_rng(0).choice(np.array([0, 90, 255], np.uint8), (30, 40))
    sitk.WriteImage(sitk.GetImageFromArray(weights), str(tmp_path / "mask.png"))
    asks = {"uses_importance_mask": True, "importance_mask": tmp_path / "mask.png", "method": "average", "spacing": (2.0,) * 3}
    configured = reconstruct(sweep(**asks))
    given = reconstruct(sweep(spacing=(2.0,) * 3), ReconstructionSettings(importance_mask=weights / 255))
    plain = reconstruct(sweep(spacing=(2.0,) * 3))
    np.testing.assert_array_equal(configured.intensity.array, given.intensity.array)
    assert (configured.intensity.array != plain.intensity.array).any()


def test_what_is_configured_and_does_not_go_with_the_method_is_told():
    plus = {"uses_importance_mask": True, "method": "average", "spacing": (2.0,) * 3}
    result = reconstruct(sweep(**plus), ReconstructionSettings(method="maximum"))
    assert "The configuration's importance mask is not used: it is for an average, and the method is maximum." in result.notes
    result = reconstruct(sweep(**plus, **LINEAR, probe=ProbeGeometry("linear")), bone=sphere_bone())
    assert result.method == "weighted"
    said = "Interpolation=LINEAR is not used: it is for methods average, latest, maximum, and this is weighted."
    assert any(said in note for note in result.notes)


# From the command line


def test_a_plus_configuration_drives_the_command(tmp_path, capsys):
    write_sequence(tracked_sequence(), tmp_path / "sweep.igs.mha")
    asked = 'ClipRectangleSize="39 29" Interpolation="LINEAR" CompoundingMode="MAXIMUM" Optimization="PARTIAL" FillHoles="ON" '
    holes = '<HoleFillingElement Type="STICK" StickLengthLimit="9" NumberOfSticksToUse="1"/>'
    config = write_configuration(tmp_path / "plus.xml", asked + 'PixelRejectionThreshold="20"', holes)
    outputs = ["--output", tmp_path / "volume.nrrd", "--mask", tmp_path / "mask.nrrd"]
    assert main(["reconstruct", *map(str, [tmp_path / "sweep.igs.mha", "--config", config, *outputs])]) == 0
    assert "Optimization=PARTIAL has no effect" in capsys.readouterr().out
    assert (read_volume(tmp_path / "mask.nrrd").array == 2).any()
