"""Folders to write in: what a killed program left is cleared away, what is in use is not."""

from __future__ import annotations

import os
import subprocess
import sys
import time
import uuid
from importlib.util import find_spec

import pytest

from AIFReconLib.io.disk import workspace as module
from AIFReconLib.io.disk.atomic import check_writable, write_text
from AIFReconLib.io.disk.workspace import LEFT_BEHIND, PREFIX, remove_left_behind, workspace

LEFT = f"{PREFIX}{uuid.getnode():012x}-abcdef12"
needs_locks = pytest.mark.skipif(find_spec("fcntl") is None, reason="folders cannot be locked here")


def left_behind(folder, name=LEFT):
    """A folder as a killed program leaves it."""
    (folder / name).mkdir()
    (folder / name / "half.nrrd").write_bytes(b"half")
    return folder / name


@needs_locks
@pytest.mark.parametrize("write", [check_writable, lambda path: write_text(path, "x")], ids=["check", "write"])
def test_what_a_killed_program_left_is_gone_after_the_next_write(tmp_path, write):
    left_behind(tmp_path)
    write(tmp_path / "a.txt")
    assert not (tmp_path / LEFT).exists()


@pytest.mark.parametrize("name", [".aifrecon-notes", ".aifrecon-0123456789ab-abcdef12", LEFT[1:], None])
def test_a_folder_of_another_name_or_a_link_is_not_ours(tmp_path, name):
    folder = left_behind(tmp_path, name or "real")
    if name is None and os.name != "nt":
        (tmp_path / LEFT).symlink_to(folder)
    remove_left_behind(tmp_path)
    assert (folder / "half.nrrd").exists()


OTHER = """import sys, time, uuid
from pathlib import Path
from AIFReconLib.io.disk import workspace as module
if {elsewhere}: uuid.getnode = lambda: 7
with module.workspace(Path(sys.argv[1])) as folder:
    print(folder, flush=True); time.sleep(60)
"""


@needs_locks
@pytest.mark.parametrize("elsewhere", [False, True], ids=["here", "on another computer whose lock is not seen"])
def test_a_folder_in_use_stays_until_its_program_is_killed(tmp_path, monkeypatch, elsewhere):
    with workspace(tmp_path) as ours:
        remove_left_behind(tmp_path)
        assert ours.is_dir()
    assert not ours.exists()
    if elsewhere:
        # As on a network disk: whoever asks gets the lock
        monkeypatch.setattr(module, "hold", lambda _: True)
    program = [sys.executable, "-c", OTHER.format(elsewhere=elsewhere), str(tmp_path)]
    with subprocess.Popen(program, stdout=subprocess.PIPE, text=True) as other:
        folder = tmp_path / other.stdout.readline().strip().rpartition(os.sep)[2]
        for path in (folder, *folder.iterdir()):
            os.utime(path, (1, 1))
        write_text(tmp_path / "a.txt", "x")
        assert folder.is_dir()
        other.kill()
    remove_left_behind(tmp_path)
    assert folder.exists() == elsewhere


@pytest.mark.parametrize(("age", "stays"), [(LEFT_BEHIND - 60, True), (LEFT_BEHIND + 60, False)], ids=["younger", "older than a day"])
def test_where_folders_cannot_be_locked_their_age_tells(tmp_path, monkeypatch, age, stays):
    monkeypatch.setattr(module, "hold", lambda _: False)
    folder = left_behind(tmp_path)
    for path in (folder / "half.nrrd", folder):
        os.utime(path, (time.time() - age,) * 2)
    remove_left_behind(tmp_path)
    assert folder.exists() == stays
