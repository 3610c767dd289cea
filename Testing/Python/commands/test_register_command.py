"""`aifrecon register` and what `reconstruct` says of a registration, on a small simulated patient."""

from __future__ import annotations

import csv
import json
import shlex
from dataclasses import replace

import numpy as np
import pytest

from AIFReconLib.batch.case import TRANSFORM, carry_out
from AIFReconLib.batch.records import RECORDS
from AIFReconLib.batch.table import read_cases
from AIFReconLib.commands.parser import main
from AIFReconLib.errors import DisagreementWarning, DoubtfulInputWarning
from AIFReconLib.evaluation.metrics import evaluate
from AIFReconLib.evaluation.quantities import OTHER_BONE, OWN_BONE
from AIFReconLib.geometry.transforms import LPS_FROM_RAS, transform_points
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.transform.files import read_transform, write_transform
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.io.volume.label_files import read_labels
from AIFReconLib.io.volume.models import read_model
from AIFReconLib.provenance.settings_files import read_settings
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.simulation.scan import random_rigid
from AIFReconLib.workflows.simulate import write_simulated_patient


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
    placed = [word for name in ("placed.nrrd", "placed.vtp") for word in ("--labels-output", folder / name)]
    start = ("--bone-transform", folder / "rough.tfm", "--report", folder / "report.json")
    assert command(patient, folder / "found.tfm", *start, *placed) == 0
    return folder


def test_the_transform_is_the_true_one(patient, done):
    found, truth = read_transform(done / "found.tfm"), read_transform(patient.ct_to_reference)
    off = (found @ np.linalg.inv(truth)) @ np.append(patient.center_ras, 1.0) - np.append(patient.center_ras, 1.0)
    assert np.linalg.norm(off) < 0.5
    report = json.loads((done / "report.json").read_text())
    assert {"agreement", "median_distance_mm", "echoes", "uncertain", "alternatives", "per_label"} <= set(report)
    assert report["accepted"] is True
    np.testing.assert_allclose(report["transform"], found, atol=1e-6)


def test_placed_labels_and_their_surface_lie_where_the_transform_puts_them(patient, done):
    placed, labels = read_labels(done / "placed.nrrd"), read_labels(patient.labels)
    expected = labels.placed_by(read_transform(done / "found.tfm"))
    np.testing.assert_allclose(placed.ijk_to_reference, expected.ijk_to_reference, atol=1e-4)
    np.testing.assert_array_equal(placed.array, labels.array)
    surface = read_model(done / "placed.vtp").points
    points = transform_points(placed.ijk_to_reference, np.argwhere(placed.array > 0)[:, ::-1].astype(float))
    np.testing.assert_allclose([surface.min(0), surface.max(0)], [points.min(0), points.max(0)], atol=1.0)


def test_a_case_of_a_batch_is_registered_to_the_same_transform(patient, done, tmp_path):
    head = "case,sweeps,config,bone_labels,bone_transform,register,method,spacing,preview"
    files = (patient.sequence, patient.configuration, patient.labels, done / "rough.tfm")
    (tmp_path / "cases.csv").write_text(f"{head}\nP1,{','.join(map(str, files))},yes,average,3,no\n")
    (tmp_path / RECORDS).mkdir()
    (case,) = read_cases(tmp_path / "cases.csv").cases
    record = carry_out(case, tmp_path)
    assert (tmp_path / "P1" / TRANSFORM).read_bytes() == (done / "found.tfm").read_bytes()
    assert record.results[0]["registration_agreement"] > 0.5
    assert 0 < record.results[0]["sweep_met"] < 1


def test_the_report_says_of_the_calibration_what_info_says_with_the_transform_that_was_found(patient, done, capsys):
    told = json.loads((done / "report.json").read_text())["calibration"]
    words = [patient.sequence, "--config", patient.configuration, "--bone-labels", patient.labels, "--bone-transform", done / "found.tfm"]
    assert main(["info", *map(str, words)]) == 0
    assert "\n".join(told) in capsys.readouterr().out
    assert told[0].startswith("Calibration: agrees with this sweep within ")


