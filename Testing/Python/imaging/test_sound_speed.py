"""Pixels at their true depth, in closed form: along image rows for linear probes, along radii for sectors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from files import calibrated, tracked_sequence
from sweeps import compounded, image_pose, oblique_frames, sphere_bone, turned_grid

from AIFReconLib.commands.parser import main
from AIFReconLib.compounding.methods.table import METHODS
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.errors import BeamGeometryError
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, Fan, ImageRegion
from AIFReconLib.imaging.sound_speed import DepthScale, depth_factor
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.frames import TrackedFrame

LINEAR, PHASED = ProbeGeometry("linear"), ProbeGeometry("sector", (50.0, 0.0))
SPACING = (0.2, 0.3)
WATER = {"speed_of_sound": 1480.0, "scanner_speed_of_sound": 1540.0}
FACTOR = 1480 / 1540


def place_of(pixel, probe, region, **settings):
    """Where, in mm in the image plane, a volume shows the one bright pixel (column, row) of an image."""
    image = np.zeros((120, 100), np.uint8)
    image[pixel[1], pixel[0]] = 200
    grid = VoxelGrid.from_spacing((-5, -5, 0), (601, 801, 1), (0.05, 0.05, 1.0))
    made = compounded([TrackedFrame(image, image_pose(SPACING))], grid, None, probe, region, method="maximum", **settings)
    row, column = np.argwhere(made.intensity.array[0] == 200).mean(axis=0)
    return column * 0.05 - 5, row * 0.05 - 5


@pytest.mark.parametrize(
    ("pixel", "probe", "region", "place", "interpolation"),
    [
        *(
            ((50, 100), LINEAR, ImageRegion(ClipRectangle((10, 20), (80, 90))), (50 * 0.2, 20 * 0.3 + FACTOR * 80 * 0.3), how)
            for how in ("nearest", "linear")
        ),
        ((70, 90), PHASED, ImageRegion(), (50 * 0.2 + FACTOR * 20 * 0.2, FACTOR * 90 * 0.3), "nearest"),
    ],
    ids=["linear probe", "linear probe and interpolation", "phased array"],
)
def test_depth_is_below_the_first_row_of_the_region_or_from_the_apex(pixel, probe, region, place, interpolation):
    np.testing.assert_allclose(place_of(pixel, probe, region, interpolation=interpolation, **WATER), place, atol=0.05)


def test_a_sector_shows_depth_below_its_transducer_along_radii():
    apex = (50.0, -40.0)
    region = ImageRegion(fan=Fan(apex, (-40, 40), (18.0, 50.0), SPACING))
    x, y = place_of((80, 70), ProbeGeometry("sector", apex), region, **WATER)
    shown = np.array([(80 - apex[0]) * 0.2, (70 - apex[1]) * 0.3])
    radius = np.linalg.norm(shown)
    true = (18.0 + FACTOR * (radius - 18.0)) / radius * shown + np.array(apex) * SPACING
    # The face is where the region's pixels begin, to a fraction of a pixel; 4 % of that is lost in a voxel
    np.testing.assert_allclose((x, y), true, atol=0.06)


def volumes(method, frames, bone=None, **settings):
    return compounded(frames, None, bone, LINEAR, method=method, intensity_maximum=255, **settings)


@pytest.mark.parametrize("method", [m for m in METHODS if m != "weighted"])
def test_for_a_linear_probe_it_is_the_same_as_images_of_another_pixel_size(method):
    bone = None if method in ("average", "latest", "maximum") else sphere_bone()
    frames = oblique_frames(seed=6, count=3)
    scaled = [replace(f, image_to_reference=f.image_to_reference @ np.diag([1, FACTOR, 1, 1])) for f in frames]
    ours, theirs = volumes(method, frames, bone, **WATER), volumes(method, scaled, bone)
    np.testing.assert_array_equal(ours.hits.array, theirs.hits.array)
    np.testing.assert_allclose(ours.intensity.array, theirs.intensity.array, rtol=1e-4, atol=1e-3)
    np.testing.assert_allclose(ours.score.array, theirs.score.array, rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("probe", [LINEAR, ProbeGeometry("sector", (20.0, -9.0))])
@pytest.mark.parametrize("speed", [1300.0, 1700.0])
def test_the_box_around_the_sweep_holds_every_pixel_at_its_true_place(probe, speed):
    sequence = calibrated(probe=probe, region=ImageRegion(ClipRectangle((0, 0), (39, 29))))
    result = reconstruct(sequence, ReconstructionSettings(hole_limit=0.0, method="average", spacing=0.7, speed_of_sound=speed))
    assert result.hits.array.sum() == 6 * 30 * 40
    assert all(result.hits.array.any(axis=axes)[end] for axes in ((1, 2), (0, 2), (0, 1)) for end in (0, -1))


def test_the_beams_must_be_known_for_another_speed_and_without_one_nothing_moves():
    with pytest.raises(BeamGeometryError, match="speed of sound needs the direction of the beams"):
        Reconstructor(turned_grid(), ReconstructionSettings(hole_limit=0.0, **WATER))
    for settings in ({}, {"scanner_speed_of_sound": 1500.0}, {"speed_of_sound": 1540.0}):
        assert depth_factor(ReconstructionSettings(hole_limit=0.0, **settings)) == 1.0
    apex = DepthScale(ProbeGeometry("sector", (4.0, 3.0)), 1.1, 0.0, SPACING)
    assert apex.moved(np.array([[4.0], [3.0]])).ravel().tolist() == [4, 3]


def test_bone_from_the_sweep_itself_is_refused_with_it(tmp_path, capsys):
    from AIFReconLib.io.sequence.writer import write_sequence

    write_sequence(tracked_sequence(), tmp_path / "sweep.igs.mha")
    arguments = ["reconstruct", str(tmp_path / "sweep.igs.mha"), "--output", str(tmp_path / "v.nrrd"), "--probe", "linear"]
    assert main([*arguments, "--bone-from-sweep", "--speed-of-sound", "1480"]) == 2
    assert "Leave out --speed-of-sound" in capsys.readouterr().err
