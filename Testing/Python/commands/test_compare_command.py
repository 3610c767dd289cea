"""`aifrecon compare`: volumes side by side."""

from __future__ import annotations

import pytest

from AIFReconLib.commands.parser import main

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
