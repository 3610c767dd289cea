"""The study: its patients, its wrong CTs, its files and its page."""

from __future__ import annotations

import subprocess
import sys
from datetime import date
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import measured
import numpy as np
import pytest
from study import method_cases
from study.__main__ import STUDIES
from study.__main__ import main as start
from study.free_paths import canal_depth, lines_to_canal
from study.method_cases import PHANTOM, Row, patient_rows
from study.method_page import COLUMNS, in_the_pages
from study.paths_cases import FIXED, LISTS, NONE, PLANNED
from study.paths_cases import RIGHT as RIGHT_CT
from study.paths_cases import Row as PathRow
from study.paths_page import paths_page

from AIFReconLib.evaluation.surface import distance_from_labels
from AIFReconLib.geometry.volume import Volume, VoxelGrid

TESTING = Path(__file__).resolve().parents[2]
NAMES = [name for _, name, _ in COLUMNS]


def row(seed, method="average", value=1.0, condition="right CT", kind="real shapes"):
    return Row(seed, kind, condition, method, dict.fromkeys(NAMES, value))


@mock.patch.multiple(method_cases, SPACING=2.0, HOLE_LIMIT=4.0, MULTI_FRAMES=36, SINGLE_FRAMES=4, TISSUE_FRAMES=9, SHIFTS={})
def test_a_case_reconstructs_and_measures():
    rows = {(each.condition, each.method): each.metrics for each in patient_rows((PHANTOM, 2))}
    average, weighted = rows["right CT", "average"], rows["right CT", "weighted"]
    assert weighted["bone_cnr"] > 2 * average["bone_cnr"]
    assert weighted["oblique_cnr"] > average["oblique_cnr"]
    assert weighted["lines_called_free"] < average["lines_called_free"]
    assert rows["no bone at all", "weighted"]["bone_coverage"] < 0.2
    assert rows["CT one level off", "weighted"]["bone_coverage"] < weighted["bone_coverage"]


def test_lines_that_meet_bone_are_blocked_and_those_between_are_free():
    """Two plates with a gap between them, and a canal before a body."""
    grid = VoxelGrid.from_spacing((-30.0, 0.0, -30.0), (61, 81, 61), 1.0)
    array = np.zeros(grid.shape, np.uint8)
    array[10:25, 10:40] = array[36:51, 10:40] = 1
    array[:, 60:75] = 2
    labels = Volume(array, grid.ijk_to_reference)
    tips = np.array([[0.0, 10.0, 13.0], [0.0, 10.0, -13.0]])
    assert canal_depth(labels, tips) == pytest.approx(49.5, abs=1.5)
    back = SimpleNamespace(spinous_tips=lambda: tips, skin_y=lambda x, z: np.zeros(np.shape(x)))
    lines = lines_to_canal(back, labels, distance_from_labels(labels))
    assert 0.2 < lines.blocked.mean() < 0.95
    shown = Volume(np.where(array > 0, 250.0, 20.0).astype(np.float32), labels.ijk_to_reference)
    assert lines.told_by(-lines.brightest(shown))[1] < 0.02
    empty = Volume(np.full(grid.shape, 20.0, np.float32), labels.ijk_to_reference)
    assert lines.told_by(-lines.brightest(empty))[1] == 1.0


def test_a_study_of_a_method_that_is_not_there_is_one_line(tmp_path, capsys):
    assert start(["methods", "--output", str(tmp_path / "out"), "--method", "not_there:mine"]) == 2
    assert "there is no module not_there here" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", STUDIES)
def test_every_study_starts_from_its_folder(name):
    done = subprocess.run([sys.executable, TESTING / "study", name, "--help"], capture_output=True, text=True, check=False)
    assert (done.returncode, "--output DIR" in done.stdout) == (0, True), done.stderr


def test_what_the_pages_show_is_computed_from_the_rows():
    rows = [row(0, value=0.4), row(1, value=0.2), row(0, "weighted", 0.8), row(1, "weighted", 0.6), row(0, "weighted, no CT", 0.5)]
    rows += [row(0, "weighted", 0.5, "CT 3 mm off"), row(0, "weighted", 0.1, "one angle only")]
    rows += [row(0, "weighted", 0.3, kind="own phantom"), row(0, "weighted", 0.04, "no bone at all")]
    shown = in_the_pages(rows)
    assert shown["study-proof"] == (
        "In 2 simulated patients of real shape `weighted` shows 70% of the bone that beams reach, without a CT 50%, the plain average 30%."
    )
    assert "| weighted | 0.70 | 0.70 | 70 | 70 | 70 | 70 | 70 | 0.70 | 0.70 | 0.70 |" in shown["study-methods"].splitlines()
    assert "| weighted | 0.30 |" in shown["study-methods-phantom"]
    assert "| one angle only: weighted | 0.10 |" in shown["study-methods"]
    assert "| CT 3 mm off, weighted | 0.50 | 50 | 50 | 50 |" in shown["study-wrong-ct"].splitlines()
    assert "| weighted | 4 | - |" in shown["study-no-bone"] or "| weighted | - | 4 |" in shown["study-no-bone"]


def test_what_was_measured_stands_in_the_pages_that_mark_a_place(tmp_path, monkeypatch):
    page = tmp_path / "page.md"
    page.write_text("a\n<!-- measured: speed -->\nold\n<!-- end -->\nb\n", "utf-8")
    monkeypatch.setattr(measured, "FOLDER", tmp_path)
    monkeypatch.setattr(measured, "pages", lambda: [page])
    assert measured.keep({"speed": "| 1 |\n|---|"}, "make bench", "here") == [tmp_path / "speed.md", page]
    made = f"*`make bench`, {date.today().isoformat()}, here.*"
    assert page.read_text("utf-8") == f"a\n<!-- measured: speed -->\n| 1 |\n|---|\n\n{made}\n<!-- end -->\nb\n"


def test_the_table_of_free_paths_counts_what_was_seen_and_what_was_given():
    """Forty free lines of which half were seen, and sixty blocked ones of which a clearance lets three pass."""
    truth = [3.0] * 40 + [-1.0] * 60
    told = {
        "truth": truth,
        "reached": [1.0] * 100,
        "brightest": [50.0] * 40 + [200.0] * 60,
        "clearance": [1.5] * 40 + [1.5] * 3 + [-0.5] * 57,
        "with_ct": [1.5] * 40 + [-0.5] * 60,
        "seen": [1.0] * 20 + [0.5] * 20 + [1.0] * 60,
    }
    assert set(told) == set(LISTS)
    rows = [
        PathRow(0, scan, ct, method, 297, 0.1, True, True, 1.35, **told)
        for scan in (FIXED, PLANNED)
        for ct, method in ((NONE, "average"), (RIGHT_CT, "weighted"))
    ]
    lines = paths_page(rows).splitlines()
    assert lines[0].startswith("**Fixed scans** of 297 frames, 1 patients: 40 free lines and 60 blocked ones.")
    shares = "50.0% | 50.0% | 5.00% | 5.00% | 0.0% | 100.0% |"
    assert f"| `weighted`, right CT | 1.000 | 0.0% | 0.975 | 5.0% | 5.0% | {shares}" in lines
    assert "| the same, with the CT's bone | 1.000 | 0.0% | 1.000 | 0.0% | 0.0% | 50.0% | 50.0% | 0.00% | 0.00% | 0.0% | 100.0% |" in lines
