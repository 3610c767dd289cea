"""The study on real bone: its measures on volumes whose numbers are known without computing, its cases, its page."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from study.real_bone import main
from study.real_bone_measures import by_incidence, false_bone, precision
from sweeps import rigid

from AIFReconLib.evaluation.visibility import bone_truth
from AIFReconLib.geometry.volume import Volume, VoxelGrid

GRID = VoxelGrid.from_spacing((0.0, 0.0, 0.0), (24, 24, 40), 1.0)
TOP = 20
"""The first plane of voxels that is bone; its surface is half a voxel before, and faces lower k."""


@pytest.fixture(scope="module")
def truth():
    labels = np.zeros(GRID.shape, np.uint8)
    labels[TOP:] = 1
    flat = bone_truth(Volume(labels, GRID.ijk_to_reference))
    return replace(flat, best_cosine=np.where(flat.surface.points_reference[:, 0] < 11.5, 1.0, np.cos(np.radians(50.0))))


def volume(**planes):
    gray = np.full(GRID.shape, 40, np.uint8)
    for plane, level in planes.items():
        gray[int(plane[1:])] = level
    return Volume(gray, GRID.ijk_to_reference)


def test_precision_tells_bright_voxels_on_the_surface_from_those_inside_and_outside(truth):
    found = precision(volume(k19=200, k20=200, k24=200, k14=200), truth)
    assert [found[f"{name}_180"] for name in ("precision", "inside", "outside")] == [0.5, 0.25, 0.25]
    assert found["shown_180"] == pytest.approx(1.0)


def test_a_line_where_the_misplaced_ct_expects_bone_is_false_bone(truth):
    found = false_bone(volume(k13=255), truth, rigid(translation=(0.0, 0.0, -6.0)))
    assert found["false_bone"] == 1.0
    assert found["false_area"] == pytest.approx(truth.surface.areas.sum())


def test_bone_counts_at_its_own_angle_of_incidence(truth):
    gray = volume(k19=40).array.copy()
    gray[:, :, ::2] += 10
    gray[19:21, :, 13:] = 250
    found = by_incidence(Volume(gray, GRID.ijk_to_reference), truth, volume(k0=1))
    assert found["bone_coverage_0"] == 0.0
    assert found["bone_coverage_45"] > 0.8
    assert found["bone_area_15"] != found["bone_area_15"], "there is none"


def test_without_the_recording_one_sentence_says_what_to_do(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("AIFRECON_DATA_DIR", str(tmp_path))
    assert main(["--output", str(tmp_path / "results")]) == 2
    assert (
        capsys.readouterr().err == f"study: {tmp_path / 'fibula'} is not there. Set AIFRECON_DATA_DIR to the folder that holds fibula/.\n"
    )
