"""Windows and macOS where there is neither: what differs there and can be brought about here. docs/developers.md has the list."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import PureWindowsPath
from unittest import mock

import pytest
from doc_pages import REPOSITORY
from files import refused

from AIFReconLib.commands.parser import main
from AIFReconLib.io.foreign.poses.files import read_poses
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.transform.files import read_transform
from AIFReconLib.provenance.settings_files import read_settings
from AIFReconLib.terminal import outputs

LIBRARY = REPOSITORY / "AIFReconLib"
POSIX_ALONE = {"fcntl", "resource", "pwd", "grp", "termios", "tty", "pty", "syslog"}
AS_ON_WINDOWS = """
import os, signal, sys
for name in {modules}:
    sys.modules[name] = None
for holder, names in ((os, ("sched_getaffinity", "fork", "mkfifo", "geteuid", "getuid")), (signal, ("SIGHUP", "SIGKILL"))):
    for name in names:
        if hasattr(holder, name):
            delattr(holder, name)
from AIFReconLib.commands.parser import main
sys.exit(main(sys.argv[1:]))
"""


def test_a_volume_is_made_without_what_windows_has_not_and_in_utf_8_whatever_the_locale(patient, results):
    """In a process of its own, which tells of every text file that is opened in the locale's encoding."""
    command = [sys.executable, "-X", "warn_default_encoding", "-W", "always::EncodingWarning"]
    program = AS_ON_WINDOWS.format(modules=sorted(POSIX_ALONE))
    arguments = [*patient.reconstruct, *patient.bone, "--spacing", "2", "--output", str(results / "volume.nrrd")]
    done = subprocess.run([*command, "-c", program, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert [line for line in done.stderr.splitlines() if "EncodingWarning" in line and str(LIBRARY) in line] == []
    assert (results / "volume.nrrd").stat().st_size > 0


# ---- names


@pytest.mark.parametrize("system", ["win32", "darwin"])
def test_an_output_that_differs_from_an_input_in_capitals_alone_is_refused(patient, results, monkeypatch, capsys, system):
    monkeypatch.setattr(outputs.sys, "platform", system)
    written = patient.sweep.with_name(patient.sweep.name.upper())
    assert "would overwrite an input" in refused([*patient.reconstruct, "--output", written], capsys, results)


@pytest.mark.parametrize("name", ["D:\\Daten\\Jürgen\\mask.png", "masks\\mask.png", "..\\mask.png"])
def test_a_windows_path_in_a_configuration_leads_to_the_same_file_anywhere(tmp_path, name):
    path = tmp_path / "plus" / "plus.xml"
    path.parent.mkdir()
    path.write_text(
        f'<PlusConfiguration><VolumeReconstruction CompoundingMode="IMPORTANCE_MASK" ImportanceMaskFilename="{name}"/></PlusConfiguration>',
        "utf-8",
    )
    mask = read_plus_configuration(path).importance_mask
    assert mask is not None
    assert PureWindowsPath(mask).parts[-2:] == (path.parent / PureWindowsPath(name).as_posix()).parts[-2:]


# ---- line ends of Windows


TEXTS = {
    "plus.xml": (read_plus_configuration, lambda patient: patient.config.read_text("utf-8")),
    "transform.tfm": (read_transform, lambda patient: patient.transform.read_text("utf-8")),
    "settings.json": (read_settings, lambda patient: '{\n  "method": "average",\n  "spacing": 0.5\n}\n'),
    "settings.toml": (read_settings, lambda patient: 'method = "average"\nspacing = 0.5\n'),
    "poses.csv": (read_poses, lambda patient: "time,x,y,z,qx,qy,qz,qw\n0.0,1,2,3,0,0,0,1\n0.1,2,3,4,0,0,0,1\n"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_a_text_file_may_have_the_line_ends_of_windows(patient, tmp_path, name):
    read, text = TEXTS[name]
    found = []
    for folder, ends in (("lf", "\n"), ("crlf", "\r\n")):
        path = tmp_path / folder / name
        path.parent.mkdir()
        path.write_bytes(text(patient).replace("\n", ends).encode())
        found.append(re.sub(r"(crlf|lf)\b", "", repr(read(path))))
    assert found[0] == found[1]


# ---- files that another program holds open


def test_a_file_that_another_program_holds_open_is_not_replaced_and_said_so(patient, results, monkeypatch, capsys):
    """Windows refuses to rename over it."""
    held = PermissionError(13, "The process cannot access the file because it is being used by another process")
    volume = results / "volume.nrrd"
    volume.write_bytes(b"older")
    monkeypatch.setattr(os, "replace", mock.Mock(side_effect=held))
    assert main([*patient.reconstruct, "--spacing", "2", "--output", str(volume)]) == 2
    assert "close programs that hold the file open" in capsys.readouterr().err
    assert volume.read_bytes() == b"older"
    assert [path.name for path in results.iterdir()] == ["volume.nrrd"]
