"""What a Plus configuration or the options ask for while scanning: the volume is that of the recording, reconstructed alike."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import SimpleITK as sitk
from files import COLUMNS, ROWS, tracked_sequence, write_configuration
from live_messages import streamed

from AIFReconLib.commands.parser import main
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.live.replay.server import ReplayServer
from AIFReconLib.live.session.session import LiveSession
from AIFReconLib.live.wire.sources import QueueSource
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.reconstruction import reconstruct

FRAMES = 10
GRID = VoxelGrid.from_spacing((-9.0, -8.0, -6.0), (19, 17, 13), 1.0)
STICK = '<HoleFillingElement Type="STICK" StickLengthLimit="7" NumberOfSticksToUse="1"/>'
BY_HITS = '<HoleFillingElement Type="GAUSSIAN_ACCUMULATION" Size="5" Stdev="1" MinimumKnownVoxelsRatio="0"/>'
BOX = 'OutputOrigin="-9 -8 -6" OutputExtent="0 18 0 16 0 12"'


@pytest.fixture
def configuration(tmp_path):
    """Writes configurations, with a mask beside them; answers with the path."""
    weights = np.tile(np.linspace(0, 255, COLUMNS).astype(np.uint8), (ROWS, 1))
    sitk.WriteImage(sitk.GetImageFromArray(weights), str(tmp_path / "mask.png"))
    return lambda *asked: write_configuration(tmp_path / "plus.xml", *asked)


def volumes(path, recipe, grid=GRID, scouted=False):
    """Of a live scan and of the same frames offline."""
    sequence = replace(tracked_sequence(count=FRAMES), configuration=read_plus_configuration(path))
    source = QueueSource(limit=1000)
    for message in streamed(sequence):
        source.put(message)
    source.stop()
    session = LiveSession(source, recipe, grid=None if scouted else grid, configuration=sequence.configuration, longest_delay=None)
    session.start()
    assert session.finished.wait(60.0)
    if scouted:
        session.use_grid(session.grid_from_scout())
    live = session.finish()
    return live, reconstruct(sequence, recipe, grid=live.grid)


def same(live, offline):
    for part in ("intensity", "mask", "hits"):
        np.testing.assert_array_equal(getattr(live, part).array, getattr(offline, part).array)
    return live


WEIGHTS = np.tile(np.linspace(0, 1, COLUMNS, dtype=np.float32), (ROWS, 1))
MEAN = 'CompoundingMode="MEAN"'
NO_HOLES = {"hole_limit": 0.0}
CASES = [
    ('Interpolation="LINEAR" CompoundingMode="MAXIMUM" Optimization="FULL" PixelRejectionThreshold="90"', "", NO_HOLES),
    ('CompoundingMode="LATEST" ClipRectangleOrigin="3 4" ClipRectangleSize="30 20" FillHoles="ON"', STICK, NO_HOLES),
    ('Interpolation="LINEAR" CompoundingMode="IMPORTANCE_MASK" ImportanceMaskFilename="mask.png"', "", NO_HOLES),
    ('CompoundingMode="MEAN" FillHoles="ON" SkipInterval="2"', BY_HITS, NO_HOLES),
    (MEAN, "", {"importance_mask": WEIGHTS, "interpolation": "linear"}),
    (MEAN, "", {"holes": "gaussian", "hole_limit": 2.0, "pixel_rejection": 90.0, "method": "maximum"}),
    (MEAN, "", {"speed_of_sound": 1400.0}),
]


@pytest.mark.parametrize(("attributes", "holes", "options"), CASES)
def test_what_is_configured_or_asked_for_gives_the_volume_of_the_recording(configuration, attributes, holes, options):
    plain = same(*volumes(configuration(), Recipe(**NO_HOLES)))
    asked = same(*volumes(configuration(attributes, holes), Recipe(**options)))
    assert (asked.intensity.array != plain.intensity.array).any()
    assert (asked.mask.array == 2).any() == (bool(holes) or options.get("hole_limit") != 0.0)


def test_the_box_of_a_configuration_needs_no_scouting(configuration):
    live = same(*volumes(configuration(BOX), Recipe(), grid=None))
    assert live.grid.size == GRID.size
    np.testing.assert_allclose(live.grid.ijk_to_reference, GRID.ijk_to_reference)


def test_a_scouted_box_holds_pixels_that_sound_was_slower_to(configuration):
    usual, slow = (same(*volumes(configuration(), Recipe(speed_of_sound=speed), scouted=True)) for speed in (1540.0, 2400.0))
    assert np.prod(slow.grid.size) > np.prod(usual.grid.size)
    assert slow.hits.array.sum() == usual.hits.array.sum()


@pytest.mark.parametrize("fits", ["TRUE", "FALSE"])
def test_a_scouted_box_has_the_spacing_along_z_that_fits_where_that_is_configured(configuration, fits):
    path = configuration(f'RecomputeOutputSpacing="{fits}"')
    live, _ = volumes(path, Recipe(), scouted=True)
    offline = reconstruct(replace(tracked_sequence(count=FRAMES), configuration=read_plus_configuration(path)), Recipe())
    np.testing.assert_array_equal(live.grid.spacing, offline.grid.spacing)
    assert (live.grid.spacing[2] != 1.0) == (fits == "TRUE")


@pytest.fixture
def served(configuration):
    """The configuration of a recording that a server sends over and over, and the options that reach it."""
    sequence = replace(tracked_sequence(count=FRAMES), configuration=read_plus_configuration(configuration()))
    server = ReplayServer(sequence, port=0, rate=60.0, loop=True)
    server.start()
    yield ["live", "-q", "--port", str(server.port), "--config", str(configuration())]
    server.stop()


def test_a_scan_is_repeated_on_its_recording_and_in_another_scan(served, tmp_path):
    """Scouted box and chosen hole limit are those of the scan; how the stream was read is kept apart, and is not repeated."""
    volume, record = tmp_path / "live.nrrd", tmp_path / "scan.mha"
    first = [*served, "--frames", str(FRAMES), "--scout-seconds", "0.05", "--trust-image-pose", "--record", str(record)]
    first += ["--image-to-reference", "ImageToReference"]
    assert main([*first, "-o", str(volume)]) == 0
    assert main(["reconstruct", str(record), *served[-2:], "-q", "--settings", str(volume), "-o", str(tmp_path / "again.nrrd")]) == 0
    once, again = (read_volume(tmp_path / name) for name in ("live.nrrd", "again.nrrd"))
    assert once.array.any()
    assert again.array.tobytes() == once.array.tobytes()
    assert '"trust_image_pose": true' in once.fields["AIFRecon_stream"]
    assert "time_offset" not in once.fields["AIFRecon_settings"]
    assert main([*served, "--frames", "3", "--settings", str(volume), "-o", str(tmp_path / "other.nrrd")]) == 0
    np.testing.assert_array_equal(read_volume(tmp_path / "other.nrrd").ijk_to_reference, once.ijk_to_reference)
