"""Output files: complete under their name, or not there."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from unittest.mock import Mock

import pytest

from AIFReconLib.errors import OutputError
from AIFReconLib.io.disk import atomic
from AIFReconLib.io.disk.atomic import atomic_output, atomic_outputs, check_writable, write_text


def content_of(folder) -> dict[str, str]:
    return {path.name: path.read_text(encoding="utf-8") for path in folder.iterdir()}


def fail_with(code: int) -> Mock:
    """A function that fails as the system would."""
    return Mock(side_effect=OSError(code, os.strerror(code)))


def test_a_file_that_did_not_come_about_is_no_success(tmp_path):
    write_text(tmp_path / "a.mhd", "old")
    refused = pytest.raises(OutputError, match=r"a\.mhd: the file did not come about\. Try again")
    with refused, atomic_outputs(tmp_path / "a.zraw", tmp_path / "a.mhd") as (data, _):
        data.touch()
    assert content_of(tmp_path) == {"a.mhd": "old"}


ERRORS = {
    errno.ENOSPC: "the disk is full. Free some space",
    errno.EACCES: "no permission",
    errno.EROFS: "Read-only file system",
    errno.EIO: "Input/output error. Choose another path",
    errno.EMFILE: "too many files are open",
    errno.EBUSY: "Choose another path",
}


@pytest.mark.parametrize(("code", "expected"), ERRORS.items())
def test_a_system_error_becomes_an_output_error_and_leaves_nothing(tmp_path, code, expected):
    refused = pytest.raises(OutputError, match=expected)
    with refused as caught, atomic_output(tmp_path / "a.txt") as temporary:
        temporary.write_text("half", encoding="utf-8")
        fail_with(code)()
    assert str(tmp_path / "a.txt") in str(caught.value)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_a_disk_that_is_full_at_the_end_leaves_the_older_file(tmp_path, monkeypatch, step):
    write_text(tmp_path / "a.txt", "old")
    monkeypatch.setattr(os, step, fail_with(errno.ENOSPC))
    with pytest.raises(OutputError, match="the disk is full"):
        write_text(tmp_path / "a.txt", "new")
    assert content_of(tmp_path) == {"a.txt": "old"}


@pytest.mark.parametrize("write", [check_writable, lambda path: write_text(path, "x")], ids=["before", "when writing"])
def test_what_cannot_be_written_to_is_refused_before_and_when_writing(tmp_path, monkeypatch, write):
    with pytest.raises(OutputError, match="File name too long"):
        write(tmp_path / ("a" * 300))
    if os.path.exists("/dev/null"):
        with pytest.raises(OutputError, match="device"):
            write("/dev/null")
    monkeypatch.setattr(Path, "mkdir", fail_with(errno.EACCES))
    with pytest.raises(OutputError, match="no permission"):
        write(tmp_path / "a.txt")


@pytest.mark.skipif(os.name == "nt", reason="links need rights on Windows")
def test_a_link_stays_a_link_to_the_new_file(tmp_path):
    (tmp_path / "real").mkdir()
    write_text(tmp_path / "real" / "a.txt", "old")
    (tmp_path / "a.txt").symlink_to(tmp_path / "real" / "a.txt")
    write_text(tmp_path / "a.txt", "new")
    assert (tmp_path / "a.txt").is_symlink()
    assert (tmp_path / "real" / "a.txt").read_text(encoding="utf-8") == "new"


def test_no_two_versions_of_a_file_share_a_time(tmp_path, monkeypatch):
    """The system's own clock of files ticks every few ms."""
    monkeypatch.setattr(atomic.time, "time_ns", iter([10**18, 10**18 + 100]).__next__)
    times = []
    for text in ("old", "new"):
        write_text(tmp_path / "a.txt", text)
        times.append((tmp_path / "a.txt").stat().st_mtime_ns)
    assert times == [10**18, 10**18 + 100]
