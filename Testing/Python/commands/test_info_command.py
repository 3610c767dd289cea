"""`aifrecon info` says what reconstruct would make, with a command that makes just that."""

from __future__ import annotations

import json
import shlex

import numpy as np
import pytest

from AIFReconLib.commands.parser import main
from AIFReconLib.io.volume.files import read_volume


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
    for word in ("box:", "voxels:", "memory:", "Gaps are filled up to", "reconstruct "):
        assert word in said


def test_several_sequences_are_told_one_after_the_other(patient, capsys):
    assert main(["info", str(patient.sweep), str(patient.sweep), "--config", str(patient.config)]) == 0
    assert capsys.readouterr().out.count("To do so:") == 2
    assert main(["info", str(patient.sweep), str(patient.sweep), "--config", str(patient.config), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)) == 2


def test_one_sequence_that_cannot_be_reconstructed_is_told_by_the_exit_code(patient, capsys):
    assert main(["info", str(patient.sweep)]) == 1
    assert "To do so:" not in capsys.readouterr().out
