"""Folders to write in: what a killed program left is cleared away, what is in use is not."""

from __future__ import annotations

import os
import subprocess
import sys
import time
import uuid
from importlib.util import find_spec
from pathlib import Path

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


@pytest.mark.parametrize("name", [".aifrecon-notes", ".aifrecon-0123456789ab-abcdef12", LEFT[1:]])
def test_a_folder_of_another_name_is_not_ours(tmp_path, name):
    left_behind(tmp_path, name)
    remove_left_behind(tmp_path)
    assert (tmp_path / name / "half.nrrd").exists()


@pytest.mark.skipif(os.name == "nt", reason="links need rights on Windows")
def test_a_link_of_that_name_is_not_followed(tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "real" / "a.txt").touch()
    (tmp_path / LEFT).symlink_to(tmp_path / "real")
    remove_left_behind(tmp_path)
    assert (tmp_path / "real" / "a.txt").exists()


@needs_locks
def test_a_folder_in_use_by_this_program_stays(tmp_path):
    with workspace(tmp_path) as folder:
        remove_left_behind(tmp_path)
        assert folder.is_dir()
    assert not folder.exists()


@needs_locks
def test_a_folder_in_use_by_another_program_stays_until_that_is_killed(tmp_path):
    code = (
        "import sys, time; from pathlib import Path; from AIFReconLib.io.disk.workspace import workspace\n"
        "with workspace(Path(sys.argv[1])) as folder: print(folder, flush=True); time.sleep(60)"
    )
    other = subprocess.Popen([sys.executable, "-c", code, str(tmp_path)], stdout=subprocess.PIPE, text=True)
    with other:
        folder = tmp_path / other.stdout.readline().strip().rpartition(os.sep)[2]
        remove_left_behind(tmp_path)
        assert folder.is_dir()
        other.kill()
    remove_left_behind(tmp_path)
    assert not folder.exists()


OTHER = """import sys, time, uuid
from pathlib import Path
from AIFReconLib.io.disk import workspace as module
uuid.getnode = lambda: 7
with module.workspace(Path(sys.argv[1])) as folder:
    print(folder, flush=True); time.sleep(60)
"""


@needs_locks
def test_a_folder_in_use_on_another_computer_whose_lock_is_not_seen_stays(tmp_path, monkeypatch):
    # As on a network disk: whoever asks gets the lock
    monkeypatch.setattr(module, "hold", lambda _: True)
    other = subprocess.Popen([sys.executable, "-c", OTHER, str(tmp_path)], stdout=subprocess.PIPE, text=True)
    with other:
        folder = tmp_path / other.stdout.readline().strip().rpartition(os.sep)[2]
        for path in (folder, *folder.iterdir()):
            os.utime(path, (1, 1))
        write_text(tmp_path / "a.txt", "x")
        assert folder.is_dir()
        other.kill()


@pytest.mark.parametrize(("age", "stays"), [(LEFT_BEHIND - 60, True), (LEFT_BEHIND + 60, False)], ids=["younger", "older than a day"])
def test_where_folders_cannot_be_locked_their_age_tells(tmp_path, monkeypatch, age, stays):
    monkeypatch.setattr(module, "hold", lambda _: False)
    folder = left_behind(tmp_path)
    for path in (folder / "half.nrrd", folder):
        os.utime(path, (time.time() - age,) * 2)
    remove_left_behind(tmp_path)
    assert folder.exists() == stays


@needs_locks
def test_a_new_folder_that_another_program_clears_away_is_made_again(tmp_path, monkeypatch):
    lock, seen = module._locked, []

    def cleared_once(folder):
        seen.append(folder)
        if len(seen) == 1:
            folder.rmdir()
        return lock(folder)

    monkeypatch.setattr(module, "_locked", cleared_once)
    with workspace(tmp_path) as folder:
        assert folder.is_dir()
    assert len(seen) == 2


def test_ctrl_c_while_the_folder_is_made_leaves_nothing(tmp_path, monkeypatch):
    make = Path.mkdir

    def interrupted(path, mode):
        make(path, mode)
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "mkdir", interrupted)
    with pytest.raises(KeyboardInterrupt), workspace(tmp_path):
        pass
    assert list(tmp_path.iterdir()) == []
