"""`aifrecon register` and what `reconstruct` says of a registration, on a small simulated patient."""

from __future__ import annotations

import json
from importlib.util import find_spec

import numpy as np
import pytest

from AIFReconLib.batch.case import TRANSFORM, Task, carry_out
from AIFReconLib.batch.records import RECORDS
from AIFReconLib.batch.table import read_cases
from AIFReconLib.commands.parser import main
from AIFReconLib.commands.simulate import write_simulated_patient
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.io.transform.files import read_transform, write_transform
from AIFReconLib.io.volume.label_files import read_labels
from AIFReconLib.provenance.settings_files import read_settings
from AIFReconLib.simulation.scan import random_rigid


@pytest.fixture(scope="module")
def patient(tmp_path_factory):
    return write_simulated_patient(tmp_path_factory.mktemp("patient"), 0, "multi-angle", 36)


def command(patient, output, *options) -> int:
    words = [patient.sequence, "--config", patient.configuration, "--bone-labels", patient.labels, "--output", output, *options]
    return main(["register", *map(str, words)])


@pytest.fixture(scope="module")
def done(patient, tmp_path_factory):
    """A registration from 8 mm and 6 degrees off: its folder."""
    folder = tmp_path_factory.mktemp("done")
    rough = random_rigid(8.0, 6.0, np.random.default_rng(0), about=patient.center_ras) @ read_transform(patient.ct_to_reference)
    write_transform(rough, folder / "rough.tfm")
    options = ("--bone-transform", folder / "rough.tfm", "--report", folder / "report.json", *("--labels-output", folder / "placed.nrrd"))
    if find_spec("vtkmodules"):
        options = (*options, "--labels-output", folder / "placed.vtp")
    assert command(patient, folder / "found.tfm", *options) == 0
    return folder


def test_the_transform_is_the_true_one(patient, done):
    found, truth = read_transform(done / "found.tfm"), read_transform(patient.ct_to_reference)
    off = (found @ np.linalg.inv(truth)) @ np.append(patient.center_ras, 1.0) - np.append(patient.center_ras, 1.0)
    assert np.linalg.norm(off) < 0.5


def test_a_case_of_a_batch_is_registered_to_the_same_transform(patient, done, tmp_path):
    head = "case,sweeps,config,bone_labels,bone_transform,register,method,spacing,preview"
    files = (patient.sequence, patient.configuration, patient.labels, done / "rough.tfm")
    (tmp_path / "cases.csv").write_text(f"{head}\nP1,{','.join(map(str, files))},yes,average,3,no\n")
    (tmp_path / RECORDS).mkdir()
    (case,) = read_cases(tmp_path / "cases.csv").cases
    record = carry_out(Task(case, tmp_path, tmp_path, "now"))
    assert (tmp_path / "P1" / TRANSFORM).read_bytes() == (done / "found.tfm").read_bytes()
    assert record.results[0]["registration_agreement"] > 0.5
    assert 0 < record.results[0]["sweep_met"] < 1


def test_the_report_has_what_it_promises(done):
    report = json.loads((done / "report.json").read_text())
    assert {"accepted", "agreement", "median_distance_mm", "echoes", "transform", "uncertain", "alternatives", "per_label"} <= set(report)
    assert report["accepted"] is True
    assert 0.7 < report["agreement"] <= 1.0
    np.testing.assert_allclose(report["transform"], read_transform(done / "found.tfm"), atol=1e-6)


def test_placed_labels_lie_where_the_transform_puts_them(patient, done):
    placed, labels = read_labels(done / "placed.nrrd"), read_labels(patient.labels)
    expected = labels.placed_by(read_transform(done / "found.tfm"))
    np.testing.assert_allclose(placed.ijk_to_reference, expected.ijk_to_reference, atol=1e-4)
    np.testing.assert_array_equal(placed.array, labels.array)


def test_a_surface_without_vtk_is_refused_before_any_work(patient, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("AIFReconLib.io.volume.surfaces.find_spec", lambda name: None)
    assert command(patient, tmp_path / "found.tfm", "--labels-output", tmp_path / "placed.vtp") == 2
    assert capsys.readouterr().err.endswith("placed.vtp: the surface of labels needs VTK. Install it with: pip install vtk\n")
    assert list(tmp_path.iterdir()) == []


def test_the_surface_lies_around_the_placed_labels(done):
    reader = pytest.importorskip("vtkmodules.vtkIOXML", reason="VTK is not installed").vtkXMLPolyDataReader()
    reader.SetFileName(str(done / "placed.vtp"))
    reader.Update()
    placed = read_labels(done / "placed.nrrd")
    points = transform_points(placed.ijk_to_reference, np.argwhere(placed.array > 0)[:, ::-1].astype(float))
    bounds = np.reshape(reader.GetOutput().GetBounds(), (3, 2))
    np.testing.assert_allclose(bounds[:, 0], points.min(0), atol=1.0)
    np.testing.assert_allclose(bounds[:, 1], points.max(0), atol=1.0)


def test_a_start_that_leads_nowhere_is_exit_code_1_and_one_line_and_no_file(patient, tmp_path, capsys):
    far, output = tmp_path / "far.tfm", tmp_path / "found.tfm"
    matrix = np.eye(4)
    matrix[:3, 3] = 800.0
    write_transform(matrix, far)
    assert command(patient, output, "--bone-transform", far, "--report", tmp_path / "report.json") == 1
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert "No transform is written" in message
    assert not output.exists()
    assert json.loads((tmp_path / "report.json").read_text())["accepted"] is False


def test_a_start_that_scales_is_exit_code_2_and_leaves_nothing(patient, tmp_path, capsys):
    write_transform(np.diag([1.1, 1.1, 1.1, 1.0]), tmp_path / "scaled.tfm")
    assert command(patient, tmp_path / "found.tfm", "--bone-transform", tmp_path / "scaled.tfm") == 2
    assert "rigid" in capsys.readouterr().err
    assert not (tmp_path / "found.tfm").exists()


@pytest.mark.parametrize(("transform", "words", "widths"), [("right", "CT and sweep agree", (1.5, 2.5)), ("wrong", "WARNING", (4.0, 6.0))])
def test_reconstruct_says_whether_ct_and_sweep_agree_and_believes_it_as_far(transform, words, widths, patient, tmp_path, capsys):
    write_transform(np.eye(4), tmp_path / "wrong.tfm")
    registration = patient.ct_to_reference if transform == "right" else tmp_path / "wrong.tfm"
    inputs = [patient.sequence, "--config", patient.configuration, "--bone-labels", patient.labels, "--bone-transform", registration]
    assert main(["reconstruct", *map(str, inputs), "--spacing", "3", "--output", str(tmp_path / "v.nrrd")]) == 0
    said = capsys.readouterr().out
    width = read_settings(tmp_path / "v.nrrd").options["bone_sigma_mm"]
    assert words in said
    assert f"Tolerance around the CT's bone: {width:g} mm" in said
    assert widths[0] <= width <= widths[1]
