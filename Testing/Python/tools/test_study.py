"""The study: its patients, its wrong CTs, its files and its page."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import asdict
from datetime import date
from pathlib import Path

import numpy as np
import pytest

from AIFReconLib.errors import FileFormatError
from AIFReconLib.simulation.anatomy import LumbarAnatomy, make_lumbar_phantom
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import multi_angle_sweep

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import measured
from study import method_cases
from study.__main__ import STUDIES
from study.__main__ import main as start
from study.method_cases import Row, patient_rows, without_middle_process
from study.method_page import COLUMNS, in_the_pages
from study.patients import read_rows, run_study

TESTING = Path(__file__).resolve().parents[2]
NAMES = [name for _, name, _ in COLUMNS]


@pytest.fixture(scope="module")
def phantom():
    return make_lumbar_phantom(LumbarAnatomy.from_seed(2))


@pytest.fixture(scope="module")
def scan(phantom):
    return method_cases.simulated_scan(phantom, PhasedArray(), multi_angle_sweep(phantom, 36), seed=2)


def row(seed, method="average", value=1.0, scan="multi-angle", condition="exact", direction=""):
    return Row(seed, scan, condition, method, direction, dict.fromkeys(NAMES, value))


def test_taking_the_middle_process_away_takes_hardly_any_other_bone(phantom):
    gone = (phantom.labels.array > 0) & (without_middle_process(phantom).labels.array == 0)
    assert (phantom.labels.array[gone] == 2).mean() > 0.9
    k, j, i = np.nonzero(gone)
    points = np.stack([i, j, k], axis=1) @ phantom.labels.ijk_to_reference[:3, :3].T + phantom.labels.ijk_to_reference[:3, 3]
    extent = np.ptp(points, axis=0)
    assert 22 < extent[1] < 36, "a spinous process is about 30 mm long"
    assert gone.sum() > 2000


def test_the_phantom_without_its_process_has_the_same_bone_in_ct_and_ultrasound(phantom):
    without = without_middle_process(phantom)
    np.testing.assert_array_equal(without.bone_distance.array <= 0, without.labels.array > 0)


def test_a_case_reconstructs_and_measures(phantom, scan, monkeypatch):
    monkeypatch.setattr(method_cases, "SPACING", 2.0)
    monkeypatch.setattr(method_cases, "HOLE_LIMIT", 4.0)
    average, weighted = (
        method_cases._row(2, "multi-angle", "exact", method, scan, phantom.labels).metrics for method in ("average", "weighted")
    )
    assert weighted["bone_cnr"] > average["bone_cnr"]
    assert weighted["oblique_cnr"] > average["oblique_cnr"]


def test_a_study_of_a_method_that_is_not_there_is_one_line(tmp_path, capsys):
    assert start(["methods", "--output", str(tmp_path / "out"), "--method", "not_there:mine"]) == 2
    assert "there is no module not_there here" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_finished_study_is_read_and_not_run_again(tmp_path):
    rows = [row(0), row(0, "weighted", 2.0, direction="gradient")]
    (tmp_path / "patient-000.json").write_text(json.dumps([asdict(r) for r in rows]))
    assert run_study(patient_rows, Row, tmp_path, [0]) == rows


def test_a_spoiled_result_is_named(tmp_path):
    path = tmp_path / "patient-000.json"
    path.write_text("[{]")
    with pytest.raises(FileFormatError, match=r"patient-000\.json"):
        read_rows(path, Row)


def rows_in_another_process(seed):
    return [row(seed, value=float(seed))]


def test_the_rows_of_every_patient_are_made_in_processes_of_their_own(tmp_path):
    made = run_study(rows_in_another_process, Row, tmp_path, [3, 5])
    assert [(each.seed, each.metrics[NAMES[0]]) for each in made] == [(3, 3.0), (5, 5.0)]


@pytest.mark.parametrize("name", STUDIES)
def test_every_study_starts_from_its_folder(name):
    done = subprocess.run([sys.executable, TESTING / "study", name, "--help"], capture_output=True, text=True, check=False)
    assert (done.returncode, "--output DIR" in done.stdout) == (0, True), done.stderr


def test_what_the_pages_show_is_computed_from_the_rows():
    rows = [
        row(0, value=0.4),
        row(1, value=0.2),
        row(0, "weighted", 0.8, direction="gradient"),
        row(1, "weighted", 0.6, direction="gradient"),
    ]
    rows += [
        row(0, "weighted", 0.5, condition="CT 2 mm off", direction="gradient"),
        row(0, "weighted", 0.1, "single-angle", "exact", "gradient"),
    ]
    shown = in_the_pages(rows)
    assert shown["study-proof"] == "On 2 simulated patients `weighted` shows 70% of the bone that beams reach, the plain average 30%."
    assert "| weighted | 0.70 | 0.70 | 70 | 70 | 70 | 0.70 | 0.70 | 0.70 |" in shown["study-methods"].splitlines()
    assert "| one angle only: weighted | 0.10 |" in shown["study-methods"]
    assert "| CT 2 mm off | 0.50 | 0.50 | 50 | 50 | 50 |" in shown["study-wrong-ct"].splitlines()


def test_what_was_measured_stands_in_the_pages_that_mark_a_place(tmp_path, monkeypatch):
    page = tmp_path / "page.md"
    page.write_text("a\n<!-- measured: speed -->\nold\n<!-- end -->\nb\n", "utf-8")
    monkeypatch.setattr(measured, "FOLDER", tmp_path)
    monkeypatch.setattr(measured, "pages", lambda: [page])
    assert measured.keep({"speed": "| 1 |\n|---|"}, "make bench", "here") == [tmp_path / "speed.md", page]
    made = f"*`make bench`, {date.today().isoformat()}, here.*"
    assert page.read_text("utf-8") == f"a\n<!-- measured: speed -->\n| 1 |\n|---|\n\n{made}\n<!-- end -->\nb\n"
