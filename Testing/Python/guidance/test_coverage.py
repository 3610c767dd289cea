"""`aifrecon coverage`: the shares of what was met, from points whose numbers are known, and the files that it writes."""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import pytest
from sweeps import places

from AIFReconLib.commands.parser import main
from AIFReconLib.evaluation.surface import BoneSurface
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.guidance.coverage import covered, share_of
from AIFReconLib.guidance.mesh import bone_mesh
from AIFReconLib.io.transform.files import read_transform
from AIFReconLib.io.volume.label_files import read_labels

SHARES = ("reachable_cm2", "met", "below_60_deg", "below_45_deg", "expected_visibility")


@pytest.fixture(scope="module")
def known():
    """Five points of 100, 100, 200, 100 and 100 mm2: two not met, the others at 70, 50 and 30 degrees."""
    best = np.cos(np.radians([np.nan, 70.0, 50.0, 30.0, np.nan]))
    surface = BoneSurface(np.zeros((5, 3)), np.zeros((5, 3)), np.array([100.0, 100.0, 200.0, 100.0, 100.0]), np.array([1, 1, 1, 2, 2]))

    class Bone(SimpleNamespace):
        def __len__(self):
            return 5

    names = {1: "L3", 2: "2"}
    bone = Bone(surface=surface, border=np.array([False, False, True, True, False]), name_of=names.get, is_of_ct=True)
    return SimpleNamespace(bone=bone, best_cosine=best, expected=np.array([0.0, 0.4, 0.8, 1.0, 0.0]))


def test_shares_are_of_area(known):
    share = share_of(known, np.ones(5, dtype=bool))
    assert (share.reachable_cm2, share.met, share.below_60_deg, share.below_45_deg) == pytest.approx((6.0, 4 / 6, 3 / 6, 1 / 6))
    assert share.expected_visibility == pytest.approx((0.4 + 2 * 0.8 + 1.0) / 6)


def test_the_report_has_all_borders_and_every_label(known):
    report = covered(known).to_dict()
    assert set(report) == {"all", "interspinous", "labels"}
    assert set(report["labels"]) == {"L3", "2"}
    assert all(set(part) == set(SHARES) for part in (report["all"], report["interspinous"], *report["labels"].values()))
    assert report["interspinous"]["met"] == 1.0
    assert report["labels"]["2"]["met"] == 0.5


def test_a_mesh_of_a_ball_is_closed_and_has_its_volume():
    grid = VoxelGrid.from_spacing((-12.0, -12.0, -12.0), (25, 25, 25), 1.0)
    turned = grid.ijk_to_reference @ np.diag([1.0, -1.0, 1.0, 1.0])
    mesh = bone_mesh(Volume(np.linalg.norm(places(grid), axis=-1) - 9.0, turned))
    a, b, c = (mesh.points_reference[mesh.triangles[:, n]] for n in range(3))
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6 == pytest.approx(4 / 3 * np.pi * 9**3, rel=0.03)
    edges = np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]])
    assert {tuple(edge) for edge in edges} == {tuple(edge[::-1]) for edge in edges}


def test_the_command_prints_a_table_and_writes_report_and_surface_which_vtk_opens_where_the_bone_is(patient, results, capsys):
    report, surface = results / "coverage.json", results / "met.vtp"
    options = ["--bone-labels", str(patient.labels), "--bone-transform", str(patient.transform), "--config", str(patient.config)]
    assert main(["coverage", str(patient.sweep), *options, "--report", str(report), "--surface", str(surface)]) == 0
    said = capsys.readouterr().out
    assert "below 45 deg" in said
    assert f"wrote {surface}" in said
    written = json.loads(report.read_text("utf-8"))
    assert written["all"]["reachable_cm2"] > 0.5
    assert written["all"]["met"] >= written["all"]["below_60_deg"] >= written["all"]["below_45_deg"] >= 0
    vtk = pytest.importorskip("vtk", reason="VTK is not installed")
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(surface))
    reader.Update()
    output = reader.GetOutput()
    names = {output.GetPointData().GetArrayName(n) for n in range(output.GetPointData().GetNumberOfArrays())}
    assert {"best_cosine", "frames"} <= names
    low, high = np.array(output.GetBounds()).reshape(3, 2).T
    labels = read_labels(patient.labels)
    middle = np.argwhere(labels.array > 0).mean(axis=0)[::-1]
    center = transform_points(read_transform(patient.transform) @ labels.ijk_to_reference, middle)
    np.testing.assert_allclose((low + high) / 2, center, atol=0.5)
