"""The command line as a user meets it: what it does."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys

import numpy as np
import pytest
from files import tracked_sequence, write_patient
from sweeps import rigid

from AIFReconLib.bone.map import BoneMap
from AIFReconLib.commands.parser import main
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.transform.files import read_transform
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.io.volume.label_files import read_labels
from AIFReconLib.provenance.record import settings_of
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.terminal.reconstruction_options import gigabytes


def test_reconstruct_writes_the_volume_that_the_library_gives(patient, results):
    output = results / "volume.nrrd"
    assert main([*patient.reconstruct, *patient.bone, "--method", "aif", "--output", str(output)]) == 0
    bone = BoneMap.from_labels(read_labels(patient.labels), sigma_mm=1.6, labels_to_reference=read_transform(patient.transform))
    expected = reconstruct(read_sequence(patient.sweep, config=patient.config), ReconstructionSettings(method="aif"), bone)
    written = read_volume(output)
    np.testing.assert_array_equal(written.array, expected.intensity.array)
    np.testing.assert_allclose(written.ijk_to_reference, expected.grid.ijk_to_reference, atol=1e-6)


def test_side_outputs_are_written(patient, results):
    sides = [word for name in ("score", "hits", "mask", "cosine") for word in (f"--{name}", str(results / f"{name}.nrrd"))]
    assert main([*patient.reconstruct, *patient.bone, "--output", str(results / "v.nrrd"), *sides]) == 0
    hits, mask, cosine = (read_volume(results / f"{name}.nrrd").array for name in ("hits", "mask", "cosine"))
    np.testing.assert_array_equal(mask == 1, hits > 0)
    assert 0.5 < cosine.max() <= 1.0


def test_a_ready_probability_serves_as_bone(patient, results):
    main(["bone-map", str(patient.labels), "--bone-sigma-mm", "1.6", "--output", str(results / "p.nrrd")])
    common = ["--bone-transform", str(patient.transform), "--output-type", "float32", "--method", "aif"]
    main([*patient.reconstruct, "--bone-probability", str(results / "p.nrrd"), *common, "--output", str(results / "a.nrrd")])
    main([*patient.reconstruct, *patient.bone, "--output-type", "float32", "--method", "aif", "--output", str(results / "b.nrrd")])
    np.testing.assert_allclose(read_volume(results / "a.nrrd").array, read_volume(results / "b.nrrd").array, atol=1e-2)


def test_grid_like_uses_the_voxels_of_a_rotated_volume(patient, results):
    matrix = rigid((20, 30, 40), (-6, -6, -6)) @ np.diag([0.8, 0.9, 1.0, 1.0])
    Volume(np.zeros((10, 12, 14), np.uint8), matrix).write(results / "like.nrrd")
    assert main([*patient.reconstruct, "--grid-like", str(results / "like.nrrd"), "--output", str(results / "v.nrrd")]) == 0
    written = read_volume(results / "v.nrrd")
    assert written.array.shape == (10, 12, 14)
    np.testing.assert_allclose(written.ijk_to_reference, matrix, atol=1e-6)


def test_a_bone_map_beside_the_sweep_is_a_warning(patient, results, capsys):
    code = main([*patient.reconstruct, "--bone-labels", str(patient.labels), "--bone-sigma-mm", "1", "--output", str(results / "v.nrrd")])
    assert code == 0
    assert "Warning: the bone map does not overlap" in capsys.readouterr().out


def test_clip_and_fan_limit_what_enters_and_a_clip_keeps_the_fan_of_the_configuration(patient, results):
    curved = 'TransducerGeometry="CURVILINEAR" RadiusStartMm="4" RadiusStopMm="12" ThetaStartDeg="-20" ThetaStopDeg="20"'

    def hits(*options):
        main([*patient.reconstruct, *options, "--output", str(results / "v.nrrd"), "--hits", str(results / "h.nrrd")])
        return int(read_volume(results / "h.nrrd").array.sum())

    assert hits("--clip-px", "4", "5", "9", "7") == 6 * 10 * 8
    fan = ("--probe", "sector", "--apex-px", "20", "-10", "--fan-angles-deg", "-20", "20", "--fan-radius-px", "12", "30")
    assert 0 < hits(*fan) < hits()
    patient.config.write_text(patient.config.read_text().replace('TransducerGeometry="LINEAR"', curved))
    assert hits("--clip-px", "0", "0", "39", "29") == hits() < 6 * 40 * 30


def test_weighted_learns_the_gray_scale_of_images_that_are_not_8_bit(tmp_path, results, capsys):
    images = np.random.default_rng(0).integers(1, 4096, (6, 30, 40), dtype=np.uint16)
    patient = write_patient(tmp_path, tracked_sequence(images=images))
    main([*patient.reconstruct, *patient.bone, "--output", str(results / "v.nrrd")])
    assert "--intensity-maximum" not in capsys.readouterr().out
    assert len(settings_of(read_volume(results / "v.nrrd"))["gray_levels"]) == 8


@pytest.mark.skipif(sys.platform == "win32", reason="pipes close differently there")
def test_a_reader_that_goes_away_is_no_error(patient):
    done = subprocess.run(
        f'"{sys.executable}" -m AIFReconLib info "{patient.sweep}" --config "{patient.config}" | true; exit "${{PIPESTATUS[0]}}"',
        shell=True,
        executable="/bin/bash",
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    assert (done.returncode, done.stderr) == (0, "")


SIZES = {"1.5": 1.5e9, "1.5GB": 1.5e9, "1.5 gb": 1.5e9, "800MB": 8e8, "2G": 2e9, "2GiB": 2 * 2**30, "512MiB": 512 * 2**20}


def test_an_amount_of_memory_may_have_its_unit():
    assert {text: gigabytes(text) for text in SIZES} == SIZES


@pytest.mark.parametrize(("given", "expected"), [(None, "1"), ("3", "3")])
def test_small_products_take_one_thread_unless_the_user_says_otherwise(given, expected, monkeypatch):
    """Two for each of them took longer than one, and the cores from the threads that work."""
    from AIFReconLib import __main__ as program

    monkeypatch.setenv("OPENBLAS_NUM_THREADS", given or "")
    if given is None:
        monkeypatch.delenv("OPENBLAS_NUM_THREADS")
    monkeypatch.setattr(sys, "argv", ["aifrecon", "--version"])
    with contextlib.suppress(SystemExit):
        program.main()
    assert os.environ["OPENBLAS_NUM_THREADS"] == expected
