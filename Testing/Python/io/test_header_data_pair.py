"""A header and its data file in the place of older ones: whatever fails in between, the header names data that fit it."""

from __future__ import annotations

import contextlib
import os

import pytest

from AIFReconLib.errors import OutputError
from AIFReconLib.io.disk.atomic import atomic_outputs, named_data_file

STEPS = 8
"""More renames, links and removals than a replacement takes."""


def write_pair(folder, version: str) -> None:
    """A header that tells its version, and data that tell it too."""
    with atomic_outputs(folder / "a.raw", folder / "a.mhd") as (data, header):
        data.write_text(version, encoding="utf-8")
        header.write_text(f"Version = {version}\nElementDataFile = {data.name}\n", encoding="utf-8")


def read_pair(folder) -> tuple[str, str]:
    """The version in the header, and the version in the data file that the header names."""
    header = (folder / "a.mhd").read_text("utf-8")
    return header.split("Version = ")[1].split("\n")[0], (folder / named_data_file(folder / "a.mhd")).read_text("utf-8")


@pytest.fixture
def older(tmp_path):
    write_pair(tmp_path, "old")
    return tmp_path


def stop_at(monkeypatch, step: int, exception: BaseException) -> None:
    """Let the rename, link or removal with this number fail, and all that follow, as when the program ends there."""
    done = 0

    def failing(function):
        def call(*arguments, **options):
            nonlocal done
            done += 1
            if done > step:
                raise exception
            return function(*arguments, **options)

        return call

    for name in ("replace", "link", "unlink"):
        monkeypatch.setattr(os, name, failing(getattr(os, name)))


@pytest.mark.parametrize("exception", [KeyboardInterrupt(), OSError(5, "no answer")], ids=["Ctrl-C", "a failing disk"])
@pytest.mark.parametrize("step", range(STEPS))
def test_wherever_it_ends_the_header_names_data_of_its_own_version(older, step, exception):
    with pytest.MonkeyPatch.context() as patched:
        stop_at(patched, step, exception)
        with contextlib.suppress(KeyboardInterrupt, OutputError):
            write_pair(older, "new")
    assert read_pair(older) in (("old", "old"), ("new", "new"))


def after_step(monkeypatch, step: int, then) -> None:
    """Call `then` after the rename, link or removal with this number, which is done."""
    done = 0

    def followed(function):
        def call(*arguments, **options):
            nonlocal done
            done += 1
            answer, due = function(*arguments, **options), done == step + 1
            if due:
                then()
            return answer

        return call

    for name in ("replace", "link", "unlink"):
        monkeypatch.setattr(os, name, followed(getattr(os, name)))


@pytest.mark.parametrize("exception", [KeyboardInterrupt(), OSError(5, "no answer")], ids=["Ctrl-C", "a disk that says it failed"])
@pytest.mark.parametrize("step", range(STEPS))
def test_a_step_that_is_done_although_it_fails_leaves_a_whole_pair(older, step, exception):
    def fail():
        raise exception

    with pytest.MonkeyPatch.context() as patched:
        after_step(patched, step, fail)
        with contextlib.suppress(KeyboardInterrupt, OutputError):
            write_pair(older, "new")
    assert read_pair(older) in (("old", "old"), ("new", "new"))


@pytest.mark.parametrize("first", [True, False], ids=["a first pair", "over an older pair"])
@pytest.mark.parametrize("step", range(STEPS))
def test_of_two_writers_of_one_pair_one_wins_whole(tmp_path, step, first):
    if not first:
        write_pair(tmp_path, "old")
    with pytest.MonkeyPatch.context() as patched:
        after_step(patched, step, lambda: write_pair(tmp_path, "other"))
        write_pair(tmp_path, "new")
    assert read_pair(tmp_path) in (("other", "other"), ("new", "new"))


@pytest.mark.parametrize("step", range(STEPS))
def test_of_a_pair_that_was_cut_off_the_next_write_leaves_nothing(older, step):
    with pytest.MonkeyPatch.context() as patched:
        stop_at(patched, step, KeyboardInterrupt())
        with contextlib.suppress(KeyboardInterrupt):
            write_pair(older, "new")
    write_pair(older, "newest")
    assert {path.name for path in older.iterdir()} <= {"a.mhd", "a.raw", named_data_file(older / "a.mhd")}


def test_of_an_older_pair_nothing_is_left(older):
    for version in ("new", "newest"):
        write_pair(older, version)
        assert read_pair(older) == (version, version)
        assert {path.name for path in older.iterdir()} == {"a.mhd", named_data_file(older / "a.mhd")}


def test_a_failure_before_the_switch_leaves_no_data_file_behind(older, monkeypatch):
    stop_at(monkeypatch, 1, OSError(28, "full"))
    with pytest.raises(OutputError, match="disk is full"):
        write_pair(older, "new")
    monkeypatch.undo()
    assert read_pair(older) == ("old", "old")


def test_the_name_of_the_data_file_may_have_any_letters(tmp_path):
    (tmp_path / "a.mhd").write_bytes("NDims = 3\nElementDataFile = \\1 ä%s.raw\n".encode())
    assert named_data_file(tmp_path / "a.mhd") == "\\1 ä%s.raw"


def test_the_data_of_another_header_are_not_replaced(tmp_path):
    """ITK and Slicer call the data of a.nhdr a.raw, too."""
    (tmp_path / "a.nhdr").write_text("NRRD0004\ndata file: a.raw\n", encoding="utf-8")
    (tmp_path / "a.raw").write_text("theirs", encoding="utf-8")
    write_pair(tmp_path, "new")
    assert read_pair(tmp_path) == ("new", "new")
    assert (tmp_path / "a.raw").read_text("utf-8") == "theirs"


def test_data_of_another_name_or_place_stay(tmp_path):
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "a.raw").write_text("theirs", encoding="utf-8")
    (tmp_path / "a.mhd").write_text("NDims = 3\nElementDataFile = b/a.raw\n", encoding="utf-8")
    write_pair(tmp_path, "new")
    assert read_pair(tmp_path) == ("new", "new")
    assert (tmp_path / "b" / "a.raw").read_text("utf-8") == "theirs"
