"""`aifrecon compare`: volumes side by side."""

from __future__ import annotations

import numpy as np
import pytest

from AIFReconLib.commands.parser import main
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.volume.files import read_volume

pytest.importorskip("matplotlib", reason="matplotlib is not installed")

BEGINS = {".png": b"\x89PNG", ".pdf": b"%PDF", ".svg": b"<?xml"}


@pytest.fixture
def volumes(patient, results, capsys):
    paths = [str(results / f"{method}.nrrd") for method in ("average", "maximum")]
    for path, method in zip(paths, ("average", "maximum"), strict=True):
        assert main([*patient.reconstruct, "--method", method, "--output", path]) == 0
    capsys.readouterr()
    return paths


@pytest.mark.parametrize("suffix", BEGINS)
def test_volumes_are_drawn_beside_each_other_and_the_bone(volumes, patient, results, suffix):
    drawn = results / f"figure{suffix}"
    options = ["--bone-labels", str(patient.labels), "--names", "one", "other", "--white", "--window", "0", "200", "--title", "$x_1"]
    assert main(["compare", *volumes, *options, "--output", str(drawn)]) == 0
    assert drawn.read_bytes().startswith(BEGINS[suffix])
    if suffix == ".svg":
        text = drawn.read_text("utf-8")
        assert all(word in text for word in ("one", "other", "sagittal", "$x_1"))


def test_volumes_that_show_something_else_are_told(volumes, results, capsys):
    first = read_volume(volumes[0])
    moved, other = results / "moved.nrrd", results / "other.nrrd"
    aside = np.eye(4)
    aside[0, 3] = 900.0
    Volume(first.array, aside @ first.ijk_to_reference).write(moved)
    Volume(first.array[::-1], first.ijk_to_reference).write(other)
    drawn = str(results / "figure.png")
    assert main(["compare", *volumes, "--output", drawn]) == 0
    assert "WARNING" not in capsys.readouterr().out
    assert main(["compare", volumes[0], str(moved), str(other), "--output", drawn.replace("figure", "second")]) == 0
    out = capsys.readouterr().out
    assert "WARNING: moved.nrrd hardly shows any of what average.nrrd shows" in out
    assert "WARNING: other.nrrd shows something else than average.nrrd in the same place" in out


def test_without_bone_no_letters_of_a_patient_are_drawn(volumes, results):
    drawn = results / "figure.svg"
    assert main(["compare", *volumes, "--output", str(drawn)]) == 0
    text = drawn.read_text("utf-8")
    assert "average.nrrd" in text
    assert "sagittal" not in text


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (["--output", "v.jpg"], "a figure is a PNG, PDF or SVG"),
        (["--names", "one", "--output", "v.png"], "--names must be 2 different names"),
        (["--names", "one", "one", "--output", "v.png"], "--names must be 2 different names"),
        (["--window", "9", "3", "--output", "v.png"], "--window must be BLACK and WHITE"),
        (["--at", "900", "0", "0", "--output", "v.png"], "the cuts do not go through it. It fills"),
        (["--output", "{first}"], "would overwrite"),
    ],
)
def test_what_cannot_be_drawn_is_refused(volumes, tmp_path, monkeypatch, capsys, options, expected):
    monkeypatch.chdir(tmp_path)
    assert main(["compare", *volumes, *(option.format(first=volumes[0]) for option in options)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert expected in error
