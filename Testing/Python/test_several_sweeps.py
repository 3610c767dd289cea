"""Several sweeps are one: the voxels of the recording that holds all frames, each placed by its own transforms."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from files import IMAGE_TO_PROBE, tracked_sequence, write_configuration
from sweeps import rigid, sphere_bone

from AIFReconLib.bone.echoes.search import sweep_echoes
from AIFReconLib.commands.parser import main
from AIFReconLib.compounding.methods.table import METHODS
from AIFReconLib.effective_settings import imaging_fields
from AIFReconLib.errors import BeamGeometryError, GeometryError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, ImageRegion
from AIFReconLib.inspection.summary import summary_lines
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.recipe.recipe import Recipe, ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.configuration import PlusConfiguration
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.multi_sweep import joined
from AIFReconLib.sweep.poses import sweep_poses

CONFIGURED = PlusConfiguration(
    path=Path("made-up.xml"),
    transforms={TransformName("Image", "Probe"): TransformSample(IMAGE_TO_PROBE)},
    region=ImageRegion(ClipRectangle((0, 0), (39, 29))),
    probe=ProbeGeometry("linear"),
    spacing=(0.9, 1.1, 1.3),
)


def sweep(seed=0, name=None, configuration=CONFIGURED, **options) -> TrackedSequence:
    return replace(tracked_sequence(seed=seed, **options), configuration=configuration, path=name and Path(name))


def three() -> list[TrackedSequence]:
    """Oblique sweeps of different length; of the second a frame was not tracked."""
    return [sweep(1, "a.mha", count=5), sweep(2, "b.mha", statuses={2: TransformStatus.OUT_OF_VIEW}), sweep(3, "c.mha", count=7)]


def concatenated(sequences) -> TrackedSequence:
    """One recording of all frames, as if one clock had run on."""
    records = [record for sequence in sequences for record in sequence.records]
    records = [replace(record, timestamp=0.1 * number) for number, record in enumerate(records)]
    return TrackedSequence(np.concatenate([sequence.images for sequence in sequences]), records, configuration=CONFIGURED)


def assert_same(ours, theirs):
    for name in ("intensity", "score", "hits", "mask", "cosine"):
        one, other = getattr(ours, name), getattr(theirs, name)
        assert (one is None) == (other is None)
        if one is not None:
            np.testing.assert_array_equal(one.array, other.array)
            np.testing.assert_array_equal(one.ijk_to_reference, other.ijk_to_reference)
    assert (ours.hole_limit, ours.skipped, ours.frames_inserted) == (theirs.hole_limit, theirs.skipped, theirs.frames_inserted)


ASKED = {
    **{method: {"method": method, "best_cosine": True} for method in METHODS},
    "shares of every second frame": {"method": "average", "interpolation": "linear", "skip": 2},
}


@pytest.mark.parametrize("asked", ASKED.values(), ids=ASKED)
def test_several_sweeps_are_the_concatenated_one_to_the_last_bit(asked, engine):
    settings = ReconstructionSettings(engine=engine, output_type="float32", **asked)
    bone = sphere_bone()
    assert_same(reconstruct(three(), settings, bone), reconstruct(concatenated(three()), settings, bone))
    # What is recognized in the images is recognized in all
    bare = replace(CONFIGURED, region=ImageRegion(), probe=None)
    images = np.pad(np.full((6, 24, 30), 90, np.uint8), ((0, 0), (3, 3), (5, 5)))
    sweeps = [sweep(seed, configuration=bare, images=images) for seed in (1, 2)]
    assert_same(reconstruct(sweeps), reconstruct(replace(concatenated(sweeps), configuration=bare)))


def moved(sequence, tool, by) -> TrackedSequence:
    """With a tool held otherwise."""
    key = TransformName(tool, "Tracker")
    held = [
        replace(record, transforms={**record.transforms, key: TransformSample(record.transforms[key].matrix @ by)})
        for record in sequence.records
    ]
    return replace(sequence, records=held)


def test_each_is_placed_by_its_own_configuration_and_the_first_says_how_the_volume_is_made():
    """A second probe, calibrated otherwise and held so that its images lie where the first one's do, gives the same voxels."""
    turn = rigid((10.0, 20.0, 30.0), (5.0, -4.0, 3.0))
    calibration = {TransformName("Image", "Probe"): TransformSample(turn @ IMAGE_TO_PROBE)}
    first, second = sweep(1), sweep(2)
    other = replace(CONFIGURED, transforms=calibration, spacing=(2.0, 2.0, 2.0))
    held = replace(moved(second, "Probe", np.linalg.inv(turn)), configuration=other)
    poses, expected = (sweep_poses(joined([first, each])).image_to_reference for each in (held, second))
    np.testing.assert_allclose(poses, expected, atol=1e-9)
    settings = ReconstructionSettings(method="latest")
    there, back = reconstruct([first, second], settings), reconstruct([second, first], settings)
    assert (there.intensity.array != back.intensity.array).any()
    np.testing.assert_array_equal(there.hits.array, back.hits.array)
    assert reconstruct([first, held]).grid.spacing == pytest.approx((0.9, 1.1, 1.3))


