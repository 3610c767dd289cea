"""`aifrecon preview`, `--preview`, and the line that says how to look."""

from __future__ import annotations

import sys

import numpy as np

from AIFReconLib.commands.parser import main
from AIFReconLib.io.transform.files import write_transform


def is_png(path) -> bool:
    return path.read_bytes().startswith(b"\x89PNG")


def test_a_reconstruction_is_drawn_with_it(patient, results, capsys):
    drawn = results / "v.png"
    assert main([*patient.reconstruct, "--output", str(results / "v.nrrd"), "--preview", str(drawn)]) == 0
    assert is_png(drawn)
    assert f"wrote {drawn}" in capsys.readouterr().out


def test_a_volume_is_drawn_later_by_the_command_that_a_terminal_is_shown(patient, results, capsys, monkeypatch):
    volume = results / "v.nrrd"
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    assert main([*patient.reconstruct, "--output", str(volume)]) == 0
    line = capsys.readouterr().out.splitlines()[-1]
    assert "to look at it: " in line
    words = line.partition(" preview ")[2].split()
    assert main(["preview", *words]) == 0
    assert is_png(results / "v.png")


def test_bone_that_does_not_lie_in_the_volume_is_said(patient, results, capsys):
    assert main([*patient.reconstruct, "--output", str(results / "v.nrrd")]) == 0
    aside = np.eye(4)
    aside[0, 3] = 900.0
    write_transform(aside, results / "aside.tfm")
    drawn = ["--output", str(results / "v.png"), "--bone-transform", str(results / "aside.tfm")]
    assert main(["preview", str(results / "v.nrrd"), "--bone-labels", str(patient.labels), *drawn]) == 0
    assert "WARNING: None of the bone lies in the volume." in capsys.readouterr().out
