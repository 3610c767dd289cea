"""`aifrecon preview`, `--preview`, and the line that says how to look."""

from __future__ import annotations

import sys

import pytest

from AIFReconLib.commands.parser import main

pytest.importorskip("matplotlib", reason="matplotlib is not installed")


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


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (("--output", "v.jpg"), "a preview is a PNG picture"),
        (("--output", "v.png", "--bone-transform", "t.tfm"), "--bone-transform places labels or a CT"),
        (("--output", "none/v.png"), "none"),
    ],
)
def test_what_cannot_be_drawn_is_refused_before_anything_is_read(options, expected, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["preview", "missing.nrrd", *options]) == 2
    assert expected in capsys.readouterr().err
