"""The command line as a user meets it: what it says when it cannot."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import warnings
from unittest.mock import Mock

import numpy as np
import pytest
from files import refused, tracked_sequence, write_patient
from waiting import until

from AIFReconLib.commands import reconstruct as reconstruct_command
from AIFReconLib.commands.parser import main
from AIFReconLib.errors import SettingsError


def test_one_impossible_pose_costs_one_frame(tmp_path, results, capsys):
    patient = write_patient(tmp_path, tracked_sequence(matrices={2: np.full((4, 4), np.nan)}))
    assert main([*patient.reconstruct, "--output", str(results / "v.nrrd")]) == 0
    assert "5 of 6 frames" in capsys.readouterr().out


@pytest.mark.parametrize(("command", "name"), [("demo", "ct.nrrd"), ("simulate", "PlusDeviceSet.xml")])
def test_simulated_files_replace_none_that_were_not_simulated(command, name, tmp_path, results, capsys):
    (tmp_path / name).write_text("real", encoding="utf-8")
    assert f"it holds {name}, which was not simulated" in refused([command, "--output", tmp_path], capsys, results)


def test_a_full_disk_leaves_no_file(patient, results, capsys, monkeypatch):
    monkeypatch.setattr(os, "fsync", Mock(side_effect=OSError(28, os.strerror(28))))
    assert "disk is full" in refused([*patient.reconstruct, "--output", results / "v.nrrd"], capsys, results)


@pytest.mark.skipif(sys.platform == "win32", reason="Ctrl-C cannot be sent to a child without a console")
def test_ctrl_c_stops_with_130_and_leaves_no_partial_file(results):
    output = results / "demo"
    demo = subprocess.Popen([sys.executable, "-m", "AIFReconLib", "demo", "--output", str(output)], stderr=subprocess.PIPE, text=True)
    assert until(lambda: (output / "ct.nrrd").exists())
    demo.send_signal(signal.SIGINT)
    _, error = demo.communicate()
    assert demo.returncode == 130, error
    assert error.count("\n") == 1, error
    assert not [path for path in output.rglob("*") if path.name.startswith(".") or path.name in ("sweep.igs.mha", "comparison.png")]


def test_a_warning_of_numpy_is_for_the_log(patient, results, capsys, tmp_path, monkeypatch):
    def warning(*_, **__):
        warnings.warn_explicit("invalid value", RuntimeWarning, "module.py", 1)
        raise SettingsError("It ends here.")

    monkeypatch.setattr(reconstruct_command, "sequences_from", warning)
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        words = [*patient.reconstruct, "--output", results / "v.nrrd", "--log", tmp_path / "log.txt"]
        assert refused(words, capsys, results) == "aifrecon: It ends here.\n"
    assert "RuntimeWarning: invalid value" in (tmp_path / "log.txt").read_text()