def test_the_report_counts_each_with_its_own_frame_numbers():
    result = reconstruct(three())
    assert [(share.name, share.frames, share.inserted) for share in result.sweeps] == [("a.mha", 5, 5), ("b.mha", 6, 5), ("c.mha", 7, 7)]
    assert result.skipped == {"ProbeToTracker OUT_OF_VIEW": [7]}
    lines = summary_lines(result, 18)
    assert "a.mha: 5 of 5 frames" in lines
    assert "b.mha: 5 of 6 frames; skipped: ProbeToTracker OUT_OF_VIEW: 1 frame (2)" in lines


# ---- what cannot be joined


SMALL = ImageRegion(ClipRectangle((5, 5), (20, 20)))
FAR_AWAY = moved(sweep(2, "b.mha"), "Reference", rigid(translation=(0.0, 3000.0, 0.0)))
UNLIKE = {
    "another reference": (
        sweep(2, "b.mha", configuration=replace(CONFIGURED, reference_frame="Tracker")),
        GeometryError,
        "a.mha would be placed in Reference, and b.mha in Tracker",
    ),
    "far away": (FAR_AWAY, GeometryError, r"a.mha and b.mha lie (29|30)\d\d mm apart, so they are not in one Reference"),
    "another size": (
        sweep(2, "b.mha", images=np.ones((6, 20, 40), np.uint8)),
        GeometryError,
        "a.mha and b.mha cannot enter one volume: images of 40 x 30 pixels, uint8 and of 40 x 20",
    ),
    "other parts": (
        sweep(2, "b.mha", configuration=replace(CONFIGURED, region=SMALL)),
        BeamGeometryError,
        "a.mha and b.mha name different parts",
    ),
}


@pytest.mark.parametrize(("second", "error", "words"), UNLIKE.values(), ids=UNLIKE)
def test_what_cannot_be_joined_is_refused_with_both_names(second, error, words):
    sweeps = [sweep(1, "a.mha"), second]
    with pytest.raises(error, match=words):
        reconstruct(sweeps)
    if second is FAR_AWAY:
        with pytest.raises(error, match=words):
            sweep_echoes(sweeps)
    if error is BeamGeometryError:
        assert reconstruct(sweeps, Recipe(**imaging_fields(SMALL))).frames_inserted == 12


# ---- from the command line


@pytest.fixture
def recordings(tmp_path, patient):
    """The patient's sweep, and a second one with a configuration of its own."""
    second, config = tmp_path / "second.igs.mha", tmp_path / "second.xml"
    write_sequence(tracked_sequence(seed=5), second)
    write_configuration(config)
    return [str(patient.sweep), str(second)], [str(patient.config), str(config)]


def test_the_command_line_joins_them_and_reports_on_each(recordings, results, capsys):
    (first, second), (config, other) = recordings
    output, report = results / "v.nrrd", results / "r.json"
    words = ["reconstruct", first, "--config", config, second, "--config", other, "-o", str(output), "--report", str(report)]
    assert main(words) == 0
    out = capsys.readouterr().out
    assert "average: 12 of 12 frames" in out
    assert "second.igs.mha: 6 of 6 frames" in out
    of_each = json.loads(report.read_text())["tracking"]
    assert [(one["sequence"], one["frames_used"]) for one in of_each] == [("sweep.igs.mha", 6), ("second.igs.mha", 6)]
    assert main(["reconstruct", second, first, "--config", config, "-q", "-o", str(results / "w.nrrd")]) == 0
    np.testing.assert_array_equal(read_volume(output).array, read_volume(results / "w.nrrd").array)


def test_a_volume_of_several_sweeps_is_measured_under_all_of_them(recordings, results, patient, capsys):
    sweeps, (config, _) = recordings
    output = str(results / "v.nrrd")
    assert main(["reconstruct", *sweeps, "--config", config, *patient.bone, "-o", output]) == 0
    labels = ["--bone", str(patient.labels), "--bone-transform", str(patient.transform)]
    assert main(["evaluate", output, *labels, "--sweep", *sweeps, "--config", config]) == 0
    assert "beams of the 12 frames met" in capsys.readouterr().out
