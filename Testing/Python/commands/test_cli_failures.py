"""The command line as a user meets it: what it says when it cannot."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import warnings
from dataclasses import replace

import numpy as np
import pytest
import SimpleITK as sitk
from files import refused, tracked_sequence, write_patient
from waiting import until

from AIFReconLib.commands import reconstruct as reconstruct_command
from AIFReconLib.commands.parser import main
from AIFReconLib.errors import SettingsError
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.sweep.frames import FrameRecord


@pytest.mark.parametrize(
    ("matrix", "reason"),
    [
        (np.full((4, 4), np.nan), "not finite"),
        (np.diag([1.0, 1.0, 0.0, 1.0]), "not rigid"),
        (np.diag([1.0, 1.3, 1.0, 1.0]), "not rigid"),
        (np.diag([-1.0, 1.0, 1.0, 1.0]), "mirrored"),
    ],
    ids=["NaN", "singular", "scaled", "mirrored"],
)
def test_poses_that_cannot_be_are_refused_when_there_are_no_others(matrix, reason, tmp_path, results, capsys):
    patient = write_patient(tmp_path, tracked_sequence(matrices=dict.fromkeys(range(6), matrix)))
    results = tmp_path / "only-results"
    results.mkdir()
    assert reason in refused([*patient.reconstruct, "--output", results / "v.nrrd"], capsys, results)


def test_one_impossible_pose_costs_one_frame(tmp_path, results, capsys):
    patient = write_patient(tmp_path, tracked_sequence(matrices={2: np.full((4, 4), np.nan)}))
    assert main([*patient.reconstruct, "--output", str(results / "v.nrrd")]) == 0
    assert "5 of 6 frames" in capsys.readouterr().out


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="permissions do not bind this user")
def test_a_read_only_folder_is_refused(patient, results, capsys):
    results.chmod(0o500)
    refused([*patient.reconstruct, "--output", results / "v.nrrd"], capsys, results)


@pytest.mark.parametrize(("command", "name"), [("demo", "ct.nrrd"), ("simulate", "PlusDeviceSet.xml")])
def test_simulated_files_replace_none_that_were_not_simulated(command, name, tmp_path, results, capsys):
    (tmp_path / name).write_text("real", encoding="utf-8")
    assert f"it holds {name}, which was not simulated" in refused([command, "--output", tmp_path], capsys, results)


def test_a_full_disk_leaves_no_file(patient, results, capsys, monkeypatch):
    def full(*_):
        raise OSError(28, os.strerror(28))

    monkeypatch.setattr(os, "fsync", full)
    assert "disk is full" in refused([*patient.reconstruct, "--output", results / "v.nrrd"], capsys, results)


@pytest.mark.skipif(sys.platform == "win32", reason="file size limits are POSIX")
def test_a_write_that_stops_halfway_leaves_no_file(patient, results):
    """The system itself refuses to let the file grow beyond 2 kB, as it would on a full disk."""
    limit = (
        "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (2048, 2048)); "
        "from AIFReconLib.commands.parser import main; sys.exit(main())"
    )
    command = [sys.executable, "-c", limit, *patient.reconstruct, "--spacing", "0.3", "--output", str(results / "v.nrrd")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2, done.stderr
    assert done.stderr.count("\n") == 1, done.stderr
    assert list(results.iterdir()) == []


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


# ---- inputs stay, also those that are read and not named


def _itself(folder):
    patient = write_patient(folder)
    return [*patient.reconstruct, "--output", patient.sweep]


def _data_of_a_header(folder):
    write_sequence(tracked_sequence(), folder / "scan.mhd")
    (folder / "scan.zraw").rename(folder / "frames.zraw")
    header = (folder / "scan.mhd").read_text()
    (folder / "scan.mhd").write_text(header.replace("scan.zraw", "frames.zraw"))
    return ["reconstruct", folder / "scan.mhd", "--output", folder / "frames.mhd"]


def _mask_of_a_configuration(folder):
    patient = write_patient(folder)
    (folder / "mask.png").write_bytes(b"mask")
    named = f'<VolumeReconstruction CompoundingMode="IMPORTANCE_MASK" ImportanceMaskFilename="{folder / "mask.png"}" '
    patient.config.write_text(patient.config.read_text("utf-8").replace("<VolumeReconstruction ", named), encoding="utf-8")
    return [*patient.reconstruct, "--output", folder / "v.nrrd", "--preview", folder / "mask.png"]


def _image_of_a_folder(folder):
    (folder / "1.png").write_bytes(b"image")
    (folder / "poses.csv").write_text("x", encoding="utf-8")
    words = ["import", folder, "--poses", folder / "poses.csv", "--transform", "ImageToTracker", "--output", folder / "s.mha"]
    return [*words, "--drawing", folder / "1.png"]


def _acquisition(folder):
    """Of CustusX: frames with data files of their own, times, poses."""
    base = folder / "US-Acq_1_Probe"
    frames = tracked_sequence(count=3)
    for number in range(3):
        write_sequence(replace(frames, images=frames.images[[number]], records=[FrameRecord()]), folder / f"{base.name}_{number}.mhd")
    base.with_suffix(".fts").write_text("1000\n1050\n1100\n")
    base.with_suffix(".fp").write_text("1 0 0 0\n0 1 0 0\n0 0 1 0\n" * 3)
    return ["convert", base.with_suffix(".fts"), folder / f"{base.name}_2.mhd"]


def _slices(folder):
    """A CT of one file a slice, one of which is named."""
    series = sitk.ImageFileWriter()
    series.KeepOriginalImageUIDOn()
    for number in range(4):
        image = sitk.GetImageFromArray(np.zeros((8, 8), np.int16))
        tags = {"0008|0060": "CT", "0020|000e": "1.2.3", "0020|000d": "1.2", "0008|0018": f"1.2.3.{number}"}
        for tag, value in {**tags, "0020|0032": f"0\\0\\{number}", "0020|0013": str(number)}.items():
            image.SetMetaData(tag, value)
        series.SetFileName(str(folder / f"{number}.dcm"))
        series.Execute(image)
    return ["preview", folder / "0.dcm", "--ct", folder / "1.dcm", "--output", folder / "3.dcm"]


def _other_name(folder):
    patient = write_patient(folder)
    (folder / "other.igs.mha").hardlink_to(patient.sweep)
    return ["convert", patient.sweep, folder / "other.igs.mha"]


CASES = [_itself, _data_of_a_header, _mask_of_a_configuration, _image_of_a_folder, _acquisition, _slices, _other_name]


@pytest.mark.parametrize("case", CASES)
def test_an_output_never_overwrites_what_is_read(case, tmp_path, results, capsys):
    words = case(tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    assert "would overwrite an input" in refused(words, capsys, results)
    assert {path: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()} == before


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
