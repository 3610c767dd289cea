"""`aifrecon calibrate`, and what `aifrecon convert` mends, on a small simulated patient."""

from __future__ import annotations

import json

import numpy as np
import pytest

from AIFReconLib.calibration import crossing, mending
from AIFReconLib.commands.parser import main
from AIFReconLib.geometry.transform_graph import TransformName
from AIFReconLib.io.plus.calibration import write_calibrated
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.transform.files import read_transform, write_transform
from AIFReconLib.simulation.scan import random_rigid
from AIFReconLib.sweep.poses import sweep_poses
from AIFReconLib.workflows.simulate import write_simulated_patient

IMAGE_TO_PROBE = TransformName("Image", "Probe")


@pytest.fixture(scope="module")
def patient(tmp_path_factory):
    return write_simulated_patient(tmp_path_factory.mktemp("patient"), 0, "multi-angle", 72)


@pytest.fixture(scope="module")
def wrong(patient):
    """A configuration whose calibration is 4 mm, 2.5 degrees and 2% off."""
    true = read_plus_configuration(patient.configuration).transforms[IMAGE_TO_PROBE].matrix
    off = random_rigid(4.0, 2.5, np.random.default_rng(1), true[:3, 3])
    path = patient.configuration.parent / "Wrong.xml"
    write_calibrated(patient.configuration, path, IMAGE_TO_PROBE, off @ true @ np.diag([1.02, 0.98, 1.0, 1.0]), "made wrong")
    return path


def calibrate(patient, config, *options) -> int:
    start = ("--bone-transform", patient.ct_to_reference)
    words = [patient.sequence, "--config", config, "--bone-labels", patient.labels, *start, *options]
    return main(["calibrate", *map(str, words)])


@pytest.fixture(scope="module")
def done(patient, wrong):
    """The folder of a calibration that was made."""
    folder = patient.configuration.parent
    outputs = ("--output", folder / "New.xml", "--report", folder / "new.json", "--preview", folder / "new.png")
    assert calibrate(patient, wrong, *outputs) == 0
    return folder


def corners(path, config) -> np.ndarray:
    """Where the corners of the sweep's images lie, mm."""
    poses = sweep_poses(read_sequence(path, config=config)).image_to_reference
    return poses[:, :3] @ np.array([(40, 40, 0, 1), (200, 40, 0, 1), (40, 240, 0, 1), (200, 240, 0, 1)], dtype=float).T


def test_the_new_configuration_places_images_where_they_are(patient, wrong, done):
    truth = read_transform(patient.ct_to_reference)
    found = np.array(json.loads((done / "new.json").read_text())["transform"])

    def on_bone(points, labels_to_reference):
        back = np.linalg.inv(labels_to_reference)
        return np.einsum("ij,njk->nik", back[:3, :3], points) + back[:3, 3:]

    true = on_bone(corners(patient.sequence, patient.configuration), truth)
    off = np.linalg.norm(on_bone(corners(patient.sequence, done / "New.xml"), found) - true, axis=1)
    was = np.linalg.norm(on_bone(corners(patient.sequence, wrong), truth) - true, axis=1)
    assert np.median(was) > 1.5
    assert np.median(off) < 0.6


@pytest.mark.parametrize("sure", [True, False])
def test_without_a_ct_crossing_frames_calibrate(patient, wrong, tmp_path, capsys, monkeypatch, sure):
    """Eight frames an angle are too few to be sure; what is written is another test's business than how sure that is."""
    new, report = tmp_path / "New.xml", tmp_path / "new.json"
    if sure:
        monkeypatch.setattr(crossing, "GAIN", 1.0)
        monkeypatch.setattr(mending, "HALVES_APART", 5.0)
    words = [patient.sequence, "--config", wrong, "--output", new, "--report", report, "--preview", tmp_path / "new.png"]
    assert main(["calibrate", *map(str, words)]) == (not sure)
    said = capsys.readouterr()
    assert "without a CT" in said.out
    between = json.loads(report.read_text())["between_angles_mm"]
    assert between["after"] < 0.7 * between["before"]
    assert new.exists() is sure
    assert ("No calibration is written" in said.err) is not sure