def test_a_surface_without_vtk_is_refused_before_any_work(patient, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("AIFReconLib.io.volume.surfaces.find_spec", lambda name: None)
    assert command(patient, tmp_path / "found.tfm", "--labels-output", tmp_path / "placed.vtp") == 2
    assert capsys.readouterr().err.endswith("placed.vtp: surfaces need VTK. Install it with: pip install vtk\n")
    assert list(tmp_path.iterdir()) == []


def test_a_start_that_leads_nowhere_is_exit_code_1_and_one_line_and_no_file(patient, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("AIFReconLib.workflows.register.checked", None)  # not asked for
    far, output = tmp_path / "far.tfm", tmp_path / "found.tfm"
    matrix = np.eye(4)
    matrix[:3, 3] = 800.0
    write_transform(matrix, far)
    assert command(patient, output, "--bone-transform", far, "--report", tmp_path / "report.json") == 1
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert "No transform is written" in message
    assert not output.exists()
    report = json.loads((tmp_path / "report.json").read_text())
    assert (report["accepted"], report["calibration"]) == (False, [])


@pytest.mark.parametrize(
    ("transform", "words", "then"),
    [
        ("right", "CT and sweep agree", "The echoes lie up to 1 mm off the CT's bone"),
        ("wrong", "WARNING", "Bone is taken from the sweep's own echoes, as the CT does not lie on them."),
    ],
)
def test_reconstruct_says_whether_ct_and_sweep_agree_and_where_bone_is_taken_from(transform, words, then, patient, tmp_path, capsys):
    write_transform(np.eye(4), tmp_path / "wrong.tfm")
    registration = patient.ct_to_reference if transform == "right" else tmp_path / "wrong.tfm"
    inputs = [patient.sequence, "--config", patient.configuration, "--bone-labels", patient.labels, "--bone-transform", registration]
    assert main(["reconstruct", *map(str, inputs), "--spacing", "3", "--output", str(tmp_path / "v.nrrd")]) == 0
    said = capsys.readouterr().out
    assert words in said
    assert then in said
    width = read_settings(tmp_path / "v.nrrd").options["bone_sigma_mm"]
    assert width == (1.0 if transform == "right" else "auto"), "the volume says how it is made again"


def test_images_that_are_out_of_step_are_told_without_a_ct(tmp_path):
    patient = write_simulated_patient(tmp_path, 0, "multi-angle", 54)
    sequence, recipe = (
        read_sequence(patient.sequence, config=patient.configuration),
        Recipe(method="weighted", bone_from_sweep=True, spacing=3.0),
    )
    assert any(line.startswith("Calibration: not checked") for line in reconstruct(sequence, recipe).messages)
    late = replace(sequence, images=np.roll(np.stack([sequence.images[n] for n in range(len(sequence))]), 1, axis=0))
    with pytest.warns(DoubtfulInputWarning, match="Echoes of different angles lie .* Images and poses may be out of step"):
        reconstruct(late, recipe)


def test_a_batch_says_which_case_s_ct_does_not_lie_on_the_sweep(patient, tmp_path, capsys):
    write_transform(np.eye(4), tmp_path / "wrong.tfm")
    files = [f"{patient.sequence},{patient.configuration},{patient.labels},{place}" for place in (patient.ct_to_reference, "wrong.tfm")]
    rows = [f"{case},{of_case},average;weighted,3,no" for case, of_case in zip(("right", "wrong"), files, strict=True)]
    (tmp_path / "cases.csv").write_text("\n".join(["case,sweeps,config,bone_labels,bone_transform,method,spacing,preview", *rows]))
    assert main(["batch", str(tmp_path / "cases.csv"), "--output", str(tmp_path / "results"), "--workers", "1"]) == 0
    said = capsys.readouterr().out
    assert "  wrong: CT and sweep do not agree" in said
    assert "  right: " not in said
    assert "doubtful" in (tmp_path / "results" / "index.html").read_text("utf-8").partition("</style>")[2]
    assert main(["evaluate", str(tmp_path / "results" / "results.csv")]) == 0
    assert "  wrong: CT and sweep do not agree" in capsys.readouterr().out
    with (tmp_path / "results" / "results.csv").open(encoding="utf-8") as file:
        found = {(row["case"], row["method"]): row for row in csv.DictReader(file)}
    assert all("WARNING: The CT is probably not where the bone is" in found["wrong", method]["notes"] for method in ("average", "weighted"))
    assert float(found["right", "average"]["registration_agreement"]) > 0.9 > float(found["wrong", "average"]["registration_agreement"])
    assert [found[case, "weighted"]["yardstick"] for case in ("right", "wrong")] == [OWN_BONE, OTHER_BONE], "its own echoes weighted it"


# ---- one's own data: the same patient's bone in other forms


def reconstructed(patient, output, *options) -> int:
    words = [patient.sequence, "--config", patient.configuration, "--bone-transform", patient.ct_to_reference, "--spacing", "2", *options]
    return main(["reconstruct", *map(str, words), "--output", str(output)])


@pytest.fixture(scope="module")
def exact(patient, tmp_path_factory):
    """The volume that the labels make."""
    path = tmp_path_factory.mktemp("exact") / "volume.nrrd"
    assert reconstructed(patient, path, "--bone-labels", patient.labels) == 0
    return read_volume(path)


def test_a_ct_alone_enhances_bone_and_says_its_threshold(patient, exact, tmp_path, capsys):
    assert reconstructed(patient, tmp_path / "volume.nrrd", "--ct", patient.ct) == 0
    said = capsys.readouterr().out
    assert said.startswith("weighted: ")
    assert " HU, found in the CT." in said
    assert "CT and sweep agree" in said
    found = read_volume(tmp_path / "volume.nrrd")
    off = np.abs(found.array.astype(float) - exact.array)
    assert off.mean() < 1.0


def test_info_gives_the_way_from_a_ct_that_is_not_registered_to_the_volume(patient, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    given = [str(patient.sequence), "--config", str(patient.configuration), "--bone-labels", str(patient.labels)]
    assert main(["info", *given, "--json"]) == 0
    plan = json.loads(capsys.readouterr().out)["plan"]
    assert any("CT and sweep do not agree" in line for line in plan["bone"])
    first = shlex.split(plan["first"][0])
    assert main(first[first.index("register") :]) == 0
    said = capsys.readouterr().out
    then = shlex.split(plan["command"])
    assert f"next: {plan['command']}" in said
    assert main([*then[then.index("reconstruct") :], "--spacing", "2"]) == 0
    assert "CT and sweep agree" in capsys.readouterr().out
    assert main(["info", *given, "--bone-transform", "CTToReference.tfm", "--json"]) == 0
    plan = json.loads(capsys.readouterr().out)["plan"]
    assert plan["first"] == []
    assert any(line.startswith("Calibration: agrees with this sweep within 0.") for line in plan["bone"])


def test_in_python_a_ct_that_does_not_agree_is_warned_about(patient):
    sequence, labels = read_sequence(patient.sequence, patient.configuration), read_labels(patient.labels)
    aside = read_transform(patient.ct_to_reference).copy()
    aside[:3, 3] += 15.0, 6.0, 0.0
    with pytest.warns(DisagreementWarning, match="do not agree"):
        result = reconstruct(sequence, Recipe(spacing=4.0), LabeledBone(labels, aside))
    with pytest.warns(DisagreementWarning, match="do not agree"):
        evaluate(result.intensity, labels.placed_by(aside), result.mask, sweep=sequence)


def test_a_model_that_does_not_say_its_space_is_placed_as_the_sweep_tells(patient):
    labels, place = read_labels(patient.labels), read_transform(patient.ct_to_reference)
    # In Reference, as a model in RAS is read that is taken for LPS
    taken = replace(labels.placed_by(place), ijk_to_reference=LPS_FROM_RAS @ place @ labels.ijk_to_reference, space_is_guessed=True)
    bone = LabeledBone(replace(taken, notes=("It is a guess.",)), None, read_sequence(patient.sequence, patient.configuration))
    assert "taken to be in RAS" in bone.labels.notes[-1]
    np.testing.assert_allclose(bone.labels.ijk_to_reference, place @ labels.ijk_to_reference, atol=1e-9)
