"""`aifrecon info` says what reconstruct would make, with a command that makes just that."""

from __future__ import annotations

import json
import shlex

import numpy as np
import pytest

from AIFReconLib.commands.parser import main
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses


def planned(capsys, *words) -> dict:
    assert main(["info", *map(str, words), "--json"]) == 0
    return json.loads(capsys.readouterr().out)["plan"]


@pytest.mark.parametrize("options", [(), ("--time-offset", "0.01"), ("--reference", "Tracker")])
def test_the_command_that_is_given_makes_the_volume_that_was_announced(patient, options, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    plan = planned(capsys, patient.sweep, "--config", patient.config, *options)
    words = shlex.split(plan["command"])
    assert main(words[words.index("reconstruct") :]) == 0
    said = capsys.readouterr().out
    made = read_volume(tmp_path / words[-1])
    assert list(made.grid.size) == plan["size"]
    np.testing.assert_allclose(made.grid.ijk_to_reference, plan["ijk_to_reference"], atol=1e-9)
    assert said.startswith(plan["method"])
    assert f"up to {plan['hole_limit_mm']:g} mm" in said


def test_box_voxels_memory_and_command_are_printed(patient, capsys):
    assert main(["info", str(patient.sweep), "--config", str(patient.config)]) == 0
    said = capsys.readouterr().out
    ready = "Ready: 6 of 6 frames can be placed by ImageToProbe, ProbeToTracker, TrackerToReference."
    facts = (ready, "6 of 40 x 30 pixels, uint8", "0.4 x 0.5 mm", "20.0 frames/s")
    for word in (*facts, "box:", "voxels:", "memory:", "Gaps between frames are filled up to", "reconstruct "):
        assert word in said


def test_several_sequences_are_told_one_after_the_other(patient, capsys):
    assert main(["info", str(patient.sweep), str(patient.sweep), "--config", str(patient.config)]) == 0
    assert capsys.readouterr().out.count("To do so:") == 2
    assert main(["info", str(patient.sweep), str(patient.sweep), "--config", str(patient.config), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)) == 2


@pytest.fixture
def unknown_probe(patient, tmp_path):
    """The sweep of the patient, lit from side to side: no outline tells the probe."""
    path = tmp_path / "lit.igs.mha"
    sequence = read_sequence(patient.sweep, config=patient.config)
    images = np.random.default_rng(1).integers(20, 200, (len(sequence), *sequence.frame_size[::-1])).astype(np.uint8)
    poses = sweep_poses(sequence).image_to_reference
    write_sequence(TrackedSequence.from_arrays(images, poses, np.arange(len(images)) * 0.1), path)
    return path


@pytest.mark.parametrize(
    ("with_labels", "words"), [(True, ("Not ready for bone", "--probe")), (False, ("Ready:", "For a CT's bone, more is needed"))]
)
def test_that_bone_needs_the_probe_is_said_and_where_bone_will_be_asked_for_the_probe_is_first(
    with_labels, words, unknown_probe, patient, capsys
):
    labels = ["--bone-labels", str(patient.labels)] if with_labels else []
    assert main(["info", str(unknown_probe), *labels]) == with_labels
    said = capsys.readouterr().out
    assert [word for word in words if word not in said] == []
    assert ("Ready:" in said) != with_labels


def test_with_the_probe_and_labels_the_command_has_them(unknown_probe, patient, capsys):
    plan = planned(capsys, unknown_probe, "--bone-labels", patient.labels, "--probe", "linear")
    assert plan["method"] == "weighted"
    assert f"--bone-labels {patient.labels}" in plan["command"]
    assert "--probe linear" in plan["command"]


def test_a_rectangle_that_was_recognized_stands_in_the_command(tmp_path, monkeypatch, capsys):
    images = np.zeros((6, 120, 160), np.uint8)
    images[:, 10:110, 40:130] = np.random.default_rng(2).integers(30, 220, (6, 100, 90))
    poses = np.tile(np.diag([0.2, 0.2, 0.2, 1.0]), (6, 1, 1))
    poses[:, 2, 3] = np.arange(6)
    write_sequence(TrackedSequence.from_arrays(images, poses, np.arange(6) * 0.1), tmp_path / "linear.igs.mha")
    monkeypatch.chdir(tmp_path)
    plan = planned(capsys, "linear.igs.mha")
    assert "--clip-px 40 10 89 99" in plan["command"]
    words = shlex.split(plan["command"])
    assert main(words[words.index("reconstruct") :]) == 0
    assert list(read_volume(tmp_path / words[-1]).grid.size) == plan["size"]


def test_where_the_images_lie_is_drawn_where_that_is_asked_for(patient, results, capsys):
    drawing = results / "sweep.svg"
    assert main(["info", str(patient.sweep), "--config", str(patient.config), "--drawing", str(drawing)]) == 0
    assert drawing.read_text("utf-8").startswith("<svg")
    assert f"drew {drawing}" in capsys.readouterr().out
    assert main(["info", str(patient.sweep), str(patient.sweep), "--config", str(patient.config), "--drawing", str(drawing)]) == 2
    assert main(["info", str(patient.sweep), "--config", str(patient.config), "--drawing", str(patient.sweep)]) == 2
    assert "would overwrite" in capsys.readouterr().err