def test_every_other_byte_stays_and_the_old_calibration_is_beside(wrong, done):
    before, after = wrong.read_bytes(), (done / "New.xml").read_bytes()
    old = b" ".join(before.split(b'Matrix="')[1].split(b'"')[0].split())
    assert old in after
    head, tail = before.split(b'Matrix="')[0], before.split(b"</CoordinateDefinitions>")[1]
    assert after.startswith(head + b'Matrix="')
    assert after.endswith(tail)


def test_mirrored_images_are_told_without_a_ct_and_mended(patient, tmp_path, capsys):
    mirrored, mended = tmp_path / "mirrored.igs.mha", tmp_path / "mended.igs.mha"
    words = ["--config", str(patient.configuration)]
    assert main(["convert", str(patient.sequence), str(mirrored), "--mirror"]) == 0
    capsys.readouterr()
    assert main(["calibrate", str(mirrored), *words, "--check"]) == 0
    assert "the images look mirrored" in (said := capsys.readouterr().out)
    assert "aifrecon convert --mirror" in said
    assert main(["convert", str(mirrored), str(mended), "--mirror"]) == 0
    assert np.array_equal(np.asarray(read_sequence(mended).images), np.asarray(read_sequence(patient.sequence).images))


def test_an_inverse_that_was_recorded_is_turned_back(patient, tmp_path):
    there, back = tmp_path / "there.igs.mha", tmp_path / "back.igs.mha"
    assert main(["convert", str(patient.sequence), str(there), "--invert", "ProbeToTracker"]) == 0
    assert main(["convert", str(there), str(back), "--invert", "ProbeToTracker"]) == 0
    name = TransformName("Probe", "Tracker")
    first, turned, again = (read_sequence(path).records[3].transforms[name].matrix for path in (patient.sequence, there, back))
    assert turned @ first == pytest.approx(np.eye(4), abs=1e-3)
    assert again == pytest.approx(first, abs=1e-3)


def test_a_correction_moves_the_image_plane_whatever_its_third_column_was(patient, tmp_path):
    out = tmp_path / "corrected.igs.mha"
    step = np.eye(4)
    step[2, 3] = 2.0  # mm out of the image
    write_transform(step, tmp_path / "step.tfm")
    config = str(patient.configuration)
    assert main(["convert", str(patient.sequence), str(out), "--config", config, "--correction", str(tmp_path / "step.tfm")]) == 0
    before, after = corners(patient.sequence, patient.configuration), corners(out, None)
    moved = after - before
    assert np.linalg.norm(moved, axis=1) == pytest.approx(2.0, abs=1e-3)
    assert np.einsum("nik,ni->nk", moved, before[:, :, 1] - before[:, :, 0]) == pytest.approx(0.0, abs=0.1)


def test_pixels_are_scaled_about_the_first(patient, tmp_path):
    out = tmp_path / "scaled.igs.mha"
    words = ["--config", str(patient.configuration), "--scale", "1", "1.02"]
    assert main(["convert", str(patient.sequence), str(out), *words]) == 0
    before, after = (
        sweep_poses(read_sequence(path, config=config)).image_to_reference
        for path, config in ((patient.sequence, patient.configuration), (out, None))
    )
    assert np.linalg.norm(after[:, :3, 1], axis=1) == pytest.approx(1.02 * np.linalg.norm(before[:, :3, 1], axis=1), rel=1e-4)
    assert after[:, :3, [0, 3]] == pytest.approx(before[:, :3, [0, 3]], abs=1e-3)


def test_sweeps_of_two_depths_are_refused(patient, tmp_path, capsys):
    deeper = tmp_path / "deeper.igs.mha"
    config = str(patient.configuration)
    assert main(["convert", str(patient.sequence), str(deeper), "--config", config, "--scale", "1.2", "1.2"]) == 0
    words = [patient.sequence, deeper, "--config", config, "--bone-labels", patient.labels, "--output", tmp_path / "c.tfm"]
    assert main(["calibrate", *map(str, words)]) == 2
    assert "pixels of one size" in capsys.readouterr().err
    assert not (tmp_path / "c.tfm").exists()
