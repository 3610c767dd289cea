"""`aifrecon compare`: volumes side by side."""

from __future__ import annotations

import pytest

from AIFReconLib.commands.parser import main

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
